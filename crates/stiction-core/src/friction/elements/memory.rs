//! The list of reverse points: last in, first out.

use crate::math::scalar::Scalar;

/// Points held at most: beside a motion that nests ever smaller loops without end, those that tell least
/// are forgotten. A ring-down never comes near.
pub const MOST: usize = 32_768;
/// Loops in a row of which the smallest is smaller by no more than this share are one loop then: the
/// force is off by no more than its square, or so, of that of the loop.
const ALIKE: f64 = 1.0 / 256.0;
/// The newest points, on which the spring is going on, stay.
const NEWEST: usize = 4;

/// Points preallocated; a ring-down nests 100 to 230 before it reaches round-off.
pub const PREALLOCATED: usize = 512;

/// Where the motion of a spring turned round.
#[derive(Debug, Clone, Copy)]
pub struct ReversePoint<S> {
    /// Elongation of the spring.
    pub position: S,
    /// Force of the spring.
    pub force: S,
}

/// Reverse points that no closed loop has wiped out yet, oldest first.
#[derive(Debug)]
pub struct ReverseMemory<S> {
    points: Vec<ReversePoint<S>>,
    growths: u64,
    /// Points that were forgotten without a loop that closed.
    merged: u64,
}

// A derived Clone would copy the points without their spare room, and the next reversal of the
// copy would allocate inside a step.
impl<S: Clone> Clone for ReverseMemory<S> {
    fn clone(&self) -> Self {
        let mut points = Vec::with_capacity(self.points.capacity());
        points.extend_from_slice(&self.points);
        Self { points, growths: self.growths, merged: self.merged }
    }
}

impl<S: Scalar> Default for ReverseMemory<S> {
    fn default() -> Self {
        Self { points: Vec::with_capacity(PREALLOCATED), growths: 0, merged: 0 }
    }
}

impl<S: Scalar> ReverseMemory<S> {
    /// The points, oldest first.
    #[inline]
    pub fn points(&self) -> &[ReversePoint<S>] {
        &self.points
    }

    /// How often room had to be added, between chunks of samples.
    pub fn growths(&self) -> u64 {
        self.growths
    }

    /// How many points were forgotten because there were too many, see [`MOST`].
    pub fn merged(&self) -> u64 {
        self.merged
    }

    /// Makes room for the reversals of the next `steps` steps, so that none of them allocates.
    #[inline]
    pub fn make_room(&mut self, steps: usize) {
        if self.points.capacity() - self.points.len() < steps {
            self.points.reserve(steps.max(self.points.len()));
            self.growths += 1;
        }
    }

    /// Whether a point more needs no room to be made.
    #[inline]
    pub fn has_room(&self) -> bool {
        self.points.capacity() > self.points.len()
    }

    /// Forgets the newest `wiped_out` points, then remembers `added`.
    #[inline]
    pub fn update(&mut self, wiped_out: usize, added: Option<ReversePoint<S>>) {
        let kept = self.points.len().saturating_sub(wiped_out);
        self.points.truncate(kept);
        if let Some(point) = added {
            self.points.push(point);
            if self.points.len() >= MOST {
                self.merge();
            }
        }
    }

    /// Forgets points until half of them are left, or nearly so: of loops in a row that are nearly as
    /// large as each other all but the outermost.
    ///
    /// What is left out are pairs, so that points go on to lie on either side in turn, and each loop stays
    /// inside the one before. A branch that would have gone from loop to loop goes past them: of widths
    /// d to (1 − ε)·d, and a loading G, it misses ε·d of the way times a change of the slope over as
    /// much, so (ε·d)²·G''. Wide loops that differ are never touched. Nothing is allocated, and
    /// the same points are left whatever chunks a motion came in.
    #[cold]
    #[inline(never)]
    fn merge(&mut self) {
        let before = self.points.len();
        let mut alike = ALIKE;
        // Between the widest and the narrowest loop that most floats tell apart there is room for all.
        while self.points.len() > before * 3 / 4 && alike < 1.0 {
            self.leave_out(alike);
            alike *= 2.0;
        }
        // A memory of what is no number has no widths.
        self.points.truncate(before.min(MOST - 1));
        self.merged += (before - self.points.len()) as u64;
    }

    fn leave_out(&mut self, alike: f64) {
        let points = &mut self.points;
        let end = points.len() - NEWEST;
        let width = |points: &[ReversePoint<S>], k: usize| {
            (points[k + 1].position.re() - points[k].position.re()).abs()
        };
        let (mut kept, mut next) = (1, 1);
        // The oldest is kept; `next` is what may follow the last one that is.
        while next < end {
            let least = (1.0 - alike) * width(points, next - 1);
            while next + 2 < end && width(points, next + 1) >= least {
                next += 2;
            }
            points[kept] = points[next];
            (kept, next) = (kept + 1, next + 1);
        }
        points.drain(kept..end);
    }

