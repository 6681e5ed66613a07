//! What a contact may give back: no more than it has taken in.
//!
//! A law is passive at constant levels. Levels that change multiply what its springs hold, and a spring
//! that was loaded at a low level and let go at a high one gives back what nobody put in. A step that
//! runs past a steep change of a level does so as well. So whatever effects do to a contact, its work is
//! counted, and where it would have given back more than it took, the body arrives that much slower. This
//! is the passivity controller of Hannaford and Ryu, IEEE Trans. Robot. Autom. 18 (2002) 1-10.

use super::machine::Machine;
use super::run::Run;
use crate::math::scalar::{Scalar, sign};

/// Share of the greatest energy by which a balance may be off, in (ω·h)²: what a step of the fast
/// integrator leaves of a ring that nothing damps is an eighth of that.
const ROUGH: f64 = 0.25;
/// The same of round-off.
const ROUND_OFF: f64 = 1e-12;
/// Times the way that velocity, other efforts and what the contact holds may carry a body in a step. What
/// goes further was thrown by its contact, and other efforts did no work on such a way.
const REACH: f64 = 2.0;

/// The work that a contact has taken in.
#[derive(Debug, Clone, Copy)]
pub struct Budget<S> {
    /// Taken in, less what was given back; infinite of a contact that brought something along.
    pub taken: S,
    /// The greatest energy so far that the motor had before a step or was given by one, beside which errors
    /// of steps are small.
    pub swing: f64,
}

impl<S: Scalar> Default for Budget<S> {
    /// Of a contact that was never moved.
    fn default() -> Self {
        Self { taken: S::constant(0.0), swing: 0.0 }
    }
}

impl<S: Scalar> Budget<S> {
    /// Of a contact that brought along nobody knows how much.
    pub fn unknown() -> Self {
        Self { taken: S::constant(f64::INFINITY), swing: 0.0 }
    }

    /// The same over another number type.
    pub fn lift<T: Scalar>(&self) -> Budget<T> {
        Budget { taken: T::constant(self.taken.re()), swing: self.swing }
    }
}

/// The work of a contact, counted from step to step under an input and a load.
pub(crate) struct Work<S> {
    acting: (S, S),
    /// How rough steps are.
    pub rough: f64,
    /// How long they are, s; infinite of steps that hold whole swings.
    pub span: f64,
    from: Run<S>,
    /// All effort but friction there.
    effort: S,
}

impl<S: Scalar> Work<S> {
    /// From where a run is, in steps as rough and as long as that.
    #[inline]
    pub fn begin(
        machine: &Machine<S>,
        run: &Run<S>,
        acting: (S, S),
        (rough, span): (f64, f64),
    ) -> Self {
        Self { acting, rough, span, from: *run, effort: effort(machine, run, acting) }
    }

    /// Counts a step that led here, and takes off the velocity what the contact would have given
    /// without having it.
    #[inline]
    pub fn count(&mut self, machine: &Machine<S>, run: &mut Run<S>) {
        let Self { acting, rough, span, from, effort: acted } = *self;
        let now = effort(machine, run, acting);
        let braked =
            machine.settle(run, (from.position, from.velocity), (acted, now), (rough, span));
        self.effort = if braked { effort(machine, run, acting) } else { now };
        self.from = *run;
    }
}

/// All effort but friction where a run is.
#[inline]
fn effort<S: Scalar>(machine: &Machine<S>, run: &Run<S>, (input, load): (S, S)) -> S {
    machine.driven(input, &run.situation()) + load + run.ambient
}

impl<S: Scalar> Machine<S> {
    /// Whether the work of the contact is counted: where effects change its levels, or something gives way
    /// in series with it. At constant levels a law is passive by itself, whatever acts beside it.
    #[inline]
    pub fn counts_work(&self) -> bool {
        self.effects.changes_levels() || self.relaxes()
    }

    /// Counts the work of a step that took a run from this position and velocity under these efforts at its
    /// start and its end; whether that was more than the contact had, and was taken off the velocity.
    #[inline(always)]
    pub(crate) fn settle(
        &self,
        run: &mut Run<S>,
        (position, velocity): (S, S),
        (acted, now): (S, S),
        (rough, span): (f64, f64),
    ) -> bool {
        let half = self.inertia * 0.5;
        let before = half * velocity * velocity;
        let after = half * run.velocity * run.velocity;
        let way = run.position - position;
        let reach = REACH * span * self.fastest(velocity, run.budget.taken, (acted, now), span);
        let way = if way.re().abs() > reach { S::constant(reach * sign(way.re())) } else { way };
        let done = (acted + now) * way * 0.5;
        let counted = run.budget.taken + done - (after - before);
        // What is beyond floats cannot be counted.
        let taken = if counted.re().is_finite() { counted } else { S::constant(f64::INFINITY) };
        let given = done.re().abs();
        let swing = run.budget.swing.max(before.re()).max(given).min(f64::MAX);
        let least = -rough * swing;
        run.budget = Budget { taken, swing };
        let short = taken.re() < least;
        if short {
            self.brake(run, after, least);
        }
        short
    }

    /// How fast a body may become in a step, by what it had, what its contact holds and other efforts.
    fn fastest(&self, velocity: S, taken: S, (acted, now): (S, S), span: f64) -> f64 {
        let held = (2.0 * taken.re().max(0.0) / self.inertia.re()).sqrt();
        let effort = acted.re().abs().max(now.re().abs());
        velocity.re().abs() + held + effort * span / self.inertia.re()
    }

    /// How rough steps of this duration are on a contact of this stiffness.
    pub(crate) fn roughness(&self, friction: f64, span: f64) -> f64 {
        (ROUGH * self.fastest_square(friction) * span * span).min(1.0) + ROUND_OFF
    }

    /// Takes off the velocity what the contact has given beyond what it may.
    #[cold]
    #[inline(never)]
    fn brake(&self, run: &mut Run<S>, kinetic: S, least: f64) {
        let left = kinetic + run.budget.taken - least;
        // What stands still and is short all the same has an error of the other efforts, no friction.
        run.velocity =
            if left.re() > 0.0 { run.velocity * (left / kinetic).sqrt() } else { S::constant(0.0) };
        run.budget.taken = S::constant(least);
        self.refresh(run);
    }
}
