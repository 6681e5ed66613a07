//! Exact derivatives by parameters: the same simulation over dual numbers.

use crate::inverse::follow::{Efforts, SeesAbout};
use crate::inverse::kernel::RowKernel;
use crate::inverse::traces::{Filling, ONCE, Stretch, Traces, put_all};
use crate::math::scalar::{COLUMNS, Dual, Scalar};
use crate::plant::{Budget, Machine, Run};
use crate::simulate::motor::{MotorSpec, Rows, Running};
use crate::support::error::{Error, Result};
pub use crate::support::motion::MeasuredMotion;
use crate::support::samples::{PerSample, Surroundings};

/// Derivatives of position and velocity at the end of every sample.
#[derive(Debug, Clone)]
pub struct Sensitivity {
    /// ∂position/∂parameter: all samples of the first parameter asked for, then all of the next.
    pub position: Vec<f64>,
    /// ∂velocity/∂parameter, likewise.
    pub velocity: Vec<f64>,
}

/// Where the derivatives of a pass go.
struct Slopes<'a> {
    /// Rows of position and velocity.
    rows: [Vec<&'a mut [f64]>; 2],
    /// What is not in them yet.
    held: [[[f64; COLUMNS]; ONCE]; 2],
    samples: usize,
}

impl Slopes<'_> {
    /// Puts what stands for so many samples up to this one into the rows: a function of its own, for
    /// which the loop puts off what it has in registers once in [`ONCE`] samples.
    #[inline(never)]
    fn put(&mut self, k: usize, number: usize) {
        for (rows, held) in self.rows.iter_mut().zip(&self.held) {
            put_all(rows, k + 1 - number, &held[..number]);
        }
    }
}

impl Rows<Dual> for Slopes<'_> {
    #[inline(always)]
    fn looks(&self) -> bool {
        false
    }

    #[inline(always)] // where it is called, the motion is in registers
    fn see(&mut self, k: usize, run: &Run<Dual>, _: &Machine<Dual>, _: impl Fn(usize) -> Dual) {
        let place = k % ONCE;
        self.held[0][place] = *run.position.slopes();
        self.held[1][place] = *run.velocity.slopes();
        if place + 1 == ONCE || k + 1 == self.samples {
            self.put(k, place + 1);
        }
    }
}

/// The state from which a differentiated run starts.
#[derive(Debug, Clone, Copy)]
pub struct Start<'a> {
    /// That of this motor, which depends on no parameter …
    pub running: &'a Running<f64>,
    /// … but for its friction where start values of the law are given: that depends on them and on
    /// the parameters of the law.
    pub primed: Option<&'a [f64]>,
    /// Whether position and velocity, `start.position` and `start.velocity`, are among them: a
    /// measured motion has its own.
    pub free: bool,
}

/// Names of what a run that follows nothing starts with, beside its friction.
const BODY: [&str; 2] = ["position", "velocity"];

impl Start<'_> {
    /// Names of all start values that it can be differentiated by.
    fn names(self, spec: &MotorSpec) -> impl Iterator<Item = String> {
        let own = if self.primed.is_some() { spec.friction.record.start } else { &[] };
        let body = if self.free { &BODY[..] } else { &[] };
        own.iter()
            .map(|own| own.name)
            .chain(body.iter().copied())
            .map(|name| format!("start.{name}"))
    }

    /// Their values.
    fn values(self) -> impl Iterator<Item = f64> {
        let run = &self.running.run;
        let body = [run.position, run.velocity].into_iter().take(if self.free { 2 } else { 0 });
        self.primed.unwrap_or_default().iter().copied().chain(body)
    }
}

impl<'a> From<&'a Running<f64>> for Start<'a> {
    fn from(running: &'a Running<f64>) -> Self {
        Self { running, primed: None, free: false }
    }
}

/// The motor with the parameters at these places seeded, start values behind the others.
pub(crate) fn seeded(
    spec: &MotorSpec,
    start: Start<'_>,
    parameters: &[f64],
    places: &[usize],
) -> Running<Dual> {
    let all = parameters.iter().copied().chain(start.values());
    let mut values: Vec<Dual> = all.map(Dual::constant).collect();
    for (column, place) in places.iter().enumerate() {
        values[*place] = Dual::variable(values[*place].re(), column);
    }
    let (values, rest) = values.split_at(parameters.len());
    let (primed, body) = rest.split_at(start.primed.map_or(0, <[f64]>::len));
    let mut running = Running::new(spec, values);
    running.resume(start.running);
    if start.primed.is_some() {
        running.state = running.law.primed(primed);
    }
    if let [position, velocity] = body {
        let run = &mut running.run;
        if start.primed.is_some() {
            run.budget = Budget::unknown();
        }
        run.position = *position;
        run.velocity = *velocity;
        // The whole machine stands elsewhere, or moves faster: a second mass with it.
        run.second_position += *position - position.re();
        run.second_velocity += *velocity - velocity.re();
        running.machine.refresh(run);
    }
    running
}

