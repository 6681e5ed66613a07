//! Runs of inputs that are held long: steps as long as an error allows, rests in one evaluation.

use crate::friction::{FrictionLaw, LawState};
use crate::integrate::{Account, Adaptive, Longest, parts};
use crate::plant::{Machine, Run};
use crate::simulate::motor::{Column, Motor, Running};
use crate::support::error::{Error, Result};
use crate::support::interrupt;
use crate::support::samples::Surroundings;
use crate::support::work::{self, Meter};

/// A tenth of an arc-second in rad.
pub const TENTH_OF_AN_ARC_SECOND: f64 = 4.848_136_811_095_36e-7;
/// Longest step of the fast integrator that the adaptive one starts from, s.
const LONGEST_NATURAL: f64 = 1e-3;
/// Share of J over the steepest fall of friction with speed, likewise.
const FALL: f64 = 0.25;
/// Samples of machines that have to be sampled, s.
const SAMPLE: f64 = 1e-3;

/// Inputs that are held, each for its duration.
#[derive(Debug, Clone, Copy)]
pub struct Segments<'a> {
    /// How long each is held, s.
    pub durations: &'a [f64],
    /// The input of each.
    pub inputs: &'a [f64],
    /// Load, temperature and whether the drive is on, for each.
    pub around: Surroundings<'a>,
    /// Error of a position that is allowed.
    pub tolerance: f64,
    /// Times from the start at which rows are wanted beside the ends of the segments, rising.
    pub times: &'a [f64],
}

impl Segments<'_> {
    /// Refuses what cannot be run.
    pub fn check(&self) -> Result<()> {
        let wanted = self.durations.len();
        if self.inputs.len() != wanted {
            return Err(Error::Length { name: "current".into(), given: self.inputs.len(), wanted });
        }
        self.around.check(wanted)?;
        let positive = |name: &str, given: f64, upper: f64| {
            if given > 0.0 && given <= upper {
                return Ok(());
            }
            let unit = String::new();
            Err(Error::OutOfBounds {
                name: name.to_owned(),
                given,
                lower: f64::MIN_POSITIVE,
                upper,
                unit,
            })
        };
        positive("tolerance", self.tolerance, 1e6)?;
        for duration in self.durations {
            positive("durations", *duration, 1e12)?;
        }
        let end: f64 = self.durations.iter().sum();
        let mut before = 0.0;
        for time in self.times {
            if !(*time > before && *time <= end) {
                let name = "times".to_owned();
                let unit = " s, each later than the one before".to_owned();
                return Err(Error::OutOfBounds {
                    name,
                    given: *time,
                    lower: before,
                    upper: end,
                    unit,
                });
            }
            before = *time;
        }
        Ok(())
    }

    /// Times of all rows from the start: ends of segments and those asked for, each once.
    pub fn rows(&self) -> Vec<f64> {
        let mut rows = Vec::with_capacity(self.durations.len() + self.times.len());
        let mut asked = self.times.iter().peekable();
        let mut end = 0.0;
        for duration in self.durations {
            let start = end;
            end += duration;
            while let Some(time) = asked.next_if(|time| **time < end) {
                if *time > start {
                    rows.push(*time);
                }
            }
            rows.push(end);
        }
        rows
    }
}

impl Running<f64> {
    /// Whether nothing of it has to be sampled or swings beside the contact.
    fn is_plain(&self) -> bool {
        let machine = &self.machine;
        self.way.is_none()
            && machine.drive.servo.is_none()
            && !machine.effects.remembers()
            && !machine.relaxes()
            && machine.effects.second_masses().is_empty()
    }

