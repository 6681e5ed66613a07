//! Plain steps in a row: a body whose contact neither turns round nor changes its mode.
//!
//! [`super::through_events`] takes any step of any machine. Nearly every step of nearly every motor
//! needs little of that: a law that has [`FrictionLaw::glide`](crate::friction::FrictionLaw::glide)
//! goes through those in one loop that keeps what runs from step to step in registers, and leaves
//! the first step that is not plain to the others. The equations are the same, to the bit.

use std::ops::Range;

use stiction_dispatch::Task;

use super::clock::after_steps;
use super::response::{Response, halves};
use crate::friction::{Channels, FrictionLaw, PlainSteps};
use crate::math::scalar::Scalar;
use crate::math::verlet::Verlet;
use crate::plant::Run;

/// (ω·h)² below which a step is not fitted to a spring.
const SOFTEST: f64 = 1e-6;

impl Verlet<f64> {
    /// The same, bent so that a body on a spring of this stiffness beside this damping would be taken
    /// where it goes, however long the step: what is left for the step to be short for is how the
    /// friction differs from that.
    ///
    /// An effort beside them that rises at some rate is left out: where the velocity is ahead by the
    /// second number times that rate, and stays so, the positions are right nevertheless.
    pub(super) fn fitted(span: f64, inertia: f64, stiffness: f64, damping: f64) -> (Self, f64) {
        // What a soft spring does in the step would be lost in round-off.
        let soft = stiffness * span * span < SOFTEST * inertia;
        let stiffness = if soft { 0.0 } else { stiffness };
        let (_, Response { impulse, slope, first, second, .. }) =
            halves(stiffness / inertia, 0.5 * damping / inertia, span);
        // x₁ = g·v₀ + G₁/J·(E − σ₀), v₁ = P·v₀ + Q·(2·E − σ₀ − σ₁), which P and Q make exact for
        // σ₁ = σ₀ + k·x₁.
        let lever = first / inertia;
        let braking = impulse / (2.0 * inertia - stiffness * first);
        let left = slope + braking * stiffness * impulse;
        let half = braking * inertia / (1.0 - braking * damping);
        let share = inertia + half * damping;
        let verlet = Self {
            half,
            lever,
            stride: impulse + lever * damping,
            kept: left * share + half * damping,
            ..Self::new(span, inertia, 1.0 / inertia)
        };
        // A step leaves out G₂·r'/J, and goes g times the velocity further.
        (verlet, second / (impulse * inertia))
    }
}

/// Who sees the body and the contact after each sample. A trait, for a closure cannot ask to be part
/// of the loop.
pub trait Seen<S: Scalar, T, E> {
    /// Whether the contact is looked at.
    fn looks(&self) -> bool;
    /// Sees samples during which nothing changes but friction and time, where it can see them at once;
    /// it has seen none of them where it cannot.
    fn still(&mut self, samples: Range<usize>, run: &Run<S>, friction: impl Fn(usize) -> S)
    -> bool;
    /// Sees a sample, and what acts in it; the contact is as it was before the first where it is not looked at.
    fn see(&mut self, sample: usize, run: &Run<S>, contact: &T, efforts: &E);
    /// Sees how far the body goes in a step and the force of its spring then, before the velocity
    /// is known: of a law that has one ([`FrictionLaw::springs`]).
    #[inline(always)]
    fn pulled(&mut self, _displacement: S, _force: S) {}
}

/// The places of position and velocity, where nothing else is wanted of a row of plain steps: what a
/// loop does not ask in every sample.
#[derive(Debug)]
pub struct Places<'a, S> {
    /// The sample that the first place is for.
    pub first: usize,
    /// Positions.
    pub position: &'a mut [S],
    /// Velocities, as many.
    pub velocity: &'a mut [S],
}

impl<S: Scalar, T, E> Seen<S, T, E> for Places<'_, S> {
    #[inline(always)]
    fn looks(&self) -> bool {
        false
    }

    #[inline(always)]
    fn still(&mut self, samples: Range<usize>, run: &Run<S>, _: impl Fn(usize) -> S) -> bool {
        let places = samples.start - self.first..samples.end - self.first;
        self.position[places.clone()].fill(run.position);
        self.velocity[places].fill(run.velocity);
        true
    }

    #[inline(always)]
    fn see(&mut self, sample: usize, run: &Run<S>, _: &T, _: &E) {
        let place = sample - self.first;
        self.position[place] = run.position;
        self.velocity[place] = run.velocity;
    }
}

