//! A stop: a linear spring behind a slider of constant level, by displacements.

use crate::math::scalar::{Scalar, sign};

/// Round-off of a stretch that reached its limit, in shares of it.
const REACHED: f64 = 1e-12;

/// Stretch of a stop, and whether it slides.
#[derive(Debug, Clone, Copy)]
pub struct Stop<S> {
    /// Stretch of the spring, at most the limit in size.
    pub stretch: S,
    /// ±1 slides in that direction, 0 sticks.
    pub mode: f64,
}

impl<S: Scalar> Stop<S> {
    /// Sticking, with nothing stretched.
    pub fn relaxed() -> Self {
        Self { stretch: S::constant(0.0), mode: 0.0 }
    }

    /// The same stop over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> Stop<T> {
        Stop { stretch: convert(self.stretch), mode: self.mode }
    }

    /// The stop after a displacement, and whether its spring follows that.
    #[inline]
    pub fn moved(&self, limit: S, displacement: S) -> (Self, bool) {
        let pull = self.stretch + displacement;
        let side = sign(pull.re());
        if pull.re().abs() > limit.re() {
            return (Self { stretch: limit * side, mode: side }, false);
        }
        // A slide ends when the spring unloads, not at a rest nor at the round-off of its start.
        let slides = self.mode * displacement.re() >= 0.0;
        (Self { stretch: pull, mode: if slides { self.mode } else { 0.0 } }, true)
    }

    /// What is left of the displacement at which it begins to slide: zero there, negative past it.
    #[inline]
    pub fn margin(&self, limit: S, displacement: S) -> S {
        let pull = self.stretch + displacement;
        // What slides one way breaks away the other.
        limit - if self.mode == 0.0 { pull.abs() } else { -(pull * self.mode) }
    }

    /// Whether it stands at its limit and does not slide yet.
    #[inline]
    pub fn due(&self, limit: S) -> bool {
        let side = sign(self.stretch.re());
        side != self.mode && self.stretch.re().abs() >= limit.re() * (1.0 - REACHED)
    }

    /// Starts to slide.
    #[inline]
    pub fn slide(&mut self) {
        self.mode = sign(self.stretch.re());
    }
}
