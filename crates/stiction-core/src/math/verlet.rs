//! A body in a step, as numbers.

use super::scalar::Scalar;

/// The body's share of a step: velocity Verlet with trapezoidal damping.
#[derive(Debug, Clone, Copy)]
pub struct Verlet<S> {
    pub(crate) span: S,
    pub(crate) half: S,
    pub(crate) inertia: S,
    /// Velocity and displacement per effort.
    pub(crate) pace: S,
    pub(crate) lever: S,
    /// Displacement per velocity, and what is left of the inertia: less what damping at the start
    /// takes off.
    pub(crate) stride: S,
    pub(crate) kept: S,
    /// Whether derivatives of the duration are carried along.
    pub(crate) located: bool,
}

impl<S: Scalar> Verlet<S> {
    /// Steps of this duration.
    #[inline(always)]
    pub fn new(span: S, inertia: S, lightness: S) -> Self {
        let half = span * 0.5;
        let pace = span * lightness;
        let located = S::CARRIES && span.derivative_is_nonzero();
        Self { span, half, inertia, pace, lever: pace * half, stride: span, kept: inertia, located }
    }

    /// Steps of which friction at the start has a share damping·velocity, which no effort below
    /// contains then. So nothing has to wait for it.
    #[inline(always)]
    pub fn dragged(self, damping: S) -> Self {
        Self {
            stride: self.stride - self.lever * damping,
            kept: self.kept - self.half * damping,
            ..self
        }
    }

    /// Displacement over the step.
    #[inline(always)]
    pub fn displacement(&self, velocity: S, net: S) -> S {
        self.stride * velocity + self.lever * net
    }

    /// Velocity predicted for the end of the step, `net` with all friction at the start.
    #[inline(always)]
    pub fn predicted(&self, velocity: S, net: S) -> S {
        (velocity + self.pace * net).alone()
    }

    /// Velocity at the end: `both` efforts, less friction at the start alone, and that at the end
    /// as what its damping leaves and that.
    ///
    /// (J·v₀ + h/2·(E₀ − F₀ + E₁ − F* + D·v*))/(J + h/2·D), F* last: the rest waits for nothing.
    #[inline(always)]
    pub fn arrive(&self, velocity: S, both: S, damping: S, undamped: S) -> S {
        let share = self.share(damping);
        self.unbraked(velocity, both, share) - self.braking(share) * undamped
    }

    /// 1/(J + h/2·D).
    #[inline(always)]
    pub fn share(&self, damping: S) -> S {
        S::constant(1.0) / (self.inertia + self.over_half(damping))
    }

    /// The velocity at the end without undamped friction there.
    #[inline(always)]
    pub fn unbraked(&self, velocity: S, both: S, share: S) -> S {
        (self.kept * velocity + self.over_half(both)) * share
    }

    /// Times half the duration. That depends on no parameter but where an event is located.
    #[inline(always)]
    fn over_half(&self, number: S) -> S {
        if S::CARRIES && !self.located { number * self.half.re() } else { number * self.half }
    }

    /// [`Self::share`] and [`Self::braking`] where nothing damps, in no one's eyes the same quotient: else
    /// every step had a division.
    #[inline(always)]
    pub fn free(&self) -> (S, S) {
        let share = self.share(S::constant(0.0)).alone();
        (share, self.braking(share))
    }

    /// What a unit of undamped friction at the end takes off the velocity there.
    #[inline(always)]
    pub fn braking(&self, share: S) -> S {
        self.over_half(share)
    }

    /// Duration of a step, half of it, inertia, velocity and displacement per effort, as plain numbers.
    pub fn numbers(&self) -> [f64; 5] {
        [self.span, self.half, self.inertia, self.pace, self.lever].map(Scalar::re)
    }

    /// Duration of a step.
    #[inline(always)]
    pub fn span(&self) -> S {
        self.span
    }
}
