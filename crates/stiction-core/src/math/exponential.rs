//! e^x for x ≤ 0 without a choice or a call, so that loops over many numbers become vectors of them
//! and the same numbers come out on every machine.
//!
//! x = n·ln 2 + r, |r| ≤ ln(2)/2: 2^n times 1 + r + r²·Q(r), Q being the polynomial of degree 9 that
//! interpolates (e^r − 1 − r)/r² at the nodes of Chebyshev, which is off by 1.1e-16 at most. It is
//! summed in pairs, and so that what takes longest, Q, comes in last.

use stiction_dispatch::{Numbers, Pair, alone};

use crate::math::scalar::Scalar;

/// Below this e^x is taken as 0; it would be under 4e-308.
const LEAST: f64 = -708.0;
/// 1.5·2⁵²: what is added to it is rounded to a whole number, which stands in its last bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// ln 2 in two parts, the first so short that its products with n are exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// Coefficients of Q.
const Q: [f64; 10] = [
    0.500_000_000_000_000_1,
    0.166_666_666_666_666_7,
    0.041_666_666_666_624_12,
    0.008_333_333_333_326_134,
    0.001_388_888_891_721_558_6,
    0.000_198_412_698_748_223_07,
    2.480_152_129_346_386_2e-5,
    2.755_725_539_833_871e-6,
    2.762_008_948_195_459e-7,
    2.510_521_769_568_451_6e-8,
];

/// 2^n, 2^n·r and 2^n·r²·Q for x = n·ln 2 + r, [`LEAST`] ≤ x ≤ 0, each times `sign`; `kept` may keep
/// the compiler from vectors of its own.
#[inline(always)]
fn parts<N: Numbers>(x: N, sign: N, kept: impl Fn(N) -> N) -> (N, N, N) {
    let q = |k: usize| N::all(Q[k]);
    let rounded = x * N::all(std::f64::consts::LOG2_E) + N::all(ROUNDER);
    let n = rounded - N::all(ROUNDER);
    let r = (x - n * N::all(LN_2[0])) - n * N::all(LN_2[1]);
    let scale = rounded.power_of_two() * sign;
    let square = r * r;
    let fourth = square * square;
    let low = (q(0) + r * q(1)) + kept(square * (q(2) + r * q(3)));
    let middle = kept((q(4) + r * q(5)) + kept(square * (q(6) + r * q(7))));
    let high = kept((fourth * fourth) * (q(8) + r * q(9)));
    (scale, scale * r, (scale * square) * ((low + high) + fourth * middle))
}

/// e^x for x ≤ 0, to 1.5 units in the last place.
#[inline(always)]
pub fn fading<N: Numbers>(x: N) -> N {
    let (scale, first, rest) = parts(x, N::all(1.0), |sum| sum);
    ((scale + first) + rest).unless_below(x, LEAST, N::all(0.0))
}

/// 1 − e^x for x ≤ 0, to 2 units in the last place.
#[inline(always)]
pub fn faded<N: Numbers>(x: N) -> N {
    let (scale, first, rest) = parts(x, N::all(1.0), |sum| sum);
    (((N::all(1.0) - scale) - first) - rest).unless_below(x, LEAST, N::all(1.0))
}

/// [`fading`] of the first and [`faded`] of the second, to the bit, for little more than one of them.
#[inline(always)]
fn fading_and_faded(first: f64, second: f64) -> (f64, f64) {
    let (x, whole) = (Pair::new(first, second), Pair::new(0.0, 1.0));
    let (scale, once, rest) = parts(x, Pair::new(1.0, -1.0), |sum| sum);
    (((whole + scale) + once) + rest).unless_below(x, LEAST, whole).split()
}

/// [`fading`], to the bit.
#[inline(always)]
fn fading_one(x: f64) -> f64 {
    if x < LEAST {
        // A branch for certain, which a processor foresees: a choice made without one is waited for.
        return alone(0.0);
    }
    let (scale, first, rest) = parts(x, 1.0, alone);
    (scale + first) + rest
}

/// [`faded`], to the bit.
#[inline(always)]
fn faded_one(x: f64) -> f64 {
    if x < LEAST {
        return alone(1.0);
    }
    let (scale, first, rest) = parts(x, 1.0, alone);
    ((1.0 - scale) - first) - rest
}

// A loop that takes more than a few of these in has no registers left for what runs in it.
#[inline(never)]
fn fading_apart(x: f64) -> f64 {
    fading_one(x)
}

#[inline(never)]
fn faded_apart(x: f64) -> f64 {
    faded_one(x)
}

/// [`fading`] of any number type.
#[inline(always)]
pub fn fading_of<S: Scalar>(x: S) -> S {
    let value = fading_apart(x.re());
    x.chain(value, value)
}

/// [`faded`] of any number type.
#[inline(always)]
pub fn faded_of<S: Scalar>(x: S) -> S {
    let value = faded_apart(x.re());
    x.chain(value, value - 1.0)
}

/// 1 − e^(−x): what has come about after x times its scale; by the library before it begins, x < 0.
#[inline]
pub fn come_about<S: Scalar>(x: S) -> S {
    if x.re() < 0.0 { -(-x).exp_m1() } else { faded_of(-x) }
}

/// [`fading_of`], as part of the loop that asks for it where it is one of plain numbers.
#[inline(always)]
pub fn fading_within<S: Scalar>(x: S) -> S {
    if S::CARRIES {
        return fading_of(x);
    }
    let value = fading_one(x.re());
    x.chain(value, value)
}

/// [`faded_of`] likewise.
#[inline(always)]
pub fn faded_within<S: Scalar>(x: S) -> S {
    if S::CARRIES {
        return faded_of(x);
    }
    let value = faded_one(x.re());
    x.chain(value, value - 1.0)
}

/// [`fading_of`] the first two and [`faded_of`] the third, as part of the loop that asks for them.
#[inline(always)]
pub fn fading_twice_and_faded_of<S: Scalar>(one: S, other: S, third: S) -> [S; 3] {
    let (other_left, gone) = fading_and_faded(other.re(), third.re());
    let left = fading_one(one.re());
    [one.chain(left, left), other.chain(other_left, other_left), third.chain(gone, gone - 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::Dual;

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
    fn every_way_to_the_same_number_has_its_bits() {
        for k in 0..40_000 {
            let x = -1e-9 * 1.001_f64.powi(k);
            assert_eq!((fading_one(x), faded_one(x)), (fading(x), faded(x)), "{x}");
            for y in [-0.0, 0.3 * x, -3.0, -1e9] {
                assert_eq!(fading_and_faded(x, y), (fading(x), faded(y)), "{x} {y}");
                assert_eq!(fading_and_faded(y, x), (fading(y), faded(x)), "{x} {y}");
            }
        }
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
