//! The fall of friction with speed that several laws share.

use crate::scalar::Scalar;

/// e^(−|v/v_s|^δ) and its slope by speed |v|; the slope is taken as 0 at v = 0, where it is not
/// defined for δ ≤ 1.
///
/// Source: Bo, Pavelescu, Wear 82 (1982).
#[inline]
pub fn fall<S: Scalar>(velocity: S, stribeck_velocity: S, exponent: S) -> (S, S) {
    let power = (velocity * (S::constant(1.0) / stribeck_velocity)).power_of_magnitude(exponent);
    let left = (-power).exp();
    if velocity.re() == 0.0 {
        return (left, S::constant(0.0));
    }
    (left, -(left * exponent * power / velocity.abs()))
}

/// About the steepest fall by speed of `excess` times that: sets how far a step may reach.
pub fn steepest(excess: f64, stribeck_velocity: f64, exponent: f64) -> f64 {
    excess / stribeck_velocity * exponent.max(1.0)
}
