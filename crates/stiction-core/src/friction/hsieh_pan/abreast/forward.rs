//! Steps of rows in which every hook slides forward under a level that does not rise with speed, so
//! that nothing damps it: nothing in them is chosen. Whatever leaves a doubt is left to `slide`.

use stiction_dispatch::{CHUNKS, Mask, Vector};

use super::{Found, Lanes, Odds, ROUNDING, accept};
use crate::friction::elements::abreast::{Block, Bodies};
use crate::math::exponential::{faded, fading};

/// Steps of rows of hooks of which all slide. Says of each row which lanes have not gone on.
#[inline(always)]
pub(super) fn forward<V: Vector, const N: usize>(blocks: &mut [Block<Lanes>; N]) -> Odds<N> {
    let (ends, odds) = found::<V, N>(blocks);
    accept::<V, _, false, N>(blocks, odds, &ends)
}

/// The same before anything is accepted, two rows stage by stage.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // a vector of all rows at a time
pub(super) fn found<V: Vector, const N: usize>(blocks: &[Block<Lanes>; N]) -> Found<Ends<V>, N> {
    const { assert!(N == 1 || N == 2) };
    let mut ends = [[Ends::<V>::default(); N]; CHUNKS];
    let mut odds = [0; N];
    for chunk in 0..V::CHUNKS {
        let (p, q) = (&blocks[0], &blocks[N - 1]);
        let begun = [p.contacts.push_off(chunk, &p.bodies), q.contacts.push_off(chunk, &q.bodies)];
        let slid =
            [p.contacts.slid_by::<V>(chunk, &begun[0]), q.contacts.slid_by::<V>(chunk, &begun[1])];
        for k in 0..N {
            let Block { bodies, contacts } = &blocks[k];
            let goes_on =
                contacts.go_forward(chunk, &begun[k], &slid[k], bodies, &mut ends[chunk][k]);
            odds[k] |= bodies.without::<V>(goes_on, chunk);
        }
    }
    (ends, odds)
}

/// Where a step of some lanes ends.
#[derive(Clone, Copy, Default)]
pub(super) struct Ends<V> {
    pub(super) displacement: V,
    pub(super) arrived: V,
    pub(super) force: V,
}

/// Departure, and levels at the start and at the end.
#[derive(Clone, Copy)]
struct Begun<V: Vector> {
    net: V,
    displacement: V,
    from: V,
    to: V,
    /// Velocity at the start and the predicted one are those of a slide forward.
    goes: V::Mask,
}

/// How the force follows the level, see `shares`.
#[derive(Clone, Copy)]
struct Slid<V: Vector> {
    distance: V,
    remainder: V,
    end_share: V,
    /// Far enough for the mean of what is left of a distance to be a quotient.
    far: V::Mask,
}

impl Lanes {
    #[inline(always)]
    fn push_off<V: Vector>(&self, chunk: usize, bodies: &Bodies) -> Begun<V> {
        let (velocity, mode) = (bodies.velocity.at::<V>(chunk), self.mode.at::<V>(chunk));
        let net = bodies.effort.at::<V>(chunk) - self.force.at::<V>(chunk);
        let (displacement, predicted) = bodies.departs(chunk, net);
        let per_velocity = self.per_velocity.at::<V>(chunk);
        let (share, before) = (predicted * per_velocity, velocity * per_velocity);
        let (left, left_before) =
            (fading((share * share).minus()), fading((before * before).minus()));
        let (coulomb, excess) = (self.coulomb.at::<V>(chunk), self.excess.at::<V>(chunk));
        let zero = V::all(0.0);
        Begun {
            net,
            displacement,
            from: coulomb + excess * left_before,
            to: coulomb + excess * left,
            goes: zero.within(velocity.flipped(mode)).and(zero.below(predicted.flipped(mode))),
        }
    }

    #[inline(always)]
    fn slid_by<V: Vector>(&self, chunk: usize, begun: &Begun<V>) -> Slid<V> {
        let distance = begun.displacement.abs();
        let z = distance * self.per_distance.at::<V>(chunk);
        let gone = faded(z.minus());
        let mean = gone * (V::all(1.0) / z);
        Slid {
            distance,
            remainder: (gone - V::all(1.0)).minus(),
            end_share: (mean - V::all(1.0)).minus(),
            far: V::all(1e-5).within(z),
        }
    }

    /// The end of a step. Returns where all of it goes on as it went.
    #[inline(always)]
    fn go_forward<V: Vector>(
        &self,
        chunk: usize,
        begun: &Begun<V>,
        slid: &Slid<V>,
        bodies: &Bodies,
        ends: &mut Ends<V>,
    ) -> V::Mask {
        let Begun { net, displacement, from, to, goes } = *begun;
        let (effort, velocity) = (bodies.effort.at::<V>(chunk), bodies.velocity.at::<V>(chunk));
        let mode = self.mode.at::<V>(chunk);
        let behind = self.force.at::<V>(chunk).flipped(mode);
        let sigma = from + (to - from) * slid.end_share + (behind - from) * slid.remainder;
        let force = sigma.flipped(mode);
        let (inertia, half) = (bodies.inertia.at::<V>(chunk), bodies.half.at::<V>(chunk));
        let unbraked =
            (inertia * velocity + half * (net + effort)) * self.undamped_share.at::<V>(chunk);
        let arrived = unbraked - self.undamped_braking.at::<V>(chunk) * force;
        *ends = Ends { displacement, arrived, force };
        let zero = V::all(0.0);
        let follows = sigma.within(
            behind - V::all(ROUNDING) * behind.abs() + self.softest.at::<V>(chunk) * slid.distance,
        );
        let held = zero.below(self.least.at::<V>(chunk) - (to - sigma));
        let inside = zero.below(sigma).and(sigma.within(self.greatest.at::<V>(chunk)));
        let moves = zero.below(arrived.flipped(mode));
        goes.and(slid.far).and(follows).and(held).and(inside).and(moves)
    }
}

impl<V: Vector> super::Ends<V> for Ends<V> {
    #[inline(always)]
    fn take_over(&self, chunk: usize, Block { bodies, contacts }: &mut Block<Lanes>) {
        contacts.force.put(chunk, self.force);
        bodies.friction.put(chunk, self.force);
        bodies.go(chunk, self.displacement, self.arrived);
    }

    #[inline(always)]
    fn went(block: &mut Block<Lanes>) {
        let Block { bodies, contacts } = block;
        let mut coasts = 0;
        for chunk in 0..V::CHUNKS {
            let coasting = contacts.coasting::<V>(chunk, bodies.velocity.at(chunk));
            coasts |= bodies.without::<V>(coasting, chunk);
        }
        contacts.coasts = coasts == 0;
    }

    #[inline(always)]
    fn take_some(&self, chunk: usize, here: V::Mask, block: &mut Block<Lanes>) {
        let Block { bodies, contacts } = block;
        contacts.force.put_where(chunk, here, self.force);
        bodies.friction.put_where(chunk, here, self.force);
        bodies.go_where(chunk, here, self.displacement, self.arrived);
    }
}
