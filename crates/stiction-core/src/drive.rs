//! Drive: from a recording's input to effort.

use crate::scalar::Scalar;

/// Gain and limit of the drive.
#[derive(Debug, Clone, Copy)]
pub struct Drive<S> {
    /// Effort per unit of input.
    pub gain: S,
    /// Greatest magnitude of the input that gets through; infinite means no limit.
    pub limit: f64,
}

impl<S: Scalar> Drive<S> {
    /// Effort for an input.
    #[inline]
    pub fn effort(&self, input: S) -> S {
        let held = if input.re() > self.limit {
            S::constant(self.limit)
        } else if input.re() < -self.limit {
            S::constant(-self.limit)
        } else {
            input
        };
        self.gain * held
    }
}
