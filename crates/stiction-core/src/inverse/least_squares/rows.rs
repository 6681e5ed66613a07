//! Sums over rows: in pieces of a fixed size that are added in their order, so that the bits are the same
//! for any number of threads, and in a fixed number of lanes, so that they are for any width of vectors.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::{DMatrix, DVector};
use stiction_dispatch::{Task, Width};

use crate::support::interrupt::{due, shared};

/// Rows that are summed by themselves before the sum is added to what came before.
const PIECE: usize = 8192;
/// Rows of which all columns stay in the first cache while each is multiplied with each.
const STRIP: usize = 256;
/// Sums that go on side by side.
const LANES: usize = 8;
/// Numbers from which on a second thread is worth its start.
const MANY: usize = 1 << 18;

/// Derivatives of the rows of one part by the columns that it has; those by all others are 0.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// Which columns, rising.
    pub columns: &'a [usize],
    /// Column by column.
    pub slopes: &'a [f64],
}

impl<'a> Block<'a> {
    /// How many rows it has.
    fn rows(&self) -> usize {
        self.slopes.len() / self.columns.len().max(1)
    }

    /// Some rows of each of its columns.
    fn piece(&self, from: usize, to: usize) -> Vec<&'a [f64]> {
        self.slopes.chunks_exact(self.rows().max(1)).map(|column| &column[from..to]).collect()
    }
}

/// Some rows of a part.
#[derive(Debug, Clone, Copy)]
struct Piece {
    part: usize,
    from: usize,
    to: usize,
}

fn pieces(lengths: impl Iterator<Item = usize>) -> Vec<Piece> {
    let mut found = Vec::new();
    for (part, rows) in lengths.enumerate() {
        let starts = (0..rows).step_by(PIECE);
        found.extend(starts.map(|from| Piece { part, from, to: rows.min(from + PIECE) }));
    }
    found
}

/// Some work on each piece, in their order, on so many threads; where the work of this thread is to end,
/// what is left of it is for nobody.
fn on_each<R: Default + Send + Sync>(
    pieces: &[Piece],
    numbers: usize,
    threads: usize,
    work: impl Fn(&Piece) -> R + Sync,
) -> Vec<R> {
    let found: Vec<OnceLock<R>> = pieces.iter().map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let labour = || {
        while !due() {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(piece) = pieces.get(place) else { break };
            // Each place is taken once.
            let _ = found[place].set(work(piece));
        }
    };
    shared(if numbers < MANY { 1 } else { threads.min(pieces.len()) }, labour);
    found.into_iter().map(|own| own.into_inner().unwrap_or_default()).collect()
}

/// Σr² of all parts.
pub fn power(parts: &[&[f64]], threads: usize) -> f64 {
    let pieces = pieces(parts.iter().map(|part| part.len()));
    let numbers = parts.iter().map(|part| part.len()).sum();
    let sums = on_each(&pieces, numbers, threads, |piece| {
        let own = &parts[piece.part][piece.from..piece.to];
        Width::widest().run(Dots { columns: &[own], with: own })[0]
    });
    sums.iter().sum()
}

