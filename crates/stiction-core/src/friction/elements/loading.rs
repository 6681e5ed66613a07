//! Loading curves: the force of a spring over the distance from a reverse point.

use super::branch::{Branch, Fading};
use crate::math::exponential::faded_of;
use crate::math::scalar::Scalar;

/// The first loading curve, before any reversal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VirginCurve {
    /// σ = sgn(x)·G(2|x|)/2: the first loop closes at the mirror of its first reverse point.
    Masing,
    /// σ = sgn(x)·G(|x|): the first loading is as soft as any branch.
    Same,
}

/// The loading curves of a spring with memory.
pub trait Loading<S: Scalar> {
    /// Slope right after a reversal, the greatest there is.
    fn initial_stiffness(&self) -> S;
    /// G and its slope at distance d ≥ 0 from a reverse point.
    fn branch(&self, d: S) -> Response<S>;
    /// The same of a branch that depends on where its reverse point lies as well.
    #[inline(always)]
    fn branch_from(&self, _anchor: S, _direction: f64, d: S) -> Response<S> {
        self.branch(d)
    }
    /// The curve before any reversal at elongation x.
    fn virgin(&self, x: S) -> Response<S>;
    /// Whether the first loop closes at the mirror of its reverse point.
    fn closes_at_mirror(&self) -> bool;
    /// How a branch in this direction fades, where it does so exponentially: then a short way along it
    /// needs no asking for its reverse point.
    #[inline(always)]
    fn fading(&self, _branch: &Branch, _direction: f64) -> Option<Fading<S>> {
        None
    }
}

/// The virgin curve that goes with a branch under Masing's rule: half its size.
#[inline(always)]
pub fn masing<S: Scalar>(curve: &impl Loading<S>, x: S) -> Response<S> {
    let s = if x.re() < 0.0 { -1.0 } else { 1.0 };
    let r = curve.branch(x * (2.0 * s));
    Response { force: r.force * (0.5 * s), slope: r.slope }
}

/// G(d) = k_inf·d + (k_0 − k_inf)·d_0·(1 − e^(−d/d_0)).
#[derive(Debug, Clone, Copy)]
pub struct Curve<S> {
    initial_stiffness: S,
    final_stiffness: S,
    fading: S,
    decay_distance: S,
    inverse_distance: S,
    virgin: VirginCurve,
}

/// Force of the spring and its slope with respect to elongation.
#[derive(Debug, Clone, Copy)]
pub struct Response<S> {
    /// Force.
    pub force: S,
    /// Stiffness.
    pub slope: S,
}

impl<S: Scalar> Curve<S> {
    /// A curve with slopes k_0 at a reversal and k_inf far from it, fading over d_0.
    pub fn new(k_0: S, k_inf: S, d_0: S, virgin: VirginCurve) -> Self {
        Self {
            initial_stiffness: k_0,
            final_stiffness: k_inf,
            fading: k_0 - k_inf,
            decay_distance: d_0,
            inverse_distance: S::constant(1.0) / d_0,
            virgin,
        }
    }

    /// The same curve over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> Curve<T> {
        Curve {
            initial_stiffness: convert(self.initial_stiffness),
            final_stiffness: convert(self.final_stiffness),
            fading: convert(self.fading),
            decay_distance: convert(self.decay_distance),
            inverse_distance: convert(self.inverse_distance),
            virgin: self.virgin,
        }
    }

    /// k_inf, k_0 − k_inf and d_0 as plain numbers.
    pub fn numbers(&self) -> [f64; 3] {
        [self.final_stiffness, self.fading, self.decay_distance].map(Scalar::re)
    }

    /// Force of what gives way, (k_0 − k_inf)·d_0.
    pub fn yielding(&self) -> S {
        self.fading * self.decay_distance
    }

    /// Share of d_0 that a displacement in this direction is on this branch.
    #[inline(always)]
    pub fn per_displacement(&self, branch: &Branch, direction: f64) -> S {
        // The first loading runs through a branch of twice the size.
        let twice = if branch.first && self.virgin == VirginCurve::Masing { 2.0 } else { 1.0 };
        self.inverse_distance * (direction * twice)
    }

    /// The elongation at which the virgin curve has this force.
    ///
    /// By Halley's iteration, which triples the digits of each pass, from the root of a fraction
    /// that meets 1 − e^(−u) to the second power; a last pass of Newton's squares what a step of one
    /// part in a thousand leaves, and carries the derivatives.
    pub fn virgin_inverse(&self, force: S) -> S {
        let twice = if self.virgin == VirginCurve::Masing { 2.0 } else { 1.0 };
        let s = if force.re() < 0.0 { -1.0 } else { 1.0 };
        let target = force.re().abs();
        let [last, fading, distance] = self.numbers();
        let (rest, share) = (last / fading, twice * target / (fading * distance));
        let linear = rest + 1.0 - 0.5 * share;
        let root = (linear * linear + 2.0 * rest * share).sqrt();
        let u = if linear > 0.0 { 2.0 * share / (linear + root) } else { (root - linear) / rest };
        let mut x = u * distance / twice;
        let mut settled = false;
        for _ in 0..20 {
            let r = self.virgin(S::constant(x));
            let (slope, bend) = (r.slope.re(), (last - r.slope.re()) * twice / distance);
            let step = (target - r.force.re()) / slope;
            let moved = step / (1.0 + 0.5 * step * bend / slope);
            x += moved;
            settled = moved.abs() <= 1e-3 * x;
            if settled {
                break;
            }
        }
        if !settled {
            // About the knee of a curve that hardly rises behind it the iteration may go in circles;
            // no force is further off than where its last slope alone would come to it.
            let risen = |x: f64| self.virgin(S::constant(x)).force.re();
            x = halved(|x| risen(x) >= target, 0.0, target / last);
        }
        let r = self.virgin(S::constant(x));
        ((force * s - r.force) / r.slope + x) * s
    }
}