    /// Runs segments on; `row` sees body, machine and one state of the law at the time of each row.
    pub fn simulate_segments(
        &mut self,
        segments: &Segments<'_>,
        mut row: impl FnMut(usize, &Run<f64>, &Machine<f64>, &dyn Fn(usize) -> f64),
    ) -> Result<Account> {
        segments.check()?;
        if !self.is_plain() {
            return self.sample_segments(segments, row);
        }
        let (rows, began) = (segments.rows(), self.run.time);
        let Self { machine, law, state, run, .. } = self;
        with_law_and_state!(law, state, |law, state| {
            let most = work::allowed_for_rows(rows.len());
            let mut adaptive = Adaptive::new(segments.tolerance, natural(machine, law), most);
            let (mut k, mut passed, mut end) = (0, 0.0, 0.0);
            for (segment, duration) in segments.durations.iter().enumerate() {
                end += duration;
                run.transmitted = segments.around.transmitted_at(segment);
                run.temperature = segments.around.temperature_at(segment);
                run.enabled = segments.around.enabled_at(segment);
                let acting = (segments.inputs[segment], segments.around.load.at(segment));
                loop {
                    let until = rows[k];
                    adaptive.run(machine, law, state, run, acting, until - passed);
                    adaptive.ended.take().map_or(Ok(()), |error| Err(error.until(until)))?;
                    interrupt::check()?;
                    // Not the sum of the steps: a long run would carry its round-off.
                    (passed, run.time) = (until, began + until);
                    let seen = &*state;
                    row(k, run, machine, &|column| seen.output(column));
                    k += 1;
                    if until >= end {
                        break;
                    }
                }
            }
            Ok(adaptive.account)
        })
    }

    /// The same in samples, for machines that cannot do without.
    fn sample_segments(
        &mut self,
        segments: &Segments<'_>,
        mut row: impl FnMut(usize, &Run<f64>, &Machine<f64>, &dyn Fn(usize) -> f64),
    ) -> Result<Account> {
        let mut account = Account::default();
        let (rows, began) = (segments.rows(), self.run.time);
        let mut meter = Meter::new(work::allowed_for_rows(rows.len()));
        let (mut k, mut passed, mut end) = (0, 0.0, 0.0);
        for (segment, duration) in segments.durations.iter().enumerate() {
            end += duration;
            self.run.transmitted = segments.around.transmitted_at(segment);
            self.run.temperature = segments.around.temperature_at(segment);
            self.run.enabled = segments.around.enabled_at(segment);
            let (input, load) = (segments.inputs[segment], segments.around.load.at(segment));
            loop {
                let until = rows[k];
                let samples = ((until - passed) / SAMPLE).ceil().max(1.0);
                let dt = (until - passed) / samples;
                let divided = self.division(dt).steps;
                meter.foresee(samples * self.cost(dt)).map_err(|error| error.until(until))?;
                for _ in 0..samples as u64 {
                    let done = self.step_within(input, load, dt, &mut meter);
                    done.map_err(|error| error.until(until))?;
                }
                account.steps += (samples * divided) as u64;
                account.evaluations = account.steps;
                (passed, self.run.time) = (until, began + until);
                with_state!(&self.state, |state| {
                    row(k, &self.run, &self.machine, &|column| state.output(column));
                });
                k += 1;
                if until >= end {
                    break;
                }
            }
        }
        Ok(account)
    }
}

/// A step of the fast integrator that needs no division.
fn natural<L: FrictionLaw<f64>>(machine: &Machine<f64>, law: &L) -> f64 {
    let step = 1.0 / parts(machine, law, 1.0, Longest::USUAL);
    let fall = FALL * machine.body.inertia / law.steepest_fall();
    step.min(LONGEST_NATURAL).min(if fall.is_finite() { fall } else { f64::INFINITY })
}

impl Motor {
    /// Runs segments on; fills the columns asked for, each as long as [`Segments::rows`]. Where they
    /// lead to no number, or cannot be gone through, the motor stays where it is; whether they did not.
    pub fn simulate_segments(
        &mut self,
        segments: &Segments<'_>,
        columns: &mut [(Column, &mut [f64])],
    ) -> Result<(Account, bool)> {
        segments.check()?;
        let wanted = segments.rows().len();
        for (_, values) in columns.iter() {
            if values.len() != wanted {
                let name = "out".to_owned();
                return Err(Error::Length { name, given: values.len(), wanted });
            }
        }
        self.or_stay(|running| {
            running.simulate_segments(segments, |k, run, machine, output| {
                for (column, values) in columns.iter_mut() {
                    values[k] = column.read(run, machine, output);
                }
            })
        })
    }
}
