//! A contact that creeps under load until it has hardened.

use super::{Effect, EffectFacts, Hook, Relaxation, Scale, Shape};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`CreepHardening`].
    pub struct CreepHardeningParameters {
        creep: Position, "way that a contact held just below its sliding force creeps in the end",
            default Value(0.0), neutral Some(0.0), typical 1e-4, bounds 0.0, 1e3;
        exponent: One, "how it falls with lower forces, n",
            default Value(2.0), neutral None, typical 2.5, bounds 1.0001, 10.0;
        rate: Rate, "rate at which creep approaches its end, α",
            default Value(2.0), neutral None, typical 2.0, bounds 1e-6, 1e6;
    }
}

/// A plastic module in series with any law: h' = |x_p'| = α·(a·|F/F_c|^n − h) where positive.
///
/// Under a held motion it lets the force relax, under a held force the body creep. A slide, here a
/// force of 98 % of that of slow sliding, makes the junctions new: h is 0 and rests.
///
/// Neutral: a = 0. A rigid contact (`coulomb`) creeps only where it holds a resting body.
/// Source: the plastic module of Hsieh, Pan, Wear 242 (2000), §2.2.3, before another law.
#[derive(Debug, Clone)]
pub struct CreepHardening<S>(CreepHardeningParameters<S>);

impl<S: Scalar> Effect<S> for CreepHardening<S> {
    const PARAMETERS: &'static [ParameterSpec] = CreepHardeningParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::StateRelaxation];
    const FACTS: EffectFacts = EffectFacts {
        summary: "the contact creeps under a held load and hardens",
        means: "a position that was reached is not kept: the machine creeps on for seconds",
        remedy: "wait until it has died out before measuring, or preload beyond the working force first; \
                 a law with creep (hsieh_pan) simulates it",
        class: "creep",
        coordinate: "time since the reversal or during a hold",
        channels: &[],
        look_alikes: &["relaxation"],
        experiment: "holds of 5 s and more at three levels from 0.3 to 0.95 of break-away",
        plan: "loops",
        gains: &["creep"],
        shapes: &[
            Shape { parameter: "exponent", scale: Scale::One, grid: &[2.0], fitted: false },
            Shape { parameter: "rate", scale: Scale::One, grid: &[0.8, 3.0], fitted: true },
        ],
        second: &[],
        law_terms: &["hardening_coefficient", "hardening_exponent", "creep_rate"],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(CreepHardeningParameters::from_values(values))
    }

    fn relaxation(&self) -> Option<Relaxation<S>> {
        let CreepHardeningParameters { creep, exponent, rate } = self.0;
        Some(Relaxation::Hardening { creep, exponent, rate })
    }
}
