//! A row of bodies and of contacts, in the form in which they run side by side.
//!
//! A law that has such a form ([`FrictionLaw::abreast`]) keeps what runs from step to step of
//! [`WIDTH`] contacts in rows and takes a step of all of them without a choice: [`Contacts`]. Who runs
//! the rows is none of its business.

use stiction_dispatch::{Mask, Vector};

use super::law::FrictionLaw;
use crate::math::row::{Row, WIDTH, bits};
use crate::math::scalar::Scalar;
use crate::math::verlet::Verlet;

/// The bodies of a block and their share of a step, see [`Verlet`].
#[derive(Debug, Clone)]
#[repr(align(64))]
pub struct Bodies {
    /// All effort but friction during the step; here, so that nobody has to ask whether it overlaps
    /// with the rest, which would cost so short a loop its vectors.
    pub effort: Row,
    /// Position.
    pub position: Row,
    /// Velocity.
    pub velocity: Row,
    /// Friction.
    pub friction: Row,
    /// Path travelled.
    pub path: Row,
    /// Time at some step of the row, and which: all lanes take each, and the clock of a lane is
    /// looked at seldom.
    pub(crate) time: Row,
    pub(crate) since: [usize; WIDTH],
    /// Steps that the row has taken.
    pub taken: usize,
    /// Duration of a step.
    pub span: Row,
    /// Half of it.
    pub half: Row,
    /// Inertia.
    pub inertia: Row,
    /// Velocity per effort.
    pub pace: Row,
    /// Displacement per effort.
    pub lever: Row,
    /// 1 where the last step was not plain, so that the lane did not take it: for loops over lanes.
    pub missed: [u64; WIDTH],
    /// A bit for each lane where there is a body.
    pub present: u8,
    /// A bit for each lane whose steps are made in pieces while friction falls with speed: then none of
    /// them is plain.
    pub in_pieces: u8,
}

impl Bodies {
    /// Bodies that do not move.
    pub fn still() -> Self {
        let zero = Row::ZERO;
        Self {
            effort: zero,
            position: zero,
            velocity: zero,
            friction: zero,
            path: zero,
            time: zero,
            since: [0; WIDTH],
            taken: 0,
            span: zero,
            half: zero,
            inertia: Row([1.0; WIDTH]),
            pace: zero,
            lever: zero,
            missed: [0; WIDTH],
            present: 0,
            in_pieces: 0,
        }
    }

    /// Takes what a body needs for a step.
    pub fn fit<S: Scalar>(&mut self, lane: usize, verlet: &Verlet<S>) {
        let [span, half, inertia, pace, lever] = verlet.numbers();
        self.span.0[lane] = span;
        self.half.0[lane] = half;
        self.inertia.0[lane] = inertia;
        self.pace.0[lane] = pace;
        self.lever.0[lane] = lever;
        self.present |= 1 << lane;
    }

    /// A bit for each lane of these that is there and where something does not hold, at its place in
    /// the row.
    #[inline(always)]
    pub fn without<V: Vector>(&self, holds: V::Mask, chunk: usize) -> u8 {
        let lanes = ((1_u32 << V::LANES) - 1) as u8;
        ((!holds.bits() & lanes) << (chunk * V::LANES)) & self.present
    }

    /// [`Verlet::depart`] of some lanes.
    #[inline(always)]
    pub fn departs<V: Vector>(&self, chunk: usize, net: V) -> (V, V) {
        let velocity = self.velocity.at::<V>(chunk);
        let displacement = self.span.at::<V>(chunk) * velocity + self.lever.at::<V>(chunk) * net;
        (displacement, velocity + self.pace.at::<V>(chunk) * net)
    }

    /// Moves some lanes on, but for their friction.
    #[inline(always)]
    pub fn go<V: Vector>(&mut self, chunk: usize, displacement: V, velocity: V) {
        self.position.more(chunk, displacement);
        self.path.more(chunk, displacement.abs());
        self.velocity.put(chunk, velocity);
    }

    /// The same where something holds.
    #[inline(always)]
    pub fn go_where<V: Vector>(
        &mut self,
        chunk: usize,
        taken: V::Mask,
        displacement: V,
        velocity: V,
    ) {
        self.position.more_where(chunk, taken, displacement);
        self.path.more_where(chunk, taken, displacement.abs());
        self.velocity.put_where(chunk, taken, velocity);
    }

    /// [`Verlet::depart`] of a lane.
    #[inline(always)]
    pub fn depart(&self, lane: usize, net: f64) -> (f64, f64) {
        let velocity = self.velocity.0[lane];
        let displacement = self.span.0[lane] * velocity + self.lever.0[lane] * net;
        (displacement, velocity + self.pace.0[lane] * net)
    }

