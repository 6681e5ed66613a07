//! Waves over position.
//!
//! What asks for a wave step by step asks close by: the value about a node of a grid of phases is a short
//! polynomial, and the sine and cosine of the node stay from step to step ([`Follower`]). A value depends
//! on its phase alone, so that it has the same bits whoever asks, and whatever was asked before.

use crate::math::scalar::Scalar;
use crate::math::trig::{WIDEST, round, sin_cos};

/// Nodes in a unit of phase: a power of two, so that a distance from a node is exact.
const NODES: f64 = 32.0;

/// a·cos(N·x) + b·sin(N·x).
#[derive(Debug, Clone, Copy)]
pub struct Harmonic<S> {
    /// Amplitude of the cosine, a.
    pub cosine: S,
    /// Amplitude of the sine, b.
    pub sine: S,
    /// Order, N.
    pub order: S,
}

impl<S: Scalar> Harmonic<S> {
    /// Its value at a position.
    #[inline(always)]
    pub fn at(&self, position: S) -> S {
        let Self { cosine, sine, order } = *self;
        let phase = order * position;
        let value = Node::near(cosine.re(), sine.re(), phase.re()).at(phase.re());
        if !S::CARRIES {
            return S::constant(value);
        }
        let (s, c) = phase.sin_cos();
        (cosine * c + sine * s).with_value(value)
    }

    /// The same without derivatives.
    pub fn plain(&self) -> Harmonic<f64> {
        let [cosine, sine, order] = [self.cosine, self.sine, self.order].map(Scalar::re);
        Harmonic { cosine, sine, order }
    }
}

/// A harmonic at a node, and its slope there by the phase.
#[derive(Debug, Clone, Copy)]
struct Node {
    phase: f64,
    /// How far the phases go whose node this is.
    reach: f64,
    value: f64,
    slope: f64,
}

impl Node {
    /// That of a phase: the nearest one, or where that would lose digits the phase itself.
    #[inline(always)]
    fn near(cosine: f64, sine: f64, phase: f64) -> Self {
        let within = phase.abs() <= WIDEST;
        let (node, reach) =
            if within { (round(phase * NODES) / NODES, 0.5 / NODES) } else { (phase, 0.0) };
        let (s, c) = sin_cos(node);
        Self { phase: node, reach, value: cosine * c + sine * s, slope: sine * c - cosine * s }
    }

    /// The value at a phase of this node: what sine and 1 less cosine of the way leave out is below 5e-17.
    #[inline(always)]
    fn at(&self, phase: f64) -> f64 {
        let way = phase - self.phase;
        let square = way * way;
        let sine = way + way * square * (square * (1.0 / 120.0) - 1.0 / 6.0);
        let fall = square * (square * (1.0 / 24.0 - square * (1.0 / 720.0)) - 0.5);
        self.value + (self.slope * sine + self.value * fall)
    }
}

/// A harmonic that is asked for at one place after another.
#[derive(Debug, Clone, Copy)]
pub struct Follower {
    harmonic: Harmonic<f64>,
    /// Position at which its phase is 0.
    zero: f64,
    node: Node,
}

impl Follower {
    /// Of a harmonic whose phase is 0 at that position.
    pub fn new(harmonic: Harmonic<f64>, zero: f64) -> Self {
        let node = Node { phase: 0.0, reach: 0.0, value: 0.0, slope: 0.0 };
        Self { harmonic, zero, node }
    }

    /// Its value there, to the bit that of [`Harmonic::at`].
    #[inline(always)]
    pub fn at(&mut self, position: f64) -> f64 {
        let phase = self.harmonic.order * (position - self.zero);
        // A phase half way between two nodes may belong to either.
        if (phase - self.node.phase).abs() < self.node.reach {
            self.node.at(phase)
        } else {
            self.go_to(phase)
        }
    }

    /// The same without going there.
    #[inline(always)]
    pub fn seen(&self, position: f64) -> f64 {
        let phase = self.harmonic.order * (position - self.zero);
        if (phase - self.node.phase).abs() < self.node.reach {
            self.node.at(phase)
        } else {
            let mut there = *self;
            there.go_to(phase)
        }
    }

