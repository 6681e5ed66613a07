//! Steps of rows in which every hook sticks and every spring goes on along its branch: most of all
//! steps, and nothing in them is chosen. Whatever leaves a doubt is left to `stick`.

use stiction_dispatch::{CHUNKS, Mask, Vector};

use super::stick::shortly;
use super::{Found, Known, Lanes, Odds, accept};
use crate::friction::elements::abreast::{Block, Bodies};
use crate::friction::elements::branch::SYNCHRONISED;
use crate::math::scalar::{SECOND_BELOW, SHORT};

/// Of the margin, what creep is sure to keep through a step of z < [`SHORTER`](crate::math::scalar::SHORTER): it goes on where this
/// and what the limit rises by are above 0. By far: 1 − z·φ₁ > 0.99·φ₁ there. Where the limit is below
/// the hardening and does not make up for this much of it, none begins.
const SURE: f64 = 0.99;
/// A way that nobody misses, and no product of which with anything here is lost.
const FAINT: f64 = 1e-140;

/// Steps of rows of hooks of which all stick. Says of each row which lanes have not gone on.
#[inline(always)]
pub(super) fn onward<V: Vector, const N: usize>(blocks: &mut [Block<Lanes>; N]) -> Odds<N> {
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
        let crept = [p.contacts.set_out(chunk, &p.bodies), q.contacts.set_out(chunk, &q.bodies)];
        for k in 0..N {
            let contacts = &blocks[k].contacts;
            let goes_on = contacts.go_on(chunk, &crept[k], &mut ends[chunk][k]);
            odds[k] |= blocks[k].bodies.without::<V>(goes_on, chunk);
        }
    }
    (ends, odds)
}

/// Where a step of some lanes ends.
#[derive(Clone, Copy, Default)]
pub(super) struct Ends<V> {
    displacement: V,
    arrived: V,
    hardening: V,
    left: V,
    position: V,
    force: V,
    slope: V,
    /// A bit for each where creep was found, whatever the spring does.
    known: u8,
}

/// A step as far as the spring.
#[derive(Clone, Copy)]
struct Crept<V: Vector> {
    displacement: V,
    /// The velocity at the end but for the spring.
    unbraked: V,
    hardening: V,
    left: V,
    /// Where creep was found, and where the spring goes on in its direction.
    known: V::Mask,
    onward: V::Mask,
}

/// a + b·z.
#[inline(always)]
pub(super) fn line<V: Vector>(a: f64, b: f64, z: V) -> V {
    V::all(a) + V::all(b) * z
}

/// `second_share`.
#[inline(always)]
pub(super) fn second<V: Vector>(z: V) -> V {
    let [a, b, c, d] = SECOND_BELOW;
    line(a, b, z) + z * z * line(c, d, z)
}

impl Lanes {
    /// Departure and creep, where creep goes on through the whole step or has none.
    #[inline(always)]
    fn set_out<V: Vector>(&self, chunk: usize, bodies: &Bodies) -> Crept<V> {
        let (effort, velocity) = (bodies.effort.at::<V>(chunk), bodies.velocity.at::<V>(chunk));
        let (force, slope) = (self.force.at::<V>(chunk), self.slope.at::<V>(chunk));
        let push = effort - force;
        let displacement =
            self.stride.at::<V>(chunk) * velocity + bodies.lever.at::<V>(chunk) * push;
        let unbraked = (self.kept.at::<V>(chunk) * velocity
            + bodies.half.at::<V>(chunk) * (push + effort))
            * self.share.at::<V>(chunk);
        let margin =
            self.coefficient.at::<V>(chunk) * (force * force) - self.hardening.at::<V>(chunk);
        let starts = V::all(0.0).below(margin);
        let progress = self.progress.at::<V>(chunk);
        let gained = progress * margin;
        let held = gained.kept(starts);
        let back = held.flipped(force);
        let towards = displacement - back;
        let forward = towards * self.direction.at::<V>(chunk);
        let onward = V::all(FAINT).below(forward);
        let turns = forward.below(V::all(-FAINT));
        let stiffness = self.initial_stiffness.at::<V>(chunk).or(onward, slope);
        let pace = self.pace.at::<V>(chunk) * force.abs() * stiffness;
        let z = progress + pace;
        let second = second(z);
        let paced = pace * displacement;
        let lagged = (second * (back * z - paced)).kept(starts);
        // Margin and what the limit rises by, both times what a unit of margin gains.
        let creeps = V::all(0.0).below(gained * V::all(SURE) + paced.flipped(force));
        let steady = creeps.same(starts);
        Crept {
            displacement,
            unbraked,
            hardening: held - lagged.flipped(force),
            left: towards + lagged,
            known: steady.and(onward.or(turns)),
            onward: steady.and(onward),
        }
    }