    /// What [`Verlet::dragged`] and a share of this damping are in a lane.
    pub fn dragged(&self, lane: usize, damping: f64) -> Dragged {
        let (inertia, half) = (self.inertia.0[lane], self.half.0[lane]);
        let share = 1.0 / (inertia + half * damping);
        Dragged {
            stride: self.span.0[lane] - self.lever.0[lane] * damping,
            kept: inertia - half * damping,
            share,
            braking: half * share,
        }
    }

    /// [`Verlet::arrive`] of a lane.
    #[inline(always)]
    pub fn arrive(&self, lane: usize, both: f64, damping: f64, undamped: f64) -> f64 {
        let (inertia, half) = (self.inertia.0[lane], self.half.0[lane]);
        let share = 1.0 / (inertia + half * damping);
        (inertia * self.velocity.0[lane] + half * both) * share - half * share * undamped
    }

    /// What a loop over lanes has left in `missed`.
    #[inline(always)]
    pub fn rest(&self) -> Rest {
        let any = self.missed.iter().fold(0, |any, missed| any | missed) != 0;
        let missed = if any { bits(&self.missed) & self.present } else { 0 };
        Rest { missed, changed: 0 }
    }

    /// Moves a lane on where `plain`, see `Glide::accept`.
    #[inline(always)]
    pub fn accept(
        &mut self,
        lane: usize,
        plain: bool,
        displacement: f64,
        velocity: f64,
        friction: f64,
    ) {
        self.position.add(lane, plain, displacement);
        self.path.add(lane, plain, displacement.abs());
        self.velocity.take(lane, plain, velocity);
        self.friction.take(lane, plain, friction);
    }
}

/// What a step of a row leaves to be done, a bit for each lane.
#[derive(Debug, Clone, Copy, Default)]
pub struct Rest {
    /// Where it was not plain, so that the lane did not take it.
    pub missed: u8,
    /// Where the contact has more to note of it than rows do.
    pub changed: u8,
}

/// A body's share of steps against one damping, see [`Verlet`].
#[derive(Debug, Clone, Copy)]
pub struct Dragged {
    /// Displacement per velocity.
    pub stride: f64,
    /// What is left of the inertia.
    pub kept: f64,
    /// 1/(J + h/2·D).
    pub share: f64,
    /// What a unit of friction at the end takes off the velocity there.
    pub braking: f64,
}

/// Contacts of one law, one in each lane; by default lanes with nothing in them.
pub trait Contacts<S: Scalar, L: FrictionLaw<S>>: Clone + Default {
    /// Takes the parameters of a contact whose body has this inertia and half step.
    fn fit(&mut self, lane: usize, law: &L, bodies: &Bodies);
    /// Takes the state of a contact.
    fn load(&mut self, lane: usize, law: &L, state: &L::State);
    /// Puts the state of a lane back.
    fn store(&self, lane: usize, state: &mut L::State);
    /// Notes what the last step of a lane has changed besides its rows.
    fn note(&mut self, _lane: usize, _law: &L, _state: &mut L::State) {}
    /// Brings up to date what steps leave to be known later: friction.
    #[inline(always)]
    fn settle(&mut self, _bodies: &mut Bodies) {}
    /// Takes a step of all lanes of some blocks under their efforts; those that it is not plain for stay
    /// where they are. Returns what is left to be done, if anything. Compiled for several widths: mark it as `#[inline(always)]`. A processor looks a
    /// few hundred operations ahead, which is one block: what takes as many stage by stage shares the
    /// waiting among them.
    fn step<V: Vector, const N: usize>(blocks: &mut [Block<Self>; N]) -> Option<[Rest; N]>;
}

/// [`WIDTH`] motors.
///
/// A load waits for a store that is still under way to the same place of another page of 4096 bytes,
/// as if it were the same place. Half a page apart, few rows of one block are where another is written.
#[derive(Debug, Clone)]
#[repr(C, align(2048))]
pub struct Block<C> {
    /// Their bodies.
    pub bodies: Bodies,
    /// Their contacts.
    pub contacts: C,
}

/// What takes contacts of a law side by side, once the law has told in which form they run.
pub trait SideBySide<S: Scalar, L: FrictionLaw<S>> {
    /// What comes of it.
    type Output;
    /// Takes contacts in this form.
    fn with<C: Contacts<S, L>>(self) -> Self::Output;
}

/// Asks for no more than whether there is such a form.
#[derive(Debug, Clone, Copy)]
pub struct Asked;

impl<S: Scalar, L: FrictionLaw<S>> SideBySide<S, L> for Asked {
    type Output = ();

    fn with<C: Contacts<S, L>>(self) {}
}
