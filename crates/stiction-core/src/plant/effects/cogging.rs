//! Effort that depends on position alone.

use super::{Effect, EffectFacts, Hook, Memory, Scale, Shape, Situation};
use crate::math::scalar::Scalar;
use crate::math::wave::Wave;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`Cogging`].
    pub struct CoggingParameters {
        cosine: Effort, "amplitude of the cosine part",
            default Value(0.0), neutral Some(0.0), typical 0.02, bounds -1e9, 1e9;
        sine: Effort, "amplitude of the sine part",
            default Value(0.0), neutral Some(0.0), typical 0.02, bounds -1e9, 1e9;
        order: Order, "periods per 2π rad (rotary) or per 2π m (linear), N",
            default Value(12.0), neutral None, typical 12.0, bounds 1e-6, 1e9;
        cosine_2: Effort, "amplitude of the cosine part of a second wave",
            default Value(0.0), neutral Some(0.0), typical 0.02, bounds -1e9, 1e9;
        sine_2: Effort, "amplitude of the sine part of a second wave",
            default Value(0.0), neutral Some(0.0), typical 0.02, bounds -1e9, 1e9;
        order_2: Order, "periods of the second wave per 2π rad (rotary) or per 2π m (linear), N",
            default Value(24.0), neutral None, typical 24.0, bounds 1e-6, 1e9;
    }
}

/// Effort a·cos(N·x) + b·sin(N·x), the same in both directions.
///
/// Neutral: a = b = 0. Written with two amplitudes because amplitude and phase are not linear.
/// Source: Hendershot, Miller, Design of Brushless Permanent-Magnet Motors (1994), ch. 4.
#[derive(Debug, Clone)]
pub struct Cogging<S>(Wave<S>);

impl<S: Scalar> Effect<S> for Cogging<S> {
    const PARAMETERS: &'static [ParameterSpec] = CoggingParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::AddedEffort];
    const FACTS: EffectFacts = EffectFacts {
        summary: "effort that repeats with position, whatever the direction",
        means: "the rotor is pulled towards preferred positions, so slow motion and holding depend on \
                where the machine stands",
        remedy: "feed the fitted effort forward over position, or look for what repeats that often a \
                 turn: magnets and slots, teeth, the screw's lead",
        class: "cogging",
        coordinate: "order spectrum over position, not odd in direction",
        channels: &[],
        look_alikes: &["torque_bias", "gravity_unbalance"],
        experiment: "slow full turns both ways",
        plan: "turns",
        gains: &["cosine", "sine"],
        shapes: &[Shape { parameter: "order", scale: Scale::Order, grid: &[], fitted: true }],
        second: &["cosine_2", "sine_2", "order_2"],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        let p = CoggingParameters::from_values(values);
        Self(Wave::new([p.cosine, p.sine, p.order], [p.cosine_2, p.sine_2, p.order_2]))
    }

    #[inline(always)]
    fn effort(&self, at: &Situation<S>, _memory: &Memory<S>) -> S {
        self.0.at(at.position)
    }

    fn effort_wave(&self) -> Option<Wave<S>> {
        Some(self.0)
    }

    fn stiffness(&self, _sliding: f64) -> f64 {
        self.0.steepest()
    }
}
