//! Friction that is higher at low speed.

use super::{Effect, EffectFacts, Hook, LevelChange, Memory, Scale, Shape, Situation};
use crate::friction::elements::stribeck::fall;
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`Stribeck`].
    pub struct StribeckParameters {
        excess: One, "friction at rest above that at high speed, as a share of the latter",
            default Value(0.0), neutral Some(0.0), typical 0.3, bounds 0.0, 10.0;
        velocity: Velocity, "speed scale of the fall",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-9, 1e6;
        exponent: One, "shape of the fall",
            default Value(2.0), neutral None, typical 2.0, bounds 0.3, 5.0;
    }
}

/// Level 1 + e·exp(−|v/v_s|^δ).
///
/// Neutral: e = 0. A level that rises with speed is no Stribeck effect, so e is not negative.
/// Source: Stribeck (1902), in the form of Bo, Pavelescu, Wear 82 (1982).
#[derive(Debug, Clone)]
pub struct Stribeck<S>(StribeckParameters<S>);

impl<S: Scalar> Effect<S> for Stribeck<S> {
    const PARAMETERS: &'static [ParameterSpec] = StribeckParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const CHANGES_IN_TIME: bool = false;
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction falls from a level at rest to a lower one as speed rises",
        means: "friction that falls with speed makes slow motion jerk: stick-slip and hunting",
        remedy: "compensate with the fitted curve, move faster through the fall, or change the \
                 lubricant",
        class: "breakaway",
        coordinate: "logarithm of speed, odd in direction",
        channels: &[],
        look_alikes: &["dwell_strengthening", "rate_dependent_breakaway"],
        experiment: "two-way constant-speed ramps over three decades, without rests",
        plan: "ramps",
        gains: &["excess"],
        shapes: &[
            Shape {
                parameter: "velocity",
                scale: Scale::Speed,
                grid: &[0.1, 0.25, 0.4, 0.55, 0.7],
                fitted: true,
            },
            Shape { parameter: "exponent", scale: Scale::One, grid: &[2.0], fitted: false },
        ],
        second: &[],
        law_terms: &["stribeck_velocity", "stribeck_exponent"],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(StribeckParameters::from_values(values))
    }

    #[inline(always)]
    fn level(&self, at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        let p = &self.0;
        let (left, _) = fall(at.velocity, p.velocity, p.exponent);
        LevelChange { friction: p.excess * left, viscous: S::constant(0.0) }
    }
}
