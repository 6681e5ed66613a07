//! Body: inertia and the efforts that position alone decides.

use crate::math::scalar::Scalar;
use crate::math::wave::Harmonic;

/// Inertia and gravity.
#[derive(Debug, Clone, Copy)]
pub struct Body<S> {
    /// Inertia (mass).
    pub inertia: S,
    /// Amplitude of the pendulum torque F_g = amplitude·sin(x − zero), which pulls back to zero.
    pub gravity_amplitude: S,
    /// Position at which the pendulum hangs.
    pub gravity_zero: S,
    /// Constant weight against positive motion (linear plants).
    pub weight: S,
    gravity: bool,
}

impl<S: Scalar> Body<S> {
    /// A body with a pendulum torque and a weight; 0 switches either off.
    pub fn new(inertia: S, gravity_amplitude: S, gravity_zero: S, weight: S) -> Self {
        let gravity = gravity_amplitude.re() != 0.0 || gravity_amplitude.derivative_is_nonzero();
        Self { inertia, gravity_amplitude, gravity_zero, weight, gravity }
    }

    /// Whether gravity is the same everywhere.
    pub fn is_level(&self) -> bool {
        !self.gravity
    }

    /// Effort of gravity, positive along +x.
    #[inline(always)]
    pub fn gravity(&self, position: S) -> S {
        let weight = self.level_gravity();
        if self.gravity {
            weight + self.pendulum().at(position - self.gravity_zero)
        } else {
            weight
        }
    }

    /// Its part that goes by the position, beyond [`Self::gravity_zero`].
    #[inline(always)]
    pub(super) fn pendulum(&self) -> Harmonic<S> {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        Harmonic { cosine: zero, sine: -self.gravity_amplitude, order: one }
    }

    /// The same where it is the same everywhere.
    #[inline(always)] // a loop over rows of derivatives asks for it in every sample
    pub fn level_gravity(&self) -> S {
        -self.weight
    }
}
