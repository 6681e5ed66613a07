//! What a contact is told, what it answers, and what is counted of it.

use super::law::FrictionLaw;
use crate::math::scalar::Scalar;

/// A displacement of the contact over a step.
#[derive(Debug, Clone, Copy)]
pub struct Motion<S> {
    /// Displacement Δx over the step.
    pub displacement: S,
    /// Duration of the step; may be 0, which asks for the present force.
    pub duration: S,
    /// Velocity at the start of the step.
    pub start_velocity: S,
    /// Velocity at the end of the step, where the friction is wanted.
    pub velocity: S,
}

impl<S: Scalar> Motion<S> {
    /// A velocity held over the step.
    #[inline]
    pub fn held(velocity: S, duration: S) -> Self {
        let displacement = velocity * duration;
        Self { displacement, duration, start_velocity: velocity, velocity }
    }
}

/// What reaches the contact besides its motion.
#[derive(Debug, Clone, Copy)]
pub struct Channels<S> {
    /// All other effort on the body, positive along +x: what a stuck contact has to hold.
    pub effort: S,
    /// Load on the contact, gravity with it, positive along +x; 0 is neutral.
    pub load: S,
    /// Multiplier of the friction level; 1 is neutral.
    pub level: S,
    /// Multiplier of viscous friction; 1 is neutral.
    pub viscous_level: S,
    /// Temperature in °C, where known.
    pub temperature: Option<f64>,
}

impl<S: Scalar> Default for Channels<S> {
    fn default() -> Self {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        Self { effort: zero, load: zero, level: one, viscous_level: one, temperature: None }
    }
}

/// Friction at the end of a step.
#[derive(Debug, Clone, Copy)]
pub struct Outcome<S> {
    /// Friction, positive when it resists positive motion.
    pub force: S,
    /// ∂force/∂velocity for a velocity held over the step, at fixed duration.
    pub slope: S,
    /// ∂force/∂(velocity at the end) at fixed displacement, where it calms the motion; 0 where
    /// friction falls with speed.
    pub damping: S,
}

/// What carries a body on through a step.
#[derive(Debug, Clone, Copy)]
pub struct Push<S> {
    /// Velocity at the start.
    pub velocity: S,
    /// Friction at the start.
    pub friction: S,
    /// All other effort, the mean over the step.
    pub effort: S,
    /// Inertia.
    pub inertia: S,
    /// Duration.
    pub span: S,
}

/// Where a step takes a body.
#[derive(Debug, Clone, Copy)]
pub struct Arrival<S> {
    /// Velocity at the end.
    pub velocity: S,
    /// Displacement over the step.
    pub displacement: S,
}

/// What a contact does while its body rests under a held effort.
#[derive(Debug, Clone, Copy)]
pub struct Rest<S, T> {
    /// The whole of it, to be committed as a step.
    pub trial: T,
    /// How far the body creeps.
    pub displacement: S,
    /// Its velocity at the end.
    pub velocity: S,
}

impl<S: Scalar, T> Rest<S, T> {
    /// Nothing moves: the rest of a contact whose force stays where the body does.
    #[inline]
    pub fn still<L: FrictionLaw<S, Trial = T>>(
        law: &L,
        state: &L::State,
        channels: &Channels<S>,
        duration: S,
    ) -> Self {
        let zero = S::constant(0.0);
        let trial = law.advance(state, &Motion::held(zero, duration), channels);
        Self { trial, displacement: zero, velocity: zero }
    }
}

/// A change of contact mode inside a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// The contact reaches its break-away level and starts to slide.
    BreakAway,
    /// The sliding velocity reaches zero.
    Reversal,
    /// The hook would be dragged backwards and sticks while the body still moves.
    HookReturn,
}

/// How often each branch was taken; equal counts mean that two runs took the same branches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Statistics {
    /// The spring turned round.
    pub reversals: u64,
    /// Loops closed and wiped out.
    pub closings: u64,
    /// Break-aways.
    pub breakaways: u64,
    /// Slides that ended in sticking.
    pub sticks: u64,
    /// Most reverse points held at once.
    pub memory_peak: u64,
    /// How often room for reverse points was added, between chunks of samples.
    pub memory_growths: u64,
    /// Reverse points forgotten because there were too many, see
    /// [`super::memory::MOST`].
    pub memory_merged: u64,
}
