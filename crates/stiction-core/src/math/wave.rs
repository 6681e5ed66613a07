//! A wave over position with one more of another order: what repeats with position is seldom a sine.

use crate::math::scalar::Scalar;

/// a·cos(N·x) + b·sin(N·x), twice.
#[derive(Debug, Clone, Copy)]
pub struct Wave<S> {
    first: [S; 3],
    second: Option<[S; 3]>,
}

impl<S: Scalar> Wave<S> {
    /// Two waves, each as amplitudes of cosine and sine and the order; a second one without
    /// amplitude is left out.
    pub fn new(first: [S; 3], second: [S; 3]) -> Self {
        let [a, b, _] = second;
        let there = |amplitude: S| amplitude.re() != 0.0 || amplitude.derivative_is_nonzero();
        Self { first, second: (there(a) || there(b)).then_some(second) }
    }

    /// Its value at a position.
    #[inline(always)]
    pub fn at(&self, position: S) -> S {
        let one = |[cosine, sine, order]: [S; 3]| {
            let (s, c) = (order * position).sin_cos();
            cosine * c + sine * s
        };
        let first = one(self.first);
        self.second.map_or(first, |second| first + one(second))
    }

    /// Greatest slope by position.
    pub fn steepest(&self) -> f64 {
        let one = |[cosine, sine, order]: [S; 3]| cosine.re().hypot(sine.re()) * order.re();
        one(self.first) + self.second.map_or(0.0, one)
    }
}
