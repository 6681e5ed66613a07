//! Levenberg-Marquardt within bounds.
//!
//! The normal matrix is formed at once (n·p² operations against the decomposition of all rows, which costs
//! ten times that) with columns scaled by their norms; what stands at a bound and is pushed against it is
//! held, the step of the others is cut at theirs. Slopes are corrected by what each step shows of them and
//! used again (Broyden, Math. Comp. 19 (1965)) as long as steps keep what they promise; the corrections
//! stand beside the slopes, which are never written. Damping after Nielsen, Damping parameter in
//! Marquardt's method, IMM-REP-1999-05.

use nalgebra::{DMatrix, DVector};

use super::rows::{Block, missed, normal, power, products, take_off};
use super::solve::solve;

/// Least and greatest damping, in units of the scaled normal matrix's diagonal.
const DAMPING: (f64, f64) = (1e-12, 1e12);
/// A variable whose slope is this share of the steepest one is left where it is.
const DEAD: f64 = 1e-12;
/// Share of what a step promised that it must gain for its slopes to be corrected and used once more: a
/// residual costs a tenth of its slopes.
const KEPT: (f64, f64) = (0.25, 2.0);
/// Steps that one set of slopes is used for.
const MOST_USES: usize = 8;

/// What is left of the rows of each part, where it lies.
pub trait Parts {
    /// The rows of each part.
    fn parts(&self) -> Vec<&[f64]>;
}

/// Slopes of the rows of each part, where they lie.
pub trait Slopes {
    /// By what a model is stated in.
    fn blocks(&self) -> Vec<Block<'_>>;
    /// Derivative of that by the variables; none where both are the same.
    fn chain(&self) -> Option<&DMatrix<f64>>;
}

/// What is to be minimised.
pub trait Problem {
    /// Why it may fail.
    type Error;
    /// What is left.
    type Residual: Parts;
    /// Its slopes.
    type Slopes: Slopes;

    /// What is left at a point.
    fn residual(&mut self, at: &[f64]) -> Result<Self::Residual, Self::Error>;

    /// The slopes of that; with the parts of the residual, row by row.
    fn slopes(&mut self, at: &[f64]) -> Result<Self::Slopes, Self::Error>;

    /// Does work over all rows, which may take long.
    fn over_rows<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Result<R, Self::Error>;
}

/// Between which values each variable may be.
#[derive(Debug, Clone, Copy)]
pub struct Bounds<'a> {
    /// Least values.
    pub low: &'a [f64],
    /// Greatest values.
    pub high: &'a [f64],
}

impl Bounds<'_> {
    fn inside(&self, at: &DVector<f64>) -> DVector<f64> {
        let places = at.iter().zip(self.low).zip(self.high);
        let inside = places.map(|((value, low), high)| value.max(*low).min(*high));
        DVector::from_iterator(at.len(), inside)
    }
}

/// What keeps a variable near a centre where rows tell little of it: one more row, weight·(x − centre).
#[derive(Debug, Clone, Copy)]
pub struct Pull {
    /// Which variable.
    pub place: usize,
    /// Where it is kept.
    pub centre: f64,
    /// How strongly.
    pub weight: f64,
}

/// When to end, and how to begin.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Evaluations of the residual at most.
    pub most: usize,
    /// Relative change of cost, and of the step, below which nothing more is gained.
    pub tolerance: f64,
    /// Sum of squares that rounding may leave: from there on it changes at random.
    pub nothing: f64,
    /// Whether the residual depends on the variables nearly in a straight line: then it may end on
    /// corrected slopes, too.
    pub straight: bool,
    /// To start with, in units of the scaled normal matrix's diagonal.
    pub damping: f64,
    /// Over which sums over rows are divided.
    pub threads: usize,
}

/// Where the iteration ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The point.
    pub x: Vec<f64>,
    /// Sum of squares there.
    pub cost: f64,
    /// Whether nothing more is to be gained.
    pub converged: bool,
    /// Whether the slopes that were asked for last belong to the point, or to the one before a last step
    /// that gained less than the tolerance.
    pub fresh: bool,
}

