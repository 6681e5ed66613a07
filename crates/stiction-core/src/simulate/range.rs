//! Whether a step can leave the range of floats, and what a motor goes back to where one has.
//!
//! A step that ends in no number is refused and taken back. For that one needs a copy, and a copy costs
//! more than a step does: it is made only where something is so large, so small or so stiff that a step
//! may get there. Elsewhere nothing but a few comparisons is paid.

use crate::friction::Entry;
use crate::plant::servo::Servo;
use crate::simulate::motor::MotorSpec;
use crate::support::parameter::ParameterSpec;

/// Times and parts of typical values within which parameters are ordinary.
const ORDINARY: f64 = 1e6;
/// Inertias between which bodies are; of what else there is of a body, [`ORDINARY`] is the most.
const LIGHTEST: f64 = 1e-9;
const HEAVIEST: f64 = 1e9;
/// Sum of the magnitudes of input, load, position and velocity from which on steps are watched.
const WATCHED: f64 = 1e9;
/// The same of each number of a state that is put in, clocks and counters too.
const LARGE: f64 = 1e12;
/// Durations of steps between which they are not, s.
const SHORTEST: f64 = 1e-9;
const LONGEST: f64 = 10.0;
/// Parts of a step up to which it is not: what grows in each of them has little time to.
const PARTS: f64 = 64.0;

/// Within what a step needs no watch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Range {
    /// By the parameters alone; negative where every step is watched.
    own: f64,
    /// The same with the state that was put in.
    reach: f64,
    longest: f64,
}

impl Range {
    /// That of parameters that are ordinary or not, which divide steps into so many parts a second.
    pub fn new(ordinary: bool, parts: f64) -> Self {
        let own = if ordinary { WATCHED } else { -1.0 };
        Self { own, reach: own, longest: LONGEST.min(PARTS / parts) }
    }

    /// Whether a step of this duration from numbers of this size needs no watch.
    #[inline]
    pub fn covers(&self, size: f64, dt: f64) -> bool {
        size <= self.reach && dt >= SHORTEST && dt <= self.longest
    }

    /// Whether numbers of this size, reached from anywhere, need none.
    pub fn holds(&self, size: f64) -> bool {
        size <= self.reach
    }

    /// Takes note of the state of another machine that is taken over.
    pub fn follow(&mut self, other: &Self) {
        self.reach = self.own.min(other.reach);
    }

    /// Forgets what was put in.
    pub fn forget(&mut self) {
        self.reach = self.own;
    }

    /// Takes note of a state that is put in.
    pub fn meet<'a>(&mut self, entries: impl IntoIterator<Item = &'a Entry>) {
        // An infinite level is one that is never reached.
        let small = |x: &f64| x.abs() <= LARGE || x.is_infinite();
        let calm = entries.into_iter().all(|entry| match entry {
            Entry::Number(x) => small(x),
            Entry::Pairs(rows) => rows.as_flattened().iter().all(small),
        });
        if !calm {
            self.reach = -1.0;
        }
    }
}

/// Whether these values are neither far beyond the typical ones nor vanishing beside them; none and
/// infinitely much are no matter, for laws and effects look out for both.
pub(crate) fn ordinary(specs: &[ParameterSpec], values: impl IntoIterator<Item = f64>) -> bool {
    specs.iter().zip(values).all(|(spec, value)| {
        let (size, typical) = (value.abs(), spec.typical.abs());
        let usual = size <= ORDINARY * typical && size * ORDINARY >= typical;
        usual || value == 0.0 || value.is_infinite() || spec.neutral == Some(value)
    })
}

/// Whether a motor is made of ordinary numbers, with these values in the order of its parameters.
pub(crate) fn ordinary_motor(spec: &MotorSpec, values: &[f64]) -> bool {
    let (body, rest) = values.split_at(5);
    let (friction, mut rest) = rest.split_at(spec.friction.values.len());
    let effects = spec.effects.iter().all(|effect| {
        let (values, after) = rest.split_at(effect.values.len());
        rest = after;
        ordinary(effect.record.parameters, values.iter().copied())
    });
    let servo = spec.servo.is_none_or(|servo| ordinary(Servo::SPECS, servo.values()));
    let inertia = body[0] >= LIGHTEST && body[0] <= HEAVIEST;
    let others = body[1..].iter().all(|x| x.abs() <= ORDINARY);
    let law = ordinary(spec.friction.record.parameters, friction.iter().copied());
    inertia && others && servo && effects && law
}

/// Whether a state is made of numbers; what is infinite was so before.
pub(crate) fn sound<N>(before: &[(N, Entry)], after: &[(N, Entry)]) -> bool {
    let number = |(before, after): (&Entry, &Entry)| match after {
        Entry::Number(x) => x.is_finite() || (!x.is_nan() && before == after),
        Entry::Pairs(rows) => rows.as_flattened().iter().all(|x| x.is_finite()),
    };
    before.iter().map(|(_, entry)| entry).zip(after.iter().map(|(_, entry)| entry)).all(number)
}
