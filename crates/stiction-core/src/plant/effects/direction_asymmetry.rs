//! Friction that differs between the two directions.

use super::{Effect, EffectFacts, Hook, LevelChange, Memory, Scale, Shape, Situation};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`DirectionAsymmetry`].
    pub struct DirectionAsymmetryParameters {
        coulomb: One, "share by which dry friction is higher forwards and lower backwards",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -0.9, 0.9;
        viscous: One, "share by which viscous friction is higher forwards and lower backwards",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -0.9, 0.9;
        velocity: Velocity, "speed over which one direction goes over into the other",
            default Value(0.01), neutral None, typical 0.01, bounds 1e-9, 1e6;
    }
}

/// Levels 1 + a·d(v) and 1 + b·d(v), d(v) = v/√(v² + v₀²).
///
/// The direction is smooth, because the level multiplies a force that does not vanish where the
/// velocity changes sign: a jump there would do work without motion. Neutral: a = b = 0.
/// Source: Armstrong-Hélouvry, Control of Machines with Friction (1991), ch. 4, whose two
/// directions have parameters of their own; the smooth change is ours.
#[derive(Debug, Clone)]
pub struct DirectionAsymmetry<S>(DirectionAsymmetryParameters<S>);

impl<S: Scalar> Effect<S> for DirectionAsymmetry<S> {
    const PARAMETERS: &'static [ParameterSpec] = DirectionAsymmetryParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const CHANGES_IN_TIME: bool = false;
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction is higher in one direction than in the other",
        means: "a compensation with one friction level for both directions is wrong in each",
        remedy: "give the compensation a level for each direction; look for one-sided preload, a seal \
                 lip or a gear that drives one way more easily",
        class: "offset",
        coordinate: "sign of speed; gone in small loops",
        channels: &[],
        look_alikes: &["torque_bias"],
        experiment: "pre-sliding loops and rests at zero input; a change of load",
        plan: "loops",
        gains: &["coulomb", "viscous"],
        shapes: &[Shape {
            parameter: "velocity",
            scale: Scale::Speed,
            grid: &[-0.2, 0.15, 0.4],
            fitted: true,
        }],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(DirectionAsymmetryParameters::from_values(values))
    }

    #[inline(always)]
    fn level(&self, at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        let p = &self.0;
        let direction = at.velocity / (at.velocity * at.velocity + p.velocity * p.velocity).sqrt();
        LevelChange { friction: p.coulomb * direction, viscous: p.viscous * direction }
    }
}
