//! First loading of elasto-slide elements without number, their yield points spread as one likes.

use super::branch::{Branch, Fading, Here};
use super::loading::{Loading, Response, masing};
use super::reachable::reachable;
use super::spring::SpringState;
use crate::math::exponential::{faded_of, faded_within};
use crate::math::scalar::{Scalar, logarithmic_mean};

/// Edges of the groups of elements, in units of the mean yield displacement of the plain curve.
const EDGES: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 3.0];
/// Groups of elements.
pub const GROUPS: usize = EDGES.len() + 1;

/// What a group of elements, and all that yield later, do: m·v(y) + l·(y − E) + o.
#[derive(Debug, Clone, Copy)]
struct Group<S> {
    weight: S,
    slope: S,
    offset: S,
}

/// Virgin curve of parallel elements and Masing's branches G(d) = 2·V(d/2).
///
/// The plain curve is v(y) = 1 − (1 − κ·y)₊^(1/κ), y = k_0·|x|/F_c; κ → 0 is 1 − e^(−y). Its elements
/// yield with density −v″. Between the edges ¼, ½, 1, 2, 3 that density is multiplied by a weight
/// for each group, then force and displacement are scaled so that F_c and k_0 stay what they are.
#[derive(Debug, Clone, Copy)]
pub struct YieldCurve<S> {
    coulomb: S,
    stiffness: S,
    shape: S,
    groups: [Group<S>; GROUPS],
    /// Force per force of the weighted curve.
    force: S,
    /// y per displacement.
    inverse_distance: S,
    /// Whether it is 1 − e^(−y), and no derivative asks what else it could be.
    exponential: bool,
}

impl<S: Scalar> YieldCurve<S> {
    /// The curve that slides at `coulomb` and starts with `stiffness`.
    pub fn new(coulomb: S, stiffness: S, shape: S, weights: [S; GROUPS]) -> Self {
        let zero = S::constant(0.0);
        let edge = |k: usize| if k == 0 { 0.0 } else { EDGES[k - 1] };
        let at_edge: [(S, S); GROUPS] = std::array::from_fn(|k| plain(S::constant(edge(k)), shape));
        // Slope of the weighted curve at the upper edge of each group: of those that yield later.
        let mut later = [zero; GROUPS];
        let mut left = zero;
        for k in (0..GROUPS).rev() {
            later[k] = left;
            let beyond = if k + 1 < GROUPS { at_edge[k + 1].1 } else { zero };
            left += weights[k] * (at_edge[k].1 - beyond);
        }
        let mut reached = zero;
        let groups = std::array::from_fn(|k| {
            let (yielded, _) = at_edge[k];
            let (beyond, sticking) =
                if k + 1 < GROUPS { at_edge[k + 1] } else { (S::constant(1.0), zero) };
            let slope = later[k] - weights[k] * sticking;
            let group = Group { weight: weights[k], slope, offset: reached - weights[k] * yielded };
            // Beyond the last edge nothing is left that could slope.
            let width = if k + 1 < GROUPS { edge(k + 1) - edge(k) } else { 0.0 };
            reached += weights[k] * (beyond - yielded) + slope * width;
            group
        });
        let is = |number: S, given: f64| number.re() == given && !number.derivative_is_nonzero();
        let exponential = is(shape, 0.0) && weights.iter().all(|weight| is(*weight, 1.0));
        let force = if exponential { coulomb } else { coulomb / reached };
        let inverse_distance = stiffness / if exponential { coulomb } else { force * left };
        Self { coulomb, stiffness, shape, groups, force, inverse_distance, exponential }
    }

    /// Whether it is 1 − e^(−y), and no derivative asks what else it could be.
    pub fn is_exponential(&self) -> bool {
        self.exponential
    }

    /// Force and slope of the first loading at x ≥ 0.
    #[inline(always)]
    fn loading(&self, x: S) -> Response<S> {
        let y = x * self.inverse_distance;
        if self.exponential {
            let yielded = faded_of(-y);
            let slope = self.stiffness - self.stiffness * yielded;
            return Response { force: self.coulomb * yielded, slope };
        }
        self.any_loading(y, faded_of)
    }

    #[inline(always)]
    fn any_loading(&self, y: S, faded: impl Fn(S) -> S) -> Response<S> {
        if (self.shape * y).re() >= 1.0 {
            return Response { force: self.coulomb, slope: S::constant(0.0) };
        }
        let at = y.re();
        let index = EDGES.iter().filter(|edge| at >= **edge).count();
        let group = &self.groups[index];
        let edge = if index == 0 { 0.0 } else { EDGES[index - 1] };
        let (yielded, sticking) = plain_by(y, self.shape, faded);
        Response {
            force: self.force * (group.weight * yielded + group.slope * (y - edge) + group.offset),
            slope: self.force * self.inverse_distance * (group.weight * sticking + group.slope),
        }
    }

    /// A force that the curve reaches.
    pub fn reachable(&self, force: S) -> S {
        reachable(force, self.coulomb)
    }

    /// Where the virgin curve has a reachable force.
    pub fn virgin_inverse(&self, force: S) -> S {
        let s = if force.re() < 0.0 { -1.0 } else { 1.0 };
        let mut x = S::constant(self.reached_at(force.re() * s) / self.inverse_distance.re());
        // A Newton step that moves the value by round-off and carries the derivatives.
        let there = self.loading(x);
        x += (force * s - there.force) / there.slope;
        x * s
    }

