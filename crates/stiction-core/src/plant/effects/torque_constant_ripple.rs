//! Effort per input that varies with position.

use super::{Effect, EffectFacts, Hook, Scale, Shape, Situation};
use crate::math::scalar::Scalar;
use crate::math::wave::Wave;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`TorqueConstantRipple`].
    pub struct TorqueConstantRippleParameters {
        cosine: One, "amplitude of the cosine part, as a share of the gain",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds -0.6, 0.6;
        sine: One, "amplitude of the sine part, as a share of the gain",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds -0.6, 0.6;
        order: Order, "periods per 2π rad (rotary) or per 2π m (linear), N",
            default Value(6.0), neutral None, typical 6.0, bounds 1e-6, 1e9;
        cosine_2: One, "amplitude of the cosine part of a second wave, as a share of the gain",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds -0.1, 0.1;
        sine_2: One, "amplitude of the sine part of a second wave, as a share of the gain",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds -0.1, 0.1;
        order_2: Order, "periods of the second wave per 2π rad (rotary) or per 2π m (linear), N",
            default Value(12.0), neutral None, typical 12.0, bounds 1e-6, 1e9;
    }
}

/// Input times 1 + a·cos(N·x) + b·sin(N·x): a motor whose torque constant ripples.
///
/// Neutral: a = b = 0.
/// Source: Holtz, Springob, IEEE Trans. Ind. Electron. 43 (1996): torque ripple of permanent-magnet
/// motors that grows with current, beside cogging, which does not.
#[derive(Debug, Clone)]
pub struct TorqueConstantRipple<S>(Wave<S>);

impl<S: Scalar> Effect<S> for TorqueConstantRipple<S> {
    const PARAMETERS: &'static [ParameterSpec] = TorqueConstantRippleParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::InputMap];
    const FACTS: EffectFacts = EffectFacts {
        summary: "effort per input that repeats with position",
        means: "the same current gives more torque at some angles than at others",
        remedy: "tabulate the gain over the angle and divide the command by it; look for a wrong \
                 commutation angle, an offset in one phase current, or a magnet that is off",
        class: "angle",
        coordinate: "position times input",
        channels: &[],
        look_alikes: &["position_dependent_friction"],
        experiment: "sine of high acceleration, and loads either way: the input varies at the same \
                     position",
        plan: "sines",
        gains: &["cosine", "sine"],
        shapes: &[Shape { parameter: "order", scale: Scale::Order, grid: &[], fitted: true }],
        second: &["cosine_2", "sine_2", "order_2"],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        let p = TorqueConstantRippleParameters::from_values(values);
        Self(Wave::new([p.cosine, p.sine, p.order], [p.cosine_2, p.sine_2, p.order_2]))
    }

    #[inline(always)]
    fn input(&self, input: S, at: &Situation<S>) -> S {
        input + input * self.0.at(at.position)
    }

    fn input_wave(&self) -> Option<Wave<S>> {
        Some(self.0)
    }
}
