//! Drive: from a recording's input to effort.

use std::collections::VecDeque;

use crate::error::{Error, Result};
use crate::friction::{Entry, EntryReader};
use crate::scalar::Scalar;

/// Gain and limit of the drive.
#[derive(Debug, Clone, Copy)]
pub struct Drive<S> {
    /// Effort per unit of input.
    pub gain: S,
    /// Greatest magnitude of the input that gets through; infinite means no limit.
    pub limit: f64,
}

impl<S: Scalar> Drive<S> {
    /// Effort for an input.
    #[inline]
    pub fn effort(&self, input: S) -> S {
        let held = if input.re() > self.limit {
            S::constant(self.limit)
        } else if input.re() < -self.limit {
            S::constant(-self.limit)
        } else {
            input
        };
        self.gain * held
    }
}

/// Stretches that differ by less than this share of a sample or of the delay are equal: sums of
/// durations carry round-off, and a sliver would turn a derivative to the wrong side of its kink.
const ROUND_OFF: f64 = 1e-9;

/// A delay and the inputs that are on their way through it.
///
/// Inputs are data, plain numbers; only the delay is a parameter. What waits always spans the
/// delay, so a sample costs the same however long that is.
#[derive(Debug)]
pub struct DelayLine<S> {
    delay: S,
    /// The input that arrived last.
    arrived: f64,
    /// Value and duration of the inputs on their way, oldest first.
    waiting: VecDeque<[f64; 2]>,
}

// A derived Clone would leave no spare room, and the next sample of the copy would allocate.
impl<S: Clone> Clone for DelayLine<S> {
    fn clone(&self) -> Self {
        let mut waiting = VecDeque::with_capacity(self.waiting.capacity());
        waiting.extend(&self.waiting);
        Self { delay: self.delay.clone(), arrived: self.arrived, waiting }
    }
}

impl<S: Scalar> DelayLine<S> {
    /// Name of its entry in a state.
    pub const ENTRY: &'static str = "input_history";

    /// A delay through which nothing has passed yet.
    pub fn new(delay: S) -> Self {
        let mut line = Self { delay, arrived: 0.0, waiting: VecDeque::new() };
        line.clear();
        line
    }

    /// Forgets all inputs: before, they were 0.
    pub fn clear(&mut self) {
        self.arrived = 0.0;
        self.waiting.clear();
        if self.delay.re() > 0.0 {
            self.waiting.push_back([0.0, self.delay.re()]);
        }
    }

    /// Takes over the inputs on their way through another line of the same delay.
    pub fn resume<T>(&mut self, other: &DelayLine<T>) {
        self.arrived = other.arrived;
        self.waiting.clone_from(&other.waiting);
    }

    /// Takes in the input of a sample and gives the mean of what arrives during it.
    #[inline(never)] // motors without a delay are not to carry it through their loop
    pub fn pass(&mut self, input: f64, dt: f64) -> S {
        let before = self.arrived;
        self.waiting.push_back([input, dt]);
        let mean = self.mean_of_next(dt);
        // Mean of u over t₀−τ to t₁−τ: a longer delay takes in what came before at one end and
        // leaves out what came last at the other.
        self.delay.chain(mean, (before - self.arrived) / dt)
    }

    fn mean_of_next(&mut self, dt: f64) -> f64 {
        let nearly = ROUND_OFF * dt.min(self.delay.re());
        let mut left = dt;
        // −0 is the neutral element of a sum, to the bit.
        let mut mean = -0.0;
        while let Some([value, duration]) = self.waiting.front_mut() {
            let (value, beyond) = (*value, *duration - left);
            self.arrived = value;
            if beyond > nearly {
                *duration = beyond;
                return mean + value * (left / dt);
            }
            if beyond >= -nearly {
                self.waiting.pop_front();
                return mean + value * (left / dt);
            }
            mean += value * (*duration / dt);
            left -= *duration;
            self.waiting.pop_front();
        }
        mean
    }

