//! A contact alone, moved as its caller says: no body, no inertia.

use super::events::{Stepper, pass_events};
use crate::friction::{Channels, FrictionLaw, Motion, Outcome};
use crate::math::scalar::Scalar;

/// A contact that is moved at a held velocity: what `FrictionModel.step` does. `CREEPS` where something
/// gives way in series with it.
#[derive(Debug, Clone, Copy)]
pub struct Held<S, const CREEPS: bool = false> {
    /// Velocity.
    pub velocity: S,
    /// Velocity of what gives way, which the law is not moved by.
    pub creep: S,
    /// What else reaches the contact.
    pub channels: Channels<S>,
    /// Friction at the end.
    pub outcome: Outcome<S>,
}

impl<S: Scalar> Held<S> {
    /// A held velocity.
    pub fn new(velocity: S, channels: Channels<S>) -> Self {
        Self::giving(velocity, S::constant(0.0), channels)
    }
}

impl<S: Scalar, const CREEPS: bool> Held<S, CREEPS> {
    /// A held velocity, of which something in series takes its share.
    pub fn giving(velocity: S, creep: S, channels: Channels<S>) -> Self {
        let zero = S::constant(0.0);
        let outcome = Outcome { force: zero, slope: zero, damping: zero };
        Self { velocity, creep, channels, outcome }
    }
}

impl<S: Scalar, L: FrictionLaw<S>, const CREEPS: bool> Stepper<S, L> for Held<S, CREEPS> {
    type Attempt = (L::Trial, Motion<S>);

    #[inline]
    fn attempt(&self, law: &L, state: &L::State, span: S) -> Self::Attempt {
        let mut motion = Motion::held(self.velocity, span);
        if CREEPS {
            motion.displacement -= self.creep * span;
        }
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
pub struct Along<'a, S> {
    /// What the contact goes through.
    pub motion: &'a Motion<S>,
    /// What else reaches it.
    pub channels: &'a Channels<S>,
    /// Share of the sample already passed.
    pub passed: S,
    /// Friction at the end.
    pub force: S,
    /// Mean of the friction over what was passed, times its share of the sample; of a contact that is
    /// rigid.
    pub mean: S,
}

impl<S: Scalar> Along<'_, S> {
    /// Moves a contact on by a sample, with every mode change in it located and passed: to places for
    /// the friction at its end and, where that of a rigid contact is asked for, its mean.
    #[inline(always)]
    pub fn through_events<L: FrictionLaw<S>>(
        motion: &Motion<S>,
        channels: &Channels<S>,
        (law, state): (&L, &mut L::State),
        force: &mut S,
        mean: Option<&mut S>,
    ) {
        if law.pending(state, motion.start_velocity).is_none() {
            let trial = law.advance_within(state, motion, channels);
            if law.event(state, &trial, motion).is_none() {
                if let (true, Some(mean)) = (L::RIGID, mean) {
                    let half = halfway(motion);
                    *mean = law.outcome(&law.advance_within(state, &half, channels)).force;
                }
                law.commit(state, &trial);
                *force = law.outcome(&trial).force;
                return;
            }
        }
        Self::through(motion, channels, (law, state), force, mean);
    }

    /// The same where an event is due: apart, or a sample without one would be in memory as well.
    #[cold]
    #[inline(never)]
    fn through<L: FrictionLaw<S>>(
        motion: &Motion<S>,
        channels: &Channels<S>,
        (law, state): (&L, &mut L::State),
        force: &mut S,
        mean: Option<&mut S>,
    ) {
        let zero = S::constant(0.0);
        let mut along = Along { motion, channels, passed: zero, force: zero, mean: zero };
        pass_events(&mut along, law, state, motion.duration);
        *force = along.force;
        if let Some(mean) = mean {
            *mean = along.mean;
        }
    }

    /// The whole of the sample or a part of it, from where it has come to.
    #[inline(always)]
    fn part(&self, span: S) -> Motion<S> {
        if self.whole(&span) {
            return Motion { duration: span, ..*self.motion };
        }
        let share = span / self.motion.duration;
        Motion {
            displacement: self.motion.displacement * share,
            duration: span,
            start_velocity: self.velocity_at(self.passed),
            velocity: self.velocity_at(self.passed + share),
        }
    }

    #[inline(always)]
    fn velocity_at(&self, share: S) -> S {
        let (before, after) = (self.motion.start_velocity, self.motion.velocity);
        before + (after - before) * share
    }

    /// Whether a step of this duration is the whole sample, as nearly all are: then nothing is shared
    /// out.
    #[inline(always)]
    fn whole(&self, span: &S) -> bool {
        self.passed.re() == 0.0 && span.re() == self.motion.duration.re()
    }
}

/// The first half of a sample, at whose end friction of a rigid contact is its mean: inside one mode it is
/// smooth, and at the ends of the sample it may jump.
#[inline(always)]
fn halfway<S: Scalar>(motion: &Motion<S>) -> Motion<S> {
    let (before, after) = (motion.start_velocity, motion.velocity);
    Motion {
        displacement: motion.displacement * 0.5,
        duration: motion.duration * 0.5,
        start_velocity: before,
        velocity: before + (after - before) * 0.5,
    }
}

impl<S: Scalar, L: FrictionLaw<S>> Stepper<S, L> for Along<'_, S> {
    type Attempt = (L::Trial, Motion<S>);

    #[inline(always)]
    fn attempt(&self, law: &L, state: &L::State, span: S) -> Self::Attempt {
        let motion = self.part(span);
        (law.advance(state, &motion, self.channels), motion)
    }

    #[inline(always)]
    fn contact<'a>(&self, attempt: &'a Self::Attempt) -> (&'a L::Trial, &'a Motion<S>) {
        (&attempt.0, &attempt.1)
    }

    #[inline(always)]
    fn accept(&mut self, law: &L, state: &mut L::State, attempt: &Self::Attempt, _stopped: bool) {
        let whole = self.whole(&attempt.1.duration);
        let share =
            if whole { S::constant(1.0) } else { attempt.1.duration / self.motion.duration };
        if L::RIGID {
            let (trial, _) = Stepper::<S, L>::attempt(self, law, state, attempt.1.duration * 0.5);
            self.mean += law.outcome(&trial).force * share;
        }
        law.commit(state, &attempt.0);
        self.force = law.outcome(&attempt.0).force;
        self.passed += share;
    }

    #[inline(always)]
    fn velocity(&self) -> S {
        if self.passed.re() == 0.0 {
            self.motion.start_velocity
        } else {
            self.velocity_at(self.passed)
        }
    }

    fn hold(&mut self, _law: &L, _state: &mut L::State, _span: S) -> bool {
        false
    }
}
