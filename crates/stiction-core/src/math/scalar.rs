//! The number type every model is written over: `f64` for values, [`Dual`] for values with exact
//! derivatives.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use stiction_dispatch::{Task, alone};

pub use crate::math::dual::{COLUMNS, Dual};
use crate::math::logarithm::logarithm;
use crate::math::trig::sin_cos;

/// A real number or a dual number; branches are decided on the real part alone.
pub trait Scalar:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// Whether it carries derivatives: a loop over such numbers keeps none of them in registers.
    const CARRIES: bool;

    /// A number that depends on no parameter.
    fn constant(value: f64) -> Self;
    /// The parameter that owns derivative column `column`.
    fn variable(value: f64, column: usize) -> Self;
    /// The value without its derivatives.
    fn re(self) -> f64;
    /// The derivative in column `column` (0 for `f64`).
    fn partial(self, column: usize) -> f64;
    /// Chain rule: a function of `self` with the given value and slope.
    fn chain(self, value: f64, slope: f64) -> Self;
    /// The same derivatives with this value: the same quantity, summed in another order.
    fn with_value(self, value: f64) -> Self;
    /// Changes the value alone, where the number is: rows of derivatives are not carried to and fro.
    fn put(&mut self, value: f64);

    /// The number, as one that is in no vector of values, see [`alone`].
    fn alone(self) -> Self;

    /// e^x.
    #[inline(always)]
    fn exp(self) -> Self {
        let e = self.re().exp();
        self.chain(e, e)
    }
    /// e^x − 1, accurate near 0.
    #[inline(always)]
    fn exp_m1(self) -> Self {
        let e = self.re().exp_m1();
        self.chain(e, e + 1.0)
    }
    /// Natural logarithm of a positive number.
    #[inline(always)]
    fn ln(self) -> Self {
        let x = self.re();
        self.chain(x.ln(), 1.0 / x)
    }
    /// Sine.
    #[inline(always)]
    fn sin(self) -> Self {
        let (s, c) = sin_cos(self.re());
        self.chain(s, c)
    }
    /// Cosine.
    #[inline(always)]
    fn cos(self) -> Self {
        let (s, c) = sin_cos(self.re());
        self.chain(c, -s)
    }
    /// Sine and cosine, for the price of one.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = sin_cos(self.re());
        (self.chain(s, c), self.chain(c, -s))
    }
    /// √x with derivative 0 at 0, where the true one is infinite and would turn into NaN.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let r = self.re().sqrt();
        self.chain(r, if r > 0.0 { 0.5 / r } else { 0.0 })
    }
    /// |x| with derivative 0 at the kink.
    #[inline(always)]
    fn abs(self) -> Self {
        let x = self.re();
        let slope = if x > 0.0 {
            1.0
        } else if x < 0.0 {
            -1.0
        } else {
            0.0
        };
        self.chain(x.abs(), slope)
    }
    /// |x|^a for a > 0, with all derivatives 0 at x = 0 (dual libraries give NaN there).
    #[inline(always)]
    fn power_of_magnitude(self, exponent: Self) -> Self {
        let (x, a) = (self.re(), exponent.re());
        let m = x.abs();
        if m == 0.0 {
            return Self::constant(0.0);
        }
        let (value, slope) = if a == 2.0 {
            (m * m, 2.0 * x)
        } else if a == 1.0 {
            (m, x.signum())
        } else {
            let value = any_power(m, a);
            (value, a * value / x)
        };
        let in_base = self.chain(value, slope);
        if exponent.derivative_is_nonzero() {
            in_base + (exponent - a) * (value * logarithm(m))
        } else {
            // A logarithm costs more than all the rest, and most exponents are not seeded.
            in_base
        }
    }
    /// True when the number depends on a seeded parameter.
    #[inline(always)]
    fn derivative_is_nonzero(self) -> bool {
        (0..COLUMNS).any(|k| self.partial(k) != 0.0)
    }
    /// True when the value and every derivative are finite.
    fn is_finite(self) -> bool {
        self.re().is_finite() && (0..COLUMNS).all(|k| self.partial(k).is_finite())
    }
    /// Runs a loop over such numbers, with the widest vectors that the processor has where they carry
    /// rows of derivatives. What is not part of the loop, but called by it, gets none of that.
    fn run<T: Task>(task: T) -> T::Output;
}

