//! Plain steps of eight contacts at once: what [`FrictionLaw::glide`] does, without a choice.
//!
//! Most rows stick and go on along their branches (`onward`), or slide forward (`forward`); where a
//! lane of a row does anything else, those that do go through another pass (`stick`, `slide`), in which
//! what few need is left out where none does.

mod forward;
mod onward;
mod slide;
mod stick;

use std::array::from_mut;

use super::{HsiehPan, HsiehPanState};
use crate::friction::elements::loading::Loading;
use crate::friction::elements::memory::ReversePoint;
use crate::friction::elements::spring::SpringState;
use crate::lanes::{Block, Bodies, Contacts, Row, WIDTH};
use crate::scalar::Scalar;

use forward::forward;
use onward::onward;
use slide::slide;
use stick::stick;

/// Contacts of [`HsiehPan`] whose limit of hardening is a square, whose level falls as a bell and
/// whose damper sits beside the spring.
#[derive(Debug, Clone, Default)]
#[repr(align(64))]
pub struct Lanes {
    /// 0 sticks, ±1 slides.
    mode: Row,
    /// Force of spring and series.
    force: Row,
    position: Row,
    slope: Row,
    steps: Row,
    plastic: Row,
    hardening: Row,
    /// Of the branch: its direction and the share of d_0 that a displacement is.
    direction: Row,
    per_displacement: Row,
    /// Where it closes, times that direction.
    closing: Row,
    /// 1 on the first loading, and where the first loop closes at the mirror of its reverse point.
    first: Row,
    mirrors: Row,
    present: Course,
    /// The branch that goes on where the present one closes.
    older: Course,
    /// Of the curve: k_0 − k_inf, that times d_0, and 1/d_0.
    fading: Row,
    faded_force: Row,
    inverse_distance: Row,
    distance: Row,
    /// How many times as large branches are as the first loading.
    twice: Row,
    initial_stiffness: Row,
    final_stiffness: Row,
    /// Creep: α, c, 2·c, α·h and the product of the last two.
    rate: Row,
    coefficient: Row,
    twice_coefficient: Row,
    progress: Row,
    pace: Row,
    damping: Row,
    /// See `Verlet::dragged`, and 1/(J + h/2·C_s) and h/2 of that.
    stride: Row,
    kept: Row,
    share: Row,
    braking: Row,
    greatest: Row,
    /// Of the slide.
    coulomb: Row,
    excess: Row,
    per_velocity: Row,
    viscous: Row,
    per_distance: Row,
    /// Just under what the slope of the spring is at the level of break-away, below which it is steeper.
    softest: Row,
    /// ℓ, and that times this slope.
    reach: Row,
    least: Row,
    /// 1/J and h/2 of that.
    undamped_share: Row,
    undamped_braking: Row,
    sticks: bool,
    slides: bool,
    /// No lane has been given a hardening below 0, where a contact that cannot creep would.
    tame: bool,
    /// No level of a slide rises with speed.
    falls: bool,
}

/// Branches, one in each lane.
#[derive(Debug, Clone, Default)]
struct Course {
    /// Where each begins, the way along it per displacement and the force per force on it.
    origin: Row,
    force: Row,
    stretch: Row,
    scale: Row,
    /// Where it closes.
    target: Row,
}

impl Course {
    /// Takes the branch of a spring that moves in this direction with these points remembered.
    fn take(&mut self, lane: usize, points: &[ReversePoint<f64>], mirrors: bool, direction: f64) {
        let never = f64::INFINITY * direction;
        let (origin, target) = match points {
            [] => (ReversePoint { position: 0.0, force: 0.0 }, never),
            [only] => (*only, if mirrors { -only.position } else { never }),
            [.., older, anchor] => (*anchor, older.position),
        };
        let twice = points.is_empty() && mirrors;
        self.origin.0[lane] = origin.position;
        self.force.0[lane] = origin.force;
        self.stretch.0[lane] = if twice { 2.0 * direction } else { direction };
        self.scale.0[lane] = if twice { 0.5 * direction } else { direction };
        self.target.0[lane] = target;
    }
}

/// What [`Bodies::changed`] says of a spring.
const TURNED: u64 = 1;
const CLOSED: u64 = 2;