/// JᵀJ of all blocks; shape (size, size).
pub fn normal(blocks: &[Block<'_>], size: usize, threads: usize) -> DMatrix<f64> {
    let pieces = pieces(blocks.iter().map(Block::rows));
    let sums = on_each(&pieces, numbers(blocks), threads, |piece| {
        let columns = blocks[piece.part].piece(piece.from, piece.to);
        Width::widest().run(Gram { columns: &columns })
    });
    let mut found = DMatrix::zeros(size, size);
    for (piece, sum) in pieces.iter().zip(&sums) {
        let columns = blocks[piece.part].columns;
        // Empty where the work was ended early.
        for (row, one) in sum.chunks_exact(columns.len().max(1)).zip(columns) {
            for (value, other) in row.iter().zip(columns).filter(|(_, other)| *other >= one) {
                found[(*one, *other)] += value;
            }
        }
    }
    found.fill_lower_triangle_with_upper_triangle();
    found
}

/// Jᵀr of all blocks; shape (size,).
pub fn products(
    blocks: &[Block<'_>],
    with: &[&[f64]],
    size: usize,
    threads: usize,
) -> DVector<f64> {
    let pieces = pieces(blocks.iter().map(Block::rows));
    let sums = on_each(&pieces, numbers(blocks), threads, |piece| {
        let columns = blocks[piece.part].piece(piece.from, piece.to);
        let with = &with[piece.part][piece.from..piece.to];
        Width::widest().run(Dots { columns: &columns, with })
    });
    let mut found = DVector::zeros(size);
    for (piece, sum) in pieces.iter().zip(&sums) {
        for (column, value) in blocks[piece.part].columns.iter().zip(sum) {
            found[*column] += value;
        }
    }
    found
}

/// What a step changes the rows by beside what their slopes say of it: (after − before − J·step)/along,
/// part by part.
pub fn missed(
    blocks: &[Block<'_>],
    before: &[&[f64]],
    after: &[&[f64]],
    step: &DVector<f64>,
    along: f64,
    threads: usize,
) -> Vec<Vec<f64>> {
    let pieces = pieces(blocks.iter().map(Block::rows));
    let found = on_each(&pieces, numbers(blocks), threads, |piece| {
        let block = blocks[piece.part];
        let range = piece.from..piece.to;
        let columns = block.piece(piece.from, piece.to);
        let step: Vec<f64> = block.columns.iter().map(|column| step[*column]).collect();
        let before = &before[piece.part][range.clone()];
        let after = &after[piece.part][range];
        Width::widest().run(Missed { columns: &columns, step: &step, before, after, along })
    });
    let mut parts: Vec<Vec<f64>> =
        blocks.iter().map(|block| Vec::with_capacity(block.rows())).collect();
    for (piece, own) in pieces.iter().zip(found) {
        parts[piece.part].extend(own);
    }
    parts
}

/// Takes so many times others off some numbers, part by part.
pub fn take_off(from: &mut [Vec<f64>], other: &[Vec<f64>], times: f64) {
    for (part, other) in from.iter_mut().zip(other) {
        for (value, other) in part.iter_mut().zip(other) {
            *value -= times * other;
        }
    }
}

fn numbers(blocks: &[Block<'_>]) -> usize {
    blocks.iter().map(|block| block.slopes.len()).sum()
}

/// Every column times every column, upper triangle; row by row.
struct Gram<'a> {
    columns: &'a [&'a [f64]],
}

impl Task for Gram<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run(self) -> Vec<f64> {
        let (columns, count) = (self.columns, self.columns.len());
        let mut found = vec![0.0; count * count];
        let rows = columns.first().map_or(0, |column| column.len());
        for from in (0..rows).step_by(STRIP) {
            let to = rows.min(from + STRIP);
            for one in (0..count).step_by(2) {
                let next = (one + 1).min(count - 1);
                let left = [&columns[one][from..to], &columns[next][from..to]];
                for other in (one..count).step_by(2) {
                    let after = (other + 1).min(count - 1);
                    let right = [&columns[other][from..to], &columns[after][from..to]];
                    let sums = tile(left, right);
                    found[one * count + other] += sums[0][0];
                    if after > other {
                        found[one * count + after] += sums[0][1];
                    }
                    if next > one {
                        found[next * count + other] += sums[1][0];
                        if after > other {
                            found[next * count + after] += sums[1][1];
                        }
                    }
                }
            }
        }
        found
    }
}

/// Every column times one other.
struct Dots<'a> {
    columns: &'a [&'a [f64]],
    with: &'a [f64],
}

impl Task for Dots<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run(self) -> Vec<f64> {
        let mut found = vec![0.0; self.columns.len()];
        for from in (0..self.with.len()).step_by(STRIP) {
            let to = self.with.len().min(from + STRIP);
            let with = &self.with[from..to];
            for (column, sum) in self.columns.iter().zip(&mut found) {
                *sum += dot(&column[from..to], with);
            }
        }
        found
    }
}

/// See [`missed`].
struct Missed<'a> {
    columns: &'a [&'a [f64]],
    step: &'a [f64],
    before: &'a [f64],
    after: &'a [f64],
    along: f64,
}

impl Task for Missed<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run(self) -> Vec<f64> {
        let mut found: Vec<f64> = self.after.iter().zip(self.before).map(|(a, b)| a - b).collect();
        for from in (0..found.len()).step_by(STRIP) {
            let to = found.len().min(from + STRIP);
            let own = &mut found[from..to];
            for (column, step) in
                self.columns.iter().zip(self.step).filter(|(_, step)| **step != 0.0)
            {
                for (value, slope) in own.iter_mut().zip(&column[from..to]) {
                    *value -= step * slope;
                }
            }
            for value in own {
                *value /= self.along;
            }
        }
        found
    }
}

/// Two columns times two others.
#[inline(always)]
fn tile(left: [&[f64]; 2], right: [&[f64]; 2]) -> [[f64; 2]; 2] {
    let mut sums = [[[0.0; LANES]; 2]; 2];
    let whole = left[0].len() / LANES * LANES;
    let mut from = 0;
    while from < whole {
        let [a, b] = left.map(|own| row(own, from));
        let [c, d] = right.map(|own| row(own, from));
        for lane in 0..LANES {
            sums[0][0][lane] += a[lane] * c[lane];
            sums[0][1][lane] += a[lane] * d[lane];
            sums[1][0][lane] += b[lane] * c[lane];
            sums[1][1][lane] += b[lane] * d[lane];
        }
        from += LANES;
    }
    for at in whole..left[0].len() {
        for (sums, left) in sums.iter_mut().zip(left) {
            for (sums, right) in sums.iter_mut().zip(right) {
                sums[at - whole] += left[at] * right[at];
            }
        }
    }
    sums.map(|sums| sums.map(sum))
}

/// One column times another one.
#[inline(always)]
fn dot(left: &[f64], right: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let whole = left.len() / LANES * LANES;
    let mut from = 0;
    while from < whole {
        let (a, b) = (row(left, from), row(right, from));
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
        from += LANES;
    }
    for at in whole..left.len() {
        sums[at - whole] += left[at] * right[at];
    }
    sum(sums)
}

