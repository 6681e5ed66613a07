//! Exact derivatives by parameters: the same simulation over dual numbers.

use std::sync::{Mutex, PoisonError};

use crate::effects::EffectRecord;
use crate::error::{Error, Result};
use crate::motor::{EffectSpec, MotorSpec, PerSample, Running};
use crate::scalar::{COLUMNS, Dual, Scalar};

/// Derivatives of position and velocity at the end of every sample.
#[derive(Debug, Clone)]
pub struct Sensitivity {
    /// ∂position/∂parameter, one vector of samples for each parameter asked for.
    pub position: Vec<Vec<f64>>,
    /// ∂velocity/∂parameter, likewise.
    pub velocity: Vec<Vec<f64>>,
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
fn seeded(
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
fn passes(
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
    load: PerSample<'_>,
    dt: PerSample<'_>,
    paths: &[String],
) -> Result<Sensitivity> {
    let columns = || vec![vec![0.0; inputs.len()]; paths.len()];
    let mut result = Sensitivity { position: columns(), velocity: columns() };
    passes(spec, start.into(), paths, |running, first, number| {
        running.simulate(inputs, load, dt, |k, run, _, _| {
            for column in 0..number {
                result.position[first + column][k] = Scalar::partial(run.position, column);
                result.velocity[first + column][k] = Scalar::partial(run.velocity, column);
            }
        })
    })?;
    Ok(result)
}

/// Derivatives of the efforts along given positions.
#[derive(Debug, Clone)]
pub struct EffortSensitivity {
    /// ∂(friction − gravity and added efforts)/∂parameter: all samples of the first, then all of
    /// the next.
    pub needed: Vec<f64>,
    /// ∂(effort of the drive)/∂parameter, likewise.
    pub driven: Vec<f64>,
}

/// A motion that was measured or prescribed, and what acted meanwhile.
#[derive(Debug, Clone, Copy)]
pub struct MeasuredMotion<'a> {
    /// Positions, one more than there are samples.
    pub positions: &'a [f64],
    /// Inputs.
    pub inputs: PerSample<'a>,
    /// External efforts.
    pub load: PerSample<'a>,
    /// Durations.
    pub dt: PerSample<'a>,
}

impl EffortSensitivity {
    fn zeros(parameters: usize, motion: &MeasuredMotion<'_>) -> Self {
        let size = parameters * motion.samples();
        Self { needed: vec![0.0; size], driven: vec![0.0; size] }
    }

    /// The rows of each pass, one after the other.
    fn passes(
        &mut self,
        motion: &MeasuredMotion<'_>,
    ) -> impl Iterator<Item = (&mut [f64], &mut [f64])> {
        let size = (COLUMNS * motion.samples()).max(1);
        self.needed.chunks_mut(size).zip(self.driven.chunks_mut(size))
    }
}

impl MeasuredMotion<'_> {
    fn samples(&self) -> usize {
        self.positions.len().saturating_sub(1)
    }

    /// Follows the motion and fills the rows of a pass.
    fn differentiate(
        &self,
        running: &mut Running<Dual>,
        (needed, driven): (&mut [f64], &mut [f64]),
    ) {
        let (samples, columns) = (self.samples(), needed.len() / self.samples().max(1));
        running.follow(self.positions, self.inputs, self.load, self.dt, |k, efforts| {
            let short = efforts.friction - efforts.ambient;
            for column in 0..columns {
                needed[column * samples + k] = Scalar::partial(short, column);
                driven[column * samples + k] = Scalar::partial(efforts.driven, column);
            }
        });
    }
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
    let mut rows = result.passes(motion);
    passes(spec, start, paths, |running, _, _| {
        if let Some(rows) = rows.next() {
            motion.differentiate(running, rows);
        }
        Ok(())
    })?;
    drop(rows);
    Ok(result)
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
    let gains = |effect: &'static EffectRecord| {
        let place = |gain: &&str| effect.parameters.iter().position(|p| p.name == *gain);
        effect.facts.gains.iter().filter_map(place)
    };
    let rows: Vec<(usize, usize)> = candidates
        .iter()
        .enumerate()
        .flat_map(|(index, candidate)| gains(candidate.record).map(move |gain| (index, gain)))
        .collect();
    let mut result = EffortSensitivity::zeros(rows.len(), motion);
    let work = Mutex::new(rows.chunks(COLUMNS).zip(result.passes(motion)));
    let next = || work.lock().unwrap_or_else(PoisonError::into_inner).next();
    let passes = || {
        while let Some((pass, rows)) = next() {
            let mut running = with_candidates(spec, start, candidates, pass);
            motion.differentiate(&mut running, rows);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(passes);
        }
        passes();
    });
    drop(work);
    result
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
