//! A contact alone with the effects that act on it: where it is, and what reaches it in a sample.

use super::body::Body;
use super::drive::Drive;
use super::effects::{AnyEffect, Effects, Passage};
use super::machine::Machine;
use super::naming::{BODY, Place};
use super::run::Run;
use super::sensor::Sensor;
use crate::friction::{Channels, Entry, EntryReader};
use crate::math::scalar::Scalar;
use crate::support::error::Result;

/// Of what a body carries, what a contact needs of it that is moved as its caller says.
const CARRIED: [&str; 5] = ["position", "time", "path", "friction", "relaxed"];

/// Effects at a contact, and where it has come to.
///
/// It is a machine without a drive, without weight and of no inertia that matters: effects are asked by
/// the functions that a motor asks them by, in the order of a motor that follows a given motion.
#[derive(Debug, Clone)]
pub struct ContactEffects<S: Scalar> {
    machine: Machine<S>,
    run: Run<S>,
}

/// What effects make of a sample.
#[derive(Debug, Clone, Copy)]
pub struct Reach<S> {
    /// What reaches the law.
    pub channels: Channels<S>,
    /// Effort that effects add on the body, positive along +x.
    pub added: S,
    /// Velocity of what gives way in series with the law.
    pub creep: S,
}

impl<S: Scalar> ContactEffects<S> {
    /// Of a contact that was never moved; `sliding` is the law's friction of slow sliding.
    pub fn new(effects: impl IntoIterator<Item = AnyEffect<S>>, sliding: S) -> Self {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        let drive = Drive { gain: zero, limit: f64::INFINITY, servo: None };
        let body = Body::new(one, zero, zero, zero);
        let machine = Machine::new(drive, body, Effects::new(effects), Sensor::default(), sliding);
        let run = machine.start(zero, zero);
        Self { machine, run }
    }

    /// Whether something gives way in series with the law.
    #[inline]
    pub fn relaxes(&self) -> bool {
        self.machine.relaxes()
    }

    /// The effects, with what they remember.
    pub fn effects(&self) -> &Effects<S> {
        &self.machine.effects
    }

    /// Where the contact has come to.
    pub fn run(&self) -> &Run<S> {
        &self.run
    }

    /// Goes on through a sample at a held velocity, given what reaches the contact without effects. What
    /// the law makes of it is to be [noted](Self::note).
    #[inline]
    pub fn advance(&mut self, velocity: S, span: S, given: &Channels<S>) -> Reach<S> {
        let Self { machine, run } = self;
        let displacement = velocity * span;
        run.position += displacement;
        run.path += displacement.abs();
        run.time += span;
        run.velocity = velocity;
        run.temperature = given.temperature;
        machine.effects.remember(&Passage { displacement, friction: run.friction, span });
        let at = machine.at_contact(&run.situation(), given.effort, given.load);
        let added = machine.surroundings(&at);
        let own = machine.channels(&at, given.effort + added, given.load);
        let channels = Channels {
            level: own.level * given.level,
            viscous_level: own.viscous_level * given.viscous_level,
            ..own
        };
        let mut creep = S::constant(0.0);
        if machine.relaxes() {
            let (hardened, crept) = machine.relax(run.relaxed, run.friction, span);
            run.relaxed = hardened;
            creep = crept / span;
        }
        Reach { channels, added, creep }
    }

    /// Takes note of the friction of the law at the end of the sample.
    #[inline]
    pub fn note(&mut self, friction: S) {
        self.run.friction = friction;
    }

    /// Back to a contact that was never moved, at this position, with the clock and the path so far.
    pub fn reset(&mut self, [position, time, path]: [S; 3]) {
        self.machine.effects.forget();
        self.run = Run { time, path, ..self.machine.start(position, S::constant(0.0)) };
    }

    /// Takes over where another contact is and what its effects remember: of the same effects, or the
    /// first of these.
    pub fn resume(&mut self, other: &ContactEffects<f64>) {
        self.machine.effects.resume(&other.machine.effects);
        self.run = other.run.lift();
    }
}

impl ContactEffects<f64> {
    fn places() -> impl Iterator<Item = (&'static str, Place)> {
        BODY.into_iter().filter(|(name, _)| CARRIED.contains(name))
    }

    /// Where the contact is and what effects remember, as entries of a state.
    pub fn entries(&self) -> impl Iterator<Item = (&'static str, Entry)> {
        let mut run = self.run;
        let effects = &self.machine.effects;
        let numbers =
            Self::places().map(move |(name, place)| (name, Entry::Number(*place(&mut run))));
        numbers.chain(effects.remembers().then(|| effects.entry()))
    }

    /// The same from entries, all of which have to be of it.
    pub fn restored(&self, entries: &[(String, Entry)]) -> Result<Self> {
        let mut restored = self.clone();
        let mut read = EntryReader::new(entries);
        for (name, place) in Self::places() {
            *place(&mut restored.run) = read.number(name, false)?;
        }
        if restored.machine.effects.remembers() {
            restored.machine.effects.restore(&mut read)?;
        }
        read.finish()?;
        Ok(restored)
    }

    /// Takes over where a body is, and what those of its effects remember that stand at these places
    /// there, in the order of these effects.
    pub fn take(&mut self, run: &Run<f64>, effects: &Effects<f64>, places: &[usize]) {
        self.machine.effects.take(effects, places);
        let Run { position, time, path, friction, relaxed, temperature, .. } = *run;
        let fresh = self.machine.start(position, 0.0);
        self.run = Run { time, path, friction, relaxed, temperature, ..fresh };
    }

    /// Size of the numbers that it is made of, beside what effects remember.
    pub fn size(&self) -> f64 {
        self.run.position.abs() + self.run.path.abs() + self.run.time.abs()
    }
}
