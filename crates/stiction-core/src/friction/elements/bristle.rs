//! What bristle models share: a deflection z, its damping, and friction made of both.
//!
//! F = L·(σ₀·z + σ₁(v)·z') + σ₂·v, z' = v·(1 − t): t is the share of the motion that slips, which
//! is what the laws differ in. σ₁(v) = σ₁·e^(−(v/v_d)²).

use super::reachable::reachable;
use super::slides::Slides;
use super::stribeck::{SlidingLevel, fall};
use crate::friction::{Channels, Entry, EntryReader, LawState, Outcome, Statistics};
use crate::math::scalar::{Scalar, sign};
use crate::support::error::Result;

/// Stiffness, damping and steady friction of bristles.
#[derive(Debug, Clone, Copy)]
pub struct Bristle<S> {
    /// σ₀.
    pub stiffness: S,
    /// Friction of steady sliding, g.
    pub level: SlidingLevel<S>,
    /// σ₁ at rest.
    pub damping: S,
    /// v_d.
    pub damping_velocity: S,
    /// σ₂.
    pub viscous: S,
}

/// The share of a motion that slips, t.
#[derive(Debug, Clone, Copy)]
pub struct Slip<S> {
    /// t.
    pub share: S,
    /// ∂t/∂(force in the direction of motion).
    pub by_force: S,
    /// ∂t/∂|v|.
    pub by_speed: S,
}

/// Where a step leaves the bristles.
#[derive(Debug, Clone, Copy)]
pub struct Bent<S> {
    /// σ₀·z.
    pub force: S,
    /// Its derivative by a velocity held over the step.
    pub by_velocity: S,
    /// Its derivative by the velocity at the end, at fixed displacement.
    pub by_end: S,
}

/// Deflection of the bristles.
#[derive(Debug, Clone, Copy)]
pub struct BristleState<S> {
    /// z.
    pub deflection: S,
    /// Slides.
    pub slides: Slides,
}

/// A step of the bristles.
#[derive(Debug, Clone, Copy)]
pub struct BristleTrial<S> {
    /// State at its end.
    pub after: BristleState<S>,
    /// Friction at its end.
    pub outcome: Outcome<S>,
}

impl<S: Scalar> BristleState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> BristleState<T> {
        BristleState { deflection: convert(self.deflection), slides: self.slides }
    }

    /// Bristles that were never bent.
    pub fn straight() -> Self {
        Self { deflection: S::constant(0.0), slides: Slides::default() }
    }

    /// From the entries of a state.
    pub fn restore(entries: &[(String, Entry)]) -> Result<Self> {
        let mut read = EntryReader::new(entries);
        let state = Self {
            deflection: S::constant(read.number("deflection", false)?),
            slides: Slides::restore(&mut read)?,
        };
        read.finish()?;
        Ok(state)
    }
}

impl<S: Scalar> LawState<S> for BristleState<S> {
    const OUTPUTS: &'static [&'static str] = &["deflection", "mode"];

    fn output(&self, index: usize) -> S {
        if index == 0 { self.deflection } else { S::constant(self.slides.mode) }
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        let mut entries = vec![("deflection", Entry::Number(self.deflection.re()))];
        entries.extend(self.slides.entries());
        entries
    }

    fn statistics(&self) -> Statistics {
        self.slides.statistics()
    }
}

impl<S: Scalar> Bristle<S> {
    /// σ₁ at this speed and its slope by speed, where it has one.
    #[inline(always)]
    fn damper(&self, velocity: S) -> (S, Option<S>) {
        if self.damping_velocity.re().is_infinite() {
            return (self.damping, None);
        }
        let (left, steepness) = fall(velocity, self.damping_velocity, S::constant(2.0));
        (self.damping * left, Some(self.damping * steepness))
    }

    /// Bent so far that they bear this force, or what they can.
    pub fn bent_by(&self, force: S) -> BristleState<S> {
        let force = reachable(force, self.level.greatest());
        BristleState { deflection: force / self.stiffness, ..BristleState::straight() }
    }

