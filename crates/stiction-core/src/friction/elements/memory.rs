//! The list of reverse points: last in, first out.

use crate::scalar::Scalar;

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
}

// A derived Clone would copy the points without their spare room, and the next reversal of the
// copy would allocate inside a step.
impl<S: Clone> Clone for ReverseMemory<S> {
    fn clone(&self) -> Self {
        let mut points = Vec::with_capacity(self.points.capacity());
        points.extend_from_slice(&self.points);
        Self { points, growths: self.growths }
    }
}

impl<S: Scalar> Default for ReverseMemory<S> {
    fn default() -> Self {
        Self { points: Vec::with_capacity(PREALLOCATED), growths: 0 }
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
        }
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
        ReverseMemory { points, growths: self.growths }
    }
}
