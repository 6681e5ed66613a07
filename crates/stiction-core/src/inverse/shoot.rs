//! A machine started anew along a motion that was measured: where it gets to by itself.

use std::f64::consts::PI;

use crate::friction::FrictionLaw;
use crate::integrate::{LONGEST_PHASE, Longest};
use crate::inverse::sensitivity::{Start, passes, seeded};
use crate::inverse::track::Track;
use crate::math::scalar::{COLUMNS, Dual, Scalar};
use crate::simulate::motor::{MotorSpec, Running};
use crate::support::error::{Error, Result};
use crate::support::interrupt;
use crate::support::motion::MeasuredMotion;
use crate::support::samples::PerSample;
use crate::support::work::{self, Meter};

/// ω·h above which a sample of a window is divided where the ring is too fast for the weights of the
/// window to keep any of it: its phase error is 0.4 % of the phase.
const COARSE_PHASE: f64 = 0.3;
/// The same at most: of what rings faster than samples show only where it comes to rest is seen, as far
/// as its steps stay well within what is stable (ω·h < 2).
const COARSEST_PHASE: f64 = 0.6;
/// ω·T of a ring in a window of duration T from which on its weights keep less of it the faster it is:
/// three periods.
const KEPT_PHASE: f64 = 6.0 * PI;
/// Parts of a sample above which a window is refused: what swings a hundred times between two samples,
/// or calms down in the five hundredth part of one, no reading can tell from what is rigid, and a trial
/// of a fit that strays there would take minutes.
const MOST_SHOT_PARTS: f64 = 2e3;

/// Windows of equal length along a motion, evenly spaced, and what is read off each of them.
#[derive(Debug, Clone, Copy)]
pub struct Windows<'a> {
    /// Samples from the start of one to the start of the next.
    pub stride: usize,
    /// Weights of the simulated readings after the samples of a window: as many as it has samples.
    pub weights: &'a [f64],
}

impl Windows<'_> {
    /// How many fit into a motion of so many samples.
    pub fn number(&self, samples: usize) -> usize {
        let left = samples.checked_sub(self.weights.len());
        left.map_or(0, |left| left / self.stride.max(1) + 1)
    }
}

impl<S: Scalar> Running<S> {
    /// ω·h above which a sample is divided along a measured motion: as always where samples show the
    /// ring, and less finely the faster it is for them.
    fn phase_of_samples(&self, dt: f64) -> f64 {
        let phase = with_law!(&self.law, |law| self.machine.phase(law.greatest_stiffness(), dt));
        (LONGEST_PHASE * phase.powi(2)).clamp(LONGEST_PHASE, COARSEST_PHASE)
    }

    /// The same in a window of so many samples, where its weights keep less of a ring than samples show.
    fn phase_of_window(&self, dt: f64, samples: usize) -> f64 {
        let span = dt * samples as f64;
        let phase = with_law!(&self.law, |law| self.machine.phase(law.greatest_stiffness(), span));
        let kept = LONGEST_PHASE * (phase / KEPT_PHASE).powi(2);
        kept.clamp(LONGEST_PHASE, COARSE_PHASE).max(self.phase_of_samples(dt))
    }

    /// Simulates one window after the other, with an effort added to each of its samples, and reports the
    /// weighted sum of each: of what the sensor would read less what it read at the start.
    ///
    /// A window starts at the measured position and velocity, with friction, effects and delayed
    /// inputs as they are after following the motion up to there. What it does in between is its own.
    pub fn shoot(
        &mut self,
        motion: &MeasuredMotion<'_>,
        windows: &Windows<'_>,
        added: impl Fn(usize) -> S,
        land: &mut dyn FnMut(usize, S),
    ) -> Result<()> {
        let MeasuredMotion { positions, inputs, around, dt, .. } = *motion;
        let held: Vec<f64>;
        let each = match inputs {
            PerSample::Each(values) => values,
            PerSample::Same(value) => {
                held = vec![value; motion.samples()];
                &held
            }
        };
        let sensor = self.machine.effects.clone();
        let behind = |reading: f64| sensor.behind(S::constant(reading));
        let actual: Option<&dyn Fn(f64) -> S> =
            if sensor.misreads() { Some(&behind) } else { None };
        let length = windows.weights.len();
        // Windows may overlap as often as they have samples: what was given is the motion.
        let all = work::allowed(motion.samples());
        let mut left = all;
        let mut reached = 0;
        let phase = self.phase_of_window(dt.greatest(), length);
        let longest = Longest::close(self.longest.phase.max(phase));
        for window in 0..windows.number(motion.samples()) {
            interrupt::check()?;
            let start = window * windows.stride.max(1);
            self.follow_to(motion, reached..start);
            reached = start;
            let end = start + length;
            let track = Track::new(positions, actual, start);
            let mut shot = self.clone();
            shot.longest = longest;
            shot.most_parts = shot.most_parts.min(MOST_SHOT_PARTS);
            shot.run.position = track.position();
            shot.run.velocity = track.velocity(&dt);
            shot.run.second_position = shot.run.position;
            shot.run.second_velocity = shot.run.velocity;
            shot.machine.refresh(&mut shot.run);
            let (around, dt) = (around.between(start, end), dt.between(start, end));
            let read = positions[start];
            let mut sum = S::constant(0.0);
            shot.allowance = Some(left);
            let done =
                shot.simulate_under(&each[start..end], around, &added, dt, |k, run, machine, _| {
                    sum += (machine.effects.sensor(run.position) - read) * windows.weights[k];
                });
            done.map_err(|error| error.of_all(work::in_steps(all)))?;
            left = shot.allowance.unwrap_or(left);
            land(window, sum);
        }
        Ok(())
    }
}

