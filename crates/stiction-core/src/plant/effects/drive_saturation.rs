//! A drive that gives no more than so much.

use super::{Effect, EffectFacts, Hook, Scale, Shape, Situation};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`DriveSaturation`].
    pub struct DriveSaturationParameters {
        share: One, "share of what is beyond the limit that does not get through; 1 is a hard limit",
            default Value(0.0), neutral Some(0.0), typical 1.0, bounds 0.0, 1.0;
        limit: Input, "input from which on it is held back",
            default Value(1.0), neutral None, typical 0.3, bounds 0.0, 1e12;
    }
}

/// Input u − a·(|u| − L)·sgn(u) where |u| > L: at a = 1 the drive gives L and no more.
///
/// Neutral: a = 0.
/// Source: Tao, Kokotović, Adaptive Control of Systems with Actuator and Sensor Nonlinearities
/// (1996), ch. 2.
#[derive(Debug, Clone)]
pub struct DriveSaturation<S>(DriveSaturationParameters<S>);

impl<S: Scalar> Effect<S> for DriveSaturation<S> {
    const PARAMETERS: &'static [ParameterSpec] = DriveSaturationParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::InputMap];
    const MAPS_BY_PLACE: bool = false;
    const FACTS: EffectFacts = EffectFacts {
        summary: "the drive holds large inputs back",
        means: "what the controller asks for beyond the limit never arrives: fast moves overshoot \
                 and integrators wind up",
        remedy: "state the limit in the plant and in the controller (anti-windup), or raise it; \
                 look for a current limit, a voltage limit or a supply that cannot follow",
        class: "saturation",
        coordinate: "input near its limit",
        channels: &[],
        look_alikes: &["torque_constant_saturation"],
        experiment: "large efforts at low acceleration: against a load, or short pulses up to the \
                 greatest input",
        plan: "pulses",
        gains: &["share"],
        shapes: &[Shape {
            parameter: "limit",
            scale: Scale::Input,
            grid: &[0.3, 0.5, 0.7, 0.85, 0.95],
            fitted: true,
        }],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(DriveSaturationParameters::from_values(values))
    }

    #[inline(always)]
    fn input(&self, input: S, _at: &Situation<S>) -> S {
        let DriveSaturationParameters { share, limit } = self.0;
        if input.re().abs() > limit.re() {
            let direction = sign(input.re());
            input - share * (input - limit * direction)
        } else {
            input
        }
    }
}
