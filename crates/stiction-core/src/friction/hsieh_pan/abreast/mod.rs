//! Plain steps of eight contacts at once: what [`FrictionLaw::glide`] does, without a choice.
//!
//! Most rows stick and go on along their branches (`onward`), or slide forward (`forward`); where a
//! lane of a row does anything else, those that do go through another pass (`stick`, `slide`), in which
//! what few need is left out where none does.

mod coast;
mod forward;
mod onward;
mod slide;
mod stick;

use std::array::from_mut;

use stiction_dispatch::{CHUNKS, Mask, Vector};

use super::slide::ROUNDING;
use super::{HsiehPan, HsiehPanState};
use crate::friction::elements::abreast::{Block, Bodies, Contacts, Rest};
use crate::friction::elements::loading::Loading;
use crate::friction::elements::memory::ReversePoint;
use crate::friction::elements::spring::SpringState;
use crate::math::row::{Row, WIDTH};
use crate::math::scalar::{SHORTER, Scalar};

use coast::coast;
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
    /// Steps of each spring that go on from the one before.
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
    /// The same, or less, so that creep under less than that takes its short way.
    limit: Row,
    /// Of the slide.
    coulomb: Row,
    excess: Row,
    /// Speed, times the number below, beyond which the level is `coulomb` to the last bit.
    beyond: Row,
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
    known: Known,
    /// A bit for each lane that sticks, that slides, whose last step has turned its spring round, and
    /// whose friction is still to be made of force and velocity.
    sticks: u8,
    slides: u8,
    turned: u8,
    untold: u8,
    /// The same where a hook sticks that has a hardening below 0, where a contact that cannot creep
    /// would, or its force beyond `limit`.
    wild: u8,
    /// The last step was one of slides beyond all fall.
    coasts: bool,
    /// No level of a slide rises with speed.
    falls: bool,
}

/// What steps of sticking hooks come to where a spring does not go on as it went, up to the spring.
#[derive(Debug, Clone, Default)]
struct Known {
    displacement: Row,
    hardening: Row,
    /// Displacement of the spring.
    left: Row,
    /// A bit for each lane of which that is known.
    lanes: u8,
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

/// Whether these contacts can go through plain steps abreast.
pub fn fits<S: Scalar>(law: &HsiehPan<S>) -> bool {
    let p = &law.parameters;
    let bell = p.stribeck_exponent.re() == 2.0 || p.breakaway.re().is_infinite();
    bell && law.plastic.is_square() && !law.damper_on_spring && !law.rated
}

/// What is more than round-off of a bound that may be kept by as much.
const SLACK: f64 = 1.0 - 1e-9;

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
        // Nothing creeps without a rate either.
        let creeps = law.plastic.rate.re() > 0.0;
        let coefficient = if creeps { law.plastic.coefficient.re() } else { 0.0 };
        self.coefficient.0[lane] = coefficient;
        self.twice_coefficient.0[lane] = coefficient * 2.0;
        self.progress.0[lane] = law.plastic.rate.re() * bodies.span.0[lane];
        self.pace.0[lane] = self.progress.0[lane] * self.twice_coefficient.0[lane];
        self.damping.0[lane] = damping;
        self.stride.0[lane] = dragged.stride;
        self.kept.0[lane] = dragged.kept;
        self.share.0[lane] = dragged.share;
        self.braking.0[lane] = dragged.braking;
        self.greatest.0[lane] = p.breakaway.re();
        let room = SHORTER * SLACK - self.progress.0[lane];
        let steepest = self.pace.0[lane] * self.initial_stiffness.0[lane];
        let longest = if room > 0.0 { room / steepest } else { 0.0 };
        self.limit.0[lane] = longest.min(p.breakaway.re());
        self.coulomb.0[lane] = p.coulomb.re();
        self.per_velocity.0[lane] = 1.0 / p.stribeck_velocity.re();
        self.viscous.0[lane] = p.viscous.re();
        self.per_distance.0[lane] = 1.0 / p.slip_distance.re();
        self.reach.0[lane] = p.slip_distance.re();
        self.distance.0[lane] = distance;
        self.twice.0[lane] = if law.curve.closes_at_mirror() { 2.0 } else { 1.0 };
        self.softest.0[lane] = law.softest.slope;
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
        let here = 1 << lane;
        let sticks = if state.mode == 0.0 { here } else { 0 };
        self.sticks = self.sticks & !here | sticks;
        self.slides = self.slides & !here | here & !sticks;
        self.untold &= !here;
        self.falls = self.viscous.0.iter().all(|viscous| *viscous == 0.0)
            && self.excess.0.iter().all(|excess| *excess >= 0.0);
        self.beyond.0[lane] = self.beyond(lane);
        self.wild = self.wild & !here | if self.is_tame(lane) { 0 } else { sticks };
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