/// So many numbers from a place on; 0 beyond the end, where nobody looks.
#[inline(always)]
fn row(values: &[f64], from: usize) -> [f64; LANES] {
    values.get(from..from + LANES).and_then(|own| own.try_into().ok()).unwrap_or_default()
}

#[inline(always)]
fn sum(lanes: [f64; LANES]) -> f64 {
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::interrupt::watched;

    /// Numbers without a pattern.
    fn drawn(count: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut next = || {
            state =
                state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        (0..count).map(|_| next()).collect()
    }

    const LENGTHS: [usize; 3] = [3 * PIECE + 77, 5, PIECE];
    const SIZE: usize = 5;

    /// Two parts with three columns each and one with all of them.
    fn columns() -> [&'static [usize]; 3] {
        [&[0, 1, 3], &[0, 1, 4], &[0, 1, 2, 3, 4]]
    }

    fn slopes() -> Vec<Vec<f64>> {
        let sizes = LENGTHS.iter().zip(columns()).zip(1..);
        sizes.map(|((rows, own), seed)| drawn(rows * own.len(), seed)).collect()
    }

    fn blocks(slopes: &[Vec<f64>]) -> Vec<Block<'_>> {
        slopes.iter().zip(columns()).map(|(slopes, columns)| Block { columns, slopes }).collect()
    }

    /// The same with a column for each place, all rows one under the other.
    fn dense(blocks: &[Block<'_>]) -> DMatrix<f64> {
        let rows: usize = blocks.iter().map(Block::rows).sum();
        let mut found = DMatrix::zeros(rows, SIZE);
        let mut from = 0;
        for block in blocks {
            for (column, own) in block.columns.iter().zip(block.slopes.chunks_exact(block.rows())) {
                for (row, value) in own.iter().enumerate() {
                    found[(from + row, *column)] = *value;
                }
            }
            from += block.rows();
        }
        found
    }

    #[test]
    fn sums_over_blocks_are_those_of_the_whole_matrix() {
        let slopes = slopes();
        let blocks = blocks(&slopes);
        let whole = dense(&blocks);
        let left: Vec<Vec<f64>> = LENGTHS.iter().map(|rows| drawn(*rows, 9)).collect();
        let parts: Vec<&[f64]> = left.iter().map(Vec::as_slice).collect();
        let stacked = DVector::from_vec(left.concat());
        let found = normal(&blocks, SIZE, 1);
        assert!((&found - whole.tr_mul(&whole)).amax() < 1e-9, "{found}");
        let found = products(&blocks, &parts, SIZE, 1);
        assert!((&found - whole.tr_mul(&stacked)).amax() < 1e-9, "{found}");
        assert!((power(&parts, 1) - stacked.norm_squared()).abs() < 1e-9);
        let step = DVector::from_vec(drawn(SIZE, 3));
        let ahead: Vec<Vec<f64>> = LENGTHS.iter().map(|rows| drawn(*rows, 12)).collect();
        let after: Vec<&[f64]> = ahead.iter().map(Vec::as_slice).collect();
        let mut found = missed(&blocks, &parts, &after, &step, 0.5, 1);
        take_off(&mut found, &left, 2.0);
        let changed = DVector::from_vec(ahead.concat()) - &stacked;
        let wanted = (changed - whole * step) / 0.5 - 2.0 * stacked;
        assert!((DVector::from_vec(found.concat()) - wanted).amax() < 1e-12);
    }

    #[test]
    fn threads_and_vectors_change_no_bit() {
        let slopes = slopes();
        // As many as make a second thread worth its start.
        let blocks = blocks(&slopes).repeat(4);
        assert!(numbers(&blocks) > MANY);
        let left: Vec<Vec<f64>> = blocks.iter().map(|block| drawn(block.rows(), 4)).collect();
        let parts: Vec<&[f64]> = left.iter().map(Vec::as_slice).collect();
        let all = |threads: usize| {
            let mut bits: Vec<u64> = Vec::new();
            bits.extend(normal(&blocks, SIZE, threads).iter().map(|value| value.to_bits()));
            bits.extend(products(&blocks, &parts, SIZE, threads).iter().map(|v| v.to_bits()));
            bits.push(power(&parts, threads).to_bits());
            bits
        };
        let one = all(1);
        for threads in [2, 3, 7] {
            assert_eq!(all(threads), one, "{threads} threads");
        }
        let whole = blocks[0].piece(0, PIECE - 3);
        let known = Width::Baseline.run(Gram { columns: &whole });
        for width in [Width::Four, Width::Eight] {
            assert_eq!(width.run(Gram { columns: &whole }), known, "{width:?}");
        }
    }

    #[test]
    fn work_that_is_to_end_ends_before_its_last_piece() {
        let slopes = drawn(64 * PIECE, 1);
        let block = Block { columns: &[0], slopes: &slopes };
        let (found, stopped) = watched(
            || true,
            || {
                std::thread::sleep(std::time::Duration::from_millis(60));
                normal(&[block], 1, 1)
            },
        );
        assert!(stopped);
        assert_eq!(found[(0, 0)], 0.0);
    }
}
