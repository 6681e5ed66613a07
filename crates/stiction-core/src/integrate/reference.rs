//! Runge-Kutta of fourth order on body and internal variables: the yardstick for the fast one.

use super::events::Stepper;
use super::fast::Attempt;
use super::plain::hold;
use super::{Integrator, steep};
use crate::friction::elements::plain_steps::not_beyond_a_stop;
use crate::friction::{FrictionLaw, INTERNAL, Motion};
use crate::math::scalar::{Scalar, sign};
use crate::plant::effects::Situation;
use crate::plant::{Machine, Run};

/// The reference integrator over one sample.
pub(super) struct Reference<'a, S: Scalar> {
    pub machine: &'a Machine<S>,
    pub run: &'a mut Run<S>,
    pub input: S,
    pub load: S,
}

/// Displacement, velocity, both of the second mass, hardening of the relaxation, steady creep,
/// internal variables of the law.
const SIZE: usize = 6 + INTERNAL;

impl<S: Scalar> Reference<'_, S> {
    fn motion(&self, y: &[S; SIZE], span: S, friction: S) -> Motion<S> {
        let crept = (y[4] - self.run.relaxed) * sign(friction.re()) + y[5];
        Motion {
            displacement: y[0] - crept,
            duration: span,
            start_velocity: self.run.velocity,
            velocity: y[1],
        }
    }

    fn situation(&self, y: &[S; SIZE], span: S) -> Situation<S> {
        self.run.situation().after(y[0], y[1], span)
    }

    fn effort(&self, at: &Situation<S>, y: &[S; SIZE]) -> S {
        self.machine.driven(self.input, at) + self.load + self.machine.ambient(at, y[2], y[3])
    }

    fn rates<L: FrictionLaw<S>>(
        &self,
        law: &L,
        state: &L::State,
        y: &[S; SIZE],
        span: S,
    ) -> [S; SIZE] {
        let machine = self.machine;
        let shown = not_beyond_a_stop::<S, L>(self.run.velocity, y[1]);
        let at = self.run.situation().after(y[0], shown, span);
        let effort = self.effort(&at, y);
        let channels = machine.channels(&at, effort, self.load);
        let internal = [y[6], y[7], y[8]];
        let motion = self.motion(y, span, self.run.friction);
        let (friction, inner) = law.rates(state, &motion, &internal, &channels);
        let zero = S::constant(0.0);
        let second = machine.shaft.map_or(zero, |shaft| {
            let dragged = shaft.load_damping * y[3];
            -(machine.shaft(&at, y[2], y[3]) / shaft.inertia + dragged)
        });
        let relaxing = match machine.relaxation {
            Some(module) if !machine.slides(friction) => module.hardening_rate(y[4], friction),
            _ => zero,
        };
        let creeping = match machine.steady_creep {
            Some(creep) if !machine.slides(friction) => creep.speed(friction),
            _ => zero,
        };
        [
            y[1],
            (effort - friction) / machine.inertia,
            y[3],
            second,
            relaxing,
            creeping,
            inner[0],
            inner[1],
            inner[2],
        ]
    }
}

impl<S: Scalar, L: FrictionLaw<S>> Stepper<S, L> for Reference<'_, S> {
    type Attempt = Attempt<S, L::Trial>;
    const COST: u64 = Integrator::Reference.of_step::<S>(L::STEEP);

    fn attempt(&self, law: &L, state: &L::State, span: S) -> Self::Attempt {
        let run = &*self.run;
        if L::STEEP {
            return steep::finer(self.machine, run, (self.input, self.load), law, state, span);
        }
        let [a, b, c] = law.internal(state);
        let start = [
            S::constant(0.0),
            run.velocity,
            run.second_position,
            run.second_velocity,
            run.relaxed,
            S::constant(0.0),
            a,
            b,
            c,
        ];
        let along = |rates: &[S; SIZE], span: S| {
            let mut y = start;
            for (y, rate) in y.iter_mut().zip(rates) {
                *y += *rate * span;
            }
            y
        };
        let (zero, half) = (S::constant(0.0), span * 0.5);
        let k1 = self.rates(law, state, &start, zero);
        let k2 = self.rates(law, state, &along(&k1, half), half);
        let k3 = self.rates(law, state, &along(&k2, half), half);
        let k4 = self.rates(law, state, &along(&k3, span), span);
        let mut mean = k1;
        for (j, mean) in mean.iter_mut().enumerate() {
            *mean = (k1[j] + (k2[j] + k3[j]) * 2.0 + k4[j]) / 6.0;
        }
        let y = along(&mean, span);
        let at = self.situation(&y, span);
        let effort = self.effort(&at, &y);
        let motion = self.motion(&y, span, run.friction);
        let trial = law.settle(
            state,
            &motion,
            &[y[6], y[7], y[8]],
            &self.machine.channels(&at, effort, self.load),
        );
        let friction = law.outcome(&trial).force;
        let next = Run {
            position: at.position,
            velocity: y[1],
            time: at.time,
            path: at.path,
            moved: at.moved,
            transmitted: at.transmitted,
            temperature: at.temperature,
            wound: run.wound,
            enabled: run.enabled,
            friction,
            second_position: y[2],
            second_velocity: y[3],
            relaxed: if self.machine.slides(friction) { S::constant(0.0) } else { y[4] },
            ambient: self.machine.ambient(&at, y[2], y[3]),
            budget: run.budget,
        };
        Attempt { run: next, trial, motion }
    }

    fn contact<'a>(&self, attempt: &'a Self::Attempt) -> (&'a L::Trial, &'a Motion<S>) {
        (&attempt.trial, &attempt.motion)
    }

    fn accept(&mut self, law: &L, state: &mut L::State, attempt: &Self::Attempt, stopped: bool) {
        law.commit(state, &attempt.trial);
        *self.run = attempt.run;
        if stopped {
            self.run.velocity = S::constant(0.0);
        }
    }

    fn velocity(&self) -> S {
        self.run.velocity
    }

    fn hold(&mut self, law: &L, state: &mut L::State, span: S) -> bool {
        hold(self.machine, self.run, (self.input, self.load), law, state, span)
    }
}