    /// Spring and arrival. Returns where all of the step goes on as it went.
    #[inline(always)]
    fn go_on<V: Vector>(&self, chunk: usize, crept: &Crept<V>, ends: &mut Ends<V>) -> V::Mask {
        let left = crept.left;
        let (before, slope) = (self.force.at::<V>(chunk), self.slope.at::<V>(chunk));
        let position = self.position.at::<V>(chunk) + left;
        let along = left * self.per_displacement.at::<V>(chunk);
        let excess = slope - self.final_stiffness.at::<V>(chunk);
        let [force, slope] = shortly(before, slope, excess, left, along);
        let inside = position * self.direction.at::<V>(chunk);
        let fresh = self.steps.at::<V>(chunk);
        let goes_on = fresh.below_in(crept.onward, V::all(f64::from(SYNCHRONISED)));
        let goes_on = V::all(0.0).below_in(goes_on, along);
        let goes_on = along.below_in(goes_on, V::all(SHORT));
        let goes_on = inside.below_in(goes_on, self.closing.at::<V>(chunk));
        let goes_on = force.abs().below_in(goes_on, self.limit.at::<V>(chunk));
        *ends = Ends {
            displacement: crept.displacement,
            arrived: crept.unbraked - self.braking.at::<V>(chunk) * force,
            hardening: crept.hardening,
            left,
            position,
            force,
            slope,
            known: crept.known.bits(),
        };
        goes_on
    }
}

impl<V: Vector> super::Ends<V> for Ends<V> {
    #[inline(always)]
    fn take_over(&self, chunk: usize, Block { bodies, contacts }: &mut Block<Lanes>) {
        let before = contacts.force.at::<V>(chunk);
        contacts.plastic.more(chunk, self.hardening.flipped(before));
        contacts.hardening.more(chunk, self.hardening);
        contacts.position.put(chunk, self.position);
        contacts.force.put(chunk, self.force);
        contacts.slope.put(chunk, self.slope);
        contacts.steps.more(chunk, V::all(1.0));
        bodies.go(chunk, self.displacement, self.arrived);
    }

    #[inline(always)]
    fn went(block: &mut Block<Lanes>) {
        block.contacts.untold = u8::MAX;
    }

    #[inline(always)]
    fn take_some(&self, chunk: usize, here: V::Mask, block: &mut Block<Lanes>) {
        let Block { bodies, contacts } = block;
        let before = contacts.force.at::<V>(chunk);
        contacts.plastic.more_where(chunk, here, self.hardening.flipped(before));
        contacts.hardening.more_where(chunk, here, self.hardening);
        contacts.steps.more_where(chunk, here, V::all(1.0));
        contacts.position.put_where(chunk, here, self.position);
        contacts.force.put_where(chunk, here, self.force);
        contacts.slope.put_where(chunk, here, self.slope);
        bodies.go_where(chunk, here, self.displacement, self.arrived);
        let (first, all) = (chunk * V::LANES, ((1_u32 << V::LANES) - 1) as u8);
        contacts.untold |= (here.bits() & all) << first;
        let Known { displacement, hardening, left, lanes } = &mut contacts.known;
        displacement.put(chunk, self.displacement);
        hardening.put(chunk, self.hardening);
        left.put(chunk, self.left);
        *lanes = (*lanes & !(all << first)) | (self.known & all) << first;
    }
}
