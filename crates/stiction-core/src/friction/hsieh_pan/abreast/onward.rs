//! Steps of rows in which every hook sticks and every spring goes on along its branch: most of all
//! steps, and nothing in them is chosen. Whatever leaves a doubt is left to `stick`.

use super::Lanes;
use crate::friction::elements::branch::{SYNCHRONISED, short_way};
use crate::lanes::{Block, Bodies, Row, WIDTH, pick};
use crate::scalar::{SHORT, SHORTER, second_share};

/// Of the margin, what creep is sure to keep through a step of z < [`SHORTER`]: it goes on where this
/// and what the limit rises by are above 0. By far: 1 − z·φ₁ > 0.99·φ₁ there.
const SURE: f64 = 0.99;

/// Steps of rows of hooks of which all stick, two of them stage by stage, or with `MIXED` of those
/// lanes in `missed` that do. Says which rows have lanes left that have not gone on, in `missed`.
#[inline(always)]
pub(super) fn onward<const MIXED: bool, const N: usize>(
    blocks: &mut [Block<Lanes>; N],
) -> [bool; N] {
    const { assert!(N == 1 || N == 2) };
    let mut ends = [Ends::default(); N];
    let mut odds = [false; N];
    for lane in 0..WIDTH {
        let (p, q) = (&blocks[0], &blocks[N - 1]);
        let crept = [p.contacts.set_out(lane, &p.bodies), q.contacts.set_out(lane, &q.bodies)];
        for k in 0..N {
            let Block { bodies, contacts } = &blocks[k];
            let goes_on = contacts.go_on(lane, &crept[k], &mut ends[k]);
            let here = !MIXED | (contacts.mode.0[lane] == 0.0);
            let odd = !(goes_on & here) & (bodies.alive[lane] != 0);
            // The compiler makes no vectors of a loop over two rows that notes this as well.
            if MIXED {
                ends[k].odd[lane] = u64::from(odd);
            }
            odds[k] |= odd;
        }
    }
    if MIXED {
        for (Block { bodies, contacts }, ends) in blocks.iter_mut().zip(&ends) {
            contacts.take_some(ends, bodies);
        }
        return [true; N];
    }
    accept(blocks, odds, |k, Block { bodies, contacts }| contacts.take_over(&ends[k], bodies))
}

/// Accepts the steps of rows without anything odd, and says which the others are: all of their lanes
/// have missed. All rows at once first, or the compiler puts off what a row needs until the one before
/// is through.
#[inline(always)]
pub(super) fn accept<const N: usize>(
    blocks: &mut [Block<Lanes>; N],
    odds: [bool; N],
    take_over: impl Fn(usize, &mut Block<Lanes>),
) -> [bool; N] {
    if !odds.iter().fold(false, |any, odd| any | odd) {
        for (k, block) in blocks.iter_mut().enumerate() {
            take_over(k, block);
        }
        return [false; N];
    }
    for (k, block) in blocks.iter_mut().enumerate() {
        if !odds[k] {
            take_over(k, block);
        } else {
            block.bodies.missed = block.bodies.alive;
        }
    }
    odds
}

/// Where a step of a row ends.
#[derive(Clone, Copy, Default)]
struct Ends {
    displacement: Row,
    arrived: Row,
    hardening: Row,
    position: Row,
    force: Row,
    slope: Row,
    /// Not 0 where something else happens.
    odd: [u64; WIDTH],
}

/// A step as far as the spring.
#[derive(Clone, Copy)]
struct Crept {
    displacement: f64,
    /// The velocity at the end but for the spring.
    unbraked: f64,
    hardening: f64,
    left: f64,
    steady: bool,
}

/// A number times the sign of another, which costs no product.
#[inline(always)]
pub(super) fn flipped(number: f64, by: f64) -> f64 {
    f64::from_bits(number.to_bits() ^ (by.to_bits() & (-0.0_f64).to_bits()))
}

