//! The kernel through which efforts are compared: means about stamps, every so many samples.

use stiction_dispatch::{Task, Width};

use crate::support::error::{Error, Result};

/// A kernel over the samples of a motion.
#[derive(Debug, Clone, Copy)]
pub struct RowKernel<'a> {
    /// Weights of the mean, in the order of the samples; an odd number of them.
    pub mean: &'a [f64],
    /// Weights of the mean of the second derivative; two more.
    pub second: &'a [f64],
    /// Spacing of the results in samples.
    pub every: usize,
    /// Inertia, which turns what the sensor does not show of the motion into effort.
    pub inertia: f64,
    /// Whether the drive holds its effort between samples and counts as measured.
    pub held: bool,
    /// Whether what is needed goes on between samples without jumps: it counts as a second difference of
    /// positions weighs it, by how near it is to the stamp.
    pub smooth: bool,
}

impl RowKernel<'_> {
    /// Checks the numbers of weights and the spacing.
    pub fn check(&self) -> Result<()> {
        let fits = self.every > 0 && self.second.len() == self.mean.len() + 2;
        if fits && self.mean.len() % 2 == 1 { Ok(()) } else { Err(Error::Kernel) }
    }

    /// Results from so many samples.
    pub fn rows(&self, samples: usize) -> usize {
        (samples + 1).saturating_sub(self.second.len()).div_ceil(self.every)
    }

    /// Measured minus needed effort, from derivatives at the sample ends: `needed` and `driven`
    /// efforts, and how far the centre of mass is `ahead` of the reading; empty where all are 0.
    pub fn column(&self, traces: [&[f64]; 3], column: &mut [f64]) {
        self.column_of(traces, 0.., column);
    }

    /// The same at some of the places, counted from the first sample that is given.
    pub fn column_of(
        &self,
        [needed, driven, ahead]: [&[f64]; 3],
        places: impl Iterator<Item = usize> + Clone,
        column: &mut [f64],
    ) {
        Width::widest().run(Seen { kernel: self, needed, driven, ahead, places, column });
    }
}

/// A column that is being filled.
struct Seen<'a, P> {
    kernel: &'a RowKernel<'a>,
    needed: &'a [f64],
    driven: &'a [f64],
    ahead: &'a [f64],
    places: P,
    column: &'a mut [f64],
}

impl<P: Iterator<Item = usize> + Clone> Task for Seen<'_, P> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { kernel, needed, driven, ahead, places, column } = self;
        let RowKernel { mean, second, every, inertia, held, smooth } = *kernel;
        let weighed = if smooth { about(needed) } else { Vec::new() };
        let needed = if smooth { &weighed } else { needed };
        let mut short = Vec::new();
        if held && any(driven) {
            // What is held counts half a sample later.
            let next = driven.iter().skip(1).chain(driven.last());
            let both = driven.iter().zip(next).zip(needed);
            short.extend(both.map(|((one, next), needed)| needed - 0.5 * (one + next)));
        }
        let needed = if short.is_empty() { needed } else { &short };
        for (value, place) in column.iter_mut().zip(places.clone()) {
            let first = place * every + 1;
            *value = -inner(&needed[first..first + mean.len()], mean);
        }
        if any(ahead) {
            for (value, place) in column.iter_mut().zip(places) {
                let first = place * every;
                *value -= inertia * inner(&ahead[first..first + second.len()], second);
            }
        }
    }
}

/// Means of values about each of them that fall off to 0 at both neighbours, of the parabola through the
/// three: x(t+h) − 2·x(t) + x(t−h) is h² times that mean of the acceleration, exactly.
#[inline(always)]
fn about(values: &[f64]) -> Vec<f64> {
    let mut means = values.to_vec();
    for (mean, near) in means.iter_mut().skip(1).zip(values.windows(3)) {
        *mean += (near[0] - 2.0 * near[1] + near[2]) / 12.0;
    }
    means
}

/// Whether any value is not 0.
#[inline(always)]
fn any(values: &[f64]) -> bool {
    let whole = |some: &[f64]| some.iter().fold(false, |any, value| any | (*value != 0.0));
    values.chunks(256).any(whole)
}

/// Sum of products, in eight sums side by side.
#[inline(always)]
pub(crate) fn inner(values: &[f64], weights: &[f64]) -> f64 {
    const LANES: usize = 8;
    let (some, left) = values.as_chunks::<LANES>();
    let (other, right) = weights.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (v, w) in some.iter().zip(other) {
        for lane in 0..LANES {
            sums[lane] += v[lane] * w[lane];
        }
    }
    let ((some, left), (other, right)) = (left.as_chunks::<4>(), right.as_chunks::<4>());
    for (v, w) in some.iter().zip(other) {
        for lane in 0..4 {
            sums[lane] += v[lane] * w[lane];
        }
    }
    let rest: f64 = left.iter().zip(right).map(|(v, w)| v * w).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_the_mean_of_what_is_measured_less_what_is_needed() {
        let (mean, second) = ([0.25, 0.5, 0.25], [0.25, 0.0, -0.5, 0.0, 0.25]);
        let kernel = RowKernel {
            mean: &mean,
            second: &second,
            every: 2,
            inertia: 3.0,
            held: true,
            smooth: false,
        };
        let ramp: Vec<f64> = (0..12).map(f64::from).collect();
        let square: Vec<f64> = ramp.iter().map(|x| x * x).collect();
        let zeros = vec![0.0; 12];
        let mut column = vec![0.0; kernel.rows(12)];
        assert_eq!(column.len(), 4);
        kernel.column([&ramp, &zeros, &zeros], &mut column);
        assert_eq!(column, [-2.0, -4.0, -6.0, -8.0]);
        // Held efforts count half a sample later.
        kernel.column([&zeros, &ramp, &zeros], &mut column);
        assert_eq!(column, [2.5, 4.5, 6.5, 8.5]);
        kernel.column([&zeros, &zeros, &square], &mut column);
        assert_eq!(column, [-6.0; 4]);
        kernel.column_of([&ramp, &zeros, &zeros], [1, 3].into_iter(), &mut column[..2]);
        assert_eq!(column[..2], [-4.0, -8.0]);
    }

    #[test]
    fn what_goes_on_smoothly_counts_as_a_second_difference_weighs_it() {
        let (mean, second) = ([1.0], [1.0, -2.0, 1.0]);
        let kernel = RowKernel {
            mean: &mean,
            second: &second,
            every: 1,
            inertia: 1.0,
            held: false,
            smooth: true,
        };
        // Acceleration 12·t² of t⁴, whose second difference at t is 12·t² + 2.
        let (accelerations, zeros): (Vec<f64>, Vec<f64>) =
            (0..6).map(|t| (12.0 * f64::from(t * t), 0.0)).unzip();
        let mut column = vec![0.0; kernel.rows(6)];
        kernel.column([&accelerations, &zeros, &zeros], &mut column);
        assert_eq!(column, [-14.0, -50.0, -110.0, -194.0]);
    }
}