    fn note(&mut self, lane: usize, law: &HsiehPan<S>, state: &mut HsiehPanState<S>) {
        let (spring, statistics) = (&mut state.spring, &mut state.statistics);
        if self.turned >> lane & 1 == 1 {
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
    fn settle(&mut self, bodies: &mut Bodies) {
        if self.untold != 0 {
            for lane in 0..WIDTH {
                let damped = self.damping.0[lane] * bodies.velocity.0[lane];
                let untold = self.untold >> lane & 1 == 1;
                bodies.friction.take(lane, untold, self.force.0[lane] + damped);
            }
            self.untold = 0;
        }
    }

    #[inline(always)]
    fn step<V: Vector, const N: usize>(blocks: &mut [Block<Self>; N]) -> Option<[Rest; N]> {
        let onwards =
            |Block { contacts, .. }: &Block<Self>| contacts.slides == 0 && contacts.wild == 0;
        let forwards = |block: &Block<Self>| {
            block.contacts.sticks == 0 && block.contacts.falls && in_pieces(block) == 0
        };
        let odds = if blocks.iter().all(onwards) {
            onward::<V, N>(blocks)
        } else if blocks.iter().all(forwards) {
            if blocks.iter().all(|block| block.contacts.coasts) && coast::<V, N>(blocks) {
                return None;
            }
            forward::<V, N>(blocks)
        } else {
            let mut odds = [0; N];
            for (block, odds) in blocks.iter_mut().zip(&mut odds) {
                let row = from_mut(block);
                [*odds] = if onwards(&row[0]) {
                    onward::<V, 1>(row)
                } else if forwards(&row[0]) {
                    if row[0].contacts.coasts && coast::<V, 1>(row) {
                        continue;
                    }
                    forward::<V, 1>(row)
                } else {
                    mixed::<V>(row)
                };
            }
            odds
        };
        if odds == [0; N] {
            return None;
        }
        let mut rests = [Rest::default(); N];
        for k in 0..N {
            if odds[k] != 0 {
                let missed = odds[k] & in_pieces(&blocks[k]);
                rests[k] = any::<V>(&mut blocks[k], odds[k] & !missed);
                rests[k].missed |= missed;
            }
        }
        Some(rests)
    }
}

/// A bit for each lane of which this step is made in pieces.
#[inline(always)]
fn in_pieces(block: &Block<Lanes>) -> u8 {
    block.contacts.slides & block.bodies.in_pieces
}

/// Of each row, a bit for each lane that has missed its step.
type Odds<const N: usize> = [u8; N];

/// Steps of a row of which some stick and some slide. None is accepted before all are found: what is
/// read would wait for what was written, though that is of other lanes.
#[inline(always)]
fn mixed<V: Vector>(row: &mut [Block<Lanes>; 1]) -> Odds<1> {
    let Lanes { wild, falls, sticks, slides, .. } = row[0].contacts;
    row[0].contacts.known.lanes = 0;
    let stuck = (wild == 0 && sticks != 0).then(|| onward::found::<V, 1>(row));
    let slid = (falls && slides != 0 && in_pieces(&row[0]) == 0).then(|| {
        let coasted = coast::found::<V>(row);
        if coasted.1[0] & slides == 0 { coasted } else { forward::found::<V, 1>(row) }
    });
    let mut odds = row[0].bodies.present;
    if let Some((ends, [others])) = stuck {
        odds &= accept::<V, _, true, 1>(row, [others | slides], &ends)[0];
    }
    if let Some((ends, [others])) = slid {
        odds &= accept::<V, _, true, 1>(row, [others | sticks], &ends)[0];
    }
    [odds]
}

/// Where steps of rows end, of each vector of theirs, and which lanes are odd.
type Found<E, const N: usize> = ([[E; N]; CHUNKS], Odds<N>);

/// Where steps of some lanes of a row end.
trait Ends<V: Vector>: Copy {
    /// Goes there.
    fn take_over(&self, chunk: usize, block: &mut Block<Lanes>);
    /// Notes that a whole row went.
    fn went(block: &mut Block<Lanes>);
    /// Goes there where something holds, and leaves what was found of others.
    fn take_some(&self, chunk: usize, here: V::Mask, block: &mut Block<Lanes>);
}

/// Accepts the steps of lanes that are not odd; with `MIXED` there are lanes for which these steps are
/// none. All rows at once first, or the compiler puts off what a row needs until the one before is
/// through.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // a vector of all rows at a time
fn accept<V: Vector, E: Ends<V>, const MIXED: bool, const N: usize>(
    blocks: &mut [Block<Lanes>; N],
    odds: Odds<N>,
    ends: &[[E; N]; CHUNKS],
) -> Odds<N> {
    if !MIXED && odds.iter().fold(0, |any, odd| any | odd) == 0 {
        for chunk in 0..V::CHUNKS {
            for k in 0..N {
                ends[chunk][k].take_over(chunk, &mut blocks[k]);
            }
        }
        for block in blocks {
            E::went(block);
        }
        return odds;
    }
    for k in 0..N {
        for (chunk, ends) in ends.iter().enumerate().take(V::CHUNKS) {
            if !MIXED && odds[k] == 0 {
                ends[k].take_over(chunk, &mut blocks[k]);
            } else {
                let here = V::Mask::of(!odds[k] >> (chunk * V::LANES));
                ends[k].take_some(chunk, here, &mut blocks[k]);
            }
        }
        if !MIXED && odds[k] == 0 {
            E::went(&mut blocks[k]);
        }
    }
    odds
}

/// Steps of these lanes of a row.
#[inline(always)]
fn any<V: Vector>(block: &mut Block<Lanes>, lanes: u8) -> Rest {
    let Lanes { sticks, slides, .. } = block.contacts;
    let mut rest = Rest::default();
    if lanes & sticks != 0 {
        rest = stick::<V>(block, lanes & sticks);
    }
    if lanes & slides != 0 {
        rest.missed |= slide(block, lanes & slides);
    }
    rest
}

impl Lanes {
    /// Whether a sticking hook is not `wild`.
    fn is_tame(&self, lane: usize) -> bool {
        self.hardening.0[lane] >= 0.0
            && self.force.0[lane].abs() <= self.limit.0[lane]
            && self.slope.0[lane] * SLACK <= self.initial_stiffness.0[lane]
    }

    /// [`Self::beyond`] of a lane: what is left of the fall there is less than half of the last bit.
    fn beyond(&self, lane: usize) -> f64 {
        let (coulomb, excess) = (self.coulomb.0[lane], self.excess.0[lane]);
        if self.mode.0[lane] == 0.0 || !(coulomb > 0.0 && excess >= 0.0) {
            return f64::INFINITY;
        }
        let power = (excess / (coulomb * 2.0_f64.powi(-56))).ln();
        power.max(0.0).sqrt()
    }

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
