//! Dual numbers: a value with its derivatives by a row of parameters.
//!
//! The row is a plain array of fixed length, and each operation a loop over it without a choice: the
//! compiler makes vectors of it, as wide as the processor has where the loop that uses the numbers
//! is a [`Task`]. Products and sums are rounded one by one at every width, so that results are the
//! same to the bit on every processor and for every set of columns.

use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Neg, Sub, SubAssign};

use stiction_dispatch::{Task, Width, alone};

use crate::math::scalar::Scalar;

/// Derivative columns carried by one [`Dual`]: one pass of the model yields this many.
pub const COLUMNS: usize = 8;

/// A value with its derivatives with respect to [`COLUMNS`] seeded parameters.
///
/// The value does not lie beside the row: the compiler would read both as one vector, which has to
/// wait until what was written in two parts is in the cache.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Dual {
    re: f64,
    slopes: Row,
}

/// Derivatives, as vectors lie in memory.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Row([f64; COLUMNS]);

impl Index<usize> for Row {
    type Output = f64;
    #[inline(always)]
    fn index(&self, column: usize) -> &f64 {
        &self.0[column]
    }
}

impl Dual {
    /// A value whose derivatives are found one by one.
    #[inline(always)]
    fn new(re: f64, slope: impl Fn(usize) -> f64) -> Self {
        let mut slopes = [0.0; COLUMNS];
        for (column, place) in slopes.iter_mut().enumerate() {
            *place = slope(column);
        }
        // Among vectors that the compiler makes of values, rows would come apart.
        Self { re: alone(re), slopes: Row(slopes) }
    }

    /// All derivatives.
    #[inline(always)]
    pub fn slopes(&self) -> &[f64; COLUMNS] {
        &self.slopes.0
    }
}

impl Add for Dual {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, |k| self.slopes[k] + other.slopes[k])
    }
}

impl Sub for Dual {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, |k| self.slopes[k] - other.slopes[k])
    }
}

#[allow(clippy::suspicious_arithmetic_impl)] // the derivative of a product is a sum
impl Mul for Dual {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.re, other.re);
        Self::new(a * b, |k| self.slopes[k] * b + other.slopes[k] * a)
    }
}

impl Div for Dual {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.re / other.re;
        let share = 1.0 / other.re;
        Self::new(value, |k| (self.slopes[k] - other.slopes[k] * value) * share)
    }
}

impl Neg for Dual {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, |k| -self.slopes[k])
    }
}

impl Add<f64> for Dual {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        self.with_value(self.re + other)
    }
}

impl Sub<f64> for Dual {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        self.with_value(self.re - other)
    }
}

impl Mul<f64> for Dual {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Self::new(self.re * other, |k| self.slopes[k] * other)
    }
}

impl Div<f64> for Dual {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: f64) -> Self {
        let share = 1.0 / other;
        Self::new(self.re / other, |k| self.slopes[k] * share)
    }
}

impl AddAssign for Dual {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Dual {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Dual {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Scalar for Dual {
    const CARRIES: bool = true;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { re: value, slopes: Row([0.0; COLUMNS]) }
    }
    #[inline(always)]
    fn variable(value: f64, column: usize) -> Self {
        let mut own = Self::constant(value);
        own.slopes.0[column] = 1.0;
        own
    }
    #[inline(always)]
    fn re(self) -> f64 {
        self.re
    }
    #[inline(always)]
    fn partial(self, column: usize) -> f64 {
        self.slopes[column]
    }
    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self::new(value, |k| self.slopes[k] * slope)
    }
    #[inline(always)]
    fn with_value(self, value: f64) -> Self {
        Self::new(value, |k| self.slopes[k])
    }
    #[inline(always)]
    fn put(&mut self, value: f64) {
        self.re = alone(value);
    }
    #[inline(always)]
    fn alone(self) -> Self {
        self // every value is
    }
    #[inline(always)]
    fn derivative_is_nonzero(self) -> bool {
        self.slopes.0.iter().fold(false, |any, slope| any | (*slope != 0.0))
    }
    #[inline(always)]
    fn run<T: Task>(task: T) -> T::Output {
        Width::widest().run(task)
    }
}
