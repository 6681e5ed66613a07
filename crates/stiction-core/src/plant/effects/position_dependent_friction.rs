//! Friction that varies with position.

use super::{Effect, EffectFacts, Hook, LevelChange, Memory, Scale, Shape, Situation};
use crate::math::scalar::Scalar;
use crate::math::wave::Wave;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`PositionDependentFriction`].
    pub struct PositionDependentFrictionParameters {
        cosine: One, "amplitude of the cosine part, as a share of friction",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -0.6, 0.6;
        sine: One, "amplitude of the sine part, as a share of friction",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -0.6, 0.6;
        order: Order, "periods per 2π rad (rotary) or per 2π m (linear), N",
            default Value(1.0), neutral None, typical 1.0, bounds 1e-6, 1e9;
        cosine_2: One, "amplitude of the cosine part of a second wave, as a share of friction",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds -0.1, 0.1;
        sine_2: One, "amplitude of the sine part of a second wave, as a share of friction",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds -0.1, 0.1;
        order_2: Order, "periods of the second wave per 2π rad (rotary) or per 2π m (linear), N",
            default Value(2.0), neutral None, typical 2.0, bounds 1e-6, 1e9;
    }
}

/// Level 1 + a·cos(N·x) + b·sin(N·x): a bent shaft, a screw that runs tight once a turn.
///
/// Neutral: a = b = 0. The bounds keep the level above 0 whatever the position.
/// Source: Popović, Goldenberg, Proc. IEEE ICRA (1998).
#[derive(Debug, Clone)]
pub struct PositionDependentFriction<S>(Wave<S>);

impl<S: Scalar> Effect<S> for PositionDependentFriction<S> {
    const PARAMETERS: &'static [ParameterSpec] = PositionDependentFrictionParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const ASKS_SPEED: bool = false;
    const CHANGES_IN_TIME: bool = false;
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction that repeats with position",
        means: "the machine runs tight and loose in turn, always at the same places",
        remedy: "tabulate the friction level over position; look for a bent shaft or screw, a rail out \
                 of line, a bearing or seal that binds",
        class: "angle",
        coordinate: "position, odd in direction",
        channels: &[],
        look_alikes: &["torque_constant_ripple"],
        experiment: "sine of high acceleration: the input varies at the same position",
        plan: "sines",
        gains: &["cosine", "sine"],
        shapes: &[Shape { parameter: "order", scale: Scale::Order, grid: &[], fitted: true }],
        second: &["cosine_2", "sine_2", "order_2"],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        let p = PositionDependentFrictionParameters::from_values(values);
        Self(Wave::new([p.cosine, p.sine, p.order], [p.cosine_2, p.sine_2, p.order_2]))
    }

    #[inline(always)]
    fn level(&self, at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        LevelChange { friction: self.0.at(at.position), viscous: S::constant(0.0) }
    }

    fn level_wave(&self) -> Option<Wave<S>> {
        Some(self.0)
    }
}