/// What acts at a moment on a body and its contact.
#[derive(Debug, Clone, Copy)]
pub struct Acting<S> {
    /// Effort of the drive, and the load.
    pub driving: S,
    /// Gravity and added efforts.
    pub ambient: S,
    /// Multipliers of friction and of viscous friction.
    pub levels: (S, S),
}

impl<S: Scalar> Acting<S> {
    /// This effort alone, and levels of 1.
    pub fn plain(ambient: S) -> Self {
        let one = S::constant(1.0);
        Self { driving: S::constant(0.0), ambient, levels: (one, one) }
    }
}

/// All effort but friction, sample by sample. A trait, for a closure cannot ask to be part of the loop.
pub trait Efforts<S: Scalar> {
    /// Whether they are the same all through a sample: else what acts where the body is comes to them.
    const HELD: bool = true;
    /// Whether friction has levels beside 1; efforts that are held leave it none.
    const LEVELS: bool = false;
    /// During this sample, where they are the same all through it.
    fn at(&self, sample: usize) -> S;
    /// Of the drive and the load in a sample where a run is, to which its own ambient comes.
    #[inline(always)]
    fn driving(&self, sample: usize, _run: &Run<S>) -> S {
        self.at(sample)
    }
    /// Puts into its place what acts in a sample where a run will be after such a displacement, at such a
    /// velocity.
    #[inline(always)]
    fn acting(
        &mut self,
        _sample: usize,
        _run: &Run<S>,
        (_displacement, _velocity): (S, S),
        _span: S,
        _there: &mut Acting<S>,
    ) {
    }
    /// Puts into their place the levels where a run is; `arrived` is what was said of its place before its
    /// velocity was known, if anything was.
    #[inline(always)]
    fn levels(
        &self,
        _sample: usize,
        _run: &Run<S>,
        _arrived: Option<&Acting<S>>,
        _levels: &mut (S, S),
    ) {
    }
    /// Takes note of what a step of a sample did to a run, which began at this position and velocity, under
    /// these efforts at its start and its end; the run may come out slower.
    #[inline(always)]
    fn settle(&mut self, _sample: usize, _run: &mut Run<S>, _from: (S, S), _efforts: (S, S)) {}
    /// Lets go on what moves beside a body that is held for a step.
    #[inline(always)]
    fn held(&mut self, _run: &mut Run<S>, _span: S) {}
    /// Takes note of a sample that has ended with a run, and begins the next.
    #[inline(always)]
    fn ended(&mut self, _sample: usize, _run: &mut Run<S>) {}
    /// Whether a sample that begins under these levels and this effort needs no finer steps.
    #[inline(always)]
    fn is_fine(&self, _speed: f64, _effort: f64, _levels: (S, S)) -> bool {
        true
    }
    /// How a contact at rest stays as it is under efforts up to one.
    #[inline(always)]
    fn stillness(&self, _run: &Run<S>, _greatest: f64, _levels: (S, S)) -> Stillness {
        Stillness::Whole
    }
    /// How many of these samples in a row have no effort above this.
    #[inline(always)]
    fn within(&self, samples: Range<usize>, greatest: f64) -> usize {
        samples.take_while(|k| self.at(*k).re().abs() <= greatest).count()
    }
}

/// What changes around a contact at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stillness {
    /// Nothing: samples at rest are alike.
    Whole,
    /// Levels, from step to step.
    Changing,
    /// Something that plain steps do not go through.
    Not,
}

/// A row of plain steps.
#[derive(Debug)]
pub struct Glide<S, E, V> {
    /// The body's share of a step.
    pub verlet: Verlet<S>,
    /// The body.
    pub run: Run<S>,
    /// All effort but friction in a sample.
    pub efforts: E,
    /// Sees the body and the contact after each sample.
    pub seen: V,
    /// The present sample, and the first beyond.
    pub samples: Range<usize>,
    /// The present step of it, of so many.
    pub part: u32,
    /// Steps of a sample.
    pub parts: u32,
    /// Levels at the start of the step that is looked at, where there are any.
    pub levels: (S, S),
    /// All effort but friction then, where it is not the same all through a sample.
    pub effort: S,
    /// The same at the start of the step that was asked for last, and at its end.
    pub efforts_of_step: (S, S),
    /// What acts at the end of it.
    pub there: Acting<S>,
}

