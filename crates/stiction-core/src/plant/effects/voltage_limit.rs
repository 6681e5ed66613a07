//! A drive whose limit comes down as the motor runs.

use super::{Effect, EffectFacts, Hook, Scale, Shape, Situation};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`VoltageLimit`].
    pub struct VoltageLimitParameters {
        share: One, "share of what is beyond the limit that does not get through; 1 is a hard limit",
            default Value(0.0), neutral Some(0.0), typical 1.0, bounds 0.0, 1.0;
        limit: Input, "input from which on it is held back at rest",
            default Value(1.0), neutral None, typical 0.3, bounds 0.0, 1e12;
        no_load: Velocity, "speed at which nothing gets through any more",
            default Value(1.0), neutral None, typical 0.5, bounds 1e-9, 1e6;
    }
}

/// Input u − a·(|u| − R)·sgn(u) where |u| > R = L·(1 − v·sgn(u)/v_0), and R at least 0: a current loop
/// gives what it is asked for until supply voltage less the motor's own, V − k·v, is used up by the
/// resistance.
///
/// L is the stall current V/r as an input, v_0 = V/k the speed without load. Braking it reaches
/// further. A bridge without a current loop loses at any input (see [`super::back_emf`]).
///
/// Neutral: a = 0.
/// Source: Krishnan, Permanent Magnet Synchronous and Brushless DC Motor Drives (2010), ch. 6, the line
/// that bounds torque over speed.
#[derive(Debug, Clone)]
pub struct VoltageLimit<S>(VoltageLimitParameters<S>);

impl<S: Scalar> Effect<S> for VoltageLimit<S> {
    const PARAMETERS: &'static [ParameterSpec] = VoltageLimitParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::InputMap];
    const FACTS: EffectFacts = EffectFacts {
        summary: "the drive holds large inputs back, and the more the faster the machine runs with them",
        means: "effort runs out at speed: fast moves lag and overshoot though the same input is \
                 reached at rest, and integrators wind up",
        remedy: "plan moves below the line of torque over speed, or raise the supply voltage; look \
                 for a supply that sags",
        class: "back_emf",
        coordinate: "input near its limit, by speed",
        channels: &[],
        look_alikes: &["drive_saturation", "back_emf"],
        experiment: "the greatest inputs at rest, at half and at full speed, with the motion and \
                 against it; log current and voltage",
        plan: "fast",
        gains: &["share"],
        shapes: &[
            Shape {
                parameter: "limit",
                scale: Scale::Input,
                grid: &[0.5, 0.7, 0.9, 1.2],
                fitted: true,
            },
            Shape {
                parameter: "no_load",
                scale: Scale::Speed,
                grid: &[1.0, 1.05, 1.1, 1.25],
                fitted: true,
            },
        ],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(VoltageLimitParameters::from_values(values))
    }

    #[inline(always)]
    fn input(&self, input: S, at: &Situation<S>) -> S {
        let VoltageLimitParameters { share, limit, no_load } = self.0;
        let direction = sign(input.re());
        let along = limit - limit * (at.velocity * direction) / no_load;
        let reach = if along.re() > 0.0 { along } else { S::constant(0.0) };
        if input.re().abs() > reach.re() {
            input - share * (input - reach * direction)
        } else {
            input
        }
    }
}
