//! A few elastic elements in parallel that harden linearly: plasticity by mechanical models.

use super::{
    Channels, Entry, EntryReader, Event, FrictionLaw, LawState, Motion, Outcome, Rest, Statistics,
};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::error::{Error, Result};
use crate::support::parameter::{OptionSpec, ParameterSpec};

/// Elements of [`ParallelElements`].
pub const ELEMENTS: usize = 4;
/// Round-off of a force that reached its yield point, in shares of it.
const REACHED: f64 = 1e-12;

parameters! {
    /// Parameters of [`ParallelElements`].
    pub struct ParallelElementsParameters {
        coulomb: Effort, "sum of the forces at which the elements first yield, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "sum of the stiffnesses below yield, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        yield_spread: One, "spread of the yield displacements about their mean, s: the first is 1 − s, the last 1 + s of it",
            default Value(0.75), neutral None, typical 0.6, bounds 0.0, 0.95;
        hardening_share: One, "stiffness that is left beyond yield, h; 0 is perfectly plastic",
            default Value(0.01), neutral Some(0.0), typical 0.01, bounds 0.0, 0.9;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

/// What yielding one way does to the yield point of the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rule {
    /// It follows: the range between both keeps its size.
    Kinematic,
    /// It moves away by as much.
    Isotropic,
    /// It stays.
    Independent,
}

/// Elastic-linear-hardening elements in parallel.
///
/// F = L·Σ f_i + F_v·v;  f_i' = k_i·v within its yield points u_i, l_i, h·k_i·v at them
///
/// k_i = k_0/4, first yield at ξ_i = (F_c/k_0)·(1 + s·(2i − 3)/3), i = 0 … 3. An element that
/// yields takes its yield point along; the opposite one follows (`hardening="kinematic"`), moves
/// away by as much (`"isotropic"`) or stays (`"independent"`).
///
/// At v = 0 the force stays where it is. Memory: force and yield points of each element, the latter by
/// how far they were moved. Passive.
/// Neutral: h = 0 is perfectly plastic under any rule. With h > 0 friction never levels off.
/// Source: Prager, Proc. Inst. Mech. Eng. 169 (1955); Iwan, J. Appl. Mech. 33 (1966); Hodge (1957) on
/// the rules; from memory.
#[derive(Debug, Clone)]
pub struct ParallelElements<S> {
    parameters: ParallelElementsParameters<S>,
    rule: Rule,
    /// Force of each element at first yield.
    yields: [S; ELEMENTS],
}

/// One element; forces at level 1.
#[derive(Debug, Clone, Copy)]
struct Element<S> {
    force: S,
    /// By how much each yield point was moved since the first.
    upper: S,
    lower: S,
    /// ±1 yields in that direction, 0 is elastic.
    mode: f64,
}

/// State of [`ParallelElements`].
#[derive(Debug, Clone, Copy)]
pub struct ParallelElementsState<S> {
    elements: [Element<S>; ELEMENTS],
    statistics: Statistics,
}

/// A step of [`ParallelElements`].
#[derive(Debug, Clone, Copy)]
pub struct ParallelElementsTrial<S> {
    elements: [Element<S>; ELEMENTS],
    outcome: Outcome<S>,
}

impl<S: Scalar> Element<S> {
    fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> Element<T> {
        let (force, upper, lower) = (convert(self.force), convert(self.upper), convert(self.lower));
        Element { force, upper, lower, mode: self.mode }
    }

    /// The element after its spring was pulled by `pull` more, and whether it yields.
    #[inline]
    fn pulled(&self, pull: S, first: S, hardening: S, rule: Rule) -> (Self, bool) {
        let force = self.force + pull;
        let (above, below) = (force - first - self.upper, force + first - self.lower);
        let beyond = if above.re() > 0.0 {
            above
        } else if below.re() < 0.0 {
            below
        } else {
            // Yielding ends when the element unloads, not at a rest nor at the round-off of its
            // start.
            let mode = if self.mode * pull.re() >= 0.0 { self.mode } else { 0.0 };
            return (Self { force, mode, ..*self }, false);
        };
        // Of what lies beyond the yield point the share h is held, and moves the point along.
        let (moved, mode) = (hardening * beyond, sign(beyond.re()));
        let other = match rule {
            Rule::Kinematic => moved,
            Rule::Isotropic => -moved,
            Rule::Independent => S::constant(0.0),
        };
        let (up, down) = if mode > 0.0 { (moved, other) } else { (other, moved) };
        let (upper, lower) = (self.upper + up, self.lower + down);
        let force = if mode > 0.0 { upper + first } else { lower - first };
        (Self { force, upper, lower, mode }, true)
    }

    /// Force that is left before it begins to yield.
    #[inline]
    fn margin(&self, pull: S, first: S) -> S {
        let force = self.force + pull;
        let (above, below) = (self.upper + first - force, force + first - self.lower);
        if self.mode > 0.0 || (self.mode == 0.0 && below.re() < above.re()) { below } else { above }
    }

    /// Starts to yield where it stands at a yield point.
    #[inline]
    fn start(&mut self, first: S) {
        let (above, below) = (self.upper + first - self.force, self.force + first - self.lower);
        let slack = REACHED * (above + below).re();
        if self.mode != 1.0 && above.re() <= slack {
            self.mode = 1.0;
        } else if self.mode != -1.0 && below.re() <= slack {
            self.mode = -1.0;
        }
    }
}

impl<S: Scalar> ParallelElementsState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> ParallelElementsState<T> {
        let elements = self.elements.map(|element| element.map(&convert));
        ParallelElementsState { elements, statistics: self.statistics }
    }

    fn dry(&self) -> S {
        self.elements.iter().fold(S::constant(0.0), |sum, element| sum + element.force)
    }

    /// Takes the elements over and counts where yielding begins and ends.
    #[inline]
    fn take(&mut self, elements: &[Element<S>; ELEMENTS]) {
        for (old, new) in self.elements.iter().zip(elements) {
            if old.mode != new.mode {
                self.statistics.sticks += u64::from(old.mode != 0.0);
                self.statistics.breakaways += u64::from(new.mode != 0.0);
            }
        }
        self.elements = *elements;
    }
}