impl<S: Scalar, E: Efforts<S>, V> Glide<S, E, V> {
    /// From where a run is; `efforts` says what acts in a sample, which is divided into so many steps.
    #[inline(always)]
    pub fn new(
        run: Run<S>,
        efforts: E,
        seen: V,
        samples: Range<usize>,
        (verlet, parts): (Verlet<S>, u32),
    ) -> Self {
        let (efforts_of_step, there) = ((run.ambient, run.ambient), Acting::plain(run.ambient));
        let mut levels = there.levels;
        efforts.levels(samples.start, &run, None, &mut levels);
        let effort = run.ambient;
        let (part, first) = (0, samples.start);
        let mut glide = Self {
            verlet,
            run,
            efforts,
            seen,
            samples,
            part,
            parts,
            levels,
            effort,
            efforts_of_step,
            there,
        };
        if !E::HELD {
            glide.effort = glide.here(first);
        }
        glide
    }

    /// The last step of a sample has been made.
    #[inline(always)]
    fn end_sample<T>(&mut self, contact: &T)
    where
        V: Seen<S, T, E>,
    {
        let sample = self.samples.start;
        self.efforts.ended(sample, &mut self.run);
        self.seen.see(sample, &self.run, contact, &self.efforts);
        self.samples.start += 1;
    }

    /// All effort but friction where the body is, in a sample.
    #[inline(always)]
    fn here(&self, sample: usize) -> S {
        if E::HELD {
            return self.efforts.at(sample);
        }
        self.efforts.driving(sample, &self.run) + self.run.ambient
    }

    #[inline(always)]
    fn at_levels((level, viscous_level): (S, S)) -> Channels<S> {
        if !E::LEVELS {
            return Channels::default();
        }
        Channels { level, viscous_level, ..Channels::default() }
    }

    /// The same step by step, where levels change meanwhile.
    #[inline(never)]
    fn hold_each<T>(&mut self, greatest: S, contact: &T) -> Option<S>
    where
        V: Seen<S, T, E>,
    {
        let mut held = None;
        while let Some(effort) = self.next() {
            let holds = effort.re().abs() <= (greatest * self.levels.0).re();
            if !holds {
                break;
            }
            self.run.time += self.verlet.span;
            self.run.friction = effort;
            self.efforts.held(&mut self.run, self.verlet.span);
            held = Some(effort);
            self.part += 1;
            if self.part == self.parts {
                self.part = 0;
                self.end_sample(contact);
            }
            self.go_on(false);
        }
        held
    }

    /// What a step begins with after another one, which has arrived where it led or was held.
    #[inline(always)]
    fn go_on(&mut self, arrived: bool) {
        let Range { start, end } = self.samples;
        if start < end {
            let arrived = if arrived { Some(&self.there) } else { None };
            self.efforts.levels(start, &self.run, arrived, &mut self.levels);
            self.effort = self.here(start);
            let effort = self.effort.re();
            let speed = self.run.velocity.re();
            if self.part == 0 && !self.efforts.is_fine(speed, effort, self.levels) {
                self.samples.end = start;
            }
        }
    }
}

impl<S: Scalar, T, E: Efforts<S>, V: Seen<S, T, E>> PlainSteps<S, T> for Glide<S, E, V> {
    const LEVELS: bool = E::LEVELS;

    #[inline(always)]
    fn verlet(&self) -> &Verlet<S> {
        &self.verlet
    }

    #[inline(always)]
    fn velocity(&self) -> S {
        self.run.velocity
    }

    #[inline(always)]
    fn levels(&self) -> &(S, S) {
        &self.levels
    }

    #[inline(always)]
    fn levels_there(&self) -> &(S, S) {
        &self.there.levels
    }

    #[inline(always)]
    fn looks(&self) -> bool {
        self.seen.looks()
    }

    #[inline(always)]
    fn pulled(&mut self, displacement: S, force: S) {
        self.seen.pulled(displacement, force);
    }

    #[inline(always)]
    fn next(&self) -> Option<S> {
        // No closure, which compilers may make a call of: derivatives would go through memory.
        let Range { start, end } = self.samples;
        if start >= end {
            None
        } else if E::HELD {
            Some(self.here(start))
        } else {
            Some(self.effort)
        }
    }

    #[inline(always)]
    fn channels(&self) -> Channels<S> {
        Self::at_levels(self.levels)
    }

    #[inline(always)]
    fn channels_there(&self) -> Channels<S> {
        Self::at_levels(self.there.levels)
    }

    #[inline(always)]
    fn there(&mut self, effort: S, displacement: S, shown: impl FnOnce() -> S) -> S {
        if E::HELD {
            return effort;
        }
        let (sample, span) = (self.samples.start, self.verlet.span);
        let moved = (displacement, shown());
        self.efforts.acting(sample, &self.run, moved, span, &mut self.there);
        let then = self.there.driving + self.there.ambient;
        self.efforts_of_step = (effort, then);
        then
    }

