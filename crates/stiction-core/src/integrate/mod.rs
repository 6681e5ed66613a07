//! Integrators: how a machine and its friction get from one sample to the next.
//!
//! A step is attempted as a whole. Where the law reports that it ran past a change of contact
//! mode, the change is located inside the step, the step is shortened to it, and the rest is
//! attempted in the new mode. Held velocities, the fast integrator and the reference integrator
//! all go through the same loop.

mod contact;
mod events;
mod fast;
mod machine;
mod reference;

pub use contact::{Along, Held};
pub use events::{Stepper, quiet, through_events};
pub use machine::{Machine, Run};

use crate::friction::FrictionLaw;
use crate::scalar::Scalar;

/// Which integrator advances the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Integrator {
    /// Velocity Verlet with trapezoidal damping: one friction evaluation a step, second order.
    #[default]
    Fast,
    /// Classical Runge-Kutta of fourth order on all internal variables.
    Reference,
}

/// ω·h above which the fast integrator divides a sample: the phase error of its ring is then
/// (ω·h)²/24 ≤ 2e-4 of the phase.
const LONGEST_PHASE: f64 = 0.065;
/// (C/J)·h above which a sample is divided.
const LONGEST_DAMPING: f64 = 0.25;
/// A step divided further than this is a mistake in the units, not a stiff machine.
const MOST_SUBSTEPS: f64 = 1e5;

/// Number of equal steps that a sample of this duration is divided into.
pub fn substeps<S: Scalar, L: FrictionLaw<S>>(machine: &Machine<S>, law: &L, dt: f64) -> u32 {
    let lightest = machine.lightest_inertia();
    let stiffness = law.greatest_stiffness() + machine.greatest_stiffness();
    let phase = dt * (stiffness / lightest).sqrt() / LONGEST_PHASE;
    let damping = dt * law.greatest_damping() / lightest / LONGEST_DAMPING;
    phase.max(damping).ceil().clamp(1.0, MOST_SUBSTEPS) as u32
}

/// Advances body and friction by one sample whose input and load are held.
#[inline]
#[allow(clippy::too_many_arguments)] // the parts of a motor, borrowed apart
pub fn sample<S: Scalar, L: FrictionLaw<S>>(
    machine: &Machine<S>,
    law: &L,
    state: &mut L::State,
    run: &mut Run<S>,
    input: S,
    load: S,
    dt: f64,
    substeps: u32,
    integrator: Integrator,
) {
    let span = S::constant(dt / f64::from(substeps));
    match integrator {
        Integrator::Fast => {
            let mut stepper = fast::Fast { machine, run, input, load };
            for _ in 0..substeps {
                through_events(&mut stepper, law, state, span);
            }
        }
        Integrator::Reference => {
            let mut stepper = reference::Reference { machine, run, input, load };
            for _ in 0..substeps {
                through_events(&mut stepper, law, state, span);
            }
        }
    }
}