    #[cold]
    #[inline(never)]
    fn go_to(&mut self, phase: f64) -> f64 {
        self.node = Node::near(self.harmonic.cosine, self.harmonic.sine, phase);
        self.node.at(phase)
    }
}

/// A harmonic with one more of another order: what repeats with position is seldom a sine.
#[derive(Debug, Clone, Copy)]
pub struct Wave<S> {
    /// The first one.
    pub first: Harmonic<S>,
    /// The other, where it has an amplitude.
    pub second: Option<Harmonic<S>>,
}

impl<S: Scalar> Wave<S> {
    /// Two harmonics, each as amplitudes of cosine and sine and the order; a second one without
    /// amplitude is left out.
    pub fn new(first: [S; 3], second: [S; 3]) -> Self {
        let there = |amplitude: S| amplitude.re() != 0.0 || amplitude.derivative_is_nonzero();
        let [a, b, _] = second;
        let one = |[cosine, sine, order]: [S; 3]| Harmonic { cosine, sine, order };
        let second = (there(a) || there(b)).then_some(one(second));
        Self { first: one(first), second }
    }

    /// Its value at a position.
    #[inline(always)]
    pub fn at(&self, position: S) -> S {
        let first = self.first.at(position);
        self.second.map_or(first, |second| first + second.at(position))
    }

    /// Greatest slope by position.
    pub fn steepest(&self) -> f64 {
        let one = |harmonic: Harmonic<S>| {
            harmonic.cosine.re().hypot(harmonic.sine.re()) * harmonic.order.re()
        };
        one(self.first) + self.second.map_or(0.0, one)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::Dual;

    fn harmonic() -> Harmonic<f64> {
        Harmonic { cosine: 0.7, sine: -1.3, order: 12.0 }
    }

    #[test]
    fn a_harmonic_agrees_with_the_library() {
        let Harmonic { cosine, sine, order } = harmonic();
        let mut worst = 0.0_f64;
        for k in 0..400_000 {
            let x = f64::from(k) * 1.7e-4 - 30.0;
            let (s, c) = (order * x).sin_cos();
            worst = worst.max((harmonic().at(x) - (cosine * c + sine * s)).abs());
        }
        assert!(worst <= 1e-15, "{worst}");
    }

    #[test]
    fn a_follower_says_what_the_harmonic_says_wherever_it_was_before() {
        let mut follower = Follower::new(harmonic(), 0.0);
        let mut x = 0.0;
        for k in 0..200_000 {
            // On nodes, half way between them, beyond all of them and anywhere.
            x = match k % 7 {
                0 => f64::from(k % 1000) / 768.0,
                1 => x + 1.0 / 768.0,
                2 => -x,
                3 if k % 91 == 3 => 1e5 * f64::from(k),
                _ => x + 1e-3 * (f64::from(k)).sin(),
            };
            assert_eq!(follower.at(x).to_bits(), harmonic().at(x).to_bits(), "{x}");
        }
        assert!(follower.at(f64::NAN).is_nan() && follower.at(f64::INFINITY).is_nan());
        assert_eq!(follower.at(0.25), harmonic().at(0.25));
    }

    #[test]
    fn values_have_the_same_bits_with_derivatives() {
        for k in 0..5000 {
            let x = 0.013 * f64::from(k) - 20.0;
            let Harmonic { cosine, sine, order } = harmonic();
            let [cosine, sine, order] =
                [(cosine, 0), (sine, 1), (order, 2)].map(|(v, k)| Dual::variable(v, k));
            let dual = Harmonic { cosine, sine, order }.at(Dual::variable(x, 3));
            assert_eq!(dual.re().to_bits(), harmonic().at(x).to_bits());
            let (s, c) = (12.0 * x).sin_cos();
            let slope = 1.3_f64.mul_add(-c, -0.7 * s);
            for (column, expected) in [c, s, x * slope, 12.0 * slope].into_iter().enumerate() {
                assert!((dual.partial(column) - expected).abs() < 1e-12, "{x} {column}");
            }
        }
    }
}
