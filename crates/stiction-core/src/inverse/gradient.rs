//! Exact derivatives of a weighted motion by what acts in each of its samples.

use crate::inverse::sensitivity::seeded;
use crate::math::scalar::{COLUMNS, Dual, Scalar};
use crate::simulate::motor::{MotorSpec, Running};
use crate::support::error::{Error, Result};
use crate::support::interrupt;
use crate::support::samples::{PerSample, Surroundings};
use crate::support::work::{self, Meter};

/// What of a sample is differentiated by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acting {
    /// The input of the drive; of a servo its goal.
    Input,
    /// The external effort.
    Load,
}

/// What a motion is summed up with.
#[derive(Debug, Clone, Copy)]
pub struct Weighted<'a> {
    /// Of the positions after the samples.
    pub position: &'a [f64],
    /// Of the velocities.
    pub velocity: &'a [f64],
}

/// Derivatives of Σ position·x + velocity·v by the input, or the load, of every sample.
///
/// Each [`COLUMNS`] of them take a run over dual numbers, from the first of their samples on: the
/// cost grows with the square of their number.
pub fn gradient(
    spec: &MotorSpec,
    start: &Running<f64>,
    inputs: &[f64],
    around: Surroundings<'_>,
    dt: PerSample<'_>,
    weights: Weighted<'_>,
    by: Acting,
) -> Result<Vec<f64>> {
    let samples = inputs.len();
    around.check(samples)?;
    dt.check("dt", samples)?;
    for (name, own) in [("position", weights.position), ("velocity", weights.velocity)] {
        if own.len() != samples {
            let (name, given) = (name.to_owned(), own.len());
            return Err(Error::Length { name, given, wanted: samples });
        }
    }
    let values: Vec<f64> = spec.parameters().into_iter().map(|(_, value)| value).collect();
    let mut standing = start.clone();
    let mut found = vec![0.0; samples];
    // All runs together may cost what a simulation may, and beside that a step for each of their samples.
    let runs = samples.div_ceil(COLUMNS) as f64;
    let steps = runs * samples as f64 * (work::STEP * work::DERIVATIVES) as f64;
    let mut meter = Meter::new(work::allowed(samples) + 0.5 * steps);
    for first in (0..samples).step_by(COLUMNS) {
        interrupt::check()?;
        let mut running = seeded(spec, (&standing).into(), &values, &[]);
        let mut sum = Dual::constant(0.0);
        for (k, input) in inputs.iter().enumerate().skip(first) {
            let seed = (k < first + COLUMNS).then(|| Dual::variable(0.0, k - first));
            let more = match by {
                Acting::Input => [seed, None],
                Acting::Load => [None, seed],
            };
            running.surround(&around, k);
            let acting = (*input, around.load.at(k));
            let stepped = running.step_moved(acting, more, dt.at(k), &mut meter);
            stepped.map_err(|error| spec.blame(error))?;
            sum += running.run.position * weights.position[k];
            sum += running.run.velocity * weights.velocity[k];
        }
        let last = samples.min(first + COLUMNS);
        for (column, k) in (first..last).enumerate() {
            found[k] = sum.partial(column);
            standing.surround(&around, k);
            let load = around.load.at(k);
            let stepped = standing.step_within(inputs[k], load, dt.at(k), &mut meter);
            stepped.map_err(|error| spec.blame(error))?;
        }
    }
    Ok(match (by, &start.way) {
        (Acting::Input, Some(way)) => {
            let spans: Vec<f64> = (0..samples).map(|k| dt.at(k)).collect();
            way.carry_back(found, &spans)
        }
        _ => found,
    })
}
