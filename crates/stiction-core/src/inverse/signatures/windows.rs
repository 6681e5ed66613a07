//! What efforts that are not there would change in windows of a motion: by when in a window they act,
//! and how a simulation answers to that.

use crate::inverse::kernel::{RowKernel, inner};
use crate::inverse::sensitivity::Target;
use crate::inverse::shoot::Windows;
use crate::inverse::traces::Stretch;

/// A sample before which the sum of an effort so far counts in a window, by this weight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    sample: usize,
    window: usize,
    weight: f64,
}

/// Marks by which the sum of a window is differentiated, rising: the mean of an effort over each of
/// `parts` parts of it, times what one does that acts during that part (see
/// [`crate::inverse::shoot::shoot_response`]).
pub(super) fn marks(
    windows: &Windows<'_>,
    response: &[f64],
    parts: usize,
    number: usize,
) -> Vec<Mark> {
    let whole = windows.weights.len();
    let length = whole / parts;
    let mut found = Vec::with_capacity(number * (parts + 1));
    for window in 0..number {
        let start = window * windows.stride;
        let mut before = 0.0;
        for part in 0..parts {
            let first = part * length;
            let last = if part + 1 == parts { whole } else { first + length };
            let share = response[part * number + window] / (last - first) as f64;
            found.push(Mark { sample: start + first, window, weight: before - share });
            before = share;
        }
        found.push(Mark { sample: start + whole, window, weight: before });
    }
    found.sort_by_key(|mark| mark.sample);
    found
}

/// The windows of one gain, as they are filled.
pub(super) struct Answer<'a> {
    pub marks: &'a [Mark],
    /// Of the windows: its second difference is their weights.
    pub kernel: &'a RowKernel<'a>,
    pub values: &'a mut [f64],
    /// Samples that were taken, what was given beyond what was needed in them, and windows that have
    /// ended.
    pub done: usize,
    pub total: f64,
    pub ended: usize,
}

impl Answer<'_> {
    /// Takes samples up to this one.
    fn sum(&mut self, until: usize, begin: usize, [needed, driven, _]: Stretch<'_>) {
        let new = self.done - begin..until - begin;
        let given: f64 = driven.get(new.clone()).map_or(0.0, |given| given.iter().sum());
        self.total += given - needed[new].iter().sum::<f64>();
        self.done = until;
    }
}

impl Target for Answer<'_> {
    fn take(&mut self, begin: usize, traces: Stretch<'_>) {
        let [needed, _, ahead] = traces;
        let end = begin + needed.len();
        while let Some((mark, left)) = self.marks.split_first()
            && mark.sample <= end
        {
            if mark.sample > self.done {
                self.sum(mark.sample, begin, traces);
            }
            self.values[mark.window] += mark.weight * self.total;
            self.marks = left;
        }
        self.sum(end, begin, traces);
        let ended = self.kernel.rows(end).min(self.values.len());
        if !ahead.is_empty() {
            let RowKernel { second, every, .. } = *self.kernel;
            for window in self.ended..ended {
                let first = window * every - begin;
                self.values[window] -= inner(&ahead[first..first + second.len()], second);
            }
        }
        self.ended = ended.max(self.ended);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_answers_the_mean_over_each_of_its_parts() {
        let weights = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -2.0];
        let windows = Windows { stride: 3, weights: &weights };
        let samples = 20;
        let number = windows.number(samples);
        let parts = 3;
        let response: Vec<f64> = (0..parts * number).map(|k| 0.5 + k as f64).collect();
        let needed: Vec<f64> = (0..samples).map(|k| (k * k) as f64).collect();
        let driven: Vec<f64> = (0..samples).map(|k| 3.0 - k as f64).collect();
        let ahead: Vec<f64> = (0..samples).map(|k| (k % 5) as f64).collect();
        let marks = marks(&windows, &response, parts, number);
        let kernel = RowKernel {
            mean: &weights[2..],
            second: &weights,
            every: windows.stride,
            inertia: 1.0,
            held: false,
            smooth: false,
        };
        let mut values = vec![0.0; number];
        let mut answer = Answer {
            marks: &marks,
            kernel: &kernel,
            values: &mut values,
            done: 0,
            total: 0.0,
            ended: 0,
        };
        // Stretches reach back to what a window still asks for.
        for (begin, end) in [(0, 9), (3, 12), (6, 20)] {
            answer.take(begin, [&needed[begin..end], &driven[begin..end], &ahead[begin..end]]);
        }
        for (window, value) in values.iter().enumerate() {
            let start = 3 * window;
            let mut expected = ahead[start + 6] * 2.0 - ahead[start + 1];
            for (part, (first, last)) in [(0, 2), (2, 4), (4, 7)].into_iter().enumerate() {
                let own = start + first..start + last;
                let sum: f64 = own.clone().map(|k| driven[k] - needed[k]).sum();
                expected += response[part * number + window] * sum / own.len() as f64;
            }
            assert!((value - expected).abs() < 1e-9 * expected.abs(), "{value} {expected}");
        }
    }
}
