//! Friction that grows with the effort of the motor.

use super::{Effect, EffectFacts, Hook, LevelChange, Memory, Situation};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`EffortDependentFriction`].
    pub struct EffortDependentFrictionParameters {
        share: One, "dry friction added per effort of the motor",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds 0.0, 1.0;
    }
}

/// Level 1 + c·|m|/F_c: dry friction grows by c·|m|, m all effort on the body but friction and the load,
/// that of the motor first of all. Gears and screws press harder on their flanks the more they transmit.
///
/// Neutral: c = 0.
/// Source: Duclusaud et al., Extended Friction Models for the Physics Simulation of Servo Actuators
/// (2025), `load_friction_motor` of models M3 to M6.
#[derive(Debug, Clone)]
pub struct EffortDependentFriction<S>(EffortDependentFrictionParameters<S>);

impl<S: Scalar> Effect<S> for EffortDependentFriction<S> {
    const PARAMETERS: &'static [ParameterSpec] = EffortDependentFrictionParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction grows with the effort of the motor",
        means: "a share of what the motor gives is lost in the gear: driving takes more and braking \
                less than inertia and friction without load say",
        remedy: "divide the feed-forward by what the gear lets through where the motor drives, and \
                 multiply where it brakes",
        class: "load",
        coordinate: "effort of the motor times direction",
        channels: &[],
        look_alikes: &["torque_constant_saturation", "viscous_quadratic"],
        experiment: "hard starts and hard stops between runs at constant speed, both ways",
        plan: "chirp",
        gains: &["share"],
        shapes: &[],
        second: &[],
        law_terms: &["drive"],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(EffortDependentFrictionParameters::from_values(values))
    }

    #[inline(always)]
    fn level(&self, at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        if !(at.sliding.re() > 0.0 && at.sliding.re().is_finite()) {
            return LevelChange { friction: S::constant(0.0), viscous: S::constant(0.0) };
        }
        let friction = self.0.share * at.motor.abs() / at.sliding;
        LevelChange { friction, viscous: S::constant(0.0) }
    }
}
