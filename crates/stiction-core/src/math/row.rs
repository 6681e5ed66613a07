//! Numbers side by side, one for each lane of a block.

use stiction_dispatch::Vector;

/// Lanes of a block: one vector of the widest processors, two or four of others.
pub const WIDTH: usize = stiction_dispatch::ROW;

/// One number where `taken`, else the other.
///
/// By bits: a choice would become a load from either place, or a store under a mask, on which the
/// next load has to wait.
#[inline(always)]
pub fn pick(taken: bool, new: f64, old: f64) -> f64 {
    let mask = u64::from(taken).wrapping_neg();
    f64::from_bits((new.to_bits() & mask) | (old.to_bits() & !mask))
}

/// One number for each lane.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
pub struct Row(pub [f64; WIDTH]);

impl Row {
    /// 0 in each lane.
    pub const ZERO: Self = Self([0.0; WIDTH]);

    /// Replaces the number of a lane where `taken`.
    #[inline(always)]
    pub fn take(&mut self, lane: usize, taken: bool, new: f64) {
        self.0[lane] = pick(taken, new, self.0[lane]);
    }

    /// Some of its numbers.
    #[inline(always)]
    pub fn at<V: Vector>(&self, chunk: usize) -> V {
        V::load(&self.0, chunk)
    }

    /// Replaces some of its numbers.
    #[inline(always)]
    pub fn put<V: Vector>(&mut self, chunk: usize, numbers: V) {
        numbers.store(&mut self.0, chunk);
    }

    /// Adds to some of its numbers.
    #[inline(always)]
    pub fn more<V: Vector>(&mut self, chunk: usize, numbers: V) {
        self.put(chunk, self.at::<V>(chunk) + numbers);
    }

    /// Replaces some of its numbers where something holds.
    #[inline(always)]
    pub fn put_where<V: Vector>(&mut self, chunk: usize, taken: V::Mask, numbers: V) {
        self.put(chunk, self.at::<V>(chunk).or(taken, numbers));
    }

    /// Adds to some of its numbers where something holds.
    #[inline(always)]
    pub fn more_where<V: Vector>(&mut self, chunk: usize, taken: V::Mask, numbers: V) {
        // −0 changes no number.
        self.more(chunk, V::all(-0.0).or(taken, numbers));
    }

    /// Adds to the number of a lane where `taken`.
    #[inline(always)]
    pub fn add(&mut self, lane: usize, taken: bool, more: f64) {
        // −0 changes no number: a sum for all is written whole, and the next load need not wait.
        self.0[lane] += pick(taken, more, -0.0);
    }
}

/// A bit for each lane that is not 0.
pub fn bits(lanes: &[u64; WIDTH]) -> u8 {
    (0..WIDTH).fold(0, |bits, lane| bits | u8::from(lanes[lane] != 0) << lane)
}

/// The lanes of these bits.
pub fn lanes(mut bits: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < WIDTH).then_some(lane)
    })
}
