//! Inertia behind a gap.

use super::{Coupling, Effect, EffectFacts, Hook, Scale, SecondMass, Shape};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`Backlash`].
    pub struct BacklashParameters {
        inertia_share: One, "share of the inertia behind the gap",
            default Value(0.0), neutral Some(0.0), typical 0.3, bounds 0.0, 0.95;
        gap: Position, "width of the gap",
            default Value(1e-3), neutral None, typical 5e-3, bounds 1e-12, 1e3;
        contact_time: Time, "1/ω of the mass behind the gap on its end, motor held; 0: rigid, no rebound",
            default Value(0.0), neutral None, typical 1e-3, bounds 0.0, 1.0;
        damping_ratio: One, "damping of the masses against each other at an end, share of critical",
            default Value(0.6), neutral None, typical 0.6, bounds 0.0, 0.9;
        load_damping: Rate, "viscous friction of the mass behind the gap over its inertia",
            default Value(0.0), neutral None, typical 0.3, bounds 0.0, 1e3;
    }
}

/// A second mass that flies free between the two ends of a gap, which stop it or throw it back.
///
/// J·(1 − s)·x'' = u − F − T, J·s·y'' = T − J·s·β·y'. Within the gap T = 0; where d = x − y is beyond half
/// of its width w, T = k·(d ∓ w/2) + c·d' as long as that pushes, with the contact time t = √(s·J/k) and
/// the damping ratio ζ of the two masses against each other, c = 2·ζ·√(k·s·(1 − s)·J). Ends with t = 0
/// are rigid and stop it without rebound, whatever ζ. The sensor is on the motor, and so is the friction of
/// the law; β is the viscous friction of the load's own bearings over its inertia. While the second mass
/// flies the motor is lighter; when it is caught the motor is slowed at once.
///
/// Along a measured motion a mass between ends that yield is what may be expected of it: the mean of
/// eight that begin all over the gap behind motions that would have been read alike.
///
/// Neutral: no inertia behind the gap, whatever the rest.
/// Source: Nordin, Gutman, Automatica 38 (2002) 1633-1649, controlling mechanical systems with
/// backlash; the gap in series with a spring and damper that push and never pull.
#[derive(Debug, Clone)]
pub struct Backlash<S>(BacklashParameters<S>);

impl<S: Scalar> Effect<S> for Backlash<S> {
    const PARAMETERS: &'static [ParameterSpec] = BacklashParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::SecondMass];
    const FACTS: EffectFacts = EffectFacts {
        summary: "a part of the inertia lies behind a gap",
        means: "at each change of the effort's sign the load is lost and caught again: knocks, \
                 limit cycles, and an error of position as wide as the gap",
        remedy: "preload the gear, measure at the load, or cross the gap slowly; look for worn \
                 teeth, a key, a loose coupling",
        class: "backlash",
        coordinate: "time since the effort changed its sign",
        channels: &[],
        look_alikes: &["shaft_compliance", "drive_deadband"],
        experiment: "small reversals, and moves that speed up and slow down without reversing",
        plan: "chirp",
        gains: &["inertia_share"],
        shapes: &[
            // A gap knows nothing of the contact; of one twice as wide a sixth is seen.
            Shape {
                parameter: "gap",
                scale: Scale::Presliding,
                grid: &[0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 25.0],
                fitted: true,
            },
            // Rigid ends and a load without friction first: what more there is shows beside these.
            Shape { parameter: "contact_time", scale: Scale::One, grid: &[0.0], fitted: false },
            Shape { parameter: "damping_ratio", scale: Scale::One, grid: &[0.6], fitted: false },
            Shape { parameter: "load_damping", scale: Scale::One, grid: &[0.0], fitted: false },
        ],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(BacklashParameters::from_values(values))
    }

    fn second_mass(&self) -> Option<SecondMass<S>> {
        let BacklashParameters { inertia_share, gap, contact_time, damping_ratio, load_damping } =
            self.0;
        let coupling = Coupling::Gap { width: gap, contact_time, damping_ratio, load_damping };
        Some(SecondMass { share: inertia_share, coupling })
    }
}