    /// The inputs as an entry of a state: rows of value and duration, first the input that arrived
    /// last, whose duration is over.
    pub fn entry(&self) -> (&'static str, Entry) {
        let rows = std::iter::once([self.arrived, 0.0]).chain(self.waiting.iter().copied());
        (Self::ENTRY, Entry::Pairs(rows.collect()))
    }

    /// Takes the inputs from an entry of a state.
    pub fn restore(&mut self, read: &mut EntryReader<'_>) -> Result<()> {
        let rows = read.pairs(Self::ENTRY)?;
        let bad = |problem: String| Err(Error::State { name: Self::ENTRY.to_owned(), problem });
        let [[arrived, 0.0], waiting @ ..] = rows else {
            return bad("does not begin with the input that arrived last, of duration 0".to_owned());
        };
        let span: f64 = waiting.iter().map(|row| row[1]).sum();
        let delay = self.delay.re();
        if waiting.iter().any(|row| row[1] <= 0.0) || (span - delay).abs() > 1e-6 * delay + 1e-9 {
            return bad(format!("spans {span} s where the delay is {delay} s"));
        }
        self.arrived = *arrived;
        self.waiting.clear();
        self.waiting.extend(waiting);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    /// Inputs and durations that repeat in no period.
    fn samples() -> Vec<(f64, f64)> {
        (0..400)
            .map(|k| {
                let k = f64::from(k);
                ((0.7 * k).sin() + (0.013 * k * k).cos(), 1e-3 * (1.1 + (1.7 * k).sin()))
            })
            .collect()
    }

    /// Integral of the held inputs up to a time; 0 before the first.
    fn integral(samples: &[(f64, f64)], time: f64) -> f64 {
        let mut start = 0.0;
        samples
            .iter()
            .map(|(value, duration)| {
                let covered = (time - start).clamp(0.0, *duration);
                start += duration;
                value * covered
            })
            .sum()
    }

    #[test]
    fn what_arrives_is_the_mean_of_the_delayed_input() {
        let samples = samples();
        for delay in [0.0, 1e-5, 4e-4, 2e-3, 0.0317, 5.0] {
            let mut line = DelayLine::new(Dual::variable(delay, 0));
            let mut end = 0.0;
            for (input, dt) in &samples {
                let start = end;
                end += dt;
                let mean = |delay: f64| {
                    (integral(&samples, end - delay) - integral(&samples, start - delay)) / dt
                };
                let got = line.pass(*input, *dt);
                assert!((got.re() - mean(delay)).abs() < 1e-10, "{delay} {end}");
                let slope = (mean(delay + 1e-9) - mean(delay)) / 1e-9;
                assert!((Scalar::partial(got, 0) - slope).abs() < 2e-3 * (1.0 + slope.abs()));
            }
        }
    }

    #[test]
    fn no_delay_changes_no_bit_and_shows_its_derivative() {
        let mut line = DelayLine::new(Dual::variable(0.0, 3));
        let mut before = 0.0;
        for (input, dt) in samples().into_iter().chain([(-0.0, 1e-3), (0.0, 1e-3)]) {
            let got = line.pass(input, dt);
            assert_eq!(got.re().to_bits(), input.to_bits());
            assert_eq!(Scalar::partial(got, 3), (before - input) / dt);
            before = input;
        }
    }

    #[test]
    fn a_delay_of_whole_samples_shifts_the_input() {
        for (dt, whole) in [(1e-3, 3), (1e-4, 20), (1e-4, 5000), (0.3, 1)] {
            let mut line = DelayLine::new(Dual::variable(dt * f64::from(whole), 0));
            let inputs: Vec<f64> = samples().iter().map(|(input, _)| *input).collect();
            let at = |k: usize, late: i32| {
                k.checked_sub(late as usize).map_or(0.0, |k| inputs[k % inputs.len()])
            };
            for k in 0..12_000 {
                let got = line.pass(at(k, 0), dt);
                assert!((got.re() - at(k, whole)).abs() < 1e-8);
                let slope = (at(k, whole + 1) - at(k, whole)) / dt;
                assert!((Scalar::partial(got, 0) - slope).abs() < 1e-8 / dt, "{dt} {whole} {k}");
            }
            assert!(line.waiting.len() <= whole as usize + 1);
        }
    }
}
