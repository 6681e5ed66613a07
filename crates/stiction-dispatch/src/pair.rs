//! Two numbers in one vector: what a loop over one trajectory computes of both at once costs little
//! more than of one. Each is rounded as it would be alone.

use std::ops::{Add, Mul, Sub};

/// The number, as one that the compiler puts into no vector. In a chain of results that wait for one
/// another it makes vectors of two whose sums look alike; then the sooner waits for the later.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub fn alone(number: f64) -> f64 {
    let mut number = number;
    // SAFETY: no instruction at all.
    unsafe {
        std::arch::asm!("/* {0} */", inout(xmm_reg) number, options(pure, nomem, nostack, preserves_flags));
    }
    number
}

/// The number.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub fn alone(number: f64) -> f64 {
    number
}

/// Numbers with the operations that an exponential is made of.
pub trait Numbers: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// This number in each place.
    fn all(number: f64) -> Self;
    /// 2^n of the whole number n in the last bits of each.
    fn power_of_two(self) -> Self;
    /// `other` where `x` is below `least`.
    fn unless_below(self, x: Self, least: f64, other: Self) -> Self;
}

impl Numbers for f64 {
    #[inline(always)]
    fn all(number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self::from_bits((self.to_bits() << 52).wrapping_add(1.0_f64.to_bits()))
    }

    #[inline(always)]
    fn unless_below(self, x: Self, least: f64, other: Self) -> Self {
        if x < least { other } else { self }
    }
}

/// Two numbers.
#[derive(Debug, Clone, Copy)]
pub struct Pair(inner::Two);

impl Pair {
    /// These two.
    #[inline(always)]
    pub fn new(first: f64, second: f64) -> Self {
        Self(inner::new(first, second))
    }

    /// Both of them.
    #[inline(always)]
    pub fn split(self) -> (f64, f64) {
        inner::split(self.0)
    }
}

impl Add for Pair {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(inner::add(self.0, other.0))
    }
}

impl Sub for Pair {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(inner::sub(self.0, other.0))
    }
}

impl Mul for Pair {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(inner::mul(self.0, other.0))
    }
}

impl Numbers for Pair {
    #[inline(always)]
    fn all(number: f64) -> Self {
        Self::new(number, number)
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self(inner::power_of_two(self.0))
    }

    #[inline(always)]
    fn unless_below(self, x: Self, least: f64, other: Self) -> Self {
        Self(inner::unless_below(self.0, x.0, Self::all(least).0, other.0))
    }
}

/// SSE2, which every processor of this kind has.
#[cfg(target_arch = "x86_64")]
mod inner {
    use std::arch::x86_64 as arch;

    pub(super) type Two = arch::__m128d;

    #[inline(always)]
    pub(super) fn new(first: f64, second: f64) -> Two {
        // SAFETY: SSE2 is part of x86-64, here and below.
        unsafe { arch::_mm_set_pd(second, first) }
    }

    #[inline(always)]
    pub(super) fn split(two: Two) -> (f64, f64) {
        // SAFETY: as above.
        unsafe { (arch::_mm_cvtsd_f64(two), arch::_mm_cvtsd_f64(arch::_mm_unpackhi_pd(two, two))) }
    }

    #[inline(always)]
    pub(super) fn add(a: Two, b: Two) -> Two {
        // SAFETY: as above.
        unsafe { arch::_mm_add_pd(a, b) }
    }

    #[inline(always)]
    pub(super) fn sub(a: Two, b: Two) -> Two {
        // SAFETY: as above.
        unsafe { arch::_mm_sub_pd(a, b) }
    }

    #[inline(always)]
    pub(super) fn mul(a: Two, b: Two) -> Two {
        // SAFETY: as above.
        unsafe { arch::_mm_mul_pd(a, b) }
    }

    #[inline(always)]
    pub(super) fn power_of_two(two: Two) -> Two {
        // SAFETY: as above.
        unsafe {
            let shifted = arch::_mm_slli_epi64::<52>(arch::_mm_castpd_si128(two));
            let one = arch::_mm_castpd_si128(arch::_mm_set1_pd(1.0));
            arch::_mm_castsi128_pd(arch::_mm_add_epi64(shifted, one))
        }
    }

    #[inline(always)]
    pub(super) fn unless_below(two: Two, x: Two, least: Two, other: Two) -> Two {
        // SAFETY: as above.
        unsafe {
            let below = arch::_mm_cmplt_pd(x, least);
            arch::_mm_or_pd(arch::_mm_and_pd(below, other), arch::_mm_andnot_pd(below, two))
        }
    }
}

/// One by one.
#[cfg(not(target_arch = "x86_64"))]
mod inner {
    use super::Numbers;

    pub(super) type Two = [f64; 2];

    #[inline(always)]
    pub(super) fn new(first: f64, second: f64) -> Two {
        [first, second]
    }

    #[inline(always)]
    pub(super) fn split([first, second]: Two) -> (f64, f64) {
        (first, second)
    }

    #[inline(always)]
    pub(super) fn add(a: Two, b: Two) -> Two {
        [a[0] + b[0], a[1] + b[1]]
    }

    #[inline(always)]
    pub(super) fn sub(a: Two, b: Two) -> Two {
        [a[0] - b[0], a[1] - b[1]]
    }

    #[inline(always)]
    pub(super) fn mul(a: Two, b: Two) -> Two {
        [a[0] * b[0], a[1] * b[1]]
    }

    #[inline(always)]
    pub(super) fn power_of_two(two: Two) -> Two {
        two.map(Numbers::power_of_two)
    }

    #[inline(always)]
    pub(super) fn unless_below(two: Two, x: Two, least: Two, other: Two) -> Two {
        [0, 1].map(|k| two[k].unless_below(x[k], least[k], other[k]))
    }
}