/// Minimises Σr² within bounds; `scale` is the typical size of each variable, by which one without slope is
/// measured.
pub fn minimise<P: Problem>(
    problem: &mut P,
    begin: &[f64],
    bounds: Bounds<'_>,
    scale: &[f64],
    pulls: &[Pull],
    settings: Settings,
) -> Result<Minimum, P::Error> {
    let Settings { most, tolerance, nothing, straight, mut damping, threads } = settings;
    let scale = DVector::from_column_slice(scale);
    let mut x = bounds.inside(&DVector::from_column_slice(begin));
    let mut left = problem.residual(x.as_slice())?;
    let mut cost = squares(problem, &left, threads)? + pulled(pulls, &x);
    let (mut spent, mut growth) = (1, 2.0);
    let mut largest = DVector::zeros(x.len());
    let ended = |x: &DVector<f64>, cost: f64, converged: bool, fresh: bool| {
        Ok(Minimum { x: x.as_slice().to_vec(), cost, converged, fresh })
    };
    'slopes: loop {
        if spent >= most && cost > nothing {
            // Slopes of which no step may be tried.
            return ended(&x, cost, false, false);
        }
        let mut linear = Linear::of(problem, &x, pulls, threads)?;
        for uses in 1..=MOST_USES {
            let gradient = linear.gradient(problem, &left, &x)?;
            // Scales only grow (Moré 1978): a slope that fades must not make a step run away.
            for (largest, curve) in largest.iter_mut().zip(linear.normal.diagonal().iter()) {
                *largest = f64::max(*largest, curve.max(0.0).sqrt());
            }
            let telling = largest.component_mul(&scale);
            let least = DEAD * telling.max();
            let dead = |k: usize| telling[k] <= least;
            let size =
                DVector::from_fn(x.len(), |k, _| if dead(k) { 1.0 / scale[k] } else { largest[k] });
            let held = |k: usize| {
                dead(k)
                    || (x[k] <= bounds.low[k] && gradient[k] > 0.0)
                    || (x[k] >= bounds.high[k] && gradient[k] < 0.0)
            };
            let free: Vec<usize> = (0..x.len()).filter(|k| !held(*k)).collect();
            if cost <= nothing || (free.is_empty() && uses == 1) {
                return ended(&x, cost, true, uses == 1);
            }
            if free.is_empty() {
                continue 'slopes;
            }
            loop {
                if spent >= most {
                    return ended(&x, cost, false, false);
                }
                let step = damped(&linear.normal, &gradient, &size, &free, damping);
                let tried = bounds.inside(&(&x + &step));
                let moved = &tried - &x;
                let promised = promised(&gradient, &linear.normal, &moved);
                let still =
                    |k: usize| moved[k].abs() <= tolerance * (x[k].abs() + tolerance * scale[k]);
                if (0..x.len()).all(still) {
                    if uses > 1 {
                        continue 'slopes;
                    }
                    return ended(&x, cost, true, true);
                }
                if uses > 1 && promised <= tolerance * cost {
                    if straight {
                        return ended(&x, cost, true, false);
                    }
                    continue 'slopes;
                }
                let after = problem.residual(tried.as_slice())?;
                spent += 1;
                let power = squares(problem, &after, threads)? + pulled(pulls, &tried);
                if power < cost {
                    let gained = if promised > 0.0 { (cost - power) / promised } else { 0.0 };
                    damping *= f64::max(1.0 / 3.0, 1.0 - (2.0 * gained.min(1.0) - 1.0).powi(3));
                    (damping, growth) = (damping.max(DAMPING.0), 2.0);
                    let flat = cost - power <= tolerance * cost;
                    let before = std::mem::replace(&mut left, after);
                    (x, cost) = (tried, power);
                    if flat && (uses == 1 || straight) {
                        return ended(&x, cost, true, uses == 1);
                    }
                    if flat || !(KEPT.0 < gained && gained < KEPT.1) || uses == MOST_USES {
                        continue 'slopes;
                    }
                    linear.correct(problem, &before, &left, &moved, &size)?;
                    break;
                }
                if uses > 1 {
                    // Slopes of another point: look again before the damping is raised.
                    continue 'slopes;
                }
                // What a step cut at a bound promises says nothing of how much there is to gain.
                if self::promised(&gradient, &linear.normal, &step) <= tolerance * cost {
                    return ended(&x, cost, true, true);
                }
                (damping, growth) = (damping * growth, 2.0 * growth);
                if damping > DAMPING.1 {
                    return ended(&x, cost, true, true);
                }
            }
        }
    }
}

