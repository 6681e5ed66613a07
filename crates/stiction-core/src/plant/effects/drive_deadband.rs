//! A drive that answers small inputs with nothing.

use super::{Effect, EffectFacts, Hook, Situation};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`DriveDeadband`].
    pub struct DriveDeadbandParameters {
        deadband: Input, "input up to which the drive gives nothing, and which it takes off beyond",
            default Value(0.0), neutral Some(0.0), typical 0.02, bounds 0.0, 1e9;
    }
}

/// Input u − a·sgn(u) where |u| > a, else 0.
///
/// Neutral: a = 0, where the derivative is −sgn(u).
/// Source: Tao, Kokotović, Adaptive Control of Systems with Actuator and Sensor Nonlinearities
/// (1996), ch. 2.
#[derive(Debug, Clone)]
pub struct DriveDeadband<S>(DriveDeadbandParameters<S>);

impl<S: Scalar> Effect<S> for DriveDeadband<S> {
    const PARAMETERS: &'static [ParameterSpec] = DriveDeadbandParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::InputMap];
    const MAPS_BY_PLACE: bool = false;
    const FACTS: EffectFacts = EffectFacts {
        summary: "the drive gives nothing for small inputs, and less by as much for large ones",
        means: "small corrections never reach the machine: it hunts or stops short",
        remedy: "add the width of the band to the command with its sign; look for dead time of a bridge, \
                 a valve's overlap, or a threshold in the drive's settings",
        class: "drive",
        coordinate: "sign of the input",
        channels: &[],
        look_alikes: &[],
        experiment: "braking and coasting: input and motion of opposite signs",
        plan: "pulses",
        gains: &["deadband"],
        shapes: &[],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(DriveDeadbandParameters::from_values(values))
    }

    #[inline(always)]
    fn input(&self, input: S, _at: &Situation<S>) -> S {
        let band = self.0.deadband;
        if input.re().abs() > band.re() {
            input - band * sign(input.re())
        } else {
            // Within a band of 0 there is input 0 alone, which stays what it is to the bit.
            input * 0.0
        }
    }
}