impl<S: Scalar> LawState<S> for ParallelElementsState<S> {
    const OUTPUTS: &'static [&'static str] = &["dry_friction"];

    fn output(&self, _index: usize) -> S {
        self.dry()
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        let forces = self.elements.iter().map(|e| [e.force.re(), e.mode]).collect();
        let shifts = self.elements.iter().map(|e| [e.lower.re(), e.upper.re()]).collect();
        vec![
            ("elements", Entry::Pairs(forces)),
            ("yield_shifts", Entry::Pairs(shifts)),
            ("breakaways", Entry::Number(self.statistics.breakaways as f64)),
            ("sticks", Entry::Number(self.statistics.sticks as f64)),
        ]
    }

    fn statistics(&self) -> Statistics {
        self.statistics
    }
}

impl<S: Scalar> ParallelElements<S> {
    /// By how much a displacement pulls the spring of each element.
    #[inline]
    fn pull(&self, motion: &Motion<S>) -> S {
        self.parameters.initial_stiffness * motion.displacement / ELEMENTS as f64
    }
}

impl<S: Scalar> FrictionLaw<S> for ParallelElements<S> {
    type State = ParallelElementsState<S>;
    type Trial = ParallelElementsTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = ParallelElementsParameters::<f64>::SPECS;
    const OPTIONS: &'static [OptionSpec] = &[OptionSpec {
        name: "hardening",
        meaning: "what yielding one way does to the yield point of the other",
        choices: &[
            ("kinematic", "it follows, so that the elastic range keeps its size (Prager)"),
            ("isotropic", "it moves away by as much"),
            ("independent", "it stays where it is"),
        ],
    }];
    const REMEMBERS: bool = true;
    const SUMMARY: &'static str =
        "four elastic elements in parallel that harden linearly beyond their yield points";
    const SOURCE: &'static str = "Prager (1955); Hodge (1957); Iwan (1966); from memory";

    fn build(values: &[S], choices: &[usize]) -> Self {
        let p = ParallelElementsParameters::from_values(values);
        let rule = match choices.first() {
            Some(1) => Rule::Isotropic,
            Some(2) => Rule::Independent,
            _ => Rule::Kinematic,
        };
        let last = (ELEMENTS - 1) as f64;
        let yields = std::array::from_fn(|i| {
            let place = 2.0 * i as f64 / last - 1.0;
            p.coulomb / ELEMENTS as f64 * (p.yield_spread * place + 1.0)
        });
        Self { parameters: p, rule, yields }
    }

    fn initial(&self) -> ParallelElementsState<S> {
        let zero = S::constant(0.0);
        let element = Element { force: zero, upper: zero, lower: zero, mode: 0.0 };
        let statistics = Statistics::default();
        ParallelElementsState { elements: [element; ELEMENTS], statistics }
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<ParallelElementsState<S>> {
        let mut read = EntryReader::new(entries);
        let (forces, shifts) = (read.pairs("elements")?, read.pairs("yield_shifts")?);
        let whole = forces.len() == ELEMENTS && shifts.len() == ELEMENTS;
        if !whole || !forces.iter().all(|row| [-1.0, 0.0, 1.0].contains(&row[1])) {
            return Err(Error::State {
                name: "elements".to_owned(),
                problem:
                    "and 'yield_shifts' do not hold four rows each, of a force and -1, 0 or 1 \
                          and of two forces"
                        .to_owned(),
            });
        }
        let mut state = self.initial();
        for ((element, row), shift) in state.elements.iter_mut().zip(forces).zip(shifts) {
            *element = Element {
                force: S::constant(row[0]),
                lower: S::constant(shift[0]),
                upper: S::constant(shift[1]),
                mode: row[1],
            };
        }
        state.statistics.breakaways = read.count("breakaways")?;
        state.statistics.sticks = read.count("sticks")?;
        read.finish()?;
        Ok(state)
    }

    fn sliding_force(&self) -> S {
        self.parameters.coulomb
    }

    fn greatest_stiffness(&self) -> f64 {
        self.parameters.initial_stiffness.re()
    }

    fn greatest_damping(&self) -> f64 {
        self.parameters.viscous.re()
    }

    #[inline]
    fn force(&self, state: &ParallelElementsState<S>, velocity: S, channels: &Channels<S>) -> S {
        state.dry() * channels.level + self.parameters.viscous * channels.viscous_level * velocity
    }

    fn advance(
        &self,
        state: &ParallelElementsState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> ParallelElementsTrial<S> {
        let p = &self.parameters;
        let pull = self.pull(motion);
        let mut elements = state.elements;
        let (mut dry, mut share) = (S::constant(0.0), S::constant(0.0));
        for (element, first) in elements.iter_mut().zip(&self.yields) {
            let (after, yields) = element.pulled(pull, *first, p.hardening_share, self.rule);
            *element = after;
            dry += after.force;
            share += if yields { p.hardening_share } else { S::constant(1.0) };
        }
        let damping = p.viscous * channels.viscous_level;
        let stiffness = p.initial_stiffness * share / ELEMENTS as f64;
        let outcome = Outcome {
            force: dry * channels.level + damping * motion.velocity,
            slope: stiffness * channels.level * motion.duration + damping,
            damping,
        };
        ParallelElementsTrial { elements, outcome }
    }

    #[inline]
    fn outcome(&self, trial: &ParallelElementsTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &ParallelElementsState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, ParallelElementsTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline]
    fn commit(&self, state: &mut ParallelElementsState<S>, trial: &ParallelElementsTrial<S>) {
        state.take(&trial.elements);
    }

    // Each yield point is a kink of the force at full speed.
    #[inline]
    fn event(
        &self,
        state: &ParallelElementsState<S>,
        trial: &ParallelElementsTrial<S>,
        _motion: &Motion<S>,
    ) -> Option<Event> {
        let begins =
            |(old, new): (&Element<S>, &Element<S>)| new.mode != 0.0 && new.mode != old.mode;
        state.elements.iter().zip(&trial.elements).any(begins).then_some(Event::BreakAway)
    }

    #[inline]
    fn margin(
        &self,
        state: &ParallelElementsState<S>,
        _trial: &ParallelElementsTrial<S>,
        motion: &Motion<S>,
        _event: Event,
    ) -> S {
        let pull = self.pull(motion);
        let elements = state.elements.iter().zip(&self.yields);
        let margins = elements.map(|(element, first)| element.margin(pull, *first));
        margins.reduce(|a, b| if b.re() < a.re() { b } else { a }).unwrap_or(S::constant(0.0))
    }

    fn switch(&self, state: &mut ParallelElementsState<S>, _event: Event) {
        let mut elements = state.elements;
        for (element, first) in elements.iter_mut().zip(&self.yields) {
            element.start(*first);
        }
        state.take(&elements);
    }
}
