//! Exact derivatives by parameters: the same simulation over dual numbers.

use std::sync::{Mutex, PoisonError};

use crate::effects::{AnyEffect, EffectRecord, Effects, Hook, Passage, Situation};
use crate::error::{Error, Result};
use crate::integrate::{Machine, Run};
use crate::kernel::RowKernel;
use crate::motor::{EffectSpec, MotorSpec, PerSample, Rows, Running, Surroundings};
use crate::scalar::{COLUMNS, Dual, Scalar};
use crate::traces::{Stretch, Traces, put};

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
    position: &'a mut [f64],
    velocity: &'a mut [f64],
    samples: usize,
}

impl Rows<Dual> for Slopes<'_> {
    #[inline(always)]
    fn looks(&self) -> bool {
        false
    }

    #[inline(always)] // where it is called, the motion is in registers
    fn see(&mut self, k: usize, run: &Run<Dual>, _: &Machine<Dual>, _: impl Fn(usize) -> Dual) {
        put(self.position, self.samples, k, run.position.slopes());
        put(self.velocity, self.samples, k, run.velocity.slopes());
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
}

impl<'a> From<&'a Running<f64>> for Start<'a> {
    fn from(running: &'a Running<f64>) -> Self {
        Self { running, primed: None }
    }
}

/// The motor with the parameters at these places seeded, start values behind the others.
pub(crate) fn seeded(
    spec: &MotorSpec,
    start: Start<'_>,
    parameters: &[f64],
    places: &[usize],
) -> Running<Dual> {
    let all = parameters.iter().chain(start.primed.into_iter().flatten());
    let mut values: Vec<Dual> = all.map(|value| Dual::constant(*value)).collect();
    for (column, place) in places.iter().enumerate() {
        values[*place] = Dual::variable(values[*place].re(), column);
    }
    let (values, primed) = values.split_at(parameters.len());
    let mut running = Running::new(spec, values);
    running.resume(start.running);
    if start.primed.is_some() {
        running.state = running.law.primed(primed);
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
    if start.primed.is_some() {
        known.extend(spec.friction.record.start.iter().map(|own| format!("start.{}", own.name)));
    }
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
        visit(&mut running, pass * COLUMNS, places.len())?;
    }
    Ok(())
}

/// Simulates from the state of a motor, which depends on no parameter, and differentiates by the parameters at these paths.
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
    sensitivity_into(spec, start, inputs, around, dt, paths, rows)?;
    Ok(result)
}

