//! Friction that builds up after each reversal and remembers where that was.

use super::{
    Effect, EffectFacts, Hook, LevelChange, MEMORY, Memory, Passage, Scale, Shape, Situation,
};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`ReversePointMemory`].
    pub struct ReversePointMemoryParameters {
        share: One, "share of dry friction that builds up after a reversal, a",
            default Value(0.0), neutral Some(0.0), typical 0.3, bounds 0.0, 1.0;
        distance: Position, "distance over which it does, l",
            default Value(1e-3), neutral None, typical 1e-3, bounds 1e-12, 1e3;
    }
}

/// Dry friction (1 − a)·F + a·F_c·m, m the mean of four elements that stick up to l/5, 3·l/5, 6·l/5 and
/// 2·l and then slide.
///
/// At a = 1 the law's own dry friction has been swapped for one with memory: branches are congruent,
/// inner loops close and are wiped out. Memory: how far each element is stretched.
///
/// Neutral: a = 0.
/// Source: Iwan, J. Appl. Mech. 33 (1966), 34 (1967); Masing (1926).
#[derive(Debug, Clone)]
pub struct ReversePointMemory<S>(ReversePointMemoryParameters<S>);

/// Stretch at which each element slides, in distances.
const YIELDS: [f64; MEMORY] = [0.2, 0.6, 1.2, 2.0];

/// An element that slides where it is stretched beyond `most`.
#[inline]
fn stretched<S: Scalar>(stretch: S, most: S) -> S {
    if stretch.re() > most.re() {
        most
    } else if stretch.re() < -most.re() {
        -most
    } else {
        stretch
    }
}

impl<S: Scalar> Effect<S> for ReversePointMemory<S> {
    const PARAMETERS: &'static [ParameterSpec] = ReversePointMemoryParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel, Hook::AddedEffort];
    const REMEMBERS: bool = true;
    const FACTS: EffectFacts = EffectFacts {
        summary: "after a reversal friction builds up over a distance and remembers where it turned",
        means: "near a reversal the machine yields like a spring: small moves come back, and small \
                 loops close",
        remedy: "use a law with memory of reverse points (maxwell_slip, hsieh_pan) for the \
                 feed-forward",
        class: "memory",
        coordinate: "distance since the reversal",
        channels: &[],
        look_alikes: &["backlash", "drive_deadband"],
        experiment: "small loops below break-away, nested in one another",
        plan: "loops",
        gains: &["share"],
        shapes: &[Shape {
            parameter: "distance",
            scale: Scale::Presliding,
            // A contact without a spring has no length of its own: this one is found from far below it.
            grid: &[0.0625, 0.25, 1.0, 4.0, 16.0],
            fitted: true,
        }],
        second: &[],
        law_terms: &["law.remembers"],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(ReversePointMemoryParameters::from_values(values))
    }

    #[inline(always)]
    fn level(&self, _at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        LevelChange { friction: -self.0.share, viscous: S::constant(0.0) }
    }

    #[inline(always)]
    fn effort(&self, at: &Situation<S>, memory: &Memory<S>) -> S {
        let mut mean = S::constant(0.0);
        if !at.sliding.re().is_finite() {
            // A contact that never slides has no dry friction to build up to.
            return mean;
        }
        for (stretch, share) in memory.iter().zip(YIELDS) {
            let most = self.0.distance * share;
            mean += stretched(*stretch + at.moved, most) / most;
        }
        -(self.0.share * at.sliding * mean / MEMORY as f64)
    }

    #[inline(always)]
    fn remember(&self, memory: &mut Memory<S>, passage: &Passage<S>) {
        for (stretch, share) in memory.iter_mut().zip(YIELDS) {
            *stretch = stretched(*stretch + passage.displacement, self.0.distance * share);
        }
    }

    fn stiffness(&self, sliding: f64) -> f64 {
        if !sliding.is_finite() {
            return 0.0;
        }
        let slopes: f64 = YIELDS.iter().map(|share| 1.0 / share).sum();
        self.0.share.re() * sliding * slopes / (MEMORY as f64 * self.0.distance.re())
    }
}
