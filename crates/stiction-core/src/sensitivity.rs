//! Exact derivatives by parameters: the same simulation over dual numbers.

use crate::error::{Error, Result};
use crate::motor::{MotorSpec, PerSample, Running};
use crate::scalar::{COLUMNS, Dual, Scalar};

/// Derivatives of position and velocity at the end of every sample.
#[derive(Debug, Clone)]
pub struct Sensitivity {
    /// ∂position/∂parameter, one vector of samples for each parameter asked for.
    pub position: Vec<Vec<f64>>,
    /// ∂velocity/∂parameter, likewise.
    pub velocity: Vec<Vec<f64>>,
}

/// Runs `visit` once for every [`COLUMNS`] of the parameters at these paths, with the motor whose
/// parameters are seeded, the index of the first of them and their number.
fn passes(
    spec: &MotorSpec,
    start: &Running<f64>,
    paths: &[String],
    mut visit: impl FnMut(&mut Running<Dual>, usize, usize) -> Result<()>,
) -> Result<()> {
    let parameters = spec.parameters();
    let wanted = paths
        .iter()
        .map(|path| {
            parameters.iter().position(|(known, _)| known == path).ok_or_else(|| {
                Error::unknown("parameter path", path, parameters.iter().map(|(p, _)| p.as_str()))
            })
        })
        .collect::<Result<Vec<usize>>>()?;
    for (pass, seeded) in wanted.chunks(COLUMNS).enumerate() {
        let values: Vec<Dual> = parameters
            .iter()
            .enumerate()
            .map(|(index, (_, value))| match seeded.iter().position(|own| *own == index) {
                Some(column) => Dual::variable(*value, column),
                None => Dual::constant(*value),
            })
            .collect();
        let mut running = Running::new(spec, &values);
        running.resume(start);
        visit(&mut running, pass * COLUMNS, seeded.len())?;
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
    passes(spec, start, paths, |running, first, number| {
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
    /// ∂(friction − gravity and added efforts)/∂parameter, one vector of samples for each.
    pub needed: Vec<Vec<f64>>,
    /// ∂(effort of the drive)/∂parameter, likewise.
    pub driven: Vec<Vec<f64>>,
}

/// Follows given positions and differentiates the efforts by the parameters at these paths: all of
/// an effort residual but its inertia term.
pub fn follow_sensitivity(
    spec: &MotorSpec,
    start: &Running<f64>,
    positions: &[f64],
    inputs: PerSample<'_>,
    load: PerSample<'_>,
    dt: PerSample<'_>,
    paths: &[String],
) -> Result<EffortSensitivity> {
    let columns = || vec![vec![0.0; positions.len().saturating_sub(1)]; paths.len()];
    let mut result = EffortSensitivity { needed: columns(), driven: columns() };
    passes(spec, start, paths, |running, first, number| {
        running.follow(positions, inputs, load, dt, |k, efforts| {
            let needed = efforts.friction - efforts.ambient;
            for column in 0..number {
                result.needed[first + column][k] = Scalar::partial(needed, column);
                result.driven[first + column][k] = Scalar::partial(efforts.driven, column);
            }
        });
        Ok(())
    })?;
    Ok(result)
}
