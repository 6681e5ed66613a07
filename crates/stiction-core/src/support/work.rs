//! What a call may cost: work is counted as it is done, under a ceiling that grows with its samples.
//!
//! A sample alone is bounded by the number of its parts, but some thousands of samples at that
//! bound would take minutes. So a call has an allowance of its own and a mean for each sample. What is
//! known beforehand is refused at once; the rest, which hangs on where the motion goes, as it comes.

use std::cell::Cell;

use crate::math::scalar::Scalar;
use crate::support::error::{Error, Result};
use crate::support::interrupt;

/// A step of a bare body in a row of them, some tens of nanoseconds.
pub const IN_A_ROW: u64 = 1;
/// What beginning such a row comes to, where it is of a sample alone.
pub const A_ROW: u64 = 4;
/// Any other step of the fast integrator, or one attempt to find where in it a mode changes.
pub const STEP: u64 = 8;
/// A step with its derivatives, in steps without.
pub const DERIVATIVES: u64 = 5;

/// Work of any call: two seconds of the dearest laws, which take 28 ns for one (bouc_wen, leuven), four
/// of the dearest plants (a servo on elasto_plastic with an effect: 45 ns).
const FIRST: f64 = 8e7;
/// The same of a call of segments, whose evaluations may each take as long as several such steps.
const FIRST_OF_SEGMENTS: f64 = 3.6e7;
/// As much more for each sample: a thousand steps.
const OF_A_SAMPLE: f64 = 8e3;
/// The same for each row of segments, which are few and long.
const OF_A_ROW: f64 = 2e3;

/// Work after which the caller is asked whether to go on: some tenths of a millisecond.
const STRIDE: u64 = 2048;

/// What may take the work, in words.
pub const PARTS: &str = "samples are divided into many steps each";
/// The same of events.
pub const WITHIN_STEPS: &str =
    "its contact changes its mode or seeks its force again and again within a step";

thread_local! {
    /// Work within steps, on this thread: attempts to find where modes change, and sums of a law.
    static WITHIN: Cell<u64> = const { Cell::new(0) };
}

/// What a plain step in a row of them costs.
pub const fn in_a_row<S: Scalar>() -> u64 {
    IN_A_ROW * if S::CARRIES { DERIVATIVES } else { 1 }
}

/// Notes work within a step: an attempt to find where a mode changes, or a long sum of a law.
pub fn spend(cost: u64) {
    WITHIN.set(WITHIN.get().wrapping_add(cost));
}

/// Work in steps of the fast integrator.
pub fn in_steps(work: f64) -> f64 {
    work / STEP as f64
}

/// What a call of so many samples may cost.
pub fn allowed(samples: usize) -> f64 {
    FIRST + OF_A_SAMPLE * samples as f64
}

/// What segments may cost that end in so many rows.
pub fn allowed_for_rows(rows: usize) -> f64 {
    FIRST_OF_SEGMENTS + OF_A_ROW * rows as f64
}

/// Counts the work of a call, and asks now and then whether to go on.
#[derive(Debug, Clone, Copy)]
pub struct Meter {
    most: f64,
    left: f64,
    since: u64,
    /// What there was on the thread of work within steps at the last count.
    before: u64,
    /// What of the work was within steps.
    within: f64,
    /// Whether the caller is asked.
    asks: bool,
}

impl Meter {
    /// With so much work allowed.
    pub fn new(most: f64) -> Self {
        Self { most, left: most, since: 0, before: WITHIN.get(), within: 0.0, asks: true }
    }

    /// Counts work; an error where it is too much, or where the caller wants no more.
    #[inline(always)]
    pub fn take(&mut self, cost: u64) -> Result<()> {
        self.since += cost;
        if self.since < STRIDE { Ok(()) } else { self.settle() }
    }

    /// Refuses at once what is known to come.
    pub fn foresee(&self, cost: f64) -> Result<()> {
        if cost <= self.left { Ok(()) } else { Err(too_much(self.most, PARTS)) }
    }

    #[cold]
    #[inline(never)]
    fn settle(&mut self) -> Result<()> {
        let now = WITHIN.get();
        let within = now.wrapping_sub(self.before) as f64;
        self.left -= self.since as f64 + within;
        self.within += within;
        (self.since, self.before) = (0, now);
        if self.left < 0.0 {
            let mostly = self.within > 0.5 * (self.most - self.left);
            return Err(too_much(self.most, if mostly { WITHIN_STEPS } else { PARTS }));
        }
        if self.asks { interrupt::check() } else { Ok(()) }
    }

    /// For what is known to be short, and cannot be taken back.
    pub fn unbounded() -> Self {
        Self { asks: false, ..Self::new(f64::INFINITY) }
    }

    /// For one sample.
    pub fn of_a_sample() -> Self {
        Self::new(allowed(1))
    }

    /// What is left of the work.
    pub fn left(&self) -> f64 {
        let within = WITHIN.get().wrapping_sub(self.before) as f64;
        (self.left - self.since as f64 - within).max(0.0)
    }
}

/// The refusal of more work than that.
pub(crate) fn too_much(most: f64, why: &'static str) -> Error {
    Error::TooMuchWork { most: in_steps(most), why, remedy: String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_refused_once_it_is_too_much() {
        let mut meter = Meter::new(1e4);
        let taken = (0..).take_while(|_| meter.take(100).is_ok()).count();
        assert!((100..130).contains(&taken), "{taken}");
        assert_eq!(meter.left(), 0.0);
        assert!(Meter::new(1e4).foresee(1.1e4).is_err());
        assert!(Meter::new(1e4).foresee(0.9e4).is_ok());
    }

    #[test]
    fn what_is_done_within_steps_counts_as_well() {
        let mut meter = Meter::new(1e4);
        spend(9_000);
        assert!(meter.take(STRIDE).is_err());
        let Err(Error::TooMuchWork { why, .. }) = meter.take(STRIDE) else { panic!("no refusal") };
        assert!(why.contains("mode"), "{why}");
    }
}
