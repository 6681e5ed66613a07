//! Rows of plain steps of a body on a spring, each fitted to the oscillator that it nearly is.
//!
//! A ring is many swings, and each of them has a turn, where a spring with memory has a kink. So steps
//! that stop at turns are not worth what one of them costs; short ones of [`FrictionLaw::glide`] are,
//! as long as the error allows.

use std::cell::Cell;
use std::f64::consts::PI;
use std::ops::Range;

use super::glide::{Acting, Efforts, Glide, Seen};
use super::swing::Swing;
use crate::friction::FrictionLaw;
use crate::math::verlet::Verlet;
use crate::plant::Run;

/// Share of the tolerance that a ring may be off after a radian of its phase.
const LOCAL: f64 = 0.01;
/// Excess of that over which a row is taken again.
const REFUSED: f64 = 2.0;
/// What part of that the next row aims at.
const AIM: f64 = 0.8;
/// Steps change by no more than this from row to row.
const CHANGE: Range<f64> = 0.1..4.0;
/// The longest step and the first after a new input, in steps of the fast integrator.
const LONGEST: f64 = 12.0;
const FIRST: f64 = 1.0;
/// The shortest, which is taken whatever its error.
const SHORTEST: f64 = 1.0 / 64.0;
/// Steps of a row at most and at least, and of the first after a new input; between them half a swing,
/// so that steps grow as fast as a ring dies out.
const STEPS: usize = 48;
const FEWEST_STEPS: usize = 12;
const FIRST_STEPS: usize = 16;
/// Share of the tolerance that what is beside an oscillator may come to until a ring has died out.
const LINEAR: f64 = 0.15;
/// Radians that a ring is thought to last at most.
const MOST_RADIANS: f64 = 100.0;
/// What a step misses of the second difference of an effort.
const TWELFTH: f64 = 1.0 / 12.0;
/// Errors are weighed as if a spring had at least this share of its greatest stiffness.
const SOFTEST: f64 = 0.1;

/// Rows of steps: how long the next ones are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rows {
    /// Duration of a step of the fast integrator.
    natural: f64,
    /// Error of a position that is allowed.
    tolerance: f64,
    /// Whether the machine is bare.
    bare: bool,
    span: f64,
    steps: usize,
    /// The rate at which the force of the spring rose at the end of the last row; no number where
    /// something else came after it.
    rising: f64,
    /// Whether the last row showed a ring of an oscillator and next to nothing beside it.
    linear: bool,
}

/// A row that was taken.
#[derive(Debug, Clone, Copy)]
pub(super) struct Taken {
    /// How long it took.
    pub duration: f64,
    pub steps: usize,
    /// Rows that were taken in vain.
    pub refused: u64,
    /// The stiffness that leaves least of a remainder, and the damping beside it.
    pub stiffness: f64,
    pub damping: f64,
}

impl Rows {
    /// With this error allowed; a step of the fast integrator lasts `natural`.
    pub fn new(tolerance: f64, natural: f64) -> Self {
        let (rising, linear) = (f64::NAN, false);
        Self { natural, tolerance, bare: false, span: natural, steps: FIRST_STEPS, rising, linear }
    }

    /// A new input: what steps were like before says nothing of the next.
    pub fn begin<L: FrictionLaw<f64>>(&mut self, swing: &Swing<'_>) {
        self.bare = L::SPRINGS && swing.machine.is_bare() && swing.machine.glides(swing.run);
        self.span = self.span.min(FIRST * self.natural);
        self.steps = FIRST_STEPS;
        self.linear = false;
    }

    /// The body goes on otherwise than in a row, maybe on another contact.
    pub fn leave(&mut self, another: bool) {
        self.rising = f64::NAN;
        self.linear &= !another;
    }

    /// Whether the ring is so near to that of an oscillator that its turns are of no account.
    pub fn linear(&self) -> bool {
        self.linear
    }

    /// Beyond this a step of the oscillator is worth more than a row, where its error and the turns of
    /// the motion allow it; infinite where rows may still get longer.
    pub fn worth(&self) -> f64 {
        let lengthens = self.span < LONGEST * self.natural && !self.linear;
        if lengthens { f64::INFINITY } else { 0.5 * STEPS as f64 * self.span }
    }