    /// Friction at an instant.
    #[inline(always)]
    pub fn force(&self, deflection: S, slip: &Slip<S>, velocity: S, channels: &Channels<S>) -> S {
        self.friction(self.stiffness * deflection, slip, velocity, channels)
    }

    /// Friction of bristles that bear this force.
    #[inline(always)]
    pub fn friction(&self, borne: S, slip: &Slip<S>, velocity: S, channels: &Channels<S>) -> S {
        // What waits for the slip comes in last, here and below.
        let others = borne * channels.level + self.viscous * channels.viscous_level * velocity;
        let pace = velocity * -(slip.share - 1.0);
        others + self.damper(velocity).0 * pace * channels.level
    }

    /// The step that ends so.
    #[inline(always)]
    pub fn settled(
        &self,
        state: &BristleState<S>,
        bent: &Bent<S>,
        slip: &Slip<S>,
        velocity: S,
        channels: &Channels<S>,
    ) -> BristleTrial<S> {
        let outcome = self.outcome(bent, slip, velocity, channels);
        let coulomb = self.level.coulomb.re();
        let slides = state.slides.after(velocity.re(), bent.force.re(), coulomb);
        let after =
            BristleState { deflection: bent.force * (S::constant(1.0) / self.stiffness), slides };
        BristleTrial { after, outcome }
    }

    /// Friction of a step that ends so.
    #[inline(always)]
    pub fn outcome(
        &self,
        bent: &Bent<S>,
        slip: &Slip<S>,
        velocity: S,
        channels: &Channels<S>,
    ) -> Outcome<S> {
        let s = sign(velocity.re());
        let (damper, fading) = self.damper(velocity);
        let viscous = self.viscous * channels.viscous_level;
        let bends = -(slip.share - 1.0);
        let pace = velocity * bends;
        // By the velocity, where the force of the bristles changes with it at this rate.
        let slope = |force: S| {
            let slips = (slip.by_force * force + slip.by_speed) * s;
            let damped = damper * (bends - velocity * slips);
            let damped = fading.map_or(damped, |fading| damped + fading * pace * s);
            (force * channels.level + viscous) + damped * channels.level
        };
        let implicit = slope(bent.by_end);
        Outcome {
            force: (bent.force * channels.level + viscous * velocity)
                + damper * pace * channels.level,
            slope: slope(bent.by_velocity),
            // A falling flank is left explicit: implicit, it could outweigh the inertia.
            damping: if implicit.re() > 0.0 { implicit } else { S::constant(0.0) },
        }
    }
}

/// Whether bristles that slip no sooner than LuGre's give back no more than they took.
pub fn passive(p: &Bristle<f64>) -> bool {
    passive_with(p, 1.0)
}

/// The same of bristles that slip by aⁿ, a = (their force)/g(v), and lose no energy otherwise.
///
/// With what they store as the storage that is |v|·(σ₁(v)·(aⁿ − 1) − σ₂) ≤ g(v)·a^(n+1) for every a.
/// Without a fall of σ₁ it holds at all speeds if and only if σ₂ ≥ σ₁·((F_s/F_c)ⁿ − 1) (n = 1:
/// Barabanov, Ortega, IEEE Trans. Autom. Control 45 (2000)). With one it also holds where
/// σ₁·v_d/√(2e)·(aⁿ − 1)/a^(n+1) ≤ F_c, v_d/√(2e) being the greatest of v·e^(−(v/v_d)²).
pub fn passive_with(p: &Bristle<f64>, exponent: f64) -> bool {
    let most = p.level.greatest() / p.level.coulomb;
    if p.viscous >= p.damping * (most.powf(exponent) - 1.0) {
        return true;
    }
    // (aⁿ − 1)/a^(n+1) is greatest at aⁿ = n + 1.
    let a = most.min((exponent + 1.0).powf(1.0 / exponent));
    let fastest = p.damping_velocity / (2.0 * std::f64::consts::E).sqrt();
    p.damping * fastest * (a.powf(exponent) - 1.0) / a.powf(exponent + 1.0) <= p.level.coulomb
}
