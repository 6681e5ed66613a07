//! e^x for x ≤ 0 without a choice or a call, so that loops over many numbers become vectors of them
//! and the same numbers come out on every machine.
//!
//! x = n·ln 2 + r, |r| ≤ ln(2)/2: 2^n times the series of e^r − 1 to r¹³, summed in pairs.

use crate::scalar::Scalar;

/// Below this e^x is taken as 0; it would be under 4e-308.
const LEAST: f64 = -708.0;
/// 1.5·2⁵²: what is added to it is rounded to a whole number, which stands in its last bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// ln 2 in two parts, the first so short that its products with n are exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// 2^n and e^r − 1 for x = n·ln 2 + r, [`LEAST`] ≤ x ≤ 0.
#[inline(always)]
fn parts(x: f64) -> (f64, f64) {
    let rounded = x * std::f64::consts::LOG2_E + ROUNDER;
    let n = rounded - ROUNDER;
    let r = (x - n * LN_2[0]) - n * LN_2[1];
    let scale = f64::from_bits((rounded.to_bits() << 52).wrapping_add(1.0_f64.to_bits()));
    let square = r * r;
    let fourth = square * square;
    let low = (1.0 / 2.0 + r * (1.0 / 6.0)) + square * (1.0 / 24.0 + r * (1.0 / 120.0));
    let middle =
        (1.0 / 720.0 + r * (1.0 / 5_040.0)) + square * (1.0 / 40_320.0 + r * (1.0 / 362_880.0));
    let high = (1.0 / 3_628_800.0 + r * (1.0 / 39_916_800.0))
        + square * (1.0 / 479_001_600.0 + r * (1.0 / 6_227_020_800.0));
    (scale, r + square * ((low + fourth * middle) + (fourth * fourth) * high))
}

/// e^x for x ≤ 0, to 1.5 units in the last place.
#[inline(always)]
pub fn fading(x: f64) -> f64 {
    let (scale, above) = parts(x);
    if x < LEAST { 0.0 } else { scale + scale * above }
}

/// 1 − e^x for x ≤ 0, to 2 units in the last place.
#[inline(always)]
pub fn faded(x: f64) -> f64 {
    let (scale, above) = parts(x);
    if x < LEAST { 1.0 } else { (1.0 - scale) - scale * above }
}

// A loop over one trajectory that takes these in has no registers left for what runs in it.
#[inline(never)]
fn fading_apart(x: f64) -> f64 {
    fading(x)
}

#[inline(never)]
fn faded_apart(x: f64) -> f64 {
    faded(x)
}

/// [`fading`] of any number type.
#[inline]
pub fn fading_of<S: Scalar>(x: S) -> S {
    let value = fading_apart(x.re());
    x.chain(value, value)
}

/// [`faded`] of any number type.
#[inline]
pub fn faded_of<S: Scalar>(x: S) -> S {
    let value = faded_apart(x.re());
    x.chain(value, value - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    #[test]
    fn it_agrees_with_the_library_from_the_smallest_numbers_to_nothing() {
        let (mut worst, mut worst_gone) = (0.0_f64, 0.0_f64);
        for k in 0..400_000 {
            let x =
                -(1e-12 * (1.0 + 1e-4 * f64::from(k % 10_000)) * 2.0_f64.powi(k / 8000)).min(700.0);
            worst = worst.max((fading(x) / x.exp() - 1.0).abs());
            worst_gone = worst_gone.max((faded(x) / -x.exp_m1() - 1.0).abs());
        }
        assert!(worst < 3.4e-16, "{worst}");
        assert!(worst_gone < 4.5e-16, "{worst_gone}");
    }

    #[test]
    fn ends_are_exact() {
        for zero in [0.0, -0.0] {
            assert_eq!((fading(zero), faded(zero)), (1.0, 0.0));
        }
        for far in [-709.0, -1e300, f64::NEG_INFINITY] {
            assert_eq!((fading(far), faded(far)), (0.0, 1.0));
        }
        assert!(fading(f64::NAN).is_nan() && faded(f64::NAN).is_nan());
        let x = Dual::variable(-0.7, 1);
        assert_eq!(fading_of(x).partial(1), fading(-0.7));
        assert!((faded_of(x).partial(1) + fading(-0.7)).abs() < 1e-16);
    }
}
