//! What is kept of a member that runs alone, in its loop.

use crate::batch::ensemble::Keep;
use crate::plant::{Machine, Run};
use crate::simulate::motor::{Column, Rows};
use crate::support::samples::PerSample;

/// What is kept of its columns, whatever it is: one loop for all.
pub(super) struct Kept<'a, 'b> {
    keep: Keep<'a>,
    target: PerSample<'a>,
    samples: usize,
    kinds: &'a [Column],
    own: &'a mut [&'b mut [f64]],
    /// Samples up to the next value, and its place, where every so many are kept.
    left: usize,
    row: usize,
}

impl<'a, 'b> Kept<'a, 'b> {
    /// Places of the values, those of each kind of column.
    pub(super) fn new(
        keep: Keep<'a>,
        target: PerSample<'a>,
        samples: usize,
        kinds: &'a [Column],
        own: &'a mut [&'b mut [f64]],
    ) -> Self {
        for values in &mut *own {
            match keep {
                Keep::Every(_) | Keep::Last => (),
                Keep::Rms(_) => values[0] = 0.0,
                Keep::Extremes => values.copy_from_slice(&[f64::INFINITY, f64::NEG_INFINITY]),
            }
        }
        let left = if let Keep::Every(every) = keep { every } else { 0 };
        Self { keep, target, samples, kinds, own, left, row: 0 }
    }

    /// The run has ended.
    pub(super) fn end(self) {
        if let Keep::Rms(_) = self.keep {
            self.own
                .iter_mut()
                .for_each(|values| values[0] = (values[0] / self.samples as f64).sqrt());
        }
    }
}

impl Rows<f64> for &mut Kept<'_, '_> {
    #[inline(always)]
    fn looks(&self) -> bool {
        self.kinds.iter().any(|kind| matches!(kind, Column::Law(_)))
    }

    #[inline(always)]
    fn see(
        &mut self,
        sample: usize,
        run: &Run<f64>,
        machine: &Machine<f64>,
        output: impl Fn(usize) -> f64,
    ) {
        let seen = self.kinds.iter().map(|kind| kind.read(run, machine, &output));
        let places = self.own.iter_mut().zip(seen);
        match self.keep {
            Keep::Every(every) => {
                self.left -= 1;
                if self.left == 0 {
                    places.for_each(|(values, seen)| values[self.row] = seen);
                    (self.left, self.row) = (every, self.row + 1);
                }
            }
            Keep::Last => {
                if sample + 1 == self.samples {
                    places.for_each(|(values, seen)| values[0] = seen);
                }
            }
            Keep::Rms(_) => {
                let target = self.target.at(sample);
                for (values, seen) in places {
                    let beside = seen - target;
                    values[0] += beside * beside;
                }
            }
            Keep::Extremes => {
                for (values, seen) in places {
                    values[0] = values[0].min(seen);
                    values[1] = values[1].max(seen);
                }
            }
        }
    }
}