/// Whether these contacts can go through plain steps abreast.
pub fn fits<S: Scalar>(law: &HsiehPan<S>) -> bool {
    let p = &law.parameters;
    let bell = p.stribeck_exponent.re() == 2.0 || p.breakaway.re().is_infinite();
    bell && law.plastic.is_square() && !law.damper_on_spring && !law.rated
}

/// Of a force, what is more than round-off.
const ROUNDING: f64 = 1e-13;

/// Just under the slope of the spring at the level of break-away, or that far from a reverse point
/// where it never breaks away.
fn softest<S: Scalar>(law: &HsiehPan<S>) -> f64 {
    let p = &law.parameters;
    if !p.breakaway.re().is_finite() {
        return p.final_stiffness.re();
    }
    let slope = law.curve.virgin(law.curve.virgin_inverse(p.breakaway)).slope.re();
    (slope * (1.0 - 1e-9)).max(p.final_stiffness.re())
}

impl<S: Scalar> Contacts<S, HsiehPan<S>> for Lanes {
    fn fit(&mut self, lane: usize, law: &HsiehPan<S>, bodies: &Bodies) {
        let p = &law.parameters;
        let damping = p.damping.re();
        let dragged = bodies.dragged(lane, damping);
        let [_, fading, distance] = law.curve.numbers();
        self.fading.0[lane] = fading;
        self.faded_force.0[lane] = fading * distance;
        self.inverse_distance.0[lane] = 1.0 / distance;
        self.initial_stiffness.0[lane] = law.curve.initial_stiffness().re();
        self.final_stiffness.0[lane] = p.final_stiffness.re();
        self.rate.0[lane] = law.plastic.rate.re();
        self.coefficient.0[lane] = law.plastic.coefficient.re();
        self.twice_coefficient.0[lane] = law.plastic.coefficient.re() * 2.0;
        self.progress.0[lane] = law.plastic.rate.re() * bodies.span.0[lane];
        self.pace.0[lane] = self.progress.0[lane] * self.twice_coefficient.0[lane];
        self.damping.0[lane] = damping;
        self.stride.0[lane] = dragged.stride;
        self.kept.0[lane] = dragged.kept;
        self.share.0[lane] = dragged.share;
        self.braking.0[lane] = dragged.braking;
        self.greatest.0[lane] = p.breakaway.re();
        self.coulomb.0[lane] = p.coulomb.re();
        self.per_velocity.0[lane] = 1.0 / p.stribeck_velocity.re();
        self.viscous.0[lane] = p.viscous.re();
        self.per_distance.0[lane] = 1.0 / p.slip_distance.re();
        self.reach.0[lane] = p.slip_distance.re();
        self.distance.0[lane] = distance;
        self.twice.0[lane] = if law.curve.closes_at_mirror() { 2.0 } else { 1.0 };
        self.softest.0[lane] = softest(law);
        self.least.0[lane] = p.slip_distance.re() * self.softest.0[lane];
        let undamped = bodies.dragged(lane, 0.0);
        self.undamped_share.0[lane] = undamped.share;
        self.undamped_braking.0[lane] = undamped.braking;
        self.mirrors.0[lane] = f64::from(u8::from(law.curve.closes_at_mirror()));
    }

    #[inline]
    fn load(&mut self, lane: usize, law: &HsiehPan<S>, state: &HsiehPanState<S>) {
        let spring = &state.spring;
        self.mode.0[lane] = state.mode;
        self.force.0[lane] = if state.mode == 0.0 { spring.force } else { state.series }.re();
        self.position.0[lane] = spring.position.re();
        self.slope.0[lane] = spring.slope.re();
        self.steps.0[lane] = f64::from(spring.steps);
        self.plastic.0[lane] = state.plastic.re();
        self.hardening.0[lane] = state.hardening.re();
        self.follow(lane, law, spring);
        self.excess.0[lane] = (state.latched - law.parameters.coulomb).re();
        self.sticks = self.mode.0.contains(&0.0);
        self.slides = self.mode.0.iter().any(|mode| *mode != 0.0);
        self.falls = self.viscous.0.iter().all(|viscous| *viscous == 0.0)
            && self.excess.0.iter().all(|excess| *excess >= 0.0);
        self.tame = self.hardening.0.iter().all(|hardening| *hardening >= 0.0);
    }

