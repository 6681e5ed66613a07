//! Forces at the start that a contact can hold.

use crate::math::scalar::Scalar;

/// Shares of the greatest force by which a start stays below it: where it begins to level off, and
/// what it approaches. At the greatest force itself a curve may have no slope and no place.
const LEVELLING: (f64, f64) = (0.02, 0.001);

/// A force that a contact can hold: itself up to 98 % of the greatest one, beyond that levelling
/// off with a slope that is continuous and never 0, so that a fit finds its way back.
pub fn reachable<S: Scalar>(force: S, greatest: S) -> S {
    let (begin, end) = LEVELLING;
    let s = if force.re() < 0.0 { -1.0 } else { 1.0 };
    if force.re().abs() <= greatest.re() * (1.0 - begin) {
        return force;
    }
    let beyond = force * s / greatest - (1.0 - begin);
    let width = begin - end;
    let short = S::constant(width) / (beyond / width + 1.0) + end;
    greatest * (-(short - 1.0)) * s
}
