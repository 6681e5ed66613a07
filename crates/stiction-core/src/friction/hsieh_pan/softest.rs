//! How soft the spring of a contact can be.

use crate::friction::elements::loading::{Curve, Loading};
use crate::math::scalar::Scalar;

/// Of a stiffness, more than is lost where another one is taken off it.
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;
/// What is sure of a slope, and of how it falls.
const SLACK: f64 = 1.0 - 1e-9;

/// What the slope of the virgin curve is at least, without asking where it has a force: over the force
/// it falls ever less, so that it stays above its tangent at the level of break-away.
#[derive(Debug, Clone, Copy)]
pub(super) struct Softest {
    level: f64,
    /// Just under the slope at that level; k_inf where nothing breaks away.
    pub(super) slope: f64,
    /// By how much it rises for each unit of force below.
    easing: f64,
}

impl Softest {
    /// Of a curve, where its hook breaks away at this level.
    pub(super) fn of<S: Scalar>(curve: &Curve<S>, level: f64) -> Self {
        let [last, _, distance] = curve.numbers();
        if !level.is_finite() {
            return Self { level: 0.0, slope: last, easing: 0.0 };
        }
        let at = curve.virgin(curve.virgin_inverse(S::constant(level))).slope.re();
        let twice = if curve.closes_at_mirror() { 2.0 } else { 1.0 };
        // What is left above k_inf may be round-off of k_0, from which it is taken.
        let left = at - last - ROUND_OFF * curve.initial_stiffness().re();
        let easing = if left > 0.0 { twice * left / (distance * at) } else { 0.0 };
        Self { level, slope: (at * SLACK).max(last), easing: easing * SLACK }
    }

    /// Up to a force of this size, which no level of break-away is below.
    pub(super) fn up_to(&self, force: f64) -> f64 {
        self.slope + self.easing * (self.level - force)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::elements::loading::VirginCurve;

    #[test]
    fn no_slope_up_to_a_force_is_below_what_is_said_of_it() {
        for virgin in [VirginCurve::Masing, VirginCurve::Same] {
            for (last, distance, level) in
                [(800.0, 2.9e-4, 0.5), (0.0, 2e-4, 0.25), (2999.0, 1e-3, 7.0), (1e-3, 1e-5, 40.0)]
            {
                let curve = Curve::new(3000.0, last, distance, virgin);
                let softest = Softest::of(&curve, level);
                for share in 0..=100 {
                    let force = level * f64::from(share) / 100.0;
                    let slope = curve.virgin(curve.virgin_inverse(force)).slope;
                    let said = softest.up_to(force);
                    assert!(said <= slope, "{said} {slope} at {force} of {level}");
                    assert!(said >= last && (share < 100 || said >= slope * (1.0 - 1e-8)));
                    // Not so far below that it would answer nothing.
                    assert!(share < 50 || (last, level) != (800.0, 0.5) || said >= 0.7 * slope);
                }
            }
        }
    }
}