    #[inline]
    fn store(&self, lane: usize, state: &mut HsiehPanState<S>) {
        let number = |row: &Row| S::constant(row.0[lane]);
        state.series = number(&self.force);
        state.spring.force = number(&self.force);
        if state.mode == 0.0 {
            state.spring.position = number(&self.position);
            state.spring.slope = number(&self.slope);
            state.spring.steps = self.steps.0[lane] as u32;
            state.plastic = number(&self.plastic);
            state.hardening = number(&self.hardening);
        }
    }

    fn note(&mut self, lane: usize, what: u64, law: &HsiehPan<S>, state: &mut HsiehPanState<S>) {
        let (spring, statistics) = (&mut state.spring, &mut state.statistics);
        if what == TURNED {
            let position = S::constant(self.present.origin.0[lane]);
            let force = S::constant(self.present.force.0[lane]);
            spring.direction = self.direction.0[lane];
            spring.memory.update(0, Some(ReversePoint { position, force }));
            statistics.reversals += 1;
        } else {
            spring.memory.update(2, None);
            statistics.closings += 1;
        }
        let held = spring.memory.points().len() as u64;
        statistics.memory_peak = statistics.memory_peak.max(held);
        self.follow(lane, law, spring);
    }

    #[inline(always)]
    fn step<const N: usize>(blocks: &mut [Block<Self>; N]) -> [bool; N] {
        let onwards = |block: &Block<Self>| !block.contacts.slides && block.contacts.tame;
        let forwards = |block: &Block<Self>| !block.contacts.sticks && block.contacts.falls;
        let open = if blocks.iter().all(onwards) {
            onward::<false, N>(blocks)
        } else if blocks.iter().all(forwards) {
            forward::<false, N>(blocks)
        } else {
            let mut open = [true; N];
            for (block, open) in blocks.iter_mut().zip(&mut open) {
                let row = from_mut(block);
                [*open] = if onwards(&row[0]) {
                    onward::<false, 1>(row)
                } else if forwards(&row[0]) {
                    forward::<false, 1>(row)
                } else {
                    mixed(row)
                };
            }
            open
        };
        for (block, open) in blocks.iter_mut().zip(&open) {
            if *open {
                any(block);
            }
        }
        open
    }
}

/// Steps of a row of which some stick and some slide.
#[inline(always)]
fn mixed(row: &mut [Block<Lanes>; 1]) -> [bool; 1] {
    let (tame, falls) = (row[0].contacts.tame, row[0].contacts.falls);
    row[0].bodies.missed = row[0].bodies.alive;
    if tame && row[0].contacts.sticks {
        onward::<true, 1>(row);
    }
    if falls && row[0].contacts.slides {
        forward::<true, 1>(row);
    }
    [true]
}

/// Steps of those of a row that have missed theirs.
#[inline(always)]
fn any(block: &mut Block<Lanes>) {
    block.bodies.changed = [0; WIDTH];
    let (mut sticks, mut slides) = (0, 0);
    for lane in 0..WIDTH {
        let missed = block.bodies.missed[lane] & block.bodies.alive[lane];
        let stuck = u64::from(block.contacts.mode.0[lane] == 0.0).wrapping_neg();
        sticks |= missed & stuck;
        slides |= missed & !stuck;
    }
    if sticks != 0 {
        stick(block);
    }
    if slides != 0 {
        slide(block);
    }
}

impl Lanes {
    /// Takes the branch of a spring and the one that follows it.
    fn follow<S: Scalar>(&mut self, lane: usize, law: &HsiehPan<S>, spring: &SpringState<S>) {
        let (direction, mirrors) = (spring.direction, law.curve.closes_at_mirror());
        let points = spring.memory.points();
        let last = &points[points.len().saturating_sub(4)..];
        let mut few = [ReversePoint { position: 0.0, force: 0.0 }; 4];
        for (few, point) in few.iter_mut().zip(last) {
            *few = ReversePoint { position: point.position.re(), force: point.force.re() };
        }
        let last = &few[..last.len()];
        self.present.take(lane, last, mirrors, direction);
        self.older.take(lane, &last[..last.len().saturating_sub(2)], mirrors, direction);
        let branch = spring.present(&law.curve);
        self.direction.0[lane] = direction;
        self.closing.0[lane] = self.present.target.0[lane] * direction;
        self.first.0[lane] = f64::from(u8::from(points.is_empty()));
        self.per_displacement.0[lane] = law.curve.per_displacement(&branch, direction).re();
    }
}
