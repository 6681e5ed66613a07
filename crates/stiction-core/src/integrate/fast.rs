//! Velocity Verlet with trapezoidal damping: one evaluation of friction a step.

use super::events::Stepper;
use super::plain::hold;
use super::{Integrator, steep};
use crate::friction::elements::plain_steps::not_beyond_a_stop;
use crate::friction::{Channels, FrictionLaw, Motion};
use crate::math::scalar::Scalar;
use crate::math::verlet::Verlet;
use crate::plant::effects::Situation;
use crate::plant::{Machine, Run};

/// The fast integrator over one sample.
///
/// `BARE` promises [`Machine::is_bare`]; it changes no bit.
pub(super) struct Fast<'a, S: Scalar, const BARE: bool> {
    pub machine: &'a Machine<S>,
    pub run: &'a mut Run<S>,
    pub input: S,
    pub load: S,
    /// Duration of the pieces of a step in which friction comes to fall with speed.
    pub piece: f64,
}

impl<S: Scalar, const BARE: bool> Fast<'_, S, BARE> {
    /// What reaches the contact.
    #[inline]
    fn channels(&self, at: &Situation<S>, effort: S) -> Channels<S> {
        if BARE {
            self.machine.plain_channels(at, effort, self.load)
        } else {
            self.machine.channels(at, effort, self.load)
        }
    }
}

/// A step: the run after it, the law's trial and the motion at the contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Attempt<S, T> {
    pub run: Run<S>,
    pub trial: T,
    pub motion: Motion<S>,
}

impl<S: Scalar, L: FrictionLaw<S>, const BARE: bool> Stepper<S, L> for Fast<'_, S, BARE> {
    type Attempt = Attempt<S, L::Trial>;
    const COST: u64 = Integrator::Fast.of_step::<S>(L::STEEP);

    // x₁ = x₀ + h·v₀ + h²/2·a₀,  v₁ = v₀ + h/2·(a₀ + a₁); the part of friction that depends on
    // the velocity at the end is linearised about v₀ + h·a₀, which leaves an error of third order.
    #[inline(always)]
    fn attempt(&self, law: &L, state: &L::State, span: S) -> Self::Attempt {
        let (machine, run) = (self.machine, &*self.run);
        if L::STEEP {
            return steep::attempt(machine, run, (self.input, self.load), law, state, span);
        }
        let verlet = Verlet::new(span, machine.inertia, machine.lightness);
        let start = run.situation();
        let effort = if BARE {
            machine.bare_drive(self.input, run.enabled) + self.load + run.ambient
        } else {
            machine.driven(self.input, &start) + self.load + run.ambient
        };
        let (held, drag) = law.friction(state, run.velocity, &self.channels(&start, effort));
        let push = effort - held;
        let (verlet, friction, net) = match drag {
            None => (verlet, held, push),
            Some(damping) => {
                let dragged = damping * run.velocity;
                (verlet.dragged(damping), held + dragged, push - dragged)
            }
        };
        let displacement = verlet.displacement(run.velocity, push);
        let predicted = verlet.predicted(run.velocity, net);
        let shown = not_beyond_a_stop::<S, L>(run.velocity, predicted);
        let end = start.after(displacement, shown, span);
        let mut next = *run;
        next.position = end.position;
        next.time = end.time;
        next.path = end.path;
        next.moved = end.moved;
        let mut at_contact = displacement;
        let effort_then = if BARE {
            next.ambient = machine.weight();
            machine.bare_drive(self.input, run.enabled) + self.load + next.ambient
        } else {
            machine.swing(&start, &end, span, &mut next);
            next.ambient = machine.ambient(&end, next.second_position, next.second_velocity);
            if machine.relaxes() {
                let (hardened, crept) = machine.relax(run.relaxed, friction, span);
                next.relaxed = hardened;
                at_contact -= crept;
            }
            machine.driven(self.input, &end) + self.load + next.ambient
        };
        let mut motion = Motion {
            displacement: at_contact,
            duration: span,
            start_velocity: run.velocity,
            velocity: predicted,
        };
        let trial = law.advance(state, &motion, &self.channels(&end, effort_then));
        let outcome = law.outcome(&trial);
        let undamped = law.undamped(&trial, predicted);
        next.velocity = verlet.arrive(run.velocity, push + effort_then, outcome.damping, undamped);
        next.friction = undamped + outcome.damping * next.velocity;
        motion.velocity = next.velocity;
        Attempt { run: next, trial, motion }
    }

    #[inline(always)]
    fn pieces(&self, law: &L, state: &L::State, span: S) -> f64 {
        if !L::FALLS_AT_TIMES || span.re() <= self.piece || !law.falls(state) {
            return 1.0;
        }
        // What is round-off beyond so many is no piece.
        (span.re() / self.piece * (1.0 - 1e-9)).ceil()
    }

    #[inline]
    fn contact<'a>(&self, attempt: &'a Self::Attempt) -> (&'a L::Trial, &'a Motion<S>) {
        (&attempt.trial, &attempt.motion)
    }

    #[inline]
    fn accept(&mut self, law: &L, state: &mut L::State, attempt: &Self::Attempt, stopped: bool) {
        law.commit(state, &attempt.trial);
        *self.run = attempt.run;
        if stopped {
            self.run.velocity = S::constant(0.0);
        }
    }

    #[inline]
    fn velocity(&self) -> S {
        self.run.velocity
    }

    #[inline]
    fn hold(&mut self, law: &L, state: &mut L::State, span: S) -> bool {
        hold(self.machine, self.run, (self.input, self.load), law, state, span)
    }
}
