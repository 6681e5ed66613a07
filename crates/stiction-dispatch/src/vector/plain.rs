//! Two numbers, for the compiler to make a vector of.

use std::ops::Div;

use super::{CHUNKS, Mask, ROW, Vector};
use crate::pair::Numbers;

/// Two numbers.
#[derive(Debug, Clone, Copy)]
pub struct Two([f64; 2]);

macro_rules! each {
    ($name:ident, $a:ident, $b:ident, $it:expr) => {
        #[inline(always)]
        unsafe fn $name(one: [f64; 2], other: [f64; 2]) -> [f64; 2] {
            let by = |$a: f64, $b: f64| -> f64 { $it };
            [by(one[0], other[0]), by(one[1], other[1])]
        }
    };
}

each!(add, a, b, a + b);
each!(sub, a, b, a - b);
each!(mul, a, b, a * b);
each!(div, a, b, a / b);
operations!(Two, add, sub, mul, div);

impl Numbers for Two {
    #[inline(always)]
    fn all(number: f64) -> Self {
        Self([number; 2])
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self([self.0[0].power_of_two(), self.0[1].power_of_two()])
    }

    #[inline(always)]
    fn unless_below(self, x: Self, least: f64, other: Self) -> Self {
        self.or(x.below(Self::all(least)), other)
    }
}

impl Vector for Two {
    type Mask = [bool; 2];
    const LANES: usize = 2;

    #[inline(always)]
    fn load(row: &[f64; ROW], chunk: usize) -> Self {
        Self([row[2 * chunk], row[2 * chunk + 1]])
    }

    #[inline(always)]
    fn store(self, row: &mut [f64; ROW], chunk: usize) {
        [row[2 * chunk], row[2 * chunk + 1]] = self.0;
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self([self.0[0].abs(), self.0[1].abs()])
    }

    #[inline(always)]
    fn flipped(self, by: Self) -> Self {
        let flipped =
            |x: f64, by: f64| f64::from_bits(x.to_bits() ^ (by.to_bits() & (-0.0_f64).to_bits()));
        Self([flipped(self.0[0], by.0[0]), flipped(self.0[1], by.0[1])])
    }

    #[inline(always)]
    fn below(self, other: Self) -> [bool; 2] {
        [self.0[0] < other.0[0], self.0[1] < other.0[1]]
    }

    #[inline(always)]
    fn within(self, other: Self) -> [bool; 2] {
        [self.0[0] <= other.0[0], self.0[1] <= other.0[1]]
    }

    #[inline(always)]
    fn kept(self, mask: [bool; 2]) -> Self {
        Self::all(0.0).or(mask, self)
    }

    #[inline(always)]
    fn or(self, mask: [bool; 2], other: Self) -> Self {
        let or = |mask: bool, old: f64, new: f64| {
            let mask = u64::from(mask).wrapping_neg();
            f64::from_bits((new.to_bits() & mask) | (old.to_bits() & !mask))
        };
        Self([or(mask[0], self.0[0], other.0[0]), or(mask[1], self.0[1], other.0[1])])
    }

    #[inline(always)]
    fn at_least(self, other: Self) -> Self {
        self.or(self.below(other), other)
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> Self {
        self.or(other.below(self), other)
    }

    #[inline(always)]
    fn across(rows: [&[f64; ROW]; ROW]) -> [[Self; CHUNKS]; ROW] {
        let mut found = [[Self::default(); CHUNKS]; ROW];
        for (k, found) in found.iter_mut().enumerate() {
            for (chunk, found) in found.iter_mut().enumerate() {
                *found = Self([rows[2 * chunk][k], rows[2 * chunk + 1][k]]);
            }
        }
        found
    }
}

impl Mask for [bool; 2] {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        [self[0] & other[0], self[1] & other[1]]
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        [self[0] | other[0], self[1] | other[1]]
    }

    #[inline(always)]
    fn but(self, other: Self) -> Self {
        [self[0] & !other[0], self[1] & !other[1]]
    }

    #[inline(always)]
    fn not(self) -> Self {
        [!self[0], !self[1]]
    }

    #[inline(always)]
    fn same(self, other: Self) -> Self {
        [self[0] == other[0], self[1] == other[1]]
    }

    #[inline(always)]
    fn bits(self) -> u8 {
        u8::from(self[0]) | u8::from(self[1]) << 1
    }

    #[inline(always)]
    fn of(bits: u8) -> Self {
        [bits & 1 != 0, bits & 2 != 0]
    }
}
