//! A sliding level that rises with the way slid, whatever its direction.

use crate::math::scalar::Scalar;

/// Newton steps to the slip of an elastic overrun: one for each factor e between the rises of level
/// and spring, and a few to the last digit.
const MOST_STEPS: usize = 120;

/// F_y(κ) = F_c·(1 − (1 − h)·e^(−κ/κ_0)), κ the way slid in both directions.
///
/// Isotropic hardening of a slip criterion (Fredriksson, Comput. Struct. 6 (1976)); the
/// exponential is ours. h = 1 leaves the level where it is.
#[derive(Debug, Clone, Copy)]
pub struct SlipHardening<S> {
    coulomb: S,
    lacking: S,
    distance: S,
    hardens: bool,
}

impl<S: Scalar> SlipHardening<S> {
    /// A level that begins at `share` of F_c and approaches F_c over κ_0.
    pub fn new(coulomb: S, share: S, distance: S) -> Self {
        let missing = -(share - 1.0);
        // A gradient by the share is asked for at 1 as well, hence the second condition.
        let hardens = missing.re() != 0.0 || missing.derivative_is_nonzero();
        Self { coulomb, lacking: coulomb * missing, distance, hardens }
    }

    /// The level once this way was slid, and its slope by it.
    #[inline]
    pub fn level(&self, slid: S) -> (S, S) {
        if !self.hardens {
            return (self.coulomb, S::constant(0.0));
        }
        let left = self.lacking * (-(slid / self.distance)).exp();
        (self.coulomb - left, left / self.distance)
    }

    /// How far a slider goes that a spring of this stiffness pulls with `pull` above its level: the
    /// p with F_y(κ + p) = pull − k·p.
    #[inline]
    pub fn slip(&self, slid: S, pull: S, stiffness: S) -> S {
        let (level, rise) = self.level(slid);
        let over = pull - level;
        if !self.hardens {
            return over / stiffness;
        }
        // In w = p/κ_0: R·(1 − e^(−w)) + k·κ_0·w = over, concave, so that Newton's iteration comes
        // from the left and never passes the root.
        let (left, spring) = (rise * self.distance, stiffness * self.distance);
        let (r, k, o) = (left.re(), spring.re(), over.re());
        let mut w = ((o - r) / k).max(0.0);
        for _ in 0..MOST_STEPS {
            let faded = (-w).exp_m1();
            let step = (o + r * faded - k * w) / (r * (1.0 + faded) + k);
            w += step;
            if step.abs() <= 2.0 * f64::EPSILON * w {
                break;
            }
        }
        // A last step that moves the value by round-off and carries the derivatives.
        let faded = (-w).exp_m1();
        let rest = over + left * faded - spring * w;
        let w = S::constant(w) + rest / (left * (1.0 + faded) + spring);
        w * self.distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slip_leaves_spring_and_level_in_balance() {
        for share in [0.05, 0.6, 1.0] {
            for distance in [1e-9, 1e-4, 1.0] {
                let level = SlipHardening::new(0.35, share, distance);
                for pull in [0.36, 0.5, 40.0] {
                    for slid in [0.0, 2e-4] {
                        let p = level.slip(slid, pull, 3000.0);
                        let held = level.level(slid + p).0;
                        assert!((held - (pull - 3000.0 * p)).abs() < 1e-13 * pull, "{p}");
                    }
                }
            }
        }
    }
}