/// The residual about a point, as far as its slopes tell it: J·C + Σ missed·alongᵀ.
struct Linear<'a, S> {
    slopes: S,
    corrections: Vec<Correction>,
    normal: DMatrix<f64>,
    pulls: &'a [Pull],
    threads: usize,
}

/// What one step has shown of the slopes.
struct Correction {
    missed: Vec<Vec<f64>>,
    along: DVector<f64>,
}

impl Correction {
    /// Product of what was missed with the rows of other parts.
    fn times(&self, parts: &[&[f64]], threads: usize) -> f64 {
        let blocks: Vec<Block<'_>> =
            self.missed.iter().map(|own| Block { columns: &[0], slopes: own }).collect();
        products(&blocks, parts, 1, threads)[0]
    }
}

impl<'a, S: Slopes> Linear<'a, S> {
    /// With fresh slopes.
    fn of<P: Problem<Slopes = S>>(
        problem: &mut P,
        at: &DVector<f64>,
        pulls: &'a [Pull],
        threads: usize,
    ) -> Result<Self, P::Error> {
        let slopes = problem.slopes(at.as_slice())?;
        let blocks = slopes.blocks();
        let mut normal = problem.over_rows(|| normal(&blocks, at.len(), threads))?;
        drop(blocks);
        if let Some(chain) = slopes.chain() {
            normal = chain.tr_mul(&(normal * chain));
        }
        for pull in pulls {
            normal[(pull.place, pull.place)] += pull.weight * pull.weight;
        }
        Ok(Self { slopes, corrections: Vec::new(), normal, pulls, threads })
    }

    /// Half the gradient of Σr².
    fn gradient<P: Problem>(
        &self,
        problem: &P,
        left: &impl Parts,
        at: &DVector<f64>,
    ) -> Result<DVector<f64>, P::Error> {
        let mut found = self.times(problem, &left.parts())?;
        for pull in self.pulls {
            found[pull.place] += pull.weight * pull.weight * (at[pull.place] - pull.centre);
        }
        Ok(found)
    }

    /// Slopes, transposed, times rows.
    fn times<P: Problem>(&self, problem: &P, rows: &[&[f64]]) -> Result<DVector<f64>, P::Error> {
        let (size, threads) = (self.normal.nrows(), self.threads);
        let (blocks, corrections) = (self.slopes.blocks(), &self.corrections);
        let (mut found, shares) = problem.over_rows(|| {
            let shares: Vec<f64> = corrections.iter().map(|own| own.times(rows, threads)).collect();
            (products(&blocks, rows, size, threads), shares)
        })?;
        if let Some(chain) = self.slopes.chain() {
            found = chain.tr_mul(&found);
        }
        for (own, share) in corrections.iter().zip(shares) {
            found.axpy(share, &own.along, 1.0);
        }
        Ok(found)
    }

    /// Adds the least change of the slopes that explains what the last step changed, steps measured in
    /// units of 1/size.
    fn correct<P: Problem>(
        &mut self,
        problem: &P,
        before: &impl Parts,
        after: &impl Parts,
        moved: &DVector<f64>,
        size: &DVector<f64>,
    ) -> Result<(), P::Error> {
        let along = size.component_mul(size).component_mul(moved);
        let length = along.dot(moved);
        let step = self.slopes.chain().map_or_else(|| moved.clone(), |chain| chain * moved);
        let (blocks, corrections, threads) =
            (self.slopes.blocks(), &self.corrections, self.threads);
        let (before, after) = (before.parts(), after.parts());
        let (missed, squared) = problem.over_rows(|| {
            let mut found = missed(&blocks, &before, &after, &step, length, threads);
            for own in corrections {
                take_off(&mut found, &own.missed, own.along.dot(moved) / length);
            }
            let parts: Vec<&[f64]> = found.iter().map(Vec::as_slice).collect();
            let squared = power(&parts, threads);
            (found, squared)
        })?;
        let parts: Vec<&[f64]> = missed.iter().map(Vec::as_slice).collect();
        let cross = self.times(problem, &parts)? * along.transpose();
        self.normal += &cross + cross.transpose() + squared * &along * along.transpose();
        self.corrections.push(Correction { missed, along });
        Ok(())
    }
}