/// The same, into rows laid out as those of [`Sensitivity`]: of position, and of velocity.
pub fn sensitivity_into(
    spec: &MotorSpec,
    start: &Running<f64>,
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
    passes(spec, start.into(), paths, |running, first, number| {
        let own = first * samples..(first + number) * samples;
        let (position, velocity) = (&mut position[own.clone()], &mut velocity[own]);
        let slopes = Slopes { position, velocity, samples };
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

/// A motion that was measured or prescribed, and what acted meanwhile.
#[derive(Debug, Clone, Copy)]
pub struct MeasuredMotion<'a> {
    /// Positions, one more than there are samples.
    pub positions: &'a [f64],
    /// Inputs.
    pub inputs: PerSample<'a>,
    /// What acts beside them.
    pub around: Surroundings<'a>,
    /// Durations.
    pub dt: PerSample<'a>,
    /// Whether friction of a rigid contact is its mean about each stamp (see
    /// [`Running::follow_about`]), not its value there.
    pub averaged: bool,
}

impl EffortSensitivity {
    fn zeros(parameters: usize, motion: &MeasuredMotion<'_>) -> Self {
        let zeros = || vec![0.0; parameters * motion.samples()];
        Self { needed: zeros(), driven: zeros(), ahead: zeros() }
    }

    /// Each row of its own.
    fn rows(&mut self, motion: &MeasuredMotion<'_>) -> Vec<[&mut [f64]; 3]> {
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
    /// Samples between the positions.
    pub fn samples(&self) -> usize {
        self.positions.len().saturating_sub(1)
    }

    /// Follows the motion and hands over the traces of a pass, stretch by stretch.
    fn differentiate(
        &self,
        running: &mut Running<Dual>,
        traces: &mut Traces,
        take: impl FnMut(usize, usize, Stretch<'_>),
    ) {
        let mut traces = traces.to(take);
        running.follow_about(self, |k, efforts| {
            let short = efforts.friction - efforts.ambient;
            traces.put(k, [&short, &efforts.driven, &efforts.ahead]);
        });
        traces.hand_over();
    }
}

/// Where the traces of a parameter go.
trait Target: Send {
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
struct Column<'a> {
    kernel: &'a RowKernel<'a>,
    values: &'a mut [f64],
    /// How many of them are there.
    done: usize,
}

impl Target for Column<'_> {
    fn take(&mut self, begin: usize, traces: Stretch<'_>) {
        let places = self.kernel.rows(begin + traces[0].len()).min(self.values.len());
        if places <= self.done {
            return;
        }
        let from = self.done * self.kernel.every - begin;
        let values = &mut self.values[self.done..places];
        self.kernel.column(traces.map(|trace| &trace[from..]), values);
        self.done = places;
    }
}

/// Columns of this many parameters, one after the other, and the targets that fill them.
fn columns<'a>(
    values: &'a mut [f64],
    motion: &MeasuredMotion<'_>,
    kernel: &'a RowKernel<'a>,
) -> Vec<Column<'a>> {
    let rows = kernel.rows(motion.samples()).max(1);
    values.chunks_mut(rows).map(|values| Column { kernel, values, done: 0 }).collect()
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
    let mut targets = columns(&mut values, motion, kernel);
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

/// Follows given positions and differentiates the efforts by every gain of effects that the motor
/// does not have, each at the gain 0 and at its own shape; rows in the order of the candidates and
/// of their gains.
///
/// The effects of a pass are neutral, so none of them sees the others, nor an effect of the same
/// name that the motor has. Passes share nothing: the result is the same for any number of threads.
pub fn signatures(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    candidates: &[EffectSpec],
    threads: usize,
) -> EffortSensitivity {
    let mut result = EffortSensitivity::zeros(gains_of(candidates).len(), motion);
    signatures_into(spec, start, motion, candidates, threads, None, result.rows(motion));
    result
}

/// The same, of measured minus needed effort seen through a kernel: all rows of the first gain,
/// then all of the next.
pub fn signature_columns(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    candidates: &[EffectSpec],
    kernel: &RowKernel<'_>,
    threads: usize,
) -> Vec<f64> {
    let mut values = vec![0.0; gains_of(candidates).len() * kernel.rows(motion.samples())];
    let targets = columns(&mut values, motion, kernel);
    signatures_into(spec, start, motion, candidates, threads, Some(kernel), targets);
    values
}

/// Candidate and place among its parameters of every gain.
fn gains_of(candidates: &[EffectSpec]) -> Vec<(usize, usize)> {
    let gains = |effect: &'static EffectRecord| {
        let place = |gain: &&str| effect.parameters.iter().position(|p| p.name == *gain);
        effect.facts.gains.iter().filter_map(place)
    };
    candidates
        .iter()
        .enumerate()
        .flat_map(|(index, candidate)| gains(candidate.record).map(move |gain| (index, gain)))
        .collect()
}

fn signatures_into(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    candidates: &[EffectSpec],
    threads: usize,
    kernel: Option<&RowKernel<'_>>,
    targets: Vec<impl Target>,
) {
    let (mut direct, mut seeded) = (Vec::new(), Vec::new());
    for (place, target) in gains_of(candidates).into_iter().zip(targets) {
        let list = if acts_at_once(candidates[place.0].record) { &mut direct } else { &mut seeded };
        list.push((place, target));
    }
    if !direct.is_empty() {
        at_once(spec, start, motion, candidates, &mut direct);
    }
    let work = Mutex::new(apart(seeded, candidates).into_iter());
    let next = || work.lock().unwrap_or_else(PoisonError::into_inner).next();
    let passes = || {
        let mut traces = Traces::new(motion.samples(), kernel);
        while let Some(mut pass) = next() {
            let places: Vec<(usize, usize)> = pass.iter().map(|(place, _)| *place).collect();
            let mut running = with_candidates(spec, start, candidates, &places);
            motion.differentiate(&mut running, traces.of(pass.len()), |column, begin, stretch| {
                pass[column].1.take(begin, stretch);
            });
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(passes);
        }
        passes();
    });
}

/// A gain, by candidate and place, and where its traces go.
type Seeded<T> = ((usize, usize), T);

/// Gains dealt to passes: a contact relaxes in one way of a kind at a time, so candidates of one
/// effect that does so must not share a pass.
fn apart<T>(gains: Vec<Seeded<T>>, candidates: &[EffectSpec]) -> Vec<Vec<Seeded<T>>> {
    let alone = |index: usize| candidates[index].record.hooks.contains(&Hook::StateRelaxation);
    let mut passes: Vec<Vec<Seeded<T>>> = Vec::new();
    for gain in gains {
        let index = gain.0.0;
        let bars = |(other, _): &Seeded<T>| {
            let same = candidates[other.0].record.name == candidates[index].record.name;
            alone(index) && same && other.0 != index
        };
        match passes.iter_mut().find(|pass| pass.len() < COLUMNS && !pass.iter().any(bars)) {
            Some(pass) => pass.push(gain),
            None => passes.push(vec![gain]),
        }
    }
    passes
}

/// Whether an effect enters the efforts of a sample through that sample alone.
fn acts_at_once(record: &EffectRecord) -> bool {
    record.hooks.iter().all(|hook| match hook {
        Hook::FrictionLevel | Hook::AddedEffort | Hook::InputMap => true,
        Hook::InputDelay
        | Hook::InputLag
        | Hook::SensorMap
        | Hook::StateRelaxation
        | Hook::SecondMass => false,
    })
}

