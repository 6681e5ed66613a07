//! Steps of rows in which every hook slides so fast that nothing is left of the fall of the level with
//! speed, and its force has arrived there: to the last bit, all that `forward` computes of both is the
//! level again.

use stiction_dispatch::{CHUNKS, Mask, Vector};

use super::Lanes;
use crate::lanes::Block;

/// Steps of rows of hooks of which all slide, or with `MIXED` of those lanes that do. Returns whether
/// they were taken: all or none.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // a vector of all rows at a time
pub(super) fn coast<V: Vector, const MIXED: bool, const N: usize>(
    blocks: &mut [Block<Lanes>; N],
) -> bool {
    let mut ends = [[(V::all(0.0), V::all(0.0)); N]; CHUNKS];
    let mut odds = [0; N];
    for chunk in 0..V::CHUNKS {
        for k in 0..N {
            let Block { bodies, contacts } = &blocks[k];
            let (effort, velocity) = (bodies.effort.at::<V>(chunk), bodies.velocity.at::<V>(chunk));
            let (force, mode) = (contacts.force.at::<V>(chunk), contacts.mode.at::<V>(chunk));
            let net = effort - force;
            let (displacement, predicted) = bodies.departs(chunk, net);
            let (inertia, half) = (bodies.inertia.at::<V>(chunk), bodies.half.at::<V>(chunk));
            let unbraked = (inertia * velocity + half * (net + effort))
                * contacts.undamped_share.at::<V>(chunk);
            let arrived = unbraked - contacts.undamped_braking.at::<V>(chunk) * force;
            let begins = contacts.coasting::<V>(chunk, velocity);
            let goes_on = contacts.beyond_by::<V>(begins, chunk, predicted);
            let moves = V::all(0.0).below_in(goes_on, arrived.flipped(mode));
            ends[chunk][k] = (displacement, arrived);
            let taken = if MIXED { moves.or(contacts.sliding::<V>(chunk).not()) } else { moves };
            odds[k] |= bodies.without::<V>(taken, chunk);
        }
    }
    if odds.iter().fold(0, |any, odd| any | odd) != 0 {
        for block in blocks {
            block.contacts.coasts = false;
        }
        return false;
    }
    for chunk in 0..V::CHUNKS {
        for k in 0..N {
            let (displacement, arrived) = ends[chunk][k];
            let Block { bodies, contacts } = &mut blocks[k];
            let force = contacts.force.at::<V>(chunk);
            if MIXED {
                let here = contacts.sliding::<V>(chunk);
                bodies.go_where(chunk, here, displacement, arrived, force);
            } else {
                bodies.friction.put(chunk, force);
                bodies.go(chunk, displacement, arrived);
            }
        }
    }
    true
}

impl Lanes {
    /// Where a hook slides.
    #[inline(always)]
    pub(super) fn sliding<V: Vector>(&self, chunk: usize) -> V::Mask {
        V::all(0.0).below(self.mode.at::<V>(chunk).abs())
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
