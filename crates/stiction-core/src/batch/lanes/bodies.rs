//! How the bodies of a block come from motors, and go back to them.

use crate::friction::elements::abreast::Bodies;
use crate::integrate::after_steps;
use crate::math::scalar::Scalar;
use crate::plant::Run;

impl Bodies {
    /// Takes a body into a lane.
    #[inline]
    pub fn load<S: Scalar>(&mut self, lane: usize, run: &Run<S>) {
        self.position.0[lane] = run.position.re();
        self.velocity.0[lane] = run.velocity.re();
        self.friction.0[lane] = run.friction.re();
        self.path.0[lane] = run.path.re();
        self.time.0[lane] = run.time.re();
        self.since[lane] = self.taken;
    }

    /// Puts the body of a lane back, where it was after so many steps of the row.
    #[inline]
    pub fn store<S: Scalar>(&self, lane: usize, taken: usize, run: &mut Run<S>) {
        let steps = taken - self.since[lane];
        let time = after_steps(self.time.0[lane], self.span.0[lane], steps);
        run.position = S::constant(self.position.0[lane]);
        run.velocity = S::constant(self.velocity.0[lane]);
        run.friction = S::constant(self.friction.0[lane]);
        run.path = S::constant(self.path.0[lane]);
        run.time = S::constant(time);
    }
}