impl Lanes {
    /// Departure and creep, where creep goes on through the whole step or has none.
    #[inline(always)]
    fn set_out(&self, lane: usize, bodies: &Bodies) -> Crept {
        let (effort, velocity) = (bodies.effort.0[lane], bodies.velocity.0[lane]);
        let (force, slope) = (self.force.0[lane], self.slope.0[lane]);
        let push = effort - force;
        let displacement = self.stride.0[lane] * velocity + bodies.lever.0[lane] * push;
        let unbraked = (self.kept.0[lane] * velocity + bodies.half.0[lane] * (push + effort))
            * self.share.0[lane];
        let margin = self.coefficient.0[lane] * (force * force) - self.hardening.0[lane];
        let starts = margin > 0.0;
        let progress = self.progress.0[lane];
        let held = pick(starts, progress * margin, 0.0);
        let back = flipped(held, force);
        let towards = displacement - back;
        let size = force.abs();
        let pace = self.pace.0[lane] * size * slope;
        let z = progress + pace;
        let lagged = pick(starts, second_share(z) * (back * z - pace * displacement), 0.0);
        let gain = self.twice_coefficient.0[lane] * size * slope;
        let risen = gain * flipped(displacement, force);
        let creeps = margin * pick(starts, SURE, 1.0) + risen > 0.0;
        let forward = towards * self.direction.0[lane] > 0.0;
        Crept {
            displacement,
            unbraked,
            hardening: held - flipped(lagged, force),
            left: towards + lagged,
            steady: (creeps == starts) & !(starts & (z >= SHORTER)) & forward,
        }
    }

    /// Spring and arrival. Returns whether all of the step goes on as it went.
    #[inline(always)]
    fn go_on(&self, lane: usize, crept: &Crept, ends: &mut Ends) -> bool {
        let left = crept.left;
        let (before, slope) = (self.force.0[lane], self.slope.0[lane]);
        let position = self.position.0[lane] + left;
        let along = left * self.per_displacement.0[lane];
        let excess = slope - self.final_stiffness.0[lane];
        let [force, slope] = short_way(before, slope, excess, left, along, |x| x);
        let inside = position * self.direction.0[lane] < self.closing.0[lane];
        let near = (along > 0.0) & (along < SHORT);
        let fresh = self.steps.0[lane] < f64::from(SYNCHRONISED);
        ends.displacement.0[lane] = crept.displacement;
        ends.arrived.0[lane] = crept.unbraked - self.braking.0[lane] * force;
        ends.hardening.0[lane] = crept.hardening;
        ends.position.0[lane] = position;
        ends.force.0[lane] = force;
        ends.slope.0[lane] = slope;
        crept.steady & inside & near & fresh & (force.abs() < self.greatest.0[lane])
    }

    /// Accepts the step of a row.
    #[inline(always)]
    fn take_over(&mut self, ends: &Ends, bodies: &mut Bodies) {
        for lane in 0..WIDTH {
            let (displacement, hardening) = (ends.displacement.0[lane], ends.hardening.0[lane]);
            let (force, arrived) = (ends.force.0[lane], ends.arrived.0[lane]);
            self.plastic.0[lane] += flipped(hardening, self.force.0[lane]);
            self.hardening.0[lane] += hardening;
            self.steps.0[lane] += 1.0;
            bodies.position.0[lane] += displacement;
            bodies.path.0[lane] += displacement.abs();
            bodies.time.0[lane] += bodies.span.0[lane];
            bodies.friction.0[lane] = force + self.damping.0[lane] * arrived;
        }
        self.position = ends.position;
        self.force = ends.force;
        self.slope = ends.slope;
        bodies.velocity = ends.arrived;
    }

    /// Accepts the steps of those that are not `odd`.
    #[inline(always)]
    fn take_some(&mut self, ends: &Ends, bodies: &mut Bodies) {
        for lane in 0..WIDTH {
            let here = ends.odd[lane] == 0;
            bodies.missed[lane] &= ends.odd[lane];
            let (displacement, hardening) = (ends.displacement.0[lane], ends.hardening.0[lane]);
            let (force, arrived) = (ends.force.0[lane], ends.arrived.0[lane]);
            self.plastic.add(lane, here, flipped(hardening, self.force.0[lane]));
            self.hardening.add(lane, here, hardening);
            self.steps.add(lane, here, 1.0);
            self.position.take(lane, here, ends.position.0[lane]);
            self.force.take(lane, here, force);
            self.slope.take(lane, here, ends.slope.0[lane]);
            let friction = force + self.damping.0[lane] * arrived;
            bodies.accept(lane, here, displacement, arrived, friction);
        }
    }
}