/// Runs `visit` once for every [`COLUMNS`] of the parameters at these paths, with the motor whose
/// parameters are seeded, the index of the first of them and their number.
pub(crate) fn passes(
    spec: &MotorSpec,
    start: Start<'_>,
    paths: &[String],
    mut visit: impl FnMut(&mut Running<Dual>, usize, usize) -> Result<()>,
) -> Result<()> {
    let (mut known, values): (Vec<String>, Vec<f64>) = spec.parameters().into_iter().unzip();
    known.extend(start.names(spec));
    let wanted = paths
        .iter()
        .map(|path| {
            known.iter().position(|other| other == path).ok_or_else(|| {
                if start.primed.is_none() && path.starts_with("start.") {
                    return Error::NoStart { path: path.clone() };
                }
                Error::unknown("parameter path", path, known.iter().map(String::as_str))
            })
        })
        .collect::<Result<Vec<usize>>>()?;
    for (pass, places) in wanted.chunks(COLUMNS).enumerate() {
        let mut running = seeded(spec, start, &values, places);
        visit(&mut running, pass * COLUMNS, places.len()).map_err(|error| spec.blame(error))?;
    }
    Ok(())
}

/// Simulates from the state of a motor and differentiates by the parameters at these paths, and by
/// position and velocity at the start: `start.position`, `start.velocity`.
pub fn sensitivity(
    spec: &MotorSpec,
    start: &Running<f64>,
    inputs: &[f64],
    around: Surroundings<'_>,
    dt: PerSample<'_>,
    paths: &[String],
) -> Result<Sensitivity> {
    let zeros = || vec![0.0; paths.len() * inputs.len()];
    let mut result = Sensitivity { position: zeros(), velocity: zeros() };
    let rows = [&mut *result.position, &mut *result.velocity];
    sensitivity_into(spec, start.into(), inputs, around, dt, paths, rows)?;
    Ok(result)
}

/// The same, into rows laid out as those of [`Sensitivity`]: of position, and of velocity.
pub fn sensitivity_into(
    spec: &MotorSpec,
    start: Start<'_>,
    inputs: &[f64],
    around: Surroundings<'_>,
    dt: PerSample<'_>,
    paths: &[String],
    [position, velocity]: [&mut [f64]; 2],
) -> Result<()> {
    let samples = inputs.len();
    for rows in [&*position, &*velocity] {
        let (given, wanted) = (rows.len(), paths.len() * samples);
        if given != wanted {
            return Err(Error::Length { name: "out".to_owned(), given, wanted });
        }
    }
    let start = Start { free: true, ..start };
    passes(spec, start, paths, |running, first, number| {
        let own = first * samples..(first + number) * samples;
        let (position, velocity) = (&mut position[own.clone()], &mut velocity[own]);
        let rows = [position, velocity].map(|rows| rows.chunks_mut(samples.max(1)).collect());
        let slopes = Slopes { rows, held: [[[0.0; COLUMNS]; ONCE]; 2], samples };
        running.simulate_rows(inputs, around, |_| Dual::constant(0.0), dt, slopes)
    })
}

/// Derivatives of the efforts along given positions.
#[derive(Debug, Clone)]
pub struct EffortSensitivity {
    /// ∂(friction − gravity and added efforts)/∂parameter: all samples of the first, then all of
    /// the next.
    pub needed: Vec<f64>,
    /// ∂(effort of the drive)/∂parameter, likewise.
    pub driven: Vec<f64>,
    /// ∂(centre of mass ahead of the reading)/∂parameter, likewise.
    pub ahead: Vec<f64>,
}

impl EffortSensitivity {
    pub(crate) fn zeros(parameters: usize, motion: &MeasuredMotion<'_>) -> Self {
        let zeros = || vec![0.0; parameters * motion.samples()];
        Self { needed: zeros(), driven: zeros(), ahead: zeros() }
    }

    /// Each row of its own.
    pub(crate) fn rows(&mut self, motion: &MeasuredMotion<'_>) -> Vec<[&mut [f64]; 3]> {
        let size = motion.samples().max(1);
        let (driven, ahead) = (self.driven.chunks_mut(size), self.ahead.chunks_mut(size));
        let both = driven.zip(ahead);
        self.needed
            .chunks_mut(size)
            .zip(both)
            .map(|(needed, (driven, ahead))| [needed, driven, ahead])
            .collect()
    }
}