/// Runs a task as a function of its own, in which nothing else asks for registers.
#[inline(never)]
fn apart<T: Task>(task: T) -> T::Output {
    task.run()
}

impl Scalar for f64 {
    const CARRIES: bool = false;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn variable(value: f64, _column: usize) -> Self {
        value
    }
    #[inline(always)]
    fn re(self) -> f64 {
        self
    }
    #[inline(always)]
    fn partial(self, _column: usize) -> f64 {
        0.0
    }
    #[inline(always)]
    fn chain(self, value: f64, _slope: f64) -> Self {
        value
    }
    #[inline(always)]
    fn with_value(self, value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn put(&mut self, value: f64) {
        *self = value;
    }
    #[inline(always)]
    fn alone(self) -> Self {
        alone(self)
    }
    #[inline(always)]
    fn run<T: Task>(task: T) -> T::Output {
        apart(task)
    }
    #[inline(always)]
    fn power_of_magnitude(self, exponent: Self) -> Self {
        let m = f64::abs(self);
        if exponent == 2.0 {
            m * m
        } else if exponent == 1.0 || m == 0.0 {
            m
        } else {
            any_power(m, exponent)
        }
    }
}

/// m^a for m > 0. A half is a root, and so much sooner there than by the library; each of these is good to
/// one unit in the last place.
#[inline(always)]
fn any_power(m: f64, exponent: f64) -> f64 {
    if exponent == 1.5 {
        m * m.sqrt()
    } else if exponent == 0.5 {
        m.sqrt()
    } else {
        power_of_the_library(m, exponent)
    }
}

/// A power as the library has it. Cold, although some laws have nothing else: around a call all that a
/// loop has in registers goes to memory, and that is to be done where the call is.
#[cold]
#[inline(never)]
fn power_of_the_library(m: f64, exponent: f64) -> f64 {
    m.powf(exponent)
}

/// −ln(1 − u)/u for u < 1; 1 at u = 0.
#[inline(always)]
pub fn logarithmic_mean<S: Scalar>(u: S) -> S {
    let x = u.re();
    if x.abs() < 1e-3 {
        // The next term is below 2e-19 here.
        let value = 1.0 + x * (0.5 + x * (1.0 / 3.0 + x * (0.25 + x * (0.2 + x / 6.0))));
        let slope = 0.5 + x * (2.0 / 3.0 + x * (0.75 + x * (0.8 + x * (5.0 / 6.0))));
        return u.chain(value, slope);
    }
    let value = -(-x).ln_1p() / x;
    u.chain(value, (1.0 / (1.0 - x) - value) / x)
}

/// Below this [`gone_share`] and the short way along a branch of a spring hold.
pub const SHORT: f64 = 0.02;

/// Below this [`second_share`] holds.
pub const SHORTER: f64 = 0.01;

/// φ₂(z) = ½ − z/6 + z²/24 − … over 0 … [`SHORT`]: the polynomial of degree 3 that has its values at the
/// nodes of Chebyshev, off by 1.8e-12 at most. What it is for is z times as large.
pub const SECOND: [f64; 4] = [
    0.499_999_999_998_275,
    -0.166_666_663_905_568_75,
    0.041_665_975_929_706_4,
    -0.008_278_000_311_740_141,
];

/// The same over 0 … [`SHORTER`], off by 1.1e-13 at most.
pub const SECOND_BELOW: [f64; 4] = [
    0.499_999_999_999_891_86,
    -0.166_666_666_320_488_85,
    0.041_666_493_519_787_12,
    -0.008_305_611_273_979_163,
];

/// (1 − e^(−z))/z for 0 ≤ z < [`SHORT`], to 4e-14 of it; 1 at z = 0.
#[inline(always)]
pub fn gone_share<S: Scalar>(z: S) -> S {
    let x = z.re();
    let slope = in_pairs(
        x,
        [-1.0 / 2.0, 1.0 / 3.0, -1.0 / 8.0, 1.0 / 30.0, -1.0 / 144.0, 1.0 / 840.0, -1.0 / 5760.0],
    );
    z.chain(1.0 - x * cubic(x, SECOND), slope)
}

/// (1 − (1 − e^(−z))/z)/z for 0 ≤ z < [`SHORTER`], to 3e-13 of it; ½ at z = 0.
#[inline(always)]
pub fn second_share<S: Scalar>(z: S) -> S {
    let x = z.re();
    let slope = in_pairs(
        x,
        [
            -1.0 / 6.0,
            1.0 / 12.0,
            -1.0 / 40.0,
            1.0 / 180.0,
            -1.0 / 1008.0,
            1.0 / 6720.0,
            -1.0 / 51840.0,
        ],
    );
    z.chain(cubic(x, SECOND_BELOW), slope)
}

#[inline(always)]
fn cubic(x: f64, c: [f64; 4]) -> f64 {
    (c[0] + c[1] * x) + (x * x) * (c[2] + c[3] * x)
}

/// c₀ + c₁·x + … + c₆·x⁶.
#[inline(always)]
fn in_pairs(x: f64, c: [f64; 7]) -> f64 {
    let square = x * x;
    let low = (c[0] + c[1] * x) + square * (c[2] + c[3] * x);
    let high = (c[4] + c[5] * x) + square * c[6];
    low + (square * square) * high
}

/// The sign of a real number as −1, 0 or 1.
#[inline(always)]
pub fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_finite_at_exact_zeros() {
        let zero = Dual::variable(0.0, 0);
        for exponent in [1.0, 1.5, 2.0, 3.0] {
            assert!(zero.power_of_magnitude(Dual::variable(exponent, 1)).is_finite());
        }
        assert!(zero.sqrt().is_finite() && zero.abs().is_finite());
    }

