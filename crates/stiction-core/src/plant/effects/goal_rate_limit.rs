//! A goal that moves no faster than a limit.

use super::{Effect, EffectFacts, Hook};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`GoalRateLimit`].
    pub struct GoalRateLimitParameters {
        slowness: PerVelocity, "time that the goal takes for one unit of its way, 1/(greatest speed)",
            default Value(0.0), neutral Some(0.0), typical 0.2, bounds 0.0, 1e6;
    }
}

/// g' = sgn(u − g)/s until g = u, the goal g instead of the goal u that was asked for.
///
/// The goal of a servo comes nearer to what was asked for at a constant speed, 1/slowness, and stays
/// there: the profile velocity (goal speed) of the servo's own firmware.
///
/// What acts over a sample is its mean over it, so no sample is divided. It starts where the first
/// goal is, after a delay of the input and before a lag.
///
/// Neutral: slowness = 0. At 0 the derivative is that towards slower goals, −Δ·|Δ|/(2·dt) for a step
/// Δ of the goal.
/// Source: Biagiotti, Melchiorri, Trajectory Planning for Automatic Machines and Robots (2008), ch. 4,
/// filters that limit the velocity of a reference.
#[derive(Debug, Clone)]
pub struct GoalRateLimit<S>(GoalRateLimitParameters<S>);

impl<S: Scalar> Effect<S> for GoalRateLimit<S> {
    const PARAMETERS: &'static [ParameterSpec] = GoalRateLimitParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::InputRate];
    const FACTS: EffectFacts = EffectFacts {
        summary: "the goal moves no faster than a limit",
        means: "what is asked for in a step comes as a ramp: far goals are reached later than near ones",
        remedy: "state the limit with the goals, or raise the servo's profile velocity (goal speed)",
        class: "goal_rate_limit",
        coordinate: "distance to the goal",
        channels: &[],
        look_alikes: &["input_delay", "current_loop_lag", "drive_saturation"],
        experiment: "steps of the goal of three sizes, and slow ramps",
        plan: "fast",
        gains: &["slowness"],
        shapes: &[],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(GoalRateLimitParameters::from_values(values))
    }

    fn slowness(&self) -> Option<S> {
        Some(self.0.slowness)
    }
}
