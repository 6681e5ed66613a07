//! Friction that grows with the load.

use super::{Effect, EffectFacts, Hook, LevelChange, Memory, Scale, Shape, Situation};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`LoadDependentFriction`].
    pub struct LoadDependentFrictionParameters {
        drive: One, "dry friction added per load while the machine drives the load",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1.0, 10.0;
        back_drive: One, "dry friction added per load while the load drives the machine",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds -1.0, 10.0;
        velocity: Velocity, "speed over which the one goes over into the other",
            default Value(0.01), neutral None, typical 0.01, bounds 1e-9, 1e6;
    }
}

/// Level 1 + c·|Q|/F_c: dry friction grows by c·|Q|, Q the load: the external one and gravity.
///
/// c is c_d where the machine moves against the load and c_b where the load moves the machine: teeth and
/// screws lose more in the one than in the other. Both go over into each other within a small speed,
/// as the level multiplies a force that does not vanish where the velocity changes sign.
///
/// Neutral: c_d = c_b = 0.
/// Source: Duclusaud et al., Extended Friction Models for the Physics Simulation of Servo Actuators
/// (2025), models M3 to M5.
#[derive(Debug, Clone)]
pub struct LoadDependentFriction<S>(LoadDependentFrictionParameters<S>);

impl<S: Scalar> Effect<S> for LoadDependentFriction<S> {
    const PARAMETERS: &'static [ParameterSpec] = LoadDependentFrictionParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction grows with the load that the machine carries",
        means: "lifting takes more than the load and lowering gives back less: what was tuned \
                 without load is wrong with it",
        remedy: "feed the load forward with its losses, one for each direction of power",
        class: "load",
        coordinate: "load times direction",
        channels: &["load"],
        look_alikes: &["torque_constant_saturation", "gravity_unbalance"],
        experiment: "load steps at constant speed, both ways",
        plan: "ramps",
        gains: &["drive", "back_drive"],
        shapes: &[Shape { parameter: "velocity", scale: Scale::One, grid: &[0.01], fitted: false }],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(LoadDependentFrictionParameters::from_values(values))
    }

    #[inline(always)]
    fn level(&self, at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        let p = &self.0;
        if !(at.sliding.re() > 0.0 && at.sliding.re().is_finite()) {
            return LevelChange { friction: S::constant(0.0), viscous: S::constant(0.0) };
        }
        let speed = (at.velocity * at.velocity + p.velocity * p.velocity).sqrt();
        let direction = at.velocity / speed;
        let mean = (p.drive + p.back_drive) * 0.5 * at.load.abs();
        let apart = (p.drive - p.back_drive) * 0.5 * at.load * direction;
        let friction = (mean - apart) / at.sliding;
        LevelChange { friction, viscous: S::constant(0.0) }
    }
}
