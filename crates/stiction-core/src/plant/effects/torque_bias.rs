//! Constant effort.

use super::{Effect, EffectFacts, Hook, Memory, Situation};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`TorqueBias`].
    pub struct TorqueBiasParameters {
        bias: Effort, "effort that pushes along +x all the time",
            default Value(0.0), neutral Some(0.0), typical 0.02, bounds -1e9, 1e9;
    }
}

/// Effort b along +x, constant: amplifier offset, cable pull, a tilted axis.
///
/// Neutral: b = 0.
/// Source: Janot, Gautier, Brunot, nonlinear benchmark EMPS (2019), the offset of its model.
#[derive(Debug, Clone)]
pub struct TorqueBias<S>(TorqueBiasParameters<S>);

impl<S: Scalar> Effect<S> for TorqueBias<S> {
    const PARAMETERS: &'static [ParameterSpec] = TorqueBiasParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::AddedEffort];
    const FACTS: EffectFacts = EffectFacts {
        summary: "constant effort, at rest as well as in motion",
        means: "a constant effort pulls one way, at rest too",
        remedy: "add it as a feed-forward; look for the amplifier's or current sensor's offset, a \
                 spring, a cable, a weight",
        class: "offset",
        coordinate: "everywhere, also at rest",
        channels: &[],
        look_alikes: &["direction_asymmetry"],
        experiment: "pre-sliding loops and rests at zero input; the machine mounted the other way round",
        plan: "loops",
        gains: &["bias"],
        shapes: &[],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(TorqueBiasParameters::from_values(values))
    }

    #[inline(always)]
    fn effort(&self, _at: &Situation<S>, _memory: &Memory<S>) -> S {
        self.0.bias
    }

    fn even_effort(&self) -> Option<S> {
        Some(self.0.bias)
    }
}
