//! Exact derivatives of a trajectory by parameters: the same simulation over dual numbers.

use crate::error::{Error, Result};
use crate::friction::AnyState;
use crate::integrate::Run;
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

/// Simulates from a given state and differentiates by the parameters at these paths.
pub fn sensitivity(
    spec: &MotorSpec,
    start: (&Run<f64>, &AnyState<f64>),
    inputs: &[f64],
    load: PerSample<'_>,
    dt: PerSample<'_>,
    paths: &[String],
) -> Result<Sensitivity> {
    let parameters = spec.parameters();
    let wanted = paths
        .iter()
        .map(|path| {
            parameters.iter().position(|(known, _)| known == path).ok_or_else(|| {
                Error::unknown("parameter path", path, parameters.iter().map(|(p, _)| p.as_str()))
            })
        })
        .collect::<Result<Vec<usize>>>()?;
    let columns = || vec![vec![0.0; inputs.len()]; paths.len()];
    let mut result = Sensitivity { position: columns(), velocity: columns() };
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
        running.state = start.1.lift();
        running.run = start.0.lift();
        running.machine.refresh(&mut running.run);
        running.simulate(inputs, load, dt, |k, run, _, _| {
            for column in 0..seeded.len() {
                let target = pass * COLUMNS + column;
                result.position[target][k] = Scalar::partial(run.position, column);
                result.velocity[target][k] = Scalar::partial(run.velocity, column);
            }
        })?;
    }
    Ok(result)
}
