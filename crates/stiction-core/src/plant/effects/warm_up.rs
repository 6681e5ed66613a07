//! Friction that falls while the machine warms up.

use super::{Effect, EffectFacts, Hook, LevelChange, Memory, Scale, Shape, Situation};
use crate::math::exponential::come_about;
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`WarmUp`].
    pub struct WarmUpParameters {
        coulomb: One, "share of dry friction that is lost in the end",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds 0.0, 0.9;
        viscous: One, "share of viscous friction that is lost in the end",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds 0.0, 0.9;
        time: Time, "time in which most of it is lost, T",
            default Value(60.0), neutral None, typical 60.0, bounds 1e-3, 1e9;
    }
}

/// Levels 1 − a·w and 1 − b·w of dry and of viscous friction, w = 1 − exp(−t/T), t on the session
/// clock.
///
/// Neutral: a = b = 0.
/// Source: Bittencourt, Gunnarsson, J. Dyn. Syst. Meas. Control 134 (2012), friction of a robot
/// joint over temperature; one time constant is a body that is heated evenly.
#[derive(Debug, Clone)]
pub struct WarmUp<S>(WarmUpParameters<S>);

impl<S: Scalar> Effect<S> for WarmUp<S> {
    const PARAMETERS: &'static [ParameterSpec] = WarmUpParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const ASKS_SPEED: bool = false;
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction falls with the time since the machine was switched on",
        means: "what was tuned on a cold machine is wrong on a warm one",
        remedy: "warm the machine up before tuning and measuring, or let the compensation follow the \
                 time since the start, better a temperature",
        class: "slow",
        coordinate: "session clock, odd in direction",
        channels: &[],
        look_alikes: &["run_in"],
        experiment: "once more from cold, added to this session with cold = true: a short cycle, again \
                     after minutes of rest, again after long fast motion",
        plan: "cycle",
        gains: &["coulomb", "viscous"],
        shapes: &[Shape {
            parameter: "time",
            scale: Scale::Session,
            grid: &[0.1, 0.3, 1.0],
            fitted: true,
        }],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(WarmUpParameters::from_values(values))
    }

    #[inline(always)]
    fn level(&self, at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        let p = &self.0;
        // Minus what is lost so far.
        let lost = -come_about(at.time / p.time);
        LevelChange { friction: p.coulomb * lost, viscous: p.viscous * lost }
    }
}
