//! Derivatives of efforts along a motion, handed over stretch by stretch: what is read soon after it is
//! written stays in the cache, and a long motion asks for no more memory than a short one.

use stiction_dispatch::{ROW, Vector, Wide, Width};

use crate::inverse::kernel::RowKernel;
use crate::math::dual::{COLUMNS, Dual};
use crate::math::scalar::Scalar;

/// Samples of a stretch, or as many as a kernel covers where that is more.
const STRETCH: usize = 512;

/// Derivatives by one parameter in some samples: needed, driven, ahead; empty where all are 0.
pub type Stretch<'a> = [&'a [f64]; 3];

/// Which samples of a motion are there at once: those of a stretch, and those before it that a kernel
/// still asks for.
#[derive(Debug, Clone, Copy)]
pub struct Reach {
    samples: usize,
    room: usize,
    /// Samples that a place of the kernel covers, and from one place to the next.
    covers: Option<(usize, usize)>,
}

impl Reach {
    /// In a motion of so many samples, seen sample by sample or through a kernel.
    pub fn of(samples: usize, kernel: Option<&RowKernel<'_>>) -> Self {
        let covers = kernel.map(|kernel| (kernel.second.len(), kernel.every));
        let covered = covers.map_or(0, |(width, every)| width + every);
        let room = samples.min(covered + STRETCH.max(covered));
        Self { samples, room, covers }
    }

    /// Samples of the motion.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// How many of them there is room for.
    pub fn room(&self) -> usize {
        self.room
    }

    /// The first sample that is still asked for once all before `end` are there.
    pub fn kept_from(&self, end: usize) -> usize {
        self.covers.map_or(end, |(width, every)| {
            let places = (end + 1).saturating_sub(width).div_ceil(every);
            end.min(places * every)
        })
    }
}

/// Room for the samples of a stretch and for those before it that a kernel still asks for.
#[derive(Debug)]
pub struct Traces {
    /// Of needed, driven, ahead: all samples of the first column, then all of the next.
    rows: [Vec<f64>; 3],
    /// Which of them held anything but 0 so far; needed is there in any case.
    there: [bool; 3],
    reach: Reach,
    columns: usize,
}

impl Traces {
    /// For a motion of so many samples, seen sample by sample or through a kernel.
    pub fn new(samples: usize, kernel: Option<&RowKernel<'_>>) -> Self {
        let reach = Reach::of(samples, kernel);
        Self { rows: Default::default(), there: [true, false, false], reach, columns: 0 }
    }

    /// The same for so many columns.
    pub fn of(&mut self, columns: usize) -> &mut Self {
        self.columns = columns;
        for rows in &mut self.rows {
            rows.resize(rows.len().max(columns * self.reach.room), 0.0);
        }
        self
    }

    /// Ready for the first sample; `take` is given column, first sample and stretch.
    pub fn to<'a>(&'a mut self, take: &'a mut Take<'a>) -> Filling<'a> {
        self.there = [true, false, false];
        Filling { traces: self, begin: 0, end: 0, take }
    }
}

/// What takes column, first sample and stretch: no type of its own, or there would be one more loop
/// that fills traces for each.
pub type Take<'a> = dyn FnMut(usize, usize, Stretch<'_>) + 'a;

/// Traces that are being filled.
pub struct Filling<'a> {
    traces: &'a mut Traces,
    /// The first sample there is, and the first beyond.
    begin: usize,
    end: usize,
    take: &'a mut Take<'a>,
}

impl Filling<'_> {
    /// Takes the derivatives of the next sample.
    #[inline(always)]
    pub fn put(&mut self, sample: usize, of: [&Dual; 3]) {
        let Traces { rows, there, reach: Reach { room, .. }, columns } = &mut *self.traces;
        for ((rows, there), dual) in rows.iter_mut().zip(there).zip(of) {
            if !*there {
                if !dual.derivative_is_nonzero() {
                    continue;
                }
                // What is there from before is of another pass.
                rows.fill(0.0);
                *there = true;
            }
            put(&mut rows[..*columns * *room], *room, sample - self.begin, dual.slopes());
        }
        self.end = sample + 1;
        if self.end == self.begin + *room {
            self.hand_over();
        }
    }

    /// Hands over what is there, and keeps what is asked for again.
    #[inline(never)]
    pub fn hand_over(&mut self) {
        let Traces { rows, there, reach: Reach { room, samples, .. }, columns } = &mut *self.traces;
        let (begin, end) = (self.begin, self.end);
        for column in 0..*columns {
            let own = column * *room..column * *room + (end - begin);
            let stretch =
                std::array::from_fn(|k| if there[k] { &rows[k][own.clone()] } else { &[] });
            (self.take)(column, begin, stretch);
        }
        if end == *samples {
            return;
        }
        let room = *room;
        self.begin = self.traces.reach.kept_from(end);
        for rows in &mut self.traces.rows {
            for row in rows.chunks_exact_mut(room) {
                row.copy_within(self.begin - begin..end - begin, 0);
            }
        }
    }
}