    #[inline(always)]
    fn hold(&mut self, greatest: S, contact: &T) -> Option<S> {
        let mut most = greatest.re();
        if !E::HELD {
            most = (greatest * self.levels.0).re();
            match self.efforts.stillness(&self.run, most, self.levels) {
                Stillness::Whole => (),
                Stillness::Changing => return self.hold_each(greatest, contact),
                Stillness::Not => return None,
            }
        }
        let greatest = most;
        let Range { start, end } = self.samples;
        let held = if E::HELD {
            self.efforts.within(start..end, greatest)
        } else {
            (start..end).take_while(|k| self.here(*k).re().abs() <= greatest).count()
        };
        if held == 0 {
            return None;
        }
        let samples = start..start + held;
        let steps = |samples: usize, part: u32| samples * self.parts as usize - part as usize;
        let (mut time, part) = (self.run.time, self.part);
        let (efforts, resting) = (&self.efforts, self.run);
        let here = |k| {
            if E::HELD { efforts.at(k) } else { efforts.driving(k, &resting) + resting.ambient }
        };
        if self.seen.still(samples.clone(), &self.run, here) {
            // Of what a bare body does nothing asks for derivatives of time.
            let passed = after_steps(time.re(), self.verlet.span.re(), steps(held, part));
            time = time.with_value(passed);
        } else {
            for k in samples.clone() {
                for _ in 0..steps(1, if k == start { part } else { 0 }) {
                    time += self.verlet.span;
                }
                self.run.time = time;
                self.run.friction = here(k);
                self.seen.see(k, &self.run, contact, &self.efforts);
            }
        }
        self.run.time = time;
        self.run.friction = here(samples.end - 1);
        (self.samples.start, self.part) = (samples.end, 0);
        if !E::HELD && samples.end < self.samples.end {
            self.efforts.levels(samples.end, &self.run, None, &mut self.levels);
            self.effort = self.here(samples.end);
        }
        Some(self.run.friction)
    }

    #[inline(always)] // the body would leave its registers for a call
    fn accept(&mut self, displacement: S, velocity: S, friction: S, contact: &T) -> S {
        let run = &mut self.run;
        let from = (run.position, run.velocity);
        run.position += displacement;
        run.velocity = velocity;
        run.friction = friction;
        if E::HELD {
            // Nobody asks a bare body for derivatives of these, nor how far it has moved for its effects.
            run.path.put(run.path.re() + displacement.re().abs());
            run.time.put(run.time.re() + self.verlet.span.re());
        } else {
            run.path += displacement.abs();
            run.time += self.verlet.span;
            run.moved += displacement;
            run.ambient = self.there.ambient;
            self.efforts.settle(self.samples.start, run, from, self.efforts_of_step);
        }
        self.part += 1;
        if self.part == self.parts {
            self.part = 0;
            self.end_sample(contact);
        }
        if !E::HELD {
            self.go_on(true);
        }
        if E::HELD { velocity } else { self.run.velocity }
    }
}

/// A row of plain steps of a law, as a loop to run.
#[derive(Debug)]
pub struct Plain<'a, L, T, G> {
    /// The law.
    pub law: &'a L,
    /// Its state.
    pub state: &'a mut T,
    /// The body: its own, so that nobody else can see it and it stays in registers; or a place in
    /// memory, for numbers that carry derivatives, of which compilers would make a thousand pieces.
    pub glide: G,
}

impl<S, L, E, V> Task for Plain<'_, L, L::State, Glide<S, E, V>>
where
    S: Scalar,
    L: FrictionLaw<S>,
    E: Efforts<S>,
    V: Seen<S, L::State, E>,
{
    /// The body where it ended, the sample and the step of it.
    type Output = (Run<S>, usize, u32);

    #[inline(always)]
    fn run(self) -> Self::Output {
        // A place that nobody else sees, not even should the loop panic.
        let mut glide = self.glide;
        // A copy, which no store into a column can be taken to change.
        let law = self.law.clone();
        law.glide(self.state, &mut glide);
        (glide.run, glide.samples.start, glide.part)
    }
}

impl<S, L, E, V> Task for Plain<'_, L, L::State, &mut Glide<S, E, V>>
where
    S: Scalar,
    L: FrictionLaw<S>,
    E: Efforts<S>,
    V: Seen<S, L::State, E>,
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.law.glide(self.state, self.glide);
    }
}
