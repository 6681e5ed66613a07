//! A drive that loses to the voltage of its own motor.

use super::{Effect, EffectFacts, Hook, Situation};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`BackEmf`].
    pub struct BackEmfParameters {
        slope: PerVelocity, "share of the input that is lost per speed in its direction",
            default Value(0.0), neutral Some(0.0), typical 0.02, bounds 0.0, 1e9;
    }
}

/// Input u − b·|u|·v: a bridge that is on for the share |u| of the time and coasts for the rest.
///
/// While it is on, the motor's own voltage k·v stands against the supply V, so b = k/V, one over the
/// speed without load. Braking it adds. A bridge that never coasts loses b·v at any input: that is
/// viscous friction and no effect of its own.
///
/// Neutral: b = 0.
/// Source: Mohan, Undeland, Robbins, Power Electronics (2003), ch. 7 and 13.
#[derive(Debug, Clone)]
pub struct BackEmf<S>(BackEmfParameters<S>);

impl<S: Scalar> Effect<S> for BackEmf<S> {
    const PARAMETERS: &'static [ParameterSpec] = BackEmfParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::InputMap];
    const FACTS: EffectFacts = EffectFacts {
        summary: "the drive gives less when the machine runs with it, and more when it brakes",
        means: "effort falls with speed: there is a top speed, and gains that were tuned at rest \
                 are lower in motion",
        remedy: "close a current loop, or divide the command by what the speed leaves of it; a \
                 higher supply moves the limit up",
        class: "back_emf",
        coordinate: "speed times effort",
        channels: &[],
        look_alikes: &["viscous_quadratic", "torque_constant_saturation"],
        experiment: "braking, coasting and driving at the same speeds; log current and voltage",
        plan: "fast",
        gains: &["slope"],
        shapes: &[],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(BackEmfParameters::from_values(values))
    }

    #[inline(always)]
    fn input(&self, input: S, at: &Situation<S>) -> S {
        input - self.0.slope * input.abs() * at.velocity
    }
}
