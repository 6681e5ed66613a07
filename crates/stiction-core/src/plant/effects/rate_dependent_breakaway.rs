//! Break-away that falls the faster the contact is loaded.

use super::{
    Effect, EffectFacts, Hook, LevelChange, MEMORY, Memory, Passage, Scale, Shape, Situation,
};
use crate::friction::elements::contact_age::slide;
use crate::math::exponential::come_about;
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`RateDependentBreakaway`].
    pub struct RateDependentBreakawayParameters {
        strength: One, "friction of a contact loaded slowly above that of a slide, as a share",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds 0.0, 10.0;
        loading_rate: EffortRate, "rate of loading at which that has fallen to 1/e, r_0",
            default Value(1.0), neutral None, typical 1.0, bounds 1e-9, 1e12;
        distance: Position, "distance of slide that wipes it out, l",
            default Value(1e-2), neutral None, typical 1e-2, bounds 1e-12, 1e6;
        window: Position, "displacement within which the contact counts as resting",
            default Value(2e-3), neutral None, typical 2e-3, bounds 1e-12, 1e6;
        loading_time: Time, "averaging time of the loading rate, τ",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-6, 1e3;
    }
}

/// Level 1 + a·b; at rest b → exp(−r/r_0), r = |F − q|/τ, q' = (F − q)/τ; db/dx = −b/l in a slide.
///
/// The rate is that of a filtered force, because a bare difference quotient of measured motion is
/// noise. Rest and slide are told apart by a window of displacement. Memory: offset of the anchor,
/// q, b.
///
/// Neutral: a = 0.
/// Source: Johannes, Green, Brockley, Wear 24 (1973); Richardson, Nolle, Wear 37 (1976): static
/// friction falls with the rate at which the tangential force is applied. The form is the one
/// that `hsieh_pan` has for its hook.
#[derive(Debug, Clone)]
pub struct RateDependentBreakaway<S>(RateDependentBreakawayParameters<S>);

const OFFSET: usize = 0;
const FILTERED: usize = 1;
const STRENGTH: usize = 2;
/// Time in which b takes its value after a stop, s.
const SETTLING: f64 = 0.02;

impl<S: Scalar> Effect<S> for RateDependentBreakaway<S> {
    const PARAMETERS: &'static [ParameterSpec] = RateDependentBreakawayParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const REMEMBERS: bool = true;
    const FACTS: EffectFacts = EffectFacts {
        summary: "a contact that is loaded slowly holds more than one that is loaded fast",
        means: "slow approaches stick harder than fast ones: the last step to a target needs the most",
        remedy: "approach in quick small steps rather than in slow ramps, or raise the compensation \
                 where the reference moves slowly",
        class: "breakaway",
        coordinate: "rate of the effort before a slide",
        channels: &[],
        look_alikes: &["stribeck", "dwell_strengthening"],
        experiment: "equal rests, each followed by another rate of loading over two decades",
        plan: "dwells",
        gains: &["strength"],
        shapes: &[
            Shape {
                parameter: "loading_rate",
                scale: Scale::Loading,
                grid: &[1.0, 3.5],
                fitted: true,
            },
            Shape {
                parameter: "distance",
                scale: Scale::Presliding,
                grid: &[2.0, 7.0],
                fitted: true,
            },
            Shape { parameter: "window", scale: Scale::Resting, grid: &[1.0], fitted: true },
            Shape { parameter: "loading_time", scale: Scale::One, grid: &[0.1], fitted: false },
        ],
        second: &[],
        law_terms: &["loading_rate"],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(RateDependentBreakawayParameters::from_values(values))
    }

    fn fresh(&self) -> Memory<S> {
        let mut memory = [S::constant(0.0); MEMORY];
        memory[STRENGTH] = S::constant(1.0);
        memory
    }

    #[inline(always)]
    fn level(&self, _at: &Situation<S>, memory: &Memory<S>) -> LevelChange<S> {
        LevelChange { friction: self.0.strength * memory[STRENGTH], viscous: S::constant(0.0) }
    }

    #[inline(always)]
    fn remember(&self, memory: &mut Memory<S>, passage: &Passage<S>) {
        let p = &self.0;
        let slid = slide(&mut memory[OFFSET], passage.displacement, p.window);
        let short = passage.friction - memory[FILTERED];
        memory[FILTERED] += short * come_about(passage.span / p.loading_time);
        let b = memory[STRENGTH];
        memory[STRENGTH] = if slid.re() == 0.0 {
            let slow = (-(short.abs() / (p.loading_time * p.loading_rate))).exp();
            b + (slow - b) * come_about(passage.span / SETTLING)
        } else {
            b * (-(slid / p.distance)).exp()
        };
    }
}
