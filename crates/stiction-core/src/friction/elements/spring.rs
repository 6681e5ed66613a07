//! Nonlinear spring with hysteresis: branches between reverse points, memory and wipe-out.
//!
//! Branch from reverse point (x_r, F_r) in direction s: σ = F_r + s·G(s·(x − x_r)). G depends on
//! the distance alone, G(0) = 0, and its slope is positive and never rises. (Hsieh & Pan, Wear 242
//! (2000), §2.2, property i.) Reaching an earlier reverse point of the same direction closes the
//! loop: both its points are forgotten and motion goes on along the older branch (property ii).

use super::branch::{Branch, Fading, Here, SYNCHRONISED};
use super::memory::{ReverseMemory, ReversePoint};
use crate::error::{Error, Result};
use crate::exponential::faded_of;
use crate::friction::{Entry, EntryReader, Statistics};
use crate::scalar::{Scalar, sign};

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
        for _ in 0..60 {
            let r = self.virgin(S::constant(x));
            let (slope, bend) = (r.slope.re(), (last - r.slope.re()) * twice / distance);
            let step = (target - r.force.re()) / slope;
            let moved = step / (1.0 + 0.5 * step * bend / slope);
            x += moved;
            if moved.abs() <= 1e-3 * x {
                break;
            }
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
    /// Steps since the force was last evaluated from a reverse point.
    pub steps: u32,
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
    /// Steps since the force was last evaluated from a reverse point.
    pub steps: u32,
}

impl<S: Scalar> SpringState<S> {
    /// Relaxed, with nothing remembered.
    pub fn relaxed(curve: &impl Loading<S>) -> Self {
        Self {
            position: S::constant(0.0),
            force: S::constant(0.0),
            slope: curve.initial_stiffness(),
            direction: 0.0,
            steps: 0,
            memory: ReverseMemory::default(),
        }
    }

    /// On the virgin curve at this force, with nothing remembered.
    pub fn place_on_virgin(&mut self, curve: &Curve<S>, force: S) {
        self.place(curve, curve.virgin_inverse(force), force);
    }

    /// At this point of the virgin curve, with nothing remembered.
    pub fn place(&mut self, curve: &impl Loading<S>, position: S, force: S) {
        self.position = position;
        self.force = force;
        self.slope = curve.virgin(position).slope;
        self.direction = sign(force.re());
        self.steps = 0;
        self.memory.clear();
    }

    /// Slope with which the spring would start to move in this direction.
    #[inline(always)]
    pub fn slope_towards(&self, curve: &impl Loading<S>, direction: f64) -> S {
        if direction == self.direction || direction == 0.0 {
            self.slope
        } else {
            curve.initial_stiffness()
        }
    }

    /// Read-only walk to another elongation.
    #[inline(always)]
    pub fn walk(&self, curve: &impl Loading<S>, displacement: S) -> Walk<S> {
        let fading = curve.fading(&self.present(curve), self.direction);
        let onward = fading.and_then(|fading| self.here().onward(&fading, displacement));
        let Some(there) = onward else { return self.walk_through_points(curve, displacement) };
        Walk {
            position: there.position,
            end: Response { force: there.force, slope: there.slope },
            direction: there.direction,
            wiped_out: 0,
            closings: 0,
            added: None,
            reversed: false,
            steps: there.steps,
        }
    }

    /// Where it is.
    #[inline(always)]
    pub fn here(&self) -> Here<S> {
        Here {
            position: self.position,
            force: self.force,
            slope: self.slope,
            direction: self.direction,
            steps: self.steps,
        }
    }

    /// Puts it elsewhere on the same branch.
    #[inline(always)]
    pub fn slide(&mut self, there: &Here<S>) {
        self.position = there.position;
        self.force = there.force;
        self.slope = there.slope;
        self.steps = there.steps;
    }

    /// The branch on which it is.
    #[inline(always)]
    pub fn present(&self, curve: &impl Loading<S>) -> Branch {
        let never = f64::INFINITY * self.direction;
        match self.memory.points() {
            [] => Branch { first: true, origin: 0.0, target: never },
            [only] => {
                let origin = only.position.re();
                let target = if curve.closes_at_mirror() { -origin } else { never };
                Branch { first: false, origin, target }
            }
            [.., older, anchor] => {
                Branch { first: false, origin: anchor.position.re(), target: older.position.re() }
            }
        }
    }

    /// A walk that may turn round and close loops, evaluated from its reverse point.
    #[inline(never)]
    fn walk_through_points(&self, curve: &impl Loading<S>, displacement: S) -> Walk<S> {
        self.walk_to(curve, self.position + displacement, sign(displacement.re()))
    }

