//! Nonlinear spring with hysteresis: branches between reverse points, memory and wipe-out.
//!
//! Branch from reverse point (x_r, F_r) in direction s: σ = F_r + s·G(s·(x − x_r)). G depends on
//! the distance alone, G(0) = 0, and its slope is positive and never rises. (Hsieh & Pan, Wear 242
//! (2000), §2.2, property i.) Reaching an earlier reverse point of the same direction closes the
//! loop: both its points are forgotten and motion goes on along the older branch (property ii).

use super::branch::{Branch, Here, SYNCHRONISED};
use super::loading::{Curve, Loading, Response, branch_inverse};
use super::memory::{ReverseMemory, ReversePoint};
use crate::friction::{Entry, EntryReader, Statistics};
use crate::math::scalar::{Scalar, sign};
use crate::support::error::{Error, Result};

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

    /// At this force after the first loading went to the first of two turns and back to the second.
    ///
    /// `inverse` is the elongation of the virgin curve at a force. Turns that a later force went past
    /// are forgotten, and so are those at 0: then the spring is on its virgin curve.
    pub fn come_back(
        &mut self,
        curve: &impl Loading<S>,
        inverse: impl Fn(S) -> S,
        turns: [S; 2],
        force: S,
    ) {
        let past = |turn: S, force: S| {
            let (turn, force) = (turn.re(), force.re());
            // A branch that never closes its loop forgets on the side of its reverse point alone.
            let beyond = curve.closes_at_mirror() && force.abs() >= turn.abs();
            beyond || (force - turn) * turn >= 0.0
        };
        let [mut first, mut second] = turns;
        if second.re() != 0.0 && past(first, second) {
            (first, second) = (second, S::constant(0.0));
        }
        if past(first, force) {
            return self.place(curve, inverse(force), force);
        }
        self.place(curve, inverse(first), first);
        let from = self.position.re();
        let within = (force - first).re() * (force - second).re() < 0.0;
        if second.re() != 0.0 && within {
            self.go_back(curve, second, 2.0 * from.abs());
            self.go_back(curve, force, (from - self.position.re()).abs());
        } else {
            self.go_back(curve, force, 2.0 * from.abs());
        }
    }

    /// Turns round and goes to a force that lies within this distance.
    fn go_back(&mut self, curve: &impl Loading<S>, force: S, reach: f64) {
        let direction = -self.direction;
        let rise = (force - self.force) * direction;
        let d = branch_inverse(curve, self.position, direction, rise, reach);
        let walk = self.walk_to(curve, self.position + d * direction, direction);
        self.accept(&walk);
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
        let onward = self.walk_onward(curve, displacement);
        onward.unwrap_or_else(|| self.walk_through_points(curve, displacement))
    }

    /// The same as part of the loop that asks for it.
    #[inline(always)]
    pub fn walk_within(&self, curve: &impl Loading<S>, displacement: S) -> Walk<S> {
        if let Some(walk) = self.walk_onward(curve, displacement) {
            return walk;
        }
        self.walk_to(curve, self.position + displacement, sign(displacement.re()))
    }

    /// A short walk that stays on a branch which fades.
    #[inline(always)]
    fn walk_onward(&self, curve: &impl Loading<S>, displacement: S) -> Option<Walk<S>> {
        let fading = curve.fading(&self.present(curve), self.direction)?;
        let there = self.here().onward(&fading, displacement)?;
        Some(Walk {
            position: there.position,
            end: Response { force: there.force, slope: there.slope },
            direction: there.direction,
            wiped_out: 0,
            closings: 0,
            added: None,
            reversed: false,
            steps: there.steps,
        })
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
    } else if position * direction < 0.0 || (direction == 0.0 && position != 0.0) {
        return bad("is empty although the spring is not on its virgin curve");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::loading::VirginCurve;
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
    fn coming_back_is_going_there() {
        for virgin in [VirginCurve::Masing, VirginCurve::Same] {
            let c = curve(virgin);
            let back = |first: f64, second: f64, force: f64| {
                let mut spring = SpringState::relaxed(&c);
                spring.come_back(&c, |f| c.virgin_inverse(f), [first, second], force);
                spring
            };
            let (there, forces) = drive(&c, &[-4e-4, 1e-4, -2e-4]);
            let at = back(forces[0], forces[1], forces[2]);
            assert!((at.position - there.position).abs() < 1e-15);
            assert!((at.force - there.force).abs() < 1e-13);
            assert_eq!(at.direction, there.direction);
            for (one, other) in at.memory.points().iter().zip(there.memory.points()) {
                assert!((one.position - other.position).abs() < 1e-15);
            }
            assert_eq!(at.memory.points().len(), 2);
            // What a later force went past is forgotten, and so is a turn at 0.
            assert_eq!(back(forces[0], forces[1], 1.5 * forces[1]).memory.points().len(), 1);
            assert_eq!(back(forces[0], 0.0, forces[2]).memory.points().len(), 1);
            // Only a branch that closes at the mirror of its reverse point ends there.
            let other_side = if virgin == VirginCurve::Masing { -0.2 } else { 0.2 };
            for (first, force) in [(0.0, 0.1), (0.1, other_side), (-0.1, -0.2)] {
                let virgin = back(first, 0.5 * first, force);
                assert!(virgin.memory.points().is_empty());
                assert!((c.virgin(virgin.position).force - force).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn the_virgin_curve_is_inverted_about_its_knee() {
        // Halley's iteration goes in circles at the first of these.
        let c: Curve<f64> = Curve::new(3000.0, 3.0, 1e-4, VirginCurve::Masing);
        for share in (1..400).map(|k| 0.521 + 1e-5 * f64::from(k)).chain([0.1, 0.4, 0.9, 2.0]) {
            let force = share * c.yielding();
            assert!((c.virgin(c.virgin_inverse(force)).force - force).abs() < 1e-12 * force);
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
}
