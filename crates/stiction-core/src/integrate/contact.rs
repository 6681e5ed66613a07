//! A contact alone, moved as its caller says: no body, no inertia.

use super::events::Stepper;
use crate::friction::{Channels, FrictionLaw, Motion, Outcome};
use crate::scalar::Scalar;

/// A contact that is moved at a held velocity: what `FrictionModel.step` does.
#[derive(Debug, Clone, Copy)]
pub struct Held<S> {
    /// Velocity.
    pub velocity: S,
    /// What else reaches the contact.
    pub channels: Channels<S>,
    /// Friction at the end.
    pub outcome: Outcome<S>,
}

impl<S: Scalar> Held<S> {
    /// A held velocity.
    pub fn new(velocity: S, channels: Channels<S>) -> Self {
        let zero = S::constant(0.0);
        Self { velocity, channels, outcome: Outcome { force: zero, slope: zero, damping: zero } }
    }
}

impl<S: Scalar, L: FrictionLaw<S>> Stepper<S, L> for Held<S> {
    type Attempt = (L::Trial, Motion<S>);

    #[inline]
    fn attempt(&self, law: &L, state: &L::State, span: S) -> Self::Attempt {
        let motion = Motion::held(self.velocity, span);
        (law.advance(state, &motion, &self.channels), motion)
    }

    #[inline]
    fn contact<'a>(&self, attempt: &'a Self::Attempt) -> (&'a L::Trial, &'a Motion<S>) {
        (&attempt.0, &attempt.1)
    }

    #[inline]
    fn accept(&mut self, law: &L, state: &mut L::State, attempt: &Self::Attempt, _stopped: bool) {
        law.commit(state, &attempt.0);
        self.outcome = law.outcome(&attempt.0);
    }

    #[inline]
    fn velocity(&self) -> S {
        self.velocity
    }

    #[inline]
    fn hold(&mut self, _law: &L, _state: &mut L::State, _span: S) -> bool {
        false
    }
}

/// A contact that is moved along a measured motion: the displacement of a sample is exact, the
/// velocity changes linearly over it.
#[derive(Debug, Clone, Copy)]
pub struct Along<S> {
    /// Displacement over the sample.
    pub displacement: S,
    /// Duration of the sample.
    pub duration: S,
    /// Velocity at its start and at its end.
    pub velocities: (S, S),
    /// What else reaches the contact.
    pub channels: Channels<S>,
    /// Share of the sample already passed.
    pub passed: S,
    /// Friction at the end.
    pub outcome: Outcome<S>,
    /// Mean of the friction over what was passed, times its share of the sample; of a contact that is
    /// rigid.
    pub mean: S,
}

impl<S: Scalar> Along<S> {
    /// A sample of this motion.
    pub fn new(displacement: S, duration: S, velocities: (S, S), channels: Channels<S>) -> Self {
        let zero = S::constant(0.0);
        let outcome = Outcome { force: zero, slope: zero, damping: zero };
        Self { displacement, duration, velocities, channels, passed: zero, outcome, mean: zero }
    }

    #[inline(always)]
    fn velocity_at(&self, share: S) -> S {
        self.velocities.0 + (self.velocities.1 - self.velocities.0) * share
    }

    /// Whether a step of this duration is the whole sample, as nearly all are: then nothing is shared
    /// out.
    #[inline(always)]
    fn whole(&self, span: &S) -> bool {
        self.passed.re() == 0.0 && span.re() == self.duration.re()
    }
}

impl<S: Scalar, L: FrictionLaw<S>> Stepper<S, L> for Along<S> {
    type Attempt = (L::Trial, Motion<S>);

    #[inline(always)]
    fn attempt(&self, law: &L, state: &L::State, span: S) -> Self::Attempt {
        if self.whole(&span) {
            let motion = Motion {
                displacement: self.displacement,
                duration: span,
                start_velocity: self.velocities.0,
                velocity: self.velocities.1,
            };
            return (law.advance(state, &motion, &self.channels), motion);
        }
        let share = span / self.duration;
        let motion = Motion {
            displacement: self.displacement * share,
            duration: span,
            start_velocity: self.velocity_at(self.passed),
            velocity: self.velocity_at(self.passed + share),
        };
        (law.advance(state, &motion, &self.channels), motion)
    }

    #[inline(always)]
    fn contact<'a>(&self, attempt: &'a Self::Attempt) -> (&'a L::Trial, &'a Motion<S>) {
        (&attempt.0, &attempt.1)
    }

    #[inline(always)]
    fn accept(&mut self, law: &L, state: &mut L::State, attempt: &Self::Attempt, _stopped: bool) {
        let whole = self.whole(&attempt.1.duration);
        let share = if whole { S::constant(1.0) } else { attempt.1.duration / self.duration };
        if L::RIGID {
            // Half-way: inside one mode friction is smooth, and at its ends it may jump.
            let (trial, _) = Stepper::<S, L>::attempt(self, law, state, attempt.1.duration * 0.5);
            self.mean += law.outcome(&trial).force * share;
        }
        law.commit(state, &attempt.0);
        self.outcome = law.outcome(&attempt.0);
        self.passed += share;
    }

    #[inline(always)]
    fn velocity(&self) -> S {
        if self.passed.re() == 0.0 { self.velocities.0 } else { self.velocity_at(self.passed) }
    }

    fn hold(&mut self, _law: &L, _state: &mut L::State, _span: S) -> bool {
        false
    }
}
