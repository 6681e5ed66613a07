//! Velocity Verlet with trapezoidal damping: one evaluation of friction a step.

use super::events::Stepper;
use super::machine::{Machine, Run, hold};
use super::steep;
use crate::friction::{FrictionLaw, Motion};
use crate::scalar::Scalar;

/// The fast integrator over one sample.
pub(super) struct Fast<'a, S: Scalar> {
    pub machine: &'a Machine<S>,
    pub run: &'a mut Run<S>,
    pub input: S,
    pub load: S,
}

/// A step: the run after it, the law's trial and the motion at the contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Attempt<S, T> {
    pub run: Run<S>,
    pub trial: T,
    pub motion: Motion<S>,
}

impl<S: Scalar, L: FrictionLaw<S>> Stepper<S, L> for Fast<'_, S> {
    type Attempt = Attempt<S, L::Trial>;

    // x₁ = x₀ + h·v₀ + h²/2·a₀,  v₁ = v₀ + h/2·(a₀ + a₁); the part of friction that depends on
    // the velocity at the end is linearised about v₀ + h·a₀, which leaves an error of third order.
    #[inline]
    fn attempt(&self, law: &L, state: &L::State, span: S) -> Self::Attempt {
        let (machine, run) = (self.machine, &*self.run);
        if L::STEEP {
            return steep::attempt(machine, run, (self.input, self.load), law, state, span);
        }
        let half = span * 0.5;
        let start = run.situation();
        let effort = machine.driven(self.input, &start) + self.load + run.ambient;
        let channels = machine.channels(&start, effort, self.load);
        let friction = law.force(state, run.velocity, &channels);
        let acceleration = (effort - friction) / machine.inertia;
        let displacement = span * (run.velocity + half * acceleration);
        let predicted = run.velocity + span * acceleration;
        let end = start.after(displacement, predicted, span);
        let mut next = *run;
        next.position = end.position;
        next.time = end.time;
        next.path = end.path;
        next.moved = end.moved;
        machine.swing(&start, &end, span, &mut next);
        next.ambient = machine.ambient(&end, next.second_position, next.second_velocity);
        let mut at_contact = displacement;
        if machine.relaxes() {
            let (hardened, crept) = machine.relax(run.relaxed, friction, span);
            next.relaxed = hardened;
            at_contact -= crept;
        }
        let effort_then = machine.driven(self.input, &end) + self.load + next.ambient;
        let mut motion = Motion {
            displacement: at_contact,
            duration: span,
            start_velocity: run.velocity,
            velocity: predicted,
        };
        let trial = law.advance(state, &motion, &machine.channels(&end, effort_then, self.load));
        let outcome = law.outcome(&trial);
        let gathered =
            effort - friction + effort_then - outcome.force + outcome.damping * predicted;
        next.velocity = (machine.inertia * run.velocity + half * gathered)
            / (machine.inertia + half * outcome.damping);
        next.friction = outcome.force + outcome.damping * (next.velocity - predicted);
        motion.velocity = next.velocity;
        Attempt { run: next, trial, motion }
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