    /// Plain steps from here, where there are any, up to the first that is not.
    pub fn take<L: FrictionLaw<f64>>(
        &mut self,
        swing: &mut Swing<'_>,
        law: &L,
        state: &mut L::State,
        stiffness: f64,
        left: f64,
    ) -> Option<Taken> {
        if !L::SPRINGS || !self.bare {
            return None;
        }
        let damping = law.springs(state)?;
        let greatest = law.greatest_stiffness();
        let shortest = SHORTEST * self.natural;
        let inertia = swing.machine.inertia;
        let (effort, _) = swing.here();
        let begun = state.clone();
        let (mut refused, mut stiffness) = (0, stiffness.min(greatest));
        loop {
            let (mut span, mut steps) = (self.span, self.steps);
            if left < 1.5 * steps as f64 * span {
                steps = (left / span).ceil().max(1.0) as usize;
                span = left / steps as f64;
            }
            let oscillator = (stiffness, damping);
            let begin = (&*swing.run, self.rising);
            let went = go(law, state, begin, (inertia, effort), oscillator, (steps, span));
            swing.count(went.steps as u64);
            let weighed = stiffness.max(SOFTEST * greatest);
            let relative = went.strayed / weighed / (LOCAL * self.tolerance);
            if went.stiffness.is_finite() {
                stiffness = went.stiffness.max(0.0).min(greatest);
            }
            let change = (AIM / relative.max(f64::MIN_POSITIVE)).cbrt();
            let next = span * change.clamp(CHANGE.start, CHANGE.end);
            self.span = next.max(shortest).min(LONGEST * self.natural);
            // A state that is not finite cannot be mended by shorter steps.
            if relative > REFUSED && span > shortest {
                refused += 1;
                state.clone_from(&begun);
                continue;
            }
            let half_a_swing = PI / (greatest / inertia).sqrt();
            self.steps = ((half_a_swing / self.span).ceil() as usize).clamp(FEWEST_STEPS, STEPS);
            if went.steps == 0 {
                return None;
            }
            *swing.run = went.run;
            let duration = went.steps as f64 * span;
            // What comes again in every swing adds up as long as the ring lasts. A slide is no ring.
            let lasts = ((inertia * stiffness).sqrt() / damping).min(MOST_RADIANS);
            let beside = went.range / weighed * (1.0 + lasts);
            let swung = (stiffness / inertia).sqrt() * duration >= 2.0 * PI;
            (self.linear, self.rising) = (swung && beside < LINEAR * self.tolerance, went.rising);
            return Some(Taken { duration, steps: went.steps, refused, stiffness, damping });
        }
    }
}

/// Where steps in a row lead, and what they were like.
struct Went {
    run: Run<f64>,
    /// How many were plain.
    steps: usize,
    /// By what effort each of them was off, in the mean.
    strayed: f64,
    /// How far apart the greatest and the least effort beside the oscillator are.
    range: f64,
    /// The rate at which the force of the spring rises at the end.
    rising: f64,
    /// The stiffness that leaves least of a remainder; no number where nothing moved.
    stiffness: f64,
}

/// Goes through so many steps of a duration, or up to the first that is not plain, from where the body
/// is and the rate at which the force of the spring rises, where that is known.
#[inline(never)]
fn go<L: FrictionLaw<f64>>(
    law: &L,
    state: &mut L::State,
    (run, rising): (&Run<f64>, f64),
    (inertia, effort): (f64, f64),
    (stiffness, damping): (f64, f64),
    (steps, span): (usize, f64),
) -> Went {
    let (verlet, ahead) = Verlet::fitted(span, inertia, stiffness, damping);
    let mut run = *run;
    let hurry = |run: &mut Run<f64>, more: f64| {
        run.velocity += more;
        run.friction += damping * more;
    };
    if rising.is_finite() {
        let more = ahead * (stiffness * run.velocity - rising);
        hurry(&mut run, more);
    }
    let foreseen = Cell::new(0.0);
    let seen = Watch::from(&run, stiffness, damping, &foreseen);
    let efforts = Held { effort, foreseen: &foreseen };
    // Own places and a copy: nobody else can see them, so that they stay in registers.
    let mut glide = Glide {
        verlet,
        run,
        efforts,
        seen,
        samples: 0..steps,
        part: 0,
        parts: 1,
        levels: (1.0, 1.0),
        effort,
        efforts_of_step: (0.0, 0.0),
        there: Acting::plain(0.0),
    };
    law.clone().glide(state, &mut glide);
    let (mut run, steps, seen) = (glide.run, glide.samples.start, glide.seen);
    let slope = (seen.change + 0.5 * seen.bend) / span;
    hurry(&mut run, -ahead * slope);
    Went {
        run,
        steps,
        strayed: seen.strayed(steps),
        range: seen.most - seen.least,
        rising: stiffness * run.velocity - slope,
        stiffness: seen.products / seen.squares,
    }
}

/// All effort but friction, held; with it what a step would miss, as far as that is foreseen.
struct Held<'a> {
    effort: f64,
    foreseen: &'a Cell<f64>,
}

