//! Friction that falls with temperature.

use super::{Effect, EffectFacts, Hook, LevelChange, Memory, Scale, Shape, Situation};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`TemperatureDependentFriction`].
    pub struct TemperatureDependentFrictionParameters {
        coulomb: PerKelvin, "share of dry friction that is lost per kelvin",
            default Value(0.0), neutral Some(0.0), typical 0.005, bounds -1.0, 1.0;
        viscous: PerKelvin, "share of viscous friction that is lost per kelvin",
            default Value(0.0), neutral Some(0.0), typical 0.02, bounds -1.0, 1.0;
        reference: Temperature, "temperature at which the law holds as it is, T_0",
            default Value(25.0), neutral None, typical 25.0, bounds -273.15, 1e4;
    }
}

/// Levels 1 − a·(T − T_0) of dry and 1 − b·(T − T_0) of viscous friction, T the measured temperature.
///
/// Where no temperature is known it does nothing.
///
/// Neutral: a = b = 0.
/// Source: Bittencourt, Gunnarsson, J. Dyn. Syst. Meas. Control 134 (2012), friction of a robot joint over
/// temperature.
#[derive(Debug, Clone)]
pub struct TemperatureDependentFriction<S>(TemperatureDependentFrictionParameters<S>);

impl<S: Scalar> Effect<S> for TemperatureDependentFriction<S> {
    const PARAMETERS: &'static [ParameterSpec] =
        TemperatureDependentFrictionParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const ASKS_SPEED: bool = false;
    const CHANGES_IN_TIME: bool = false;
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction changes with temperature",
        means: "what was tuned at one temperature is wrong at another",
        remedy: "let the compensation follow the temperature, or bring the machine to temperature \
                 first",
        class: "temperature",
        coordinate: "temperature, odd in direction",
        channels: &["temperature"],
        look_alikes: &["warm_up", "run_in"],
        experiment: "one reference cycle repeated at several temperatures, heated by other means \
                 than by running",
        plan: "cycle",
        gains: &["coulomb", "viscous"],
        shapes: &[Shape {
            parameter: "reference",
            scale: Scale::One,
            grid: &[25.0],
            fitted: false,
        }],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(TemperatureDependentFrictionParameters::from_values(values))
    }

    #[inline(always)]
    fn level(&self, at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        let p = &self.0;
        let Some(temperature) = at.temperature else {
            return LevelChange { friction: S::constant(0.0), viscous: S::constant(0.0) };
        };
        let colder = p.reference - temperature;
        LevelChange { friction: p.coulomb * colder, viscous: p.viscous * colder }
    }
}
