//! Steps of rows in which every hook slides so fast that nothing is left of the fall of the level with
//! speed, and its force has arrived there: to the last bit, all that `forward` computes of both is the
//! level again.

use stiction_dispatch::{CHUNKS, Mask, Vector};

use super::forward::Ends;
use super::{Found, Lanes};
use crate::friction::elements::abreast::{Block, Bodies};

/// Steps of rows of hooks of which all slide. Returns whether they were taken: all or none.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // a vector of all rows at a time
pub(super) fn coast<V: Vector, const N: usize>(blocks: &mut [Block<Lanes>; N]) -> bool {
    let mut ends = [[Ends::<V>::default(); N]; CHUNKS];
    let mut odds = 0;
    for chunk in 0..V::CHUNKS {
        for k in 0..N {
            let Block { bodies, contacts } = &blocks[k];
            let goes_on = contacts.coast_on(chunk, bodies, &mut ends[chunk][k]);
            odds |= bodies.without::<V>(goes_on, chunk);
        }
    }
    if odds != 0 {
        for block in blocks {
            block.contacts.coasts = false;
        }
        return false;
    }
    for chunk in 0..V::CHUNKS {
        for k in 0..N {
            let Ends { displacement, arrived, force } = ends[chunk][k];
            blocks[k].bodies.friction.put(chunk, force);
            blocks[k].bodies.go(chunk, displacement, arrived);
        }
    }
    true
}

/// Steps of a row before anything is accepted.
#[inline(always)]
pub(super) fn found<V: Vector>(row: &[Block<Lanes>; 1]) -> Found<Ends<V>, 1> {
    let [Block { bodies, contacts }] = row;
    let mut ends = [[Ends::default(); 1]; CHUNKS];
    let mut odds = 0;
    for (chunk, [ends]) in ends.iter_mut().enumerate().take(V::CHUNKS) {
        odds |= bodies.without::<V>(contacts.coast_on(chunk, bodies, ends), chunk);
    }
    (ends, [odds])
}

impl Lanes {
    /// A step. Returns where it goes on beyond all fall.
    #[inline(always)]
    fn coast_on<V: Vector>(&self, chunk: usize, bodies: &Bodies, ends: &mut Ends<V>) -> V::Mask {
        let (effort, velocity) = (bodies.effort.at::<V>(chunk), bodies.velocity.at::<V>(chunk));
        let (force, mode) = (self.force.at::<V>(chunk), self.mode.at::<V>(chunk));
        let net = effort - force;
        let (displacement, predicted) = bodies.departs(chunk, net);
        let (inertia, half) = (bodies.inertia.at::<V>(chunk), bodies.half.at::<V>(chunk));
        let unbraked =
            (inertia * velocity + half * (net + effort)) * self.undamped_share.at::<V>(chunk);
        let arrived = unbraked - self.undamped_braking.at::<V>(chunk) * force;
        *ends = Ends { displacement, arrived, force };
        let begins = self.coasting::<V>(chunk, velocity);
        let goes_on = self.beyond_by::<V>(begins, chunk, predicted);
        V::all(0.0).below_in(goes_on, arrived.flipped(mode))
    }

    /// Where a hook slides beyond all fall, and its force is the level there.
    #[inline(always)]
    pub(super) fn coasting<V: Vector>(&self, chunk: usize, velocity: V) -> V::Mask {
        let behind = self.force.at::<V>(chunk).flipped(self.mode.at::<V>(chunk));
        let coulomb = self.coulomb.at::<V>(chunk);
        let arrived = behind.within(coulomb).and(coulomb.within(behind));
        self.beyond_by::<V>(arrived, chunk, velocity)
    }

    /// Where such a hook slides on beyond all fall.
    #[inline(always)]
    fn beyond_by<V: Vector>(&self, mask: V::Mask, chunk: usize, velocity: V) -> V::Mask {
        let share = (velocity * self.per_velocity.at::<V>(chunk)).flipped(self.mode.at::<V>(chunk));
        self.beyond.at::<V>(chunk).below_in(mask, share)
    }
}
