//! A contact that creeps as long as it is loaded.

use super::{Effect, EffectFacts, Hook, Relaxation, Scale, Shape};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`SteadyRelaxation`].
    pub struct SteadyRelaxationParameters {
        speed: Velocity, "speed of creep under a force just below that of sliding",
            default Value(0.0), neutral Some(0.0), typical 1e-4, bounds 0.0, 1e3;
        exponent: One, "how it falls with lower forces, n",
            default Value(2.0), neutral None, typical 2.0, bounds 1.0, 20.0;
    }
}

/// A creeping element in series with any law: x_p' = s·|F/F_c|^n·sgn F, with no hardening.
///
/// Under a held motion the force relaxes, under a held force the body creeps for as long as it is
/// held. In a slide, here from 98 % of the force of slow sliding on, it rests.
///
/// Neutral: s = 0. A rigid contact (`coulomb`) creeps only where it holds a resting body.
/// Source: Maxwell's element; Norton (1929) for the power of the force.
#[derive(Debug, Clone)]
pub struct SteadyRelaxation<S>(SteadyRelaxationParameters<S>);

impl<S: Scalar> Effect<S> for SteadyRelaxation<S> {
    const PARAMETERS: &'static [ParameterSpec] = SteadyRelaxationParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::StateRelaxation];
    const FACTS: EffectFacts = EffectFacts {
        summary: "the contact creeps under a held load and does not stop",
        means: "a held position drifts away for as long as it is loaded, and a force set by motion \
                 fades",
        remedy: "hold the position with a closed loop, or unload after the move",
        class: "creep",
        coordinate: "time since the reversal or during a hold",
        channels: &[],
        look_alikes: &["creep_hardening"],
        experiment: "holds of 5 s and more at three levels from 0.3 to 0.95 of break-away",
        plan: "loops",
        gains: &["speed"],
        shapes: &[Shape { parameter: "exponent", scale: Scale::One, grid: &[2.0], fitted: true }],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(SteadyRelaxationParameters::from_values(values))
    }

    fn relaxation(&self) -> Option<Relaxation<S>> {
        let SteadyRelaxationParameters { speed, exponent } = self.0;
        Some(Relaxation::Steady { speed, exponent })
    }
}
