//! Inertia behind a shaft that gives.

use super::{Coupling, Effect, EffectFacts, Hook, Scale, SecondMass, Shape};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`ShaftCompliance`].
    pub struct ShaftComplianceParameters {
        compliance: Compliance, "twist (stretch) of the shaft per effort",
            default Value(0.0), neutral Some(0.0), typical 1e-3, bounds 0.0, 1e6;
        inertia_share: One, "share of the inertia beyond the shaft, s",
            default Value(0.5), neutral None, typical 0.5, bounds 0.01, 0.99;
        damping_ratio: One, "damping of the masses against each other, share of the critical one",
            default Value(0.04), neutral None, typical 0.04, bounds 0.0, 0.9;
    }
}

/// A share of the inertia behind a spring and damper: what the motor turns at once is the rest.
///
/// J·(1 − s)·x'' = u − F − T, J·s·y'' = T, T = (x − y)/c + d·(x' − y'). Seen from the motor with a stiff
/// shaft that is an effort −c·(s·J)²·x'''': data far below the resonance tell c·s² alone, and those that
/// reach it c·s as well.
///
/// Neutral: c = 0.
/// Source: two-mass system, Ellis, Lorenz, Resonant load control methods, IEEE IAS (2000).
#[derive(Debug, Clone)]
pub struct ShaftCompliance<S>(ShaftComplianceParameters<S>);

impl<S: Scalar> Effect<S> for ShaftCompliance<S> {
    const PARAMETERS: &'static [ParameterSpec] = ShaftComplianceParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::SecondMass];
    const FACTS: EffectFacts = EffectFacts {
        summary: "a part of the inertia hangs on a shaft or coupling that gives",
        means: "the load does not follow the motor at once: fast moves excite a resonance",
        remedy: "keep the controller's bandwidth and the reference below the resonance, or put a notch \
                 there; look for a loose coupling, a long belt or a thin shaft",
        class: "compliance",
        coordinate: "fourth derivative of the position",
        channels: &[],
        look_alikes: &[],
        experiment: "chirp of the input through the resonance",
        plan: "chirp",
        gains: &["compliance"],
        shapes: &[
            Shape {
                parameter: "inertia_share",
                scale: Scale::One,
                grid: &[0.2, 0.3, 0.4, 0.5, 0.65, 0.8],
                fitted: true,
            },
            Shape { parameter: "damping_ratio", scale: Scale::One, grid: &[0.08], fitted: true },
        ],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(ShaftComplianceParameters::from_values(values))
    }

    fn second_mass(&self) -> Option<SecondMass<S>> {
        let ShaftComplianceParameters { compliance, inertia_share, damping_ratio } = self.0;
        let coupling = Coupling::Shaft { compliance, damping_ratio };
        Some(SecondMass { share: inertia_share, coupling })
    }
}
