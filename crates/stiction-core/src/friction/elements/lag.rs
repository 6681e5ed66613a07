//! First-order following of a target that changes linearly.

use crate::math::exponential::{faded, faded_of, faded_within};
use crate::math::row::pick;
use crate::math::scalar::Scalar;

/// What [`follow`] returns.
#[derive(Debug, Clone, Copy)]
pub struct Followed<S> {
    /// The follower at the end.
    pub value: S,
    /// ∂value/∂(target at the end), the target at the start unchanged.
    pub end_share: S,
    /// e^(−z), what is left of the initial distance.
    pub remainder: S,
}

/// Solves dy/dζ = target(ζ) − y over ζ = 0 … z with the target going linearly from `from` to `to`.
///
/// y(z) = to − (to − from)·(1 − e^(−z))/z + (y₀ − from)·e^(−z), exact and stable for any z ≥ 0.
#[inline(always)]
pub fn follow<S: Scalar>(y: S, from: S, to: S, z: S) -> Followed<S> {
    follow_by(y, from, to, z, faded_of(-z))
}

/// The same as part of the loop that asks for it.
#[inline(always)]
pub fn follow_within<S: Scalar>(y: S, from: S, to: S, z: S) -> Followed<S> {
    follow_by(y, from, to, z, faded_within(-z))
}

/// The same with 1 − e^(−z) known.
#[inline(always)]
pub fn follow_by<S: Scalar>(y: S, from: S, to: S, z: S, gone: S) -> Followed<S> {
    let remainder = -(gone - 1.0);
    // (1 − e^(−z))/z loses digits below 1e-5; the series error there is under z²/6 ≈ 2e-11.
    let mean_share = if z.re() < 1e-5 {
        -(z * 0.5 - 1.0)
    } else {
        // The reciprocal waits for no exponential.
        gone * (S::constant(1.0) / z)
    };
    let end_share = -(mean_share - 1.0);
    Followed {
        value: from + (to - from) * end_share + (y - from) * remainder,
        end_share,
        remainder,
    }
}

/// e^(−z), and the share of the target at the end: what [`follow`] is made of.
#[inline(always)]
pub fn shares(z: f64) -> (f64, f64) {
    let gone = faded(-z);
    // By bits, or a division that is left out for some would be a branch.
    let mean = pick(z < 1e-5, -(z * 0.5 - 1.0), gone * (1.0 / z));
    (-(gone - 1.0), -(mean - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn following_a_ramp_matches_small_steps() {
        for z in [1e-7_f64, 1e-3, 0.3, 4.0, 80.0] {
            let (from, to, start) = (0.2, 0.9, -0.4);
            let exact = follow(start, from, to, z).value;
            let steps = 200_000;
            let mut y: f64 = start;
            for k in 0..steps {
                let target = from + (to - from) * (f64::from(k) + 0.5) / f64::from(steps);
                let dz = z / f64::from(steps);
                y += (target - y) * (-(-dz).exp_m1());
            }
            assert!((exact - y).abs() < 1e-9, "z {z}: {exact} against {y}");
        }
    }
}