/// Share of the usual input by which a gain of the input map is moved to see what it does; such maps
/// are made of straight pieces, so any small step gives the derivative.
const SMALL: f64 = 1e-6;

/// What a sample holds for effects that act at once.
struct Sample {
    at: Situation<f64>,
    passage: Passage<f64>,
    /// ∂friction/∂(level of dry, of viscous friction, effort): a contact at rest answers an effort.
    by: [f64; 3],
    command: f64,
    /// ∂(effort of the drive)/∂command.
    gain: f64,
}

/// Traces of effects that act at once: what one unit of a gain adds to level, effort or input, times
/// the derivative by that. One pass carries the derivatives by the levels, whatever the number of
/// gains.
fn at_once(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    candidates: &[EffectSpec],
    targets: &mut [((usize, usize), impl Target)],
) {
    let (samples, rigid) = samples_along(spec, start, motion);
    let mut added = vec![0.0; samples.len()];
    let usual = samples.iter().map(|sample| sample.command.abs()).fold(0.0, f64::max);
    let mut traces = [(); 3].map(|()| vec![0.0; motion.samples()]);
    for ((index, gain), target) in targets {
        let candidate = &candidates[*index];
        let mapped = candidate.record.hooks.contains(&Hook::InputMap);
        let unit = if mapped && usual > 0.0 { SMALL * usual } else { 1.0 };
        let mut own = candidate.values.clone();
        own[*gain] = unit;
        let mut effects = Effects::new(AnyEffect::build(candidate.record.name, &own));
        let [needed, driven, _] = &mut traces;
        for (k, sample) in samples.iter().enumerate() {
            effects.remember(&sample.passage);
            let (dry, viscous) = effects.levels(&sample.at);
            added[k] = effects.effort(&sample.at) / unit;
            let mut moved = 0.0;
            if mapped {
                let input = effects.input(sample.command, &sample.at) - sample.command;
                moved = sample.gain * input / unit;
            }
            let levels = (dry - 1.0) * sample.by[0] + (viscous - 1.0) * sample.by[1];
            needed[k] = levels / unit + (added[k] + moved) * sample.by[2];
            driven[k] = moved;
        }
        if rigid {
            // As `Running::follow_about` has it.
            for k in 1..needed.len() {
                needed[k - 1] = 0.5 * (needed[k - 1] + needed[k]);
            }
        }
        for (needed, added) in needed.iter_mut().zip(&added) {
            *needed -= added;
        }
        target.take(0, traces.each_ref().map(Vec::as_slice));
    }
}

/// The samples, and whether their friction is its mean over each of them.
fn samples_along(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
) -> (Vec<Sample>, bool) {
    let values: Vec<f64> = spec.parameters().into_iter().map(|(_, value)| value).collect();
    let mut running = seeded(spec, start, &values, &[]);
    let seeds = [1.0, 1.0, 0.0];
    let [level, viscous, effort] = std::array::from_fn(|k| Dual::variable(seeds[k], k));
    running.machine.effects.seed(level, viscous, effort);
    let drive = running.machine.drive;
    let mut before = (running.actual(motion.positions[0]), running.run.friction.re());
    let mut samples = Vec::with_capacity(motion.samples());
    let mut rigid = false;
    running.follow(motion, |k, efforts, there| {
        let (friction, at) = (efforts.friction, there.situation());
        rigid = efforts.mean.is_some();
        let mean = efforts.mean.unwrap_or(friction);
        let position = at.position.re();
        let (displacement, span) = (position - before.0, motion.dt.at(k));
        let passage = Passage { displacement, friction: before.1, span };
        before = (position, friction.re());
        let command = there.command().re();
        samples.push(Sample {
            at: Situation {
                position,
                velocity: at.velocity.re(),
                time: at.time.re(),
                path: at.path.re(),
                moved: at.moved.re(),
                load: at.load.re(),
                sliding: at.sliding.re(),
                temperature: at.temperature,
                wound: at.wound.re(),
                enabled: at.enabled,
            },
            passage,
            by: std::array::from_fn(|k| mean.partial(k)),
            command,
            gain: if at.enabled { drive.slope(command, at.velocity.re()) } else { 0.0 },
        });
    });
    (samples, rigid)
}

/// The motor with the candidates of a pass, given as rows of candidate and place of its gain.
fn with_candidates(
    spec: &MotorSpec,
    start: Start<'_>,
    candidates: &[EffectSpec],
    rows: &[(usize, usize)],
) -> Running<Dual> {
    let mut extended = spec.clone();
    let mut places = Vec::with_capacity(rows.len());
    let mut end = spec.parameters().len();
    let (mut added, mut begin) = (None, end);
    for (index, gain) in rows {
        if added != Some(*index) {
            added = Some(*index);
            begin = end;
            end += candidates[*index].values.len();
            extended.effects.push(candidates[*index].clone());
        }
        places.push(begin + gain);
    }
    let values: Vec<f64> = extended.parameters().into_iter().map(|(_, value)| value).collect();
    seeded(&extended, start, &values, &places)
}
