//! Parameters and options.

use crate::parameters;
use crate::support::parameter::OptionSpec;

/// 60 arc-seconds.
const SIXTY_ARC_SECONDS: f64 = 2.908_882_086_657_216e-4;

parameters! {
    /// Parameters of [`HsiehPan`].
    pub struct HsiehPanParameters {
        initial_stiffness: Stiffness, "slope of the spring right after a reversal, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        final_stiffness: Stiffness, "slope of the spring far from a reversal, k_inf < k_0",
            default Ratio { of: "initial_stiffness", factor: 0.27, otherwise: 810.0 },
            neutral None, typical 800.0, bounds 1e-9, 1e15;
        decay_distance: Position, "distance over which the slope falls, d_0",
            default Value(SIXTY_ARC_SECONDS), neutral None, typical SIXTY_ARC_SECONDS,
            bounds 1e-15, 1e6;
        hardening_coefficient: Hardening, "c of the greatest work hardening f(s) = c·s^n",
            default Value(1.6e-3), neutral Some(0.0), typical 1.6e-3, bounds 0.0, 1e9;
        hardening_exponent: One, "n of f(s) = c·s^n, above 1 so that f'(0) = 0",
            default Value(2.0), neutral None, typical 2.0, bounds 1.0001, 10.0;
        creep_rate: Rate, "rate at which creep approaches its end, α",
            default Value(2.0), neutral Some(0.0), typical 2.0, bounds 0.0, 1e6;
        damping: Damping, "damper that acts while the hook sticks, C_s",
            default Value(0.45), neutral Some(0.0), typical 0.45, bounds 0.0, 1e9;
        breakaway: Effort, "force at which the hook breaks away when loaded slowly, F_s; inf never slips",
            default Ratio { of: "coulomb", factor: 1.0, otherwise: f64::INFINITY },
            neutral Some(f64::INFINITY), typical 0.5, bounds 1e-12, f64::INFINITY;
        coulomb: Effort, "friction while sliding fast, F_c",
            default Ratio { of: "breakaway", factor: 0.7, otherwise: f64::INFINITY },
            neutral None, typical 0.35, bounds 0.0, f64::INFINITY;
        stribeck_velocity: Velocity, "speed scale of the fall from break-away to F_c, v_s",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-9, 1e6;
        stribeck_exponent: One, "shape of the fall, δ",
            default Value(2.0), neutral None, typical 2.0, bounds 0.3, 5.0;
        viscous: Damping, "friction per speed while sliding, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
        slip_distance: Position, "distance over which a slide forgets its initial force, ℓ",
            default Value(2e-5), neutral None, typical 2e-5, bounds 1e-12, 1e6;
        loading_rate: EffortRate, "loading rate at which break-away has fallen to 1/e of F_s − F_c, r_0; inf: no dependence",
            default Value(f64::INFINITY), neutral Some(f64::INFINITY), typical 5.0,
            bounds 1e-9, f64::INFINITY;
        loading_time: Time, "averaging time of the loading rate, τ",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-6, 1e3;
    }
}

parameters! {
    /// What a contact of [`HsiehPan`] may bring along.
    pub struct HsiehPanStart {
        force: Effort, "force of the spring at the start, on the first loading curve; levels off from 98 % of F_s on, σ_0",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
        hardening: Position, "work hardening at the start, h_0",
            default Value(0.0), neutral Some(0.0), typical 5e-5, bounds 0.0, 1e6;
        turned: One, "where the contact turned round before, on the first loading curve, as a share of F_s (of (k_0 − k_inf)·d_0 where it never breaks away); 0 where it never did, and forgotten where the force is beyond it",
            default Value(0.0), neutral Some(0.0), typical 0.5, bounds -0.999, 0.999;
        turned_again: One, "where it turned round after that, as a share of F_s; 0 where it did not; forgotten where the force is beyond it, and the first turn where this one is beyond that",
            default Value(0.0), neutral Some(0.0), typical 0.3, bounds -0.999, 0.999;
    }
}

pub(super) const OPTIONS: &[OptionSpec] = &[
    OptionSpec {
        name: "virgin_curve",
        meaning: "first loading, before any reversal",
        choices: &[
            ("masing", "half-size branch: the first loop closes at its mirror point"),
            ("same", "a full branch from the origin"),
        ],
    },
    OptionSpec {
        name: "damper",
        meaning: "where the damper sits",
        choices: &[
            ("hook", "between body and hook, beside spring and plastic module"),
            ("spring", "across the spring only; its force drives creep and break-away"),
        ],
    },
    OptionSpec {
        name: "after_slip",
        meaning: "work hardening once the hook sticks again",
        choices: &[
            ("reset", "starts from zero: the junctions are new"),
            ("keep", "goes on from where it was"),
        ],
    },
];
