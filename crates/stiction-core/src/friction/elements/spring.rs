//! Nonlinear spring with hysteresis: branches between reverse points, memory and wipe-out.
//!
//! Branch from reverse point (x_r, F_r) in direction s: σ = F_r + s·G(s·(x − x_r)). G depends on
//! the distance alone, G(0) = 0, and its slope is positive and never rises. (Hsieh & Pan, Wear 242
//! (2000), §2.2, property i.) Reaching an earlier reverse point of the same direction closes the
//! loop: both its points are forgotten and motion goes on along the older branch (property ii).

use super::memory::{ReverseMemory, ReversePoint};
use crate::scalar::{Scalar, sign};

/// The first loading curve, before any reversal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VirginCurve {
    /// σ = sgn(x)·G(2|x|)/2: the first loop closes at the mirror of its first reverse point.
    Masing,
    /// σ = sgn(x)·G(|x|): the first loading is as soft as any branch.
    Same,
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

    /// Slope right after a reversal, the greatest there is.
    #[inline]
    pub fn initial_stiffness(&self) -> S {
        self.initial_stiffness
    }

    /// G and its slope at distance d from a reverse point.
    #[inline]
    pub fn branch(&self, d: S) -> Response<S> {
        // A wrong anchor gives a negative distance, and the exponential explodes.
        debug_assert!(d.re() >= 0.0, "branch evaluated behind its reverse point: {d:?}");
        let faded = -((-(d * self.inverse_distance)).exp_m1());
        Response {
            force: self.final_stiffness * d + self.fading * self.decay_distance * faded,
            slope: self.initial_stiffness - self.fading * faded,
        }
    }

    /// The virgin curve at elongation x.
    #[inline]
    pub fn virgin(&self, x: S) -> Response<S> {
        let (s, magnitude) = (if x.re() < 0.0 { -1.0 } else { 1.0 }, x.abs_keeping_slope());
        match self.virgin {
            VirginCurve::Masing => {
                let r = self.branch(magnitude * 2.0);
                Response { force: r.force * (0.5 * s), slope: r.slope }
            }
            VirginCurve::Same => {
                let r = self.branch(magnitude);
                Response { force: r.force * s, slope: r.slope }
            }
        }
    }

    /// The elongation at which the virgin curve has this force, from a guess nearby.
    ///
    /// The curve is concave and rising, so Newton's iteration cannot leave its domain once it
    /// has passed below the root; the last pass carries the derivatives.
    pub fn virgin_inverse(&self, force: S) -> S {
        let target = force.re().abs();
        let s = if force.re() < 0.0 { -1.0 } else { 1.0 };
        let mut x = S::constant(target / self.initial_stiffness.re());
        for _ in 0..60 {
            let r = self.virgin(x);
            let next = (x.re() + (target - r.force.re()) / r.slope.re()).max(0.0);
            let moved = (next - x.re()).abs();
            x = S::constant(next);
            if moved <= 4.0 * f64::EPSILON * next {
                break;
            }
        }
        let r = self.virgin(x);
        x += (force * s - r.force) / r.slope;
        x * s
    }
}

/// |x| whose derivative at 0 is that of the positive side: the virgin curve is odd and smooth
/// there, so the kink of the magnitude must not lose the slope.
trait KeepSlope {
    fn abs_keeping_slope(self) -> Self;
}
impl<S: Scalar> KeepSlope for S {
    #[inline]
    fn abs_keeping_slope(self) -> S {
        if self.re() < 0.0 { -self } else { self }
    }
}

/// Elongation, force and memory of the spring.
#[derive(Debug, Clone)]
pub struct SpringState<S> {
    /// Elongation x_s.
    pub position: S,
    /// Force at that elongation, at level 1.
    pub force: S,
    /// Slope of the branch at that elongation.
    pub slope: S,
    /// Direction of the last motion of x_s: −1, 1, or 0 before any.
    pub direction: f64,
    /// Reverse points not yet wiped out.
    pub memory: ReverseMemory<S>,
}

/// What a motion of the spring would do, without doing it.
#[derive(Debug, Clone, Copy)]
pub struct Walk<S> {
    /// Elongation at the end.
    pub position: S,
    /// Force and slope at the end.
    pub end: Response<S>,
    /// Direction at the end.
    pub direction: f64,
    /// Points of the memory that the motion wipes out.
    pub wiped_out: usize,
    /// Loops that the motion closes.
    pub closings: u32,
    /// The reverse point that the motion leaves behind.
    pub added: Option<ReversePoint<S>>,
    /// Whether x_s turned round, even if the loop closed within the step.
    pub reversed: bool,
}

impl<S: Scalar> SpringState<S> {
    /// Relaxed, with nothing remembered.
    pub fn relaxed(curve: &Curve<S>) -> Self {
        Self {
            position: S::constant(0.0),
            force: S::constant(0.0),
            slope: curve.initial_stiffness(),
            direction: 0.0,
            memory: ReverseMemory::default(),
        }
    }

    /// On the virgin curve at this force, with nothing remembered.
    pub fn place_on_virgin(&mut self, curve: &Curve<S>, force: S) {
        self.position = curve.virgin_inverse(force);
        self.force = force;
        self.slope = curve.virgin(self.position).slope;
        self.direction = sign(force.re());
        self.memory.clear();
    }

    /// Slope with which the spring would start to move in this direction.
    #[inline]
    pub fn slope_towards(&self, curve: &Curve<S>, direction: f64) -> S {
        if direction == self.direction || direction == 0.0 {
            self.slope
        } else {
            curve.initial_stiffness()
        }
    }