    /// Read-only walk to an elongation that lies in this direction, from the reverse point.
    #[inline(always)]
    pub fn walk_to(&self, curve: &impl Loading<S>, position: S, moving: f64) -> Walk<S> {
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
                let d = (position - anchor.position) * direction;
                let along = curve.branch_from(anchor.position, direction, d);
                Response { force: anchor.force + along.force * direction, slope: along.slope }
            }
            None => curve.virgin(position),
        };
        let wiped_out = points.len() - kept;
        Walk { position, end, direction, wiped_out, closings, added, reversed, steps: 0 }
    }

    /// Where the present branch closes its loop, and how many stored points that forgets.
    #[inline(always)]
    fn closing_target(
        &self,
        curve: &impl Loading<S>,
        kept: usize,
        added: Option<&ReversePoint<S>>,
    ) -> Option<(f64, usize)> {
        let points = &self.memory.points()[..kept];
        // With one point left the only loop is with the virgin curve; a branch that does not meet
        // it at the mirror point stays inside it for ever.
        let mirror =
            |anchor: &ReversePoint<S>| curve.closes_at_mirror().then(|| -anchor.position.re());
        match (added, points) {
            (Some(anchor), []) => mirror(anchor).map(|x| (x, 0)),
            (Some(_), [.., older]) => Some((older.position.re(), 1)),
            (None, []) => None,
            (None, [only]) => mirror(only).map(|x| (x, 1)),
            (None, [.., older, _]) => Some((older.position.re(), 2)),
        }
    }

    /// Accepts a walk.
    #[inline(always)]
    pub fn accept(&mut self, walk: &Walk<S>) {
        self.position = walk.position;
        self.force = walk.end.force;
        self.slope = walk.end.slope;
        self.direction = walk.direction;
        self.steps = walk.steps;
        if walk.wiped_out > 0 || walk.added.is_some() {
            self.memory.update(walk.wiped_out, walk.added);
        }
    }

    /// Counts reversals and closings of an accepted walk.
    #[inline(always)]
    pub fn count(&self, walk: &Walk<S>, statistics: &mut Statistics) {
        if walk.reversed || walk.closings > 0 {
            statistics.reversals += u64::from(walk.reversed);
            statistics.closings += u64::from(walk.closings);
            let held = self.memory.points().len() as u64;
            statistics.memory_peak = statistics.memory_peak.max(held);
        }
    }

    /// The spring as entries of a state.
    pub fn entries(&self) -> Vec<(&'static str, Entry)> {
        let points = self.memory.points();
        vec![
            ("spring", Entry::Number(self.position.re())),
            ("spring_force", Entry::Number(self.force.re())),
            ("spring_slope", Entry::Number(self.slope.re())),
            ("direction", Entry::Number(self.direction)),
            ("spring_steps", Entry::Number(f64::from(self.steps))),
            (
                "reverse_points",
                Entry::Pairs(points.iter().map(|p| [p.position.re(), p.force.re()]).collect()),
            ),
        ]
    }

    /// Takes the spring from the entries of a state.
    pub fn restore(&mut self, read: &mut EntryReader<'_>) -> Result<()> {
        self.position = S::constant(read.number("spring", false)?);
        self.force = S::constant(read.number("spring_force", false)?);
        self.slope = S::constant(read.number("spring_slope", false)?);
        self.direction = read.choice("direction", &[-1.0, 0.0, 1.0])?;
        self.steps = read.count("spring_steps")?.min(u64::from(SYNCHRONISED)) as u32;
        let rows = read.pairs("reverse_points")?;
        check_nesting(rows, self.position.re(), self.direction)?;
        self.memory.restore(
            rows.iter().map(|row| ReversePoint {
                position: S::constant(row[0]),
                force: S::constant(row[1]),
            }),
        );
        Ok(())
    }

    /// The same spring over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> SpringState<T> {
        SpringState {
            position: convert(self.position),
            force: convert(self.force),
            slope: convert(self.slope),
            direction: self.direction,
            steps: self.steps,
            memory: self.memory.map(convert),
        }
    }
}

/// Reverse points must alternate and nest, or the walk would run behind its anchor.
fn check_nesting(rows: &[[f64; 2]], position: f64, direction: f64) -> Result<()> {
    let bad = |problem: &str| {
        Err(Error::State { name: "reverse_points".to_owned(), problem: problem.to_owned() })
    };
    // The way in which the spring moved towards each point: the first from the origin, each
    // later one back from the point before it.
    let mut towards = 0.0;
    for (k, row) in rows.iter().enumerate() {
        let before = if k == 0 { 0.0 } else { rows[k - 1][0] };
        let way = sign(row[0] - before);
        let inside = k < 2 || (row[0] - rows[k - 2][0]) * way < 0.0;
        if way == 0.0 || way == towards || !inside {
            return bad("does not nest: every point lies strictly between the two before it");
        }
        towards = way;
    }
    if let [.., last] = rows {
        if direction != -towards || (position - last[0]) * direction < 0.0 {
            return bad("disagrees with 'direction'");
        }
        let passed = rows.len() > 1 && (position - rows[rows.len() - 2][0]) * direction > 0.0;
        if passed {
            return bad("does not nest: the spring is past the point before the last");
        }
    } else if position * direction < 0.0 {
        return bad("is empty although the spring is not on its virgin curve");
    }
    Ok(())
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
    fn many_short_steps_stay_within_the_bound_of_the_curve() {
        for virgin in [VirginCurve::Masing, VirginCurve::Same] {
            let c = curve(virgin);
            let mut spring = SpringState::relaxed(&c);
            let (mut worst, mut longest) = (0.0_f64, 0);
            for k in 0..60_000_u32 {
                // Slow and fast stretches, first loading, turned twice and closed on the way.
                let pace = [1e-12, 3e-9, 4e-7][(k / 700 % 3) as usize];
                let way = if (20_000..24_000).contains(&k) { -1.0 } else { 1.0 };
                let step = way * pace * (1.0 + 0.3 * f64::from(k).sin());
                let walk = spring.walk(&c, step);
                spring.accept(&walk);
                longest = longest.max(spring.steps);
                let exact = spring.walk_through_points(&c, 0.0).end;
                worst = worst
                    .max((spring.force - exact.force).abs() / exact.force.abs().max(1e-3))
                    .max((spring.slope - exact.slope).abs() / exact.slope);
            }
            assert_eq!(longest, SYNCHRONISED);
            assert!(worst > 0.0 && worst < 1e-13, "{worst}");
        }
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