/// Effort by which a run is drawn to a motion: that of a spring and a damper.
#[derive(Debug, Clone, Copy)]
pub struct Pull {
    /// Effort per distance.
    pub stiffness: f64,
    /// Effort per difference of velocities.
    pub damping: f64,
}

impl Running<f64> {
    /// Simulates once, drawn to a measured motion; reports the reading after each sample and the
    /// effort of the pull during it. With that effort among the loads the run needs no pull: a
    /// motion near the measured one that this machine has made, and what acted meanwhile.
    pub fn accompany(
        &mut self,
        motion: &MeasuredMotion<'_>,
        pull: Pull,
        mut row: impl FnMut(usize, f64, f64),
    ) -> Result<()> {
        let MeasuredMotion { positions, inputs, around, dt, .. } = *motion;
        let sensor = self.machine.effects.clone();
        let actual = |reading: f64| sensor.behind(reading);
        let actual: Option<&dyn Fn(f64) -> f64> =
            if sensor.misreads() { Some(&actual) } else { None };
        let mut meter = Meter::new(work::allowed(motion.samples()));
        let phase = self.longest.phase.max(self.phase_of_samples(dt.greatest()));
        self.longest = Longest::close(phase);
        for k in 0..motion.samples() {
            let track = Track::new(positions, actual, k);
            let behind = track.position() - self.run.position;
            let slower = track.velocity(&dt) - self.run.velocity;
            let effort = pull.stiffness * behind + pull.damping * slower;
            self.run.transmitted = around.transmitted_at(k);
            self.run.temperature = around.temperature_at(k);
            self.run.enabled = around.enabled_at(k);
            self.step_within(inputs.at(k), around.load.at(k) + effort, dt.at(k), &mut meter)?;
            row(k, self.machine.effects.sensor(self.run.position), effort);
        }
        Ok(())
    }
}

/// Rows of `windows` numbers, one for each of some derivatives: all windows of the first, then all
/// of the next.
fn rows(number: usize, windows: usize) -> Vec<f64> {
    vec![0.0; number * windows]
}

/// Equal parts of a window, of which `number` from the `first` on have a derivative each by an effort
/// that acts during them.
struct Parts {
    length: usize,
    last: usize,
    first: usize,
    number: usize,
}

impl Parts {
    const NONE: Self = Self { length: 1, last: 0, first: 0, number: 0 };

    /// The effort of each sample: one function whatever is asked, for a loop is compiled for each.
    fn effort(self) -> impl Fn(usize) -> Dual {
        let Self { length, last, first, number } = self;
        move |sample| match (sample / length).min(last).checked_sub(first) {
            Some(column) if column < number => Dual::variable(0.0, column),
            _ => Dual::constant(0.0),
        }
    }
}

/// The sums of all windows, differentiated by the parameters at these paths.
pub fn shoot_sensitivity(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    windows: &Windows<'_>,
    paths: &[String],
) -> Result<Vec<f64>> {
    let width = windows.number(motion.samples());
    let mut result = rows(paths.len(), width);
    passes(spec, start, paths, |running, first, number| {
        running.shoot(motion, windows, Parts::NONE.effort(), &mut |window, sum| {
            for column in 0..number {
                result[(first + column) * width + window] = sum.partial(column);
            }
        })
    })?;
    Ok(result)
}

/// The sums of all windows, differentiated by an effort along +x that acts during one part of each
/// window, for every of so many equal parts (the last one takes the rest): all windows of the first
/// part, then all of the next.
pub fn shoot_response(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    windows: &Windows<'_>,
    parts: usize,
) -> Result<Vec<f64>> {
    let width = windows.number(motion.samples());
    let parts = parts.clamp(1, windows.weights.len().max(1));
    let length = (windows.weights.len() / parts).max(1);
    let values: Vec<f64> = spec.parameters().into_iter().map(|(_, value)| value).collect();
    let mut result = rows(parts, width);
    for first in (0..parts).step_by(COLUMNS) {
        let number = COLUMNS.min(parts - first);
        let mut running = seeded(spec, start, &values, &[]);
        let added = Parts { length, last: parts - 1, first, number }.effort();
        let shot = running.shoot(motion, windows, added, &mut |window, sum| {
            for column in 0..number {
                result[(first + column) * width + window] = sum.partial(column);
            }
        });
        shot.map_err(|error| spec.blame(error))?;
    }
    Ok(result)
}

/// Refuses windows that are no windows.
pub fn check(windows: &Windows<'_>) -> Result<()> {
    if windows.weights.is_empty() {
        return Err(Error::Length { name: "weights".to_owned(), given: 0, wanted: 1 });
    }
    if windows.stride == 0 {
        return Err(Error::OutOfBounds {
            name: "stride".to_owned(),
            given: 0.0,
            lower: 1.0,
            upper: f64::INFINITY,
            unit: " samples".to_owned(),
        });
    }
    Ok(())
}