impl MeasuredMotion<'_> {
    /// Follows the motion and hands over the traces of a pass, stretch by stretch.
    pub(crate) fn differentiate(
        &self,
        running: &mut Running<Dual>,
        traces: &mut Traces,
        mut take: impl FnMut(usize, usize, Stretch<'_>),
    ) {
        let mut traces = traces.to(&mut take);
        running.follow_about(self, &mut traces);
        traces.hand_over();
    }
}

impl SeesAbout<Dual> for Filling<'_> {
    #[inline(always)]
    fn see(&mut self, k: usize, efforts: &Efforts<Dual>) {
        let short = efforts.friction - efforts.ambient;
        self.put(k, [&short, &efforts.driven, &efforts.ahead]);
    }
}

/// Where the traces of a parameter go.
pub(crate) trait Target: Send {
    /// Takes those of some samples, the first of which is the `begin`-th.
    fn take(&mut self, begin: usize, traces: Stretch<'_>);
}

impl Target for [&mut [f64]; 3] {
    fn take(&mut self, begin: usize, traces: Stretch<'_>) {
        for (row, trace) in self.iter_mut().zip(traces) {
            row[begin..begin + trace.len()].copy_from_slice(trace);
        }
    }
}

/// A column of rows seen through a kernel.
pub(crate) struct Column<'a> {
    kernel: &'a RowKernel<'a>,
    /// The places that are wanted, in their order; all without it.
    kept: Option<&'a [usize]>,
    values: &'a mut [f64],
    /// How many places there are, and how many of them were passed.
    places: usize,
    done: usize,
}

impl Target for Column<'_> {
    fn take(&mut self, begin: usize, traces: Stretch<'_>) {
        let places = self.kernel.rows(begin + traces[0].len()).min(self.places);
        if places <= self.done {
            return;
        }
        let from = self.done * self.kernel.every - begin;
        let left = traces.map(|trace| trace.get(from..).unwrap_or_default());
        match self.kept {
            None => self.kernel.column(left, &mut self.values[self.done..places]),
            Some(kept) => {
                let own = [self.done, places].map(|end| kept.partition_point(|place| *place < end));
                let wanted = kept[own[0]..own[1]].iter().map(|place| place - self.done);
                self.kernel.column_of(left, wanted, &mut self.values[own[0]..own[1]]);
            }
        }
        self.done = places;
    }
}

/// So many columns, one after the other, of these places or of all, and the targets that fill them; of a
/// motion of too few samples for a kernel they are empty.
pub(crate) fn columns<'a>(
    values: &'a mut [f64],
    number: usize,
    kernel: &'a RowKernel<'a>,
    samples: usize,
    kept: Option<&'a [usize]>,
) -> Vec<Column<'a>> {
    let rows = values.len() / number.max(1);
    let places = kernel.rows(samples);
    let mut left = values;
    let mut next = || {
        let own;
        (own, left) = std::mem::take(&mut left).split_at_mut(rows);
        Column { kernel, kept, values: own, places, done: 0 }
    };
    (0..number).map(|_| next()).collect()
}

/// Follows given positions and differentiates the efforts by the parameters at these paths: all of
/// an effort residual but its inertia term.
pub fn follow_sensitivity(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    paths: &[String],
) -> Result<EffortSensitivity> {
    let mut result = EffortSensitivity::zeros(paths.len(), motion);
    follow_into(spec, start, motion, paths, None, &mut result.rows(motion))?;
    Ok(result)
}

/// The same, of measured minus needed effort seen through a kernel: all rows of the first
/// parameter, then all of the next.
pub fn follow_columns(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    paths: &[String],
    kernel: &RowKernel<'_>,
) -> Result<Vec<f64>> {
    let mut values = vec![0.0; paths.len() * kernel.rows(motion.samples())];
    let mut targets = columns(&mut values, paths.len(), kernel, motion.samples(), None);
    follow_into(spec, start, motion, paths, Some(kernel), &mut targets)?;
    Ok(values)
}

fn follow_into(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    paths: &[String],
    kernel: Option<&RowKernel<'_>>,
    targets: &mut [impl Target],
) -> Result<()> {
    let mut traces = Traces::new(motion.samples(), kernel);
    passes(spec, start, paths, |running, first, number| {
        let own = &mut targets[first..first + number];
        motion.differentiate(running, traces.of(number), |column, begin, stretch| {
            own[column].take(begin, stretch);
        });
        Ok(())
    })
}