/// The elongation at which a virgin curve has this force.
///
/// The curve is concave and rising, so Newton's iteration cannot leave its domain once it has
/// passed below the root; the last pass carries the derivatives.
pub fn virgin_inverse<S: Scalar>(curve: &impl Loading<S>, force: S) -> S {
    let target = force.re().abs();
    let s = if force.re() < 0.0 { -1.0 } else { 1.0 };
    let mut x = S::constant(target / curve.initial_stiffness().re());
    for _ in 0..60 {
        let r = curve.virgin(x);
        let next = (x.re() + (target - r.force.re()) / r.slope.re()).max(0.0);
        let moved = (next - x.re()).abs();
        x = S::constant(next);
        if moved <= 4.0 * f64::EPSILON * next {
            break;
        }
    }
    let r = curve.virgin(x);
    x += (force * s - r.force) / r.slope;
    x * s
}

/// The distance d ≥ 0 from a reverse point at which the branch from there has risen by this force.
///
/// It is looked for up to `reach`, where the loop closes, and beyond that where it never does. By
/// halving, for a branch need not be concave; a last pass of Newton's carries the derivatives.
pub fn branch_inverse<S: Scalar>(
    curve: &impl Loading<S>,
    anchor: S,
    direction: f64,
    force: S,
    reach: f64,
) -> S {
    let risen = |d: f64| curve.branch_from(anchor, direction, S::constant(d));
    let target = force.re();
    let (mut low, mut high) = (0.0, reach);
    if !curve.closes_at_mirror() {
        for _ in 0..100 {
            if risen(high).force.re() >= target {
                break;
            }
            (low, high) = (high, 2.0 * high);
        }
    }
    let d = halved(|d| risen(d).force.re() >= target, low, high);
    let r = risen(d);
    let end = (force - r.force) / r.slope + d;
    // A rise that is rounding alone, or less, must not lead behind the reverse point.
    if end.re() < 0.0 { end - end.re() } else { end }
}

/// The least number between two at which something holds that holds from there on.
fn halved(holds: impl Fn(f64) -> bool, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if holds(middle) { high = middle } else { low = middle }
    }
    high
}

impl<S: Scalar> Loading<S> for Curve<S> {
    #[inline(always)]
    fn initial_stiffness(&self) -> S {
        self.initial_stiffness
    }

    #[inline(always)]
    fn branch(&self, d: S) -> Response<S> {
        // A wrong anchor gives a negative distance, and the exponential explodes.
        debug_assert!(d.re() >= 0.0, "branch evaluated behind its reverse point: {d:?}");
        let faded = faded_of(-(d * self.inverse_distance));
        Response {
            force: self.final_stiffness * d + self.fading * self.decay_distance * faded,
            slope: self.initial_stiffness - self.fading * faded,
        }
    }

    #[inline(always)]
    fn virgin(&self, x: S) -> Response<S> {
        match self.virgin {
            VirginCurve::Masing => masing(self, x),
            VirginCurve::Same => {
                let s = if x.re() < 0.0 { -1.0 } else { 1.0 };
                let r = self.branch(x * s);
                Response { force: r.force * s, slope: r.slope }
            }
        }
    }

    #[inline(always)]
    fn closes_at_mirror(&self) -> bool {
        self.virgin == VirginCurve::Masing
    }

    // 1 − e^(−(d + δ)/d_0) = M + (1 − M)·(1 − e^(−δ/d_0)), and (k_0 − k_inf)·(1 − M) is the slope
    // here less k_inf.
    #[inline(always)]
    fn fading(&self, branch: &Branch, direction: f64) -> Option<Fading<S>> {
        let share = self.per_displacement(branch, direction);
        Some(Fading { target: branch.target, last: self.final_stiffness, share })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn virgin_inverse_undoes_the_virgin_curve() {
        for virgin in [VirginCurve::Masing, VirginCurve::Same] {
            let c = Curve::new(3000.0, 800.0, 2.909e-4, virgin);
            for x in [-2e-3, -1e-5, 0.0, 3e-7, 4e-4, 0.1] {
                assert!((c.virgin_inverse(c.virgin(x).force) - x).abs() <= 1e-14 * x.abs());
            }
        }
    }
}
