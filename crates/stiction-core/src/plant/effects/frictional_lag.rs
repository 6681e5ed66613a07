//! Friction that follows speed late.

use super::{Effect, EffectFacts, Hook, LevelChange, Memory, Passage, Scale, Shape, Situation};
use crate::friction::elements::stribeck::fall;
use crate::math::exponential::come_about;
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`FrictionalLag`].
    pub struct FrictionalLagParameters {
        excess: One, "fall of the level with speed that comes late, as a share",
            default Value(0.0), neutral Some(0.0), typical 0.2, bounds -10.0, 10.0;
        velocity: Velocity, "speed scale of that fall, v_s",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-9, 1e6;
        time: Time, "time constant with which friction follows speed, T",
            default Value(0.05), neutral None, typical 0.05, bounds 1e-6, 1e3;
        fall: One, "share of the fall itself that comes with its lag: 0 the lag alone, 1 all of it",
            default Value(0.0), neutral None, typical 1.0, bounds 0.0, 1.0;
    }
}

/// Level 1 + a·(g(w) − (1 − f)·g(v)), g(v) = exp(−(v/v_s)²), w' = (v − w)/T.
///
/// What depends on speed follows it late: friction is higher while a machine speeds up and lower while
/// it slows down, a loop over speed. Where the fall itself stands in the law, or beside this as the
/// Stribeck effect, f = 0 adds its lag alone; f = 1 is a fall that was nowhere yet, and late. Memory: w.
///
/// Neutral: a = 0.
/// Source: Hess, Soom, J. Tribology 112 (1990): friction at a line contact oscillating in speed lags
/// behind; Armstrong-Hélouvry et al., Automatica 30 (1994), frictional memory.
#[derive(Debug, Clone)]
pub struct FrictionalLag<S>(FrictionalLagParameters<S>);

const FOLLOWED: usize = 0;

impl<S: Scalar> Effect<S> for FrictionalLag<S> {
    const PARAMETERS: &'static [ParameterSpec] = FrictionalLagParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const REMEMBERS: bool = true;
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction follows a change of speed late",
        means: "friction is not a function of speed: it is higher while speeding up than while \
                 slowing down, which steadies stick-slip and fools a compensation by speed",
        remedy: "compensate with a filtered speed; a law with internal states simulates it",
        class: "breakaway",
        coordinate: "loop over speed, between speeding up and slowing down",
        channels: &[],
        look_alikes: &["stribeck", "input_delay"],
        experiment: "the same speeds at different accelerations",
        plan: "sines",
        gains: &["excess"],
        shapes: &[
            Shape {
                parameter: "velocity",
                scale: Scale::Speed,
                grid: &[0.1, 0.4, 0.7],
                fitted: true,
            },
            Shape { parameter: "time", scale: Scale::Kernel, grid: &[0.7, 3.0], fitted: true },
            Shape { parameter: "fall", scale: Scale::One, grid: &[0.0, 1.0], fitted: false },
        ],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(FrictionalLagParameters::from_values(values))
    }

    #[inline(always)]
    fn level(&self, at: &Situation<S>, memory: &Memory<S>) -> LevelChange<S> {
        let FrictionalLagParameters { excess, velocity, fall: whole, .. } = self.0;
        let two = S::constant(2.0);
        let (late, _) = fall(memory[FOLLOWED], velocity, two);
        let (now, _) = fall(at.velocity, velocity, two);
        let steady = now * -(whole - 1.0);
        LevelChange { friction: excess * (late - steady), viscous: S::constant(0.0) }
    }

    #[inline(always)]
    fn remember(&self, memory: &mut Memory<S>, passage: &Passage<S>) {
        let behind = passage.displacement / passage.span - memory[FOLLOWED];
        memory[FOLLOWED] += behind * come_about(passage.span / self.0.time);
    }
}
