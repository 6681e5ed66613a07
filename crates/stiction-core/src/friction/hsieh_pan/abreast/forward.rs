//! Steps of rows in which every hook slides forward under a level that does not rise with speed, so
//! that nothing damps it: nothing in them is chosen. Whatever leaves a doubt is left to `slide`.

use super::onward::{accept, flipped};
use super::{Lanes, ROUNDING};
use crate::exponential::{faded, fading};
use crate::lanes::{Block, Bodies, Row, WIDTH};

/// Steps of rows of hooks of which all slide, two of them stage by stage, or with `MIXED` of those
/// lanes in `missed` that do. Says which rows have lanes left that have not gone on, in `missed`.
#[inline(always)]
pub(super) fn forward<const MIXED: bool, const N: usize>(
    blocks: &mut [Block<Lanes>; N],
) -> [bool; N] {
    const { assert!(N == 1 || N == 2) };
    let mut ends = [Ends::default(); N];
    let mut odds = [false; N];
    for lane in 0..WIDTH {
        let (p, q) = (&blocks[0], &blocks[N - 1]);
        let begun = [p.contacts.push_off(lane, &p.bodies), q.contacts.push_off(lane, &q.bodies)];
        let slid = [p.contacts.slid_by(lane, &begun[0]), q.contacts.slid_by(lane, &begun[1])];
        for k in 0..N {
            let Block { bodies, contacts } = &blocks[k];
            let goes_on = contacts.go_forward(lane, &begun[k], &slid[k], bodies, &mut ends[k]);
            let here = !MIXED | (contacts.mode.0[lane] != 0.0);
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
            contacts.come_some(ends, bodies);
        }
        return [true; N];
    }
    accept(blocks, odds, |k, Block { bodies, contacts }| contacts.come(&ends[k], bodies))
}

/// Where a step of a row ends.
#[derive(Clone, Copy, Default)]
struct Ends {
    displacement: Row,
    arrived: Row,
    force: Row,
    /// Not 0 where something else happens.
    odd: [u64; WIDTH],
}

/// Departure, and levels at the start and at the end.
#[derive(Clone, Copy)]
struct Begun {
    net: f64,
    displacement: f64,
    from: f64,
    to: f64,
    /// Velocity at the start and the predicted one are those of a slide forward.
    goes: bool,
}

/// How the force follows the level, see `shares`.
#[derive(Clone, Copy)]
struct Slid {
    distance: f64,
    remainder: f64,
    end_share: f64,
    /// Far enough for the mean of what is left of a distance to be a quotient.
    far: bool,
}

impl Lanes {
    #[inline(always)]
    fn push_off(&self, lane: usize, bodies: &Bodies) -> Begun {
        let (velocity, mode) = (bodies.velocity.0[lane], self.mode.0[lane]);
        let net = bodies.effort.0[lane] - self.force.0[lane];
        let (displacement, predicted) = bodies.depart(lane, net);
        let per_velocity = self.per_velocity.0[lane];
        let (share, before) = (predicted * per_velocity, velocity * per_velocity);
        let (left, left_before) = (fading(-(share * share)), fading(-(before * before)));
        let (coulomb, excess) = (self.coulomb.0[lane], self.excess.0[lane]);
        Begun {
            net,
            displacement,
            from: coulomb + excess * left_before,
            to: coulomb + excess * left,
            goes: (flipped(velocity, mode) >= 0.0) & (flipped(predicted, mode) > 0.0),
        }
    }

    #[inline(always)]
    fn slid_by(&self, lane: usize, begun: &Begun) -> Slid {
        let distance = begun.displacement.abs();
        let z = distance * self.per_distance.0[lane];
        let gone = faded(-z);
        let mean = gone * (1.0 / z);
        Slid { distance, remainder: -(gone - 1.0), end_share: -(mean - 1.0), far: z >= 1e-5 }
    }

    /// The end of a step. Returns whether all of it goes on as it went.
    #[inline(always)]
    fn go_forward(
        &self,
        lane: usize,
        begun: &Begun,
        slid: &Slid,
        bodies: &Bodies,
        ends: &mut Ends,
    ) -> bool {
        let Begun { net, displacement, from, to, goes } = *begun;
        let (effort, velocity) = (bodies.effort.0[lane], bodies.velocity.0[lane]);
        let mode = self.mode.0[lane];
        let behind = flipped(self.force.0[lane], mode);
        let sigma = from + (to - from) * slid.end_share + (behind - from) * slid.remainder;
        let force = flipped(sigma, mode);
        let unbraked = (bodies.inertia.0[lane] * velocity + bodies.half.0[lane] * (net + effort))
            * self.undamped_share.0[lane];
        let arrived = unbraked - self.undamped_braking.0[lane] * force;
        ends.displacement.0[lane] = displacement;
        ends.arrived.0[lane] = arrived;
        ends.force.0[lane] = force;
        let follows =
            sigma <= behind - ROUNDING * behind.abs() + self.softest.0[lane] * slid.distance;
        let held = self.least.0[lane] - (to - sigma) > 0.0;
        let inside = (sigma > 0.0) & (sigma <= self.greatest.0[lane]);
        goes & slid.far & follows & held & inside & (flipped(arrived, mode) > 0.0)
    }

    /// Accepts the step of a row.
    #[inline(always)]
    fn come(&mut self, ends: &Ends, bodies: &mut Bodies) {
        for lane in 0..WIDTH {
            let displacement = ends.displacement.0[lane];
            bodies.position.0[lane] += displacement;
            bodies.path.0[lane] += displacement.abs();
            bodies.time.0[lane] += bodies.span.0[lane];
        }
        self.force = ends.force;
        bodies.friction = ends.force;
        bodies.velocity = ends.arrived;
    }

    /// Accepts the steps of those that are not `odd`.
    #[inline(always)]
    fn come_some(&mut self, ends: &Ends, bodies: &mut Bodies) {
        for lane in 0..WIDTH {
            let here = ends.odd[lane] == 0;
            bodies.missed[lane] &= ends.odd[lane];
            let (displacement, force) = (ends.displacement.0[lane], ends.force.0[lane]);
            self.force.take(lane, here, force);
            bodies.accept(lane, here, displacement, ends.arrived.0[lane], force);
        }
    }
}
