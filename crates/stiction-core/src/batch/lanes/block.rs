//! A row of bodies and of contacts, in the form in which they run.

use stiction_dispatch::{Mask, Vector};

use crate::friction::FrictionLaw;
use crate::integrate::after_steps;
use crate::math::scalar::Scalar;
use crate::math::verlet::Verlet;
use crate::plant::Run;

/// Lanes of a block: one vector of the widest processors, two or four of others.
pub const WIDTH: usize = stiction_dispatch::ROW;

/// One number where `taken`, else the other.
///
/// By bits: a choice would become a load from either place, or a store under a mask, on which the
/// next load has to wait.
#[inline(always)]
pub fn pick(taken: bool, new: f64, old: f64) -> f64 {
    let mask = u64::from(taken).wrapping_neg();
    f64::from_bits((new.to_bits() & mask) | (old.to_bits() & !mask))
}

/// One number for each lane.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
pub struct Row(pub [f64; WIDTH]);

impl Row {
    /// 0 in each lane.
    pub const ZERO: Self = Self([0.0; WIDTH]);

    /// Replaces the number of a lane where `taken`.
    #[inline(always)]
    pub fn take(&mut self, lane: usize, taken: bool, new: f64) {
        self.0[lane] = pick(taken, new, self.0[lane]);
    }

    /// Some of its numbers.
    #[inline(always)]
    pub fn at<V: Vector>(&self, chunk: usize) -> V {
        V::load(&self.0, chunk)
    }

    /// Replaces some of its numbers.
    #[inline(always)]
    pub fn put<V: Vector>(&mut self, chunk: usize, numbers: V) {
        numbers.store(&mut self.0, chunk);
    }

    /// Adds to some of its numbers.
    #[inline(always)]
    pub fn more<V: Vector>(&mut self, chunk: usize, numbers: V) {
        self.put(chunk, self.at::<V>(chunk) + numbers);
    }

    /// Replaces some of its numbers where something holds.
    #[inline(always)]
    pub fn put_where<V: Vector>(&mut self, chunk: usize, taken: V::Mask, numbers: V) {
        self.put(chunk, self.at::<V>(chunk).or(taken, numbers));
    }

    /// Adds to some of its numbers where something holds.
    #[inline(always)]
    pub fn more_where<V: Vector>(&mut self, chunk: usize, taken: V::Mask, numbers: V) {
        // −0 changes no number.
        self.more(chunk, V::all(-0.0).or(taken, numbers));
    }

    /// Adds to the number of a lane where `taken`.
    #[inline(always)]
    pub fn add(&mut self, lane: usize, taken: bool, more: f64) {
        // −0 changes no number: a sum for all is written whole, and the next load need not wait.
        self.0[lane] += pick(taken, more, -0.0);
    }
}

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
    time: Row,
    since: [usize; WIDTH],
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

    /// Takes a body into a lane.
    #[inline]
    pub fn load<S: Scalar>(&mut self, lane: usize, run: &Run<S>) {
        self.position.0[lane] = run.position.re();
        self.velocity.0[lane] = run.velocity.re();
        self.friction.0[lane] = run.friction.re();
        self.path.0[lane] = run.path.re();
        self.time.0[lane] = run.time.re();
        self.since[lane] = self.taken;
    }

    /// Puts the body of a lane back, where it was after so many steps of the row.
    #[inline]
    pub fn store<S: Scalar>(&self, lane: usize, taken: usize, run: &mut Run<S>) {
        let steps = taken - self.since[lane];
        let time = after_steps(self.time.0[lane], self.span.0[lane], steps);
        run.position = S::constant(self.position.0[lane]);
        run.velocity = S::constant(self.velocity.0[lane]);
        run.friction = S::constant(self.friction.0[lane]);
        run.path = S::constant(self.path.0[lane]);
        run.time = S::constant(time);
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

/// A bit for each lane that is not 0.
pub fn bits(lanes: &[u64; WIDTH]) -> u8 {
    (0..WIDTH).fold(0, |bits, lane| bits | u8::from(lanes[lane] != 0) << lane)
}

/// The lanes of these bits.
pub fn lanes(mut bits: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < WIDTH).then_some(lane)
    })
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