fn squares<P: Problem>(problem: &P, left: &P::Residual, threads: usize) -> Result<f64, P::Error> {
    let parts = left.parts();
    problem.over_rows(|| power(&parts, threads))
}

/// What pulls add to the sum of squares.
fn pulled(pulls: &[Pull], at: &DVector<f64>) -> f64 {
    pulls.iter().map(|pull| (pull.weight * (at[pull.place] - pull.centre)).powi(2)).sum()
}

/// What a step would take off the sum of squares if the residual were linear.
fn promised(gradient: &DVector<f64>, normal: &DMatrix<f64>, step: &DVector<f64>) -> f64 {
    -(2.0 * gradient.dot(step) + step.dot(&(normal * step)))
}

/// The damped step of the free variables; 0 for the others.
fn damped(
    normal: &DMatrix<f64>,
    gradient: &DVector<f64>,
    size: &DVector<f64>,
    free: &[usize],
    damping: f64,
) -> DVector<f64> {
    let scaled = DMatrix::from_fn(free.len(), free.len(), |row, column| {
        let (one, other) = (free[row], free[column]);
        let raised = if row == column { damping } else { 0.0 };
        normal[(one, other)] / (size[one] * size[other]) + raised
    });
    let right = DVector::from_fn(free.len(), |row, _| gradient[free[row]] / size[free[row]]);
    let found = solve(scaled, &right);
    let mut step = DVector::zeros(gradient.len());
    for (value, place) in found.iter().zip(free) {
        step[*place] = -value / size[*place];
    }
    step
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    /// A function of a few variables whose rows lie in parts.
    struct Function<R, J> {
        residual: R,
        slopes: J,
        asked: usize,
    }

    struct Rows(Vec<Vec<f64>>);

    impl Parts for Rows {
        fn parts(&self) -> Vec<&[f64]> {
            self.0.iter().map(Vec::as_slice).collect()
        }
    }

    /// Columns and slopes of each part, and the chain.
    struct Columns(Vec<(Vec<usize>, Vec<f64>)>, Option<DMatrix<f64>>);

    impl Slopes for Columns {
        fn blocks(&self) -> Vec<Block<'_>> {
            self.0.iter().map(|(columns, slopes)| Block { columns, slopes }).collect()
        }

        fn chain(&self) -> Option<&DMatrix<f64>> {
            self.1.as_ref()
        }
    }

    impl<R: FnMut(&[f64]) -> Vec<Vec<f64>>, J: FnMut(&[f64]) -> Columns> Problem for Function<R, J> {
        type Error = Infallible;
        type Residual = Rows;
        type Slopes = Columns;

        fn residual(&mut self, at: &[f64]) -> Result<Rows, Infallible> {
            Ok(Rows((self.residual)(at)))
        }

        fn slopes(&mut self, at: &[f64]) -> Result<Columns, Infallible> {
            self.asked += 1;
            Ok((self.slopes)(at))
        }

        fn over_rows<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, Infallible> {
            Ok(work())
        }
    }

    const USUAL: Settings = Settings {
        most: 200,
        tolerance: 1e-12,
        nothing: 0.0,
        straight: false,
        damping: 0.1,
        threads: 1,
    };
    const WIDE: Bounds<'static> =
        Bounds { low: &[f64::NEG_INFINITY; 2], high: &[f64::INFINITY; 2] };

    fn found<R, J>(
        residual: R,
        slopes: J,
        begin: &[f64],
        bounds: Bounds<'_>,
        pulls: &[Pull],
    ) -> (Minimum, usize)
    where
        R: FnMut(&[f64]) -> Vec<Vec<f64>>,
        J: FnMut(&[f64]) -> Columns,
    {
        let mut problem = Function { residual, slopes, asked: 0 };
        let scale = vec![1.0; begin.len()];
        let Ok(found) = minimise(&mut problem, begin, bounds, &scale, pulls, USUAL);
        (found, problem.asked)
    }

    fn rosenbrock(x: &[f64]) -> Vec<Vec<f64>> {
        vec![vec![10.0 * (x[1] - x[0] * x[0])], vec![1.0 - x[0]]]
    }

    fn its_slopes(x: &[f64]) -> Columns {
        Columns(vec![(vec![0, 1], vec![-20.0 * x[0], 10.0]), (vec![0], vec![-1.0])], None)
    }

    #[test]
    fn the_valley_is_followed_to_its_end_and_no_further_than_a_bound() {
        let (wide, asked) = found(rosenbrock, its_slopes, &[-1.2, 1.0], WIDE, &[]);
        assert!(wide.converged && wide.fresh);
        assert!((wide.x[0] - 1.0).abs() < 1e-9 && (wide.x[1] - 1.0).abs() < 1e-9, "{wide:?}");
        assert!(asked < 30, "{asked} sets of slopes");
        let tight = Bounds { low: &[-2.0; 2], high: &[0.5, 2.0] };
        let (cut, _) = found(rosenbrock, its_slopes, &[-1.2, 1.0], tight, &[]);
        assert!(cut.converged && cut.x[0] == 0.5 && (cut.x[1] - 0.25).abs() < 1e-9, "{cut:?}");
        let outside = Bounds { low: &[2.0, 0.0], high: &[3.0, 3.0] };
        let (moved, _) = found(rosenbrock, its_slopes, &[-1.2, 1.0], outside, &[]);
        assert!(moved.x == [2.0, 3.0], "{moved:?}");
    }

    #[test]
    fn it_ends_after_so_many_evaluations() {
        let mut problem = Function { residual: rosenbrock, slopes: its_slopes, asked: 0 };
        let few = Settings { most: 3, ..USUAL };
        let Ok(end) = minimise(&mut problem, &[-1.2, 1.0], WIDE, &[1.0; 2], &[], few);
        assert!(!end.converged);
        let none = Settings { most: 0, ..USUAL };
        let Ok(end) = minimise(&mut problem, &[-1.2, 1.0], WIDE, &[1.0; 2], &[], none);
        assert_eq!((end.x, end.converged), (vec![-1.2, 1.0], false));
    }

    #[test]
    fn variables_that_a_chain_leads_to_have_the_same_minimum() {
        // The first one by its logarithm, the second one as a share of the first.
        let at = |u: &[f64]| [u[0].exp(), u[1] * u[0].exp()];
        let chained = |u: &[f64]| {
            let first = u[0].exp();
            let chain = DMatrix::from_row_slice(2, 2, &[first, 0.0, u[1] * first, first]);
            Columns(its_slopes(&at(u)).0, Some(chain))
        };
        let (end, _) = found(|u| rosenbrock(&at(u)), chained, &[-1.0, 0.3], WIDE, &[]);
        assert!(end.x[0].abs() < 1e-9 && (end.x[1] - 1.0).abs() < 1e-9, "{end:?}");
    }

    #[test]
    fn a_pull_is_one_more_row() {
        let pull = Pull { place: 0, centre: 0.2, weight: 3.0 };
        let (one, _) = found(rosenbrock, its_slopes, &[-1.2, 1.0], WIDE, &[pull]);
        let more = |x: &[f64]| {
            let mut rows = rosenbrock(x);
            rows.push(vec![3.0 * (x[0] - 0.2)]);
            rows
        };
        let its = |x: &[f64]| {
            let mut slopes = its_slopes(x);
            slopes.0.push((vec![0], vec![3.0]));
            slopes
        };
        let (other, _) = found(more, its, &[-1.2, 1.0], WIDE, &[]);
        assert!((one.cost - other.cost).abs() < 1e-12 * other.cost);
        assert!((one.x[0] - other.x[0]).abs() < 1e-9 && (one.x[1] - other.x[1]).abs() < 1e-9);
        // Where no row tells of a variable, it goes where it is pulled.
        let flat = |_: &[f64]| Columns(vec![(vec![0, 1], vec![0.0, 0.0])], None);
        let pull = Pull { place: 1, centre: 0.7, weight: 1.0 };
        let (end, _) = found(|_| vec![vec![1.0]], flat, &[0.0, 0.0], WIDE, &[pull]);
        assert!(end.x[0] == 0.0 && (end.x[1] - 0.7).abs() < 1e-9, "{end:?}");
    }
}
