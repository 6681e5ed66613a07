//! Stick and slip of a contact that is rigid until it breaks away.

use crate::friction::{Entry, EntryReader, Motion, Statistics};
use crate::math::scalar::{Scalar, sign};
use crate::support::error::Result;

/// Share of the velocity at the end of a step below which one at its start is what rounding left of a stop: an event is
/// enclosed no closer.
const STILL: f64 = 1e-13;

/// Contact mode, and the force at the end of the last step.
#[derive(Debug, Clone, Copy)]
pub struct Rigid<S> {
    /// 0 sticks, ±1 slides in that direction.
    pub mode: f64,
    /// Friction.
    pub force: S,
    /// Break-aways and sticks.
    pub statistics: Statistics,
}

impl<S: Scalar> Rigid<S> {
    /// Sticking, with nothing to hold.
    pub fn at_rest() -> Self {
        Self { mode: 0.0, force: S::constant(0.0), statistics: Statistics::default() }
    }

    /// The same contact over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> Rigid<T> {
        Rigid { mode: self.mode, force: convert(self.force), statistics: self.statistics }
    }

    /// The contact as entries of a state.
    pub fn entries(&self) -> Vec<(&'static str, Entry)> {
        vec![
            ("mode", Entry::Number(self.mode)),
            ("force", Entry::Number(self.force.re())),
            ("breakaways", Entry::Number(self.statistics.breakaways as f64)),
            ("sticks", Entry::Number(self.statistics.sticks as f64)),
        ]
    }

    /// Takes the contact from the entries of a state.
    pub fn restore(read: &mut EntryReader<'_>) -> Result<Self> {
        Ok(Self {
            mode: read.choice("mode", &[-1.0, 0.0, 1.0])?,
            force: S::constant(read.number("force", false)?),
            statistics: Statistics {
                breakaways: read.count("breakaways")?,
                sticks: read.count("sticks")?,
                ..Statistics::default()
            },
        })
    }

    /// The mode at this velocity: a slide lasts until an event ends it.
    #[inline]
    pub fn mode_at(&self, velocity: S) -> f64 {
        if self.mode == 0.0 { sign(velocity.re()) } else { self.mode }
    }

    /// The mode over a step. A body that moves already when a contact first meets it slides the way that it
    /// moves, even where the step is predicted to end the other way: it stops on the way there, which is an event.
    #[inline]
    pub fn mode_over(&self, motion: &Motion<S>) -> f64 {
        let (start, end) = (motion.start_velocity.re(), motion.velocity.re());
        let moves = start * end <= 0.0 && start.abs() > STILL * end.abs();
        if moves && self.mode == 0.0 { sign(start) } else { self.mode_at(motion.velocity) }
    }

    /// Accepts a step that ends in this mode with this force.
    #[inline]
    pub fn accept(&mut self, mode: f64, force: S) {
        if self.mode == 0.0 && mode != 0.0 {
            self.statistics.breakaways += 1;
        }
        self.mode = mode;
        self.force = force;
    }

    /// Whether a contact at velocity 0 holds this effort; starts a slide where it does not.
    #[inline]
    pub fn holds(&mut self, effort: S, greatest: S) -> bool {
        if self.mode != 0.0 {
            return false;
        }
        if effort.re().abs() <= greatest.re() {
            self.force = effort;
            return true;
        }
        self.mode = sign(effort.re());
        self.statistics.breakaways += 1;
        false
    }

    /// Whether it slides one way while the velocity points the other.
    #[inline]
    pub fn turned(&self, velocity: S) -> bool {
        self.mode * velocity.re() < 0.0
    }

    /// Whether a slide in this mode over a step ends with it: also one that begins with the step, where the
    /// body moved that way already.
    #[inline]
    pub fn stops_over(&self, mode: f64, motion: &Motion<S>) -> bool {
        let slid = self.mode != 0.0 || mode * motion.start_velocity.re() > 0.0;
        slid && mode * motion.velocity.re() <= 0.0 && mode != 0.0
    }

    /// Ends a slide.
    pub fn stick(&mut self) {
        self.mode = 0.0;
        self.statistics.sticks += 1;
    }
}

/// What a resting contact answers to an effort: the effort, at most its break-away level.
#[inline]
pub fn held<S: Scalar>(effort: S, greatest: S) -> S {
    if effort.re().abs() <= greatest.re() { effort } else { greatest * sign(effort.re()) }
}