/// Writes what stands for a sample into one row after the other, for as many as there are.
#[inline(always)]
pub fn put(rows: &mut [f64], samples: usize, k: usize, slopes: &[f64; COLUMNS]) {
    if rows.len() == COLUMNS * samples {
        for (column, slope) in slopes.iter().enumerate() {
            rows[column * samples + k] = *slope;
        }
    } else {
        for (row, slope) in rows.chunks_exact_mut(samples).zip(slopes) {
            row[k] = *slope;
        }
    }
}

/// Samples whose derivatives are put into the rows at once: rows lie apart, and a processor keeps
/// few pages at hand to write to.
pub const ONCE: usize = ROW;

/// Writes what stands for some samples from `first` on, [`ONCE`] at most, into one row after the other.
pub fn put_all(rows: &mut [&mut [f64]], first: usize, slopes: &[[f64; COLUMNS]]) {
    if let Some(slopes) = slopes.first_chunk() {
        return Width::widest().run_wide(Across { rows, first, slopes });
    }
    for (k, slopes) in (first..).zip(slopes) {
        for (row, slope) in rows.iter_mut().zip(slopes) {
            row[k] = *slope;
        }
    }
}

/// Writing as many samples as a vector has numbers, as a loop to run.
struct Across<'a, 'b> {
    rows: &'a mut [&'b mut [f64]],
    first: usize,
    slopes: &'a [[f64; COLUMNS]; ONCE],
}

impl Wide for Across<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vector>(self) {
        for (half, rows) in self.rows.chunks_mut(ROW).enumerate() {
            let mut halves = [&[0.0; ROW]; ROW];
            for (place, of) in halves.iter_mut().zip(self.slopes) {
                *place = &of.as_chunks().0[half];
            }
            let across = V::across(halves);
            for (row, across) in rows.iter_mut().zip(across) {
                if let Some(places) = row[self.first..].first_chunk_mut() {
                    for (chunk, vector) in across.iter().enumerate().take(V::CHUNKS) {
                        vector.store(places, chunk);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_end_where_the_next_begins_or_a_kernel_still_reaches_back() {
        let weights = [0.0; 42];
        let kernel = RowKernel {
            mean: &weights[..39],
            second: &weights[..41],
            every: 7,
            inertia: 0.0,
            held: true,
            smooth: false,
        };
        for (samples, kernel) in
            [(0, None), (1, None), (5000, None), (5000, Some(&kernel)), (30, Some(&kernel))]
        {
            let mut traces = Traces::new(samples, kernel);
            let mut seen = [0, 0];
            let mut places = 0;
            let mut take = |column: usize, begin, [needed, driven, _]: Stretch<'_>| {
                assert!(begin <= seen[column]);
                for (k, needed) in needed.iter().enumerate() {
                    assert_eq!(*needed, (begin + k) as f64 * [1.0, 2.0][column]);
                }
                assert!(driven.is_empty());
                seen[column] = begin + needed.len();
                if let (Some(kernel), 0) = (kernel, column) {
                    assert!(begin <= places * kernel.every);
                    places = kernel.rows(seen[0]);
                }
            };
            let mut filling = traces.of(2).to(&mut take);
            let zero = Dual::constant(0.0);
            for k in 0..samples {
                let x = (Dual::variable(0.0, 0) + Dual::variable(0.0, 1) * 2.0) * k as f64;
                filling.put(k, [&x, &zero, &zero]);
            }
            filling.hand_over();
            assert_eq!(seen, [samples; 2]);
        }
    }
    #[test]
    fn what_was_0_until_now_is_0_there_whatever_was_put_before() {
        let zero = Dual::constant(0.0);
        let one = Dual::variable(0.0, 0);
        let mut traces = Traces::new(1200, None);
        for begins in [0, 300, 700, 1200] {
            let mut seen = vec![0.0; 1200];
            let mut take = |_, begin: usize, [_, driven, ahead]: Stretch<'_>| {
                seen[begin..begin + driven.len()].copy_from_slice(driven);
                assert!(ahead.is_empty());
            };
            let mut filling = traces.of(1).to(&mut take);
            for k in 0..1200 {
                filling.put(k, [&one, if k < begins { &zero } else { &one }, &zero]);
            }
            filling.hand_over();
            assert!((0..1200).all(|k| seen[k] == f64::from(k >= begins)), "{begins}");
        }
    }
}