    #[test]
    fn power_of_magnitude_differentiates_base_and_exponent() {
        for (x, a) in [(0.3, 2.0), (-0.7, 2.0), (1.9, 1.0), (-2.5, 1.4), (0.02, 3.3)] {
            let y = Dual::variable(x, 0).power_of_magnitude(Dual::variable(a, 1));
            let f = |x: f64, a: f64| x.abs().powf(a);
            let step = 1e-6;
            let in_base = (f(x + step, a) - f(x - step, a)) / (2.0 * step);
            let in_exponent = (f(x, a + step) - f(x, a - step)) / (2.0 * step);
            assert!((y.partial(0) - in_base).abs() < 1e-7 * (1.0 + in_base.abs()));
            assert!((y.partial(1) - in_exponent).abs() < 1e-7 * (1.0 + in_exponent.abs()));
            assert!((y.re() - Scalar::power_of_magnitude(x, a)).abs() <= f64::EPSILON);
        }
    }

    #[test]
    fn short_series_agree_with_the_library() {
        for k in 1..2000 {
            let z = SHORT * f64::from(k) / 2000.0;
            let gone = -(-z).exp_m1() / z;
            let second = (1.0 - gone) / z;
            assert!((gone_share(z) - gone).abs() <= 4e-14, "{z}");
            if z < SHORTER {
                // The difference from 1 loses digits, which the polynomial does not.
                assert!((second_share(z) - second).abs() <= 1.2e-13 + 2.3e-16 / z, "{z}");
            }
            let (a, b) = (gone_share(Dual::variable(z, 0)), second_share(Dual::variable(z, 0)));
            assert!((a.partial(0) - ((-z).exp() - gone) / z).abs() <= 4e-16 / z);
            assert!((b.partial(0) + (second - (gone - (-z).exp()) / z) / z).abs() <= 1e-15 / z / z);
        }
    }

    #[test]
    fn functions_agree_with_central_differences() {
        type Pair = (fn(Dual) -> Dual, fn(f64) -> f64);
        let functions: [Pair; 6] = [
            (|x| Scalar::exp(x), f64::exp),
            (|x| Scalar::exp_m1(x), f64::exp_m1),
            (|x| Scalar::ln(x), f64::ln),
            (|x| Scalar::sin(x), f64::sin),
            (|x| Scalar::cos(x), f64::cos),
            (|x| Scalar::sqrt(x), f64::sqrt),
        ];
        for (dual, real) in functions {
            let y = dual(Dual::variable(0.8, 3));
            let slope = (real(0.8 + 1e-6) - real(0.8 - 1e-6)) / 2e-6;
            assert_eq!(y.re(), real(0.8));
            assert!((y.partial(3) - slope).abs() < 1e-8);
        }
    }
}
