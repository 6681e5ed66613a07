//! Friction that falls with the path travelled.

use super::{Effect, EffectFacts, Hook, LevelChange, Memory, Scale, Shape, Situation};
use crate::math::exponential::come_about;
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`RunIn`].
    pub struct RunInParameters {
        coulomb: One, "share of dry friction that is lost in the end",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds 0.0, 0.9;
        distance: Position, "path over which most of it is lost, P",
            default Value(100.0), neutral None, typical 100.0, bounds 1e-9, 1e12;
    }
}

/// Level 1 − a·(1 − exp(−p/P)), p the path travelled since the session began.
///
/// Neutral: a = 0.
/// Source: Blau, Wear 71 (1981): friction in the first distance slid of new or greased surfaces; the
/// exponential is ours.
#[derive(Debug, Clone)]
pub struct RunIn<S>(RunInParameters<S>);

impl<S: Scalar> Effect<S> for RunIn<S> {
    const PARAMETERS: &'static [ParameterSpec] = RunInParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const ASKS_SPEED: bool = false;
    const CHANGES_IN_TIME: bool = false;
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction falls with the path travelled",
        means: "the machine eases with motion, not with time: new parts, fresh grease, or a long rest \
                 before",
        remedy: "run it in before tuning and measuring: some full strokes after each long rest",
        class: "slow",
        coordinate: "cumulative path, odd in direction",
        channels: &[],
        look_alikes: &["warm_up"],
        experiment: "once more from cold, added to this session with cold = true: a short cycle, again \
                     after minutes of rest, again after long fast motion",
        plan: "cycle",
        gains: &["coulomb"],
        shapes: &[Shape {
            parameter: "distance",
            scale: Scale::Path,
            grid: &[0.1, 0.3, 1.0],
            fitted: true,
        }],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(RunInParameters::from_values(values))
    }

    #[inline(always)]
    fn level(&self, at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        let p = &self.0;
        let lost = -come_about(at.path / p.distance);
        LevelChange { friction: p.coulomb * lost, viscous: S::constant(0.0) }
    }
}
