//! A drive whose gain falls with its input.

use super::{Effect, EffectFacts, Hook, Scale, Shape, Situation};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`TorqueConstantSaturation`].
    pub struct TorqueConstantSaturationParameters {
        loss: One, "share of the gain that is lost at the input below",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 0.9;
        input: Input, "input at which that share is lost, u_0",
            default Value(1.0), neutral None, typical 1.0, bounds 1e-12, 1e12;
    }
}

/// Input u·(1 − a·(u/u_0)²): iron that saturates gives less effort per ampere.
///
/// Neutral: a = 0.
/// Source: Hendershot, Miller, Design of Brushless Permanent-Magnet Motors (1994), ch. 5: saturation
/// is even in the current, so its first term is the square.
#[derive(Debug, Clone)]
pub struct TorqueConstantSaturation<S>(TorqueConstantSaturationParameters<S>);

impl<S: Scalar> Effect<S> for TorqueConstantSaturation<S> {
    const PARAMETERS: &'static [ParameterSpec] = TorqueConstantSaturationParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::InputMap];
    const MAPS_BY_PLACE: bool = false;
    const FACTS: EffectFacts = EffectFacts {
        summary: "the drive gives less effort per input where the input is large",
        means: "large efforts fall short: acceleration is less than the controller thinks it asked \
                 for",
        remedy: "let the feed-forward ask for more at large inputs, or stay below the knee; look \
                 for a saturated iron core, a hot magnet or a sagging supply",
        class: "saturation",
        coordinate: "size of the input",
        channels: &[],
        look_alikes: &["drive_saturation"],
        experiment: "large efforts at low acceleration: against a load, or pushing a mass slowly \
                 through large friction",
        plan: "pulses",
        gains: &["loss"],
        shapes: &[Shape { parameter: "input", scale: Scale::Input, grid: &[1.0], fitted: false }],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(TorqueConstantSaturationParameters::from_values(values))
    }

    #[inline(always)]
    fn input(&self, input: S, _at: &Situation<S>) -> S {
        let ratio = input / self.0.input;
        input - self.0.loss * ratio * ratio * input
    }
}
