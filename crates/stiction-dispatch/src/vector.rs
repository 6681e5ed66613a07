//! Numbers in a vector of the processor that a [`Wide`](crate::Wide) loop is compiled for: for loops
//! that the compiler makes vectors of by way of memory only. Each number is rounded as it would be
//! alone.

use std::ops::Div;

use crate::pair::Numbers;

/// Numbers of a row: a whole number of vectors of each kind.
pub const ROW: usize = 8;
/// Vectors that make a row at most.
pub const CHUNKS: usize = 4;

/// A vector of numbers. [`Width`](crate::Width) hands a loop those that the processor has, and nobody
/// else can name them.
pub trait Vector: Numbers + Div<Output = Self> + Default {
    /// For each number whether something holds.
    type Mask: Mask;
    /// How many numbers.
    const LANES: usize;
    /// How many vectors make a row.
    const CHUNKS: usize = ROW / Self::LANES;

    /// A vector of a row, counted from 0.
    fn load(row: &[f64; ROW], chunk: usize) -> Self;
    /// Puts it there.
    fn store(self, row: &mut [f64; ROW], chunk: usize);
    /// Magnitudes.
    fn abs(self) -> Self;
    /// Times the sign of another, which costs no product.
    fn flipped(self, by: Self) -> Self;
    /// Where it is below another.
    fn below(self, other: Self) -> Self::Mask;
    /// The same where something holds already.
    #[inline(always)]
    fn below_in(self, mask: Self::Mask, other: Self) -> Self::Mask {
        self.below(other).and(mask)
    }
    /// Where it is at most another.
    fn within(self, other: Self) -> Self::Mask;
    /// Itself where something holds, else 0.
    fn kept(self, mask: Self::Mask) -> Self;
    /// Another where something holds.
    fn or(self, mask: Self::Mask, other: Self) -> Self;
    /// Of eight rows, the rows of what is at the same place in each, in vectors.
    fn across(rows: [&[f64; ROW]; ROW]) -> [[Self; CHUNKS]; ROW];

    /// The greater of it and another; itself where it is no number.
    fn at_least(self, other: Self) -> Self;
    /// The lesser of the two likewise.
    fn at_most(self, other: Self) -> Self;

    /// The other sign.
    #[inline(always)]
    fn minus(self) -> Self {
        self.flipped(Self::all(-1.0))
    }
}

/// For each number of a vector whether something holds.
pub trait Mask: Copy {
    /// Where both hold.
    fn and(self, other: Self) -> Self;
    /// Where either holds.
    fn or(self, other: Self) -> Self;
    /// Where it holds and another does not.
    fn but(self, other: Self) -> Self;
    /// Where it does not hold.
    fn not(self) -> Self;
    /// Where both hold or neither.
    fn same(self, other: Self) -> Self;
    /// A bit for each, the first the lowest.
    fn bits(self) -> u8;
    /// The same back.
    fn of(bits: u8) -> Self;
}

/// The operations of a vector that are one instruction each.
macro_rules! operations {
    ($name:ident, $add:path, $sub:path, $mul:path, $div:path) => {
        impl std::ops::Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                // SAFETY: whoever has such a vector has the processor for it, here and below.
                Self(unsafe { $add(self.0, other.0) })
            }
        }

        impl std::ops::Sub for $name {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $sub(self.0, other.0) })
            }
        }

        impl std::ops::Mul for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $mul(self.0, other.0) })
            }
        }

        impl Div for $name {
            type Output = Self;
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                // SAFETY: as above.
                Self(unsafe { $div(self.0, other.0) })
            }
        }

        impl Default for $name {
            #[inline(always)]
            fn default() -> Self {
                Self::all(0.0)
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
#[path = "vector/x86_64.rs"]
mod kinds;
#[cfg(not(target_arch = "x86_64"))]
#[path = "vector/plain.rs"]
mod kinds;

pub(crate) use kinds::*;