    /// y at which the loading has a force, in plain numbers.
    fn reached_at(&self, force: f64) -> f64 {
        let target = force / self.force.re();
        let reached = |y: f64| self.loading(S::constant(y / self.inverse_distance.re())).force.re();
        let index = EDGES.iter().filter(|edge| reached(**edge) <= force).count();
        let group = &self.groups[index];
        if group.slope.re() == 0.0 {
            // Nothing that yields later differs: the plain curve, inverted.
            let left = (-(target - group.offset.re()) / group.weight.re()).ln_1p();
            let z = self.shape.re() * left;
            let series = -left * (1.0 + 0.5 * z);
            return if z.abs() < 1e-8 { series } else { -z.exp_m1() / self.shape.re() };
        }
        let mut low = if index == 0 { 0.0 } else { EDGES[index - 1] };
        let mut high = if index < EDGES.len() { EDGES[index] } else { 2.0 * low };
        while reached(high) < force {
            high *= 2.0;
        }
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            if reached(middle) < force { low = middle } else { high = middle }
        }
    }
}

/// The branch on which a spring is, as numbers.
#[derive(Debug, Clone, Copy)]
pub struct Course<S> {
    /// Reverse point, or 0 on the first loading.
    origin: S,
    force: S,
    /// Way on the first loading per elongation, and force per force there.
    stretch: f64,
    scale: f64,
    fading: Fading<S>,
}

impl<S: Scalar> YieldCurve<S> {
    /// The branch on which this spring is.
    pub fn course(&self, spring: &SpringState<S>) -> Course<S> {
        let (branch, direction) = (spring.present(self), spring.direction);
        let zero = S::constant(0.0);
        let anchor = spring.memory.points().last();
        let (origin, force) = anchor.map_or((zero, zero), |p| (p.position, p.force));
        let size = if branch.first { 1.0 } else { 0.5 };
        let fading = self.faded_over(&branch, direction);
        let (stretch, scale) = (size * direction, direction / size);
        Course { origin, force, stretch, scale, fading }
    }

    /// How a branch would fade were the curve exponential.
    #[inline(always)]
    fn faded_over(&self, branch: &Branch, direction: f64) -> Fading<S> {
        // Branches have twice the size of the first loading.
        let share = self.inverse_distance * if branch.first { 1.0 } else { 0.5 };
        let last = S::constant(0.0);
        Fading { target: branch.target, last, share: share * direction }
    }

    /// Where a motion gets that neither turns round nor closes its loop: what
    /// [`SpringState::walk`] finds, to the bit. `EXPONENTIAL` as in [`Self::is_exponential`].
    #[inline(always)]
    pub fn along<const EXPONENTIAL: bool>(
        &self,
        course: &Course<S>,
        here: &Here<S>,
        displacement: S,
    ) -> Option<Here<S>> {
        let (position, share) = here.reach(&course.fading, displacement);
        if !here.stays(&course.fading, position.re(), share.re()) {
            return None;
        }
        if EXPONENTIAL && here.is_short(share) {
            return Some(here.shortly(&course.fading, displacement, position, share));
        }
        let y = (position - course.origin) * course.stretch * self.inverse_distance;
        if !EXPONENTIAL {
            let Response { force, slope } = self.any_loading(y, faded_within);
            let force = course.force + force * course.scale;
            return Some(Here { position, force, slope, direction: here.direction, steps: 0 });
        }
        let yielded = faded_within(-y);
        let force = course.force + self.coulomb * yielded * course.scale;
        let slope = self.stiffness - self.stiffness * yielded;
        Some(Here { position, force, slope, direction: here.direction, steps: 0 })
    }
}

/// v(y) and its slope, for κ·y < 1; beyond, everything slides.
fn plain<S: Scalar>(y: S, shape: S) -> (S, S) {
    plain_by(y, shape, faded_of)
}

/// The same, by this 1 − e^x.
#[inline(always)]
fn plain_by<S: Scalar>(y: S, shape: S, faded: impl Fn(S) -> S) -> (S, S) {
    let u = shape * y;
    if u.re() >= 1.0 {
        return (S::constant(1.0), S::constant(0.0));
    }
    let yielded = faded(-(y * logarithmic_mean(u)));
    (yielded, -(yielded - 1.0) / (-(u - 1.0)))
}

impl<S: Scalar> Loading<S> for YieldCurve<S> {
    #[inline]
    fn initial_stiffness(&self) -> S {
        self.stiffness
    }

    #[inline(always)]
    fn branch(&self, d: S) -> Response<S> {
        debug_assert!(d.re() >= 0.0, "branch evaluated behind its reverse point: {d:?}");
        let half = self.loading(d * 0.5);
        Response { force: half.force * 2.0, slope: half.slope }
    }

    #[inline(always)]
    fn virgin(&self, x: S) -> Response<S> {
        masing(self, x)
    }

    #[inline]
    fn closes_at_mirror(&self) -> bool {
        true
    }

    #[inline(always)]
    fn fading(&self, branch: &Branch, direction: f64) -> Option<Fading<S>> {
        self.exponential.then(|| self.faded_over(branch, direction))
    }
}