impl Efforts<f64> for Held<'_> {
    #[inline(always)]
    fn at(&self, _: usize) -> f64 {
        self.effort + self.foreseen.get()
    }
}

/// What friction does beside a spring and a damping.
///
/// Verlet's steps x₂ − 2·x₁ + x₀ = h²/J·R₁ miss h²/12 of the second derivative of R, whatever acts
/// beside the oscillator that they are fitted to: they go as if R₁ were off by a twelfth of its second
/// difference. The last one known is what is foreseen of the next, and added to the effort; what is
/// left is the error.
struct Watch<'a> {
    stiffness: f64,
    force: f64,
    /// By how much the remainder k·x − σ changed in the last step; no number before the first.
    change: f64,
    /// The remainder since the first place, the least and the greatest of it.
    remainder: f64,
    least: f64,
    most: f64,
    /// How the last two changes differ; a twelfth of that is what is foreseen for the next.
    bend: f64,
    foreseen: &'a Cell<f64>,
    /// The sum of what was not foreseen.
    bends: f64,
    /// Sums of Δx² and of Δx·Δσ.
    squares: f64,
    products: f64,
}

impl<'a> Watch<'a> {
    fn from(run: &Run<f64>, stiffness: f64, damping: f64, foreseen: &'a Cell<f64>) -> Self {
        let force = run.friction - damping * run.velocity;
        let change = f64::NAN;
        let (remainder, least, most, bend) = (0.0, 0.0, 0.0, 0.0);
        let (bends, squares, products) = (0.0, 0.0, 0.0);
        Self {
            stiffness,
            force,
            change,
            remainder,
            least,
            most,
            bend,
            foreseen,
            bends,
            squares,
            products,
        }
    }

    fn strayed(&self, steps: usize) -> f64 {
        TWELFTH * self.bends / steps.saturating_sub(1).max(1) as f64
    }
}

impl<T, E> Seen<f64, T, E> for Watch<'_> {
    #[inline(always)]
    fn looks(&self) -> bool {
        false
    }

    #[inline(always)]
    fn still(&mut self, _: Range<usize>, _: &Run<f64>, _: impl Fn(usize) -> f64) -> bool {
        false
    }

    #[inline(always)]
    fn see(&mut self, _: usize, _: &Run<f64>, _: &T, _: &E) {}

    #[inline(always)]
    fn pulled(&mut self, way: f64, force: f64) {
        // The next step waits for what is done with the force: as little as can be.
        let before = self.stiffness * way + self.force;
        let bend = (before - self.change) - force;
        let change = before - force;
        // What is no number, of the first step, is no bend.
        if !bend.is_nan() {
            self.foreseen.set(TWELFTH * bend);
            self.bends += (bend - self.bend).abs();
            self.bend = bend;
        }
        self.remainder += change;
        self.least = self.least.min(self.remainder);
        self.most = self.most.max(self.remainder);
        self.squares += way * way;
        self.products += way * (force - self.force);
        (self.force, self.change) = (force, change);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::response::halves;

    #[test]
    fn a_fitted_step_is_exact_on_an_oscillator() {
        let (inertia, effort) = (0.0076, 0.2);
        for (stiffness, damping) in [(3000.0, 0.45), (3000.0, 0.0), (40.0, 3.0), (0.0, 0.3)] {
            for span in [1e-4, 8e-4, 3e-3] {
                let (verlet, _) = Verlet::fitted(span, inertia, stiffness, damping);
                let verlet = verlet.dragged(damping);
                let (start, velocity, force) = (1e-5, 0.02, stiffness * 1e-5);
                let push = effort - force;
                let gone = verlet.displacement(velocity, push);
                let then = stiffness * (start + gone);
                let arrived = verlet.arrive(velocity, push + effort, damping, then);
                let (decay, square) = (0.5 * damping / inertia, stiffness / inertia);
                let (_, exact) = halves(square, decay, span);
                let way = velocity * exact.impulse + push * exact.first / inertia;
                let speed = velocity * exact.slope + push * exact.impulse / inertia;
                assert!((gone - way).abs() <= 1e-13 * way.abs(), "{span}: {gone} {way}");
                assert!((arrived - speed).abs() <= 1e-12 * 0.02, "{span}: {arrived} {speed}");
            }
        }
    }

    #[test]
    fn a_spring_too_soft_to_tell_is_none() {
        let [soft, none] = [1e-13, 0.0].map(|k| Verlet::fitted(8e-4, 0.002, k, 0.3).0);
        assert_eq!(soft.displacement(0.02, 0.1), none.displacement(0.02, 0.1));
    }
}