    /// Forgets everything.
    #[inline]
    pub fn clear(&mut self) {
        self.points.clear();
    }

    /// Replaces the points.
    pub fn restore(&mut self, points: impl IntoIterator<Item = ReversePoint<S>>) {
        self.points.clear();
        self.points.extend(points);
    }

    /// The same memory over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> ReverseMemory<T> {
        let mut points = Vec::with_capacity(self.points.capacity());
        points.extend(self.points.iter().map(|point| ReversePoint {
            position: convert(point.position),
            force: convert(point.force),
        }));
        ReverseMemory { points, growths: self.growths, merged: self.merged }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::elements::loading::{Curve, Loading, VirginCurve};
    use crate::friction::elements::spring::SpringState;

    /// A spring that forgets nothing but loops that close.
    struct Full {
        curve: Curve<f64>,
        points: Vec<(f64, f64)>,
        here: (f64, f64),
        way: f64,
    }

    impl Full {
        fn go(&mut self, to: f64) -> f64 {
            let way = (to - self.here.0).signum();
            if way == -self.way {
                self.points.push(self.here);
            }
            self.way = way;
            loop {
                let (target, closed) = match self.points[..] {
                    [] => break,
                    [only] => (-only.0, 1),
                    [.., older, _] => (older.0, 2),
                };
                if way * (to - target) < 0.0 {
                    break;
                }
                self.points.truncate(self.points.len() - closed);
            }
            let force = self.points.last().map_or_else(
                || self.curve.virgin(to).force,
                |(x, f)| f + way * self.curve.branch_from(*x, way, way * (to - x)).force,
            );
            self.here = (to, force);
            force
        }
    }

    /// Greatest difference of forces that a motion makes whose turns are these, and of the motion out of
    /// them, as a share of the greatest force; and how many points were held and merged.
    fn off(turns: impl Iterator<Item = f64>) -> (f64, usize, u64) {
        let curve: Curve<f64> = Curve::new(3000.0, 800.0, 2.9e-4, VirginCurve::Masing);
        let mut spring = SpringState::relaxed(&curve);
        let mut full = Full { curve, points: Vec::new(), here: (0.0, 0.0), way: 0.0 };
        let (mut worst, mut greatest, mut held) = (0.0_f64, 0.0_f64, 0);
        let mut go = |to: f64| {
            let way = (to - spring.position).signum();
            let walk = spring.walk_to(&curve, to, way);
            spring.accept(&walk);
            let exact = full.go(to);
            worst = worst.max((spring.force - exact).abs());
            greatest = greatest.max(exact.abs());
            held = held.max(spring.memory.points().len());
            spring.position
        };
        let mut last = 0.0;
        for turn in turns {
            last = go(turn);
        }
        let out = 1.2e-3 * -last.signum();
        for k in 1..=200_000 {
            go(last + (out - last) * f64::from(k) / 200_000.0);
        }
        (worst / greatest, held, spring.memory.merged())
    }

    #[test]
    fn merged_loops_are_hardly_missed() {
        let side = |k: u32| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let number = 150_000;
        let share = |k: u32| f64::from(k) / f64::from(number);
        let evenly = (0..number).map(|k| 1e-3 * side(k) * (1.0 - share(k)));
        let ever_less = (0..number).map(|k| 1e-3 * side(k) * (-12.0 * share(k)).exp());
        // Ever less, and after every hundred loops at once a tenth.
        let in_leaps =
            (0..number).map(|k| 1e-3 * side(k) * (0.9_f64.powi(k as i32 / 3000) - 1e-3 * share(k)));
        for (off, held, merged) in [off(evenly), off(ever_less), off(in_leaps)] {
            assert!(merged > 0 && held < MOST, "{merged} {held}");
            assert!(off < 1e-5, "{off}");
        }
    }

    #[test]
    fn what_is_kept_nests_as_before() {
        let mut memory = ReverseMemory::default();
        for k in 0..3 * MOST {
            let size = 1.0 / (1.0 + k as f64);
            let position = if k % 2 == 0 { size } else { -size };
            memory.update(0, Some(ReversePoint { position, force: position }));
        }
        let points = memory.points();
        assert!(points.len() < MOST && memory.merged() > 0);
        assert_eq!(points[0].position, 1.0);
        assert_eq!(points[points.len() - 1].position.abs(), 1.0 / (3 * MOST) as f64);
        for pair in points.windows(3) {
            assert!((pair[0].position - pair[1].position) * pair[0].position > 0.0);
            assert!(pair[2].position.abs() < pair[0].position.abs());
        }
    }
}