    /// Read-only walk to another elongation.
    #[inline]
    pub fn walk(&self, curve: &Curve<S>, displacement: S) -> Walk<S> {
        let position = self.position + displacement;
        let moving = sign(displacement.re());
        let direction = if moving == 0.0 { self.direction } else { moving };
        let points = self.memory.points();
        let reversed = direction != self.direction && self.direction != 0.0;
        let mut added =
            reversed.then_some(ReversePoint { position: self.position, force: self.force });
        let mut kept = points.len();
        let mut closings = 0;
        // `≥`, and in a loop: one step can close several loops, and with `>` a cycle between
        // equal levels would add two points for ever.
        while let Some((target, wiped)) = self.closing_target(curve, kept, added.as_ref()) {
            if direction * (position.re() - target) < 0.0 {
                break;
            }
            kept -= wiped;
            added = None;
            closings += 1;
        }
        let anchor = added.as_ref().or(points[..kept].last());
        let end = match anchor {
            Some(anchor) => {
                let along = curve.branch((position - anchor.position) * direction);
                Response { force: anchor.force + along.force * direction, slope: along.slope }
            }
            None => curve.virgin(position),
        };
        Walk { position, end, direction, wiped_out: points.len() - kept, closings, added, reversed }
    }

    /// Where the present branch closes its loop, and how many stored points that forgets.
    #[inline]
    fn closing_target(
        &self,
        curve: &Curve<S>,
        kept: usize,
        added: Option<&ReversePoint<S>>,
    ) -> Option<(f64, usize)> {
        let points = &self.memory.points()[..kept];
        let mirror = |anchor: &ReversePoint<S>| match curve.virgin {
            // The only loop is with the virgin curve, and it closes at the mirror point.
            VirginCurve::Masing => Some(-anchor.position.re()),
            // The branch stays inside the virgin curve for ever.
            VirginCurve::Same => None,
        };
        match (added, points) {
            (Some(anchor), []) => mirror(anchor).map(|x| (x, 0)),
            (Some(_), [.., older]) => Some((older.position.re(), 1)),
            (None, []) => None,
            (None, [only]) => mirror(only).map(|x| (x, 1)),
            (None, [.., older, _]) => Some((older.position.re(), 2)),
        }
    }

    /// Accepts a walk.
    #[inline]
    pub fn accept(&mut self, walk: &Walk<S>) {
        self.position = walk.position;
        self.force = walk.end.force;
        self.slope = walk.end.slope;
        self.direction = walk.direction;
        if walk.wiped_out > 0 || walk.added.is_some() {
            self.memory.update(walk.wiped_out, walk.added);
        }
    }

    /// The same spring over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> SpringState<T> {
        SpringState {
            position: convert(self.position),
            force: convert(self.force),
            slope: convert(self.slope),
            direction: self.direction,
            memory: self.memory.map(convert),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(virgin: VirginCurve) -> Curve<f64> {
        Curve::new(3000.0, 800.0, 2.909e-4, virgin)
    }

    fn drive(curve: &Curve<f64>, path: &[f64]) -> (SpringState<f64>, Vec<f64>) {
        let mut spring = SpringState::relaxed(curve);
        let forces = path
            .iter()
            .map(|x| {
                let walk = spring.walk(curve, x - spring.position);
                spring.accept(&walk);
                spring.force
            })
            .collect();
        (spring, forces)
    }

    #[test]
    fn closing_a_loop_forgets_it() {
        for virgin in [VirginCurve::Masing, VirginCurve::Same] {
            let c = curve(virgin);
            let (spring, forces) = drive(&c, &[4e-4, 1e-4, 3e-4, 2e-4, 3e-4, 4e-4, 5e-4]);
            assert!((forces[4] - forces[2]).abs() < 1e-15);
            assert!((forces[5] - forces[0]).abs() < 1e-15);
            assert!((forces[6] - c.virgin(5e-4).force).abs() < 1e-15);
            assert!(spring.memory.points().is_empty());
        }
    }

    #[test]
    fn one_step_can_close_several_loops() {
        let c = curve(VirginCurve::Masing);
        let (spring, forces) = drive(&c, &[6e-4, 0.0, 5e-4, 1e-4, 4e-4, 2e-4, 7e-4]);
        assert!(spring.memory.points().is_empty());
        assert!((forces[6] - c.virgin(7e-4).force).abs() < 1e-15);
    }

    #[test]
    fn first_loop_closes_at_the_mirror_point() {
        let c = curve(VirginCurve::Masing);
        let (spring, forces) = drive(&c, &[4e-4, -4e-4, -5e-4]);
        assert!((forces[1] + forces[0]).abs() < 1e-15);
        assert!((forces[2] - c.virgin(-5e-4).force).abs() < 1e-15);
        assert!(spring.memory.points().is_empty());
    }

    #[test]
    fn cycles_between_equal_levels_do_not_grow_the_memory() {
        let c = curve(VirginCurve::Masing);
        let path: Vec<f64> = (0..2000).map(|k| if k % 2 == 0 { 4e-4 } else { 1e-4 }).collect();
        let (spring, _) = drive(&c, &path);
        assert!(spring.memory.points().len() <= 2);
    }

    #[test]
    fn virgin_inverse_undoes_the_virgin_curve() {
        for virgin in [VirginCurve::Masing, VirginCurve::Same] {
            let c = curve(virgin);
            for x in [-2e-3, -1e-5, 0.0, 3e-7, 4e-4, 0.1] {
                assert!((c.virgin_inverse(c.virgin(x).force) - x).abs() <= 1e-14 * x.abs());
            }
        }
    }
}
