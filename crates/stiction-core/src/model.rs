//! A friction law with its parameters and state: what `FrictionModel` is in Python.

use crate::error::{Error, Result, Shown};
use crate::finite;
use crate::friction::{
    AnyState, AnyTrial, Channels, Entry, Law, LawRecord, LawState, Outcome, Statistics, law_record,
};
use crate::integrate::{Held, through_events};
use crate::interrupt;
use crate::parameter::resolve;
use crate::range::{Range, ordinary, sound};
use crate::scalar::{COLUMNS, Dual, Scalar};

/// Samples between two checks that the next reversals find room.
pub const CHUNK: usize = 128;
/// Commits that events may add to a chunk.
const EVENT_ROOM: usize = 32;

/// Which law, with every parameter and option decided.
#[derive(Clone)]
pub struct LawSpec {
    /// Catalogue entry.
    pub record: &'static LawRecord,
    /// Values in the order of the record's parameters.
    pub values: Vec<f64>,
    /// Index of the choice for each of the record's options.
    pub choices: Vec<usize>,
}

impl std::fmt::Debug for LawSpec {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut shown = formatter.debug_struct(self.record.name);
        for (parameter, value) in self.record.parameters.iter().zip(&self.values) {
            shown.field(parameter.name, value);
        }
        for (name, word) in self.options() {
            shown.field(name, &word);
        }
        shown.finish()
    }
}

impl PartialEq for LawSpec {
    fn eq(&self, other: &Self) -> bool {
        self.record.name == other.record.name
            && self.values == other.values
            && self.choices == other.choices
    }
}

impl LawSpec {
    /// The law called `name`; what is not stated takes its default.
    pub fn new(name: &str, stated: &[(String, f64)], options: &[(String, String)]) -> Result<Self> {
        let record = law_record(name)?;
        for (option, word) in options {
            if record.parameters.iter().any(|known| known.name == option) {
                let allowed = "a number".to_owned();
                let given = format!("the word '{word}'");
                return Err(Error::WrongKind {
                    name: format!("{option} of {name}"),
                    given,
                    allowed,
                });
            }
            if !record.options.iter().any(|known| known.name == option) {
                let words = record.parameters.iter().map(|p| p.name);
                let words: Vec<&str> = words.chain(record.options.iter().map(|o| o.name)).collect();
                return Err(Error::unknown(format!("option of {name}"), option, words));
            }
        }
        let choices = record
            .options
            .iter()
            .map(|option| match options.iter().find(|(given, _)| given == option.name) {
                None => Ok(0),
                Some((_, word)) => {
                    option.choices.iter().position(|(known, _)| known == word).ok_or_else(|| {
                        Error::unknown(
                            format!("value of option {} of {name}", option.name),
                            word,
                            option.choices.iter().map(|(known, _)| *known),
                        )
                    })
                }
            })
            .collect::<Result<Vec<usize>>>()?;
        for (number, value) in stated {
            if let Some(option) = record.options.iter().find(|known| known.name == number) {
                let words: Vec<&str> = option.choices.iter().map(|(word, _)| *word).collect();
                return Err(Error::WrongKind {
                    name: format!("{number} of {name}"),
                    given: format!("the number {}", Shown(*value)),
                    allowed: words.join(" or "),
                });
            }
        }
        let values = resolve(name, record.parameters, stated)?;
        Law::<f64>::check(name, &values)?;
        Ok(Self { record, values, choices })
    }

    /// Whether a contact of this law never gives back more than it took, at constant levels.
    pub fn passive(&self) -> bool {
        Law::passive(self.record.name, &self.values).unwrap_or(false)
    }

    /// Start values of a contact in the order of the record; what is not stated is 0.
    pub fn start(&self, stated: &[(String, f64)]) -> Result<Vec<f64>> {
        resolve(&format!("the start of {}", self.record.name), self.record.start, stated)
    }

    /// The law over some number type, from values of that type.
    pub fn law<S: Scalar>(&self, values: &[S]) -> Law<S> {
        Law::build(self.record.name, values, &self.choices)
            .expect("the record's own name is in the list")
    }

    /// The law with plain values.
    pub fn plain(&self) -> Law<f64> {
        self.law(&self.values)
    }

    /// Names and words of the options.
    pub fn options(&self) -> impl Iterator<Item = (&'static str, &'static str)> + '_ {
        self.record
            .options
            .iter()
            .zip(&self.choices)
            .map(|(option, choice)| (option.name, option.choices[*choice].0))
    }
}

/// A friction law, its parameters and its state.
#[derive(Debug, Clone)]
pub struct FrictionModel {
    spec: LawSpec,
    law: Law<f64>,
    state: AnyState<f64>,
    /// What the last `trial` would lead to.
    proposed: Option<Proposed>,
    /// Within what a step needs no watch.
    range: Range,
}

/// A step not yet accepted.
#[derive(Debug, Clone)]
enum Proposed {
    /// Within one contact mode: what would change.
    Step(AnyTrial<f64>),
    /// Through a change of mode: the state after it.
    State(Box<AnyState<f64>>),
}

impl FrictionModel {
    /// A contact that was never moved.
    pub fn new(spec: LawSpec) -> Self {
        let law = spec.plain();
        let state = law.initial();
        let values = spec.values.iter().copied();
        let range = Range::new(ordinary(spec.record.parameters, values), 0.0);
        Self { spec, law, state, proposed: None, range }
    }

    /// Law, parameters and options.
    pub fn spec(&self) -> &LawSpec {
        &self.spec
    }

    /// The law itself.
    pub fn law(&self) -> &Law<f64> {
        &self.law
    }

    /// The present state.
    pub fn state(&self) -> &AnyState<f64> {
        &self.state
    }

    /// One sample at a held velocity; the friction at its end. Where that is no number, the contact
    /// stays as it is.
    #[inline]
    pub fn step(&mut self, velocity: f64, dt: f64, channels: &Channels<f64>) -> Result<f64> {
        if !self.needs_no_watch(velocity, dt, channels) {
            return self.step_watched(velocity, dt, channels);
        }
        self.proposed = None;
        let force = self.go(velocity, dt, channels);
        if force.is_finite() { Ok(force) } else { Err(self.out_of_range()) }
    }

    #[inline(always)]
    fn go(&mut self, velocity: f64, dt: f64, channels: &Channels<f64>) -> f64 {
        with_law_and_state!(&self.law, &mut self.state, |law, state| {
            state.make_room(EVENT_ROOM);
            let mut held = Held::new(velocity, *channels);
            through_events(&mut held, law, state, dt);
            held.outcome.force
        })
    }

    #[cold]
    #[inline(never)]
    fn step_watched(&mut self, velocity: f64, dt: f64, channels: &Channels<f64>) -> Result<f64> {
        let before = self.state.clone();
        let force = self.go(velocity, dt, channels);
        self.keep_or_return(before, force.is_finite())?;
        Ok(force)
    }

    /// Whether a sample cannot lead to anything but numbers.
    #[inline]
    fn needs_no_watch(&self, velocity: f64, dt: f64, channels: &Channels<f64>) -> bool {
        let warmth = channels.temperature.map_or(0.0, f64::abs);
        let efforts = channels.effort.abs() + channels.load.abs();
        self.range.covers(velocity.abs() + warmth + efforts, dt)
    }

    /// Keeps the present state where it is one, and goes back to the one before where it is none.
    fn keep_or_return(&mut self, before: AnyState<f64>, finite: bool) -> Result<()> {
        let entries = |state: &AnyState<f64>| with_state!(state, |state| state.entries());
        if finite && (self.range.holds(0.0) || sound(&entries(&before), &entries(&self.state))) {
            self.proposed = None;
            return Ok(());
        }
        self.state = before;
        Err(self.out_of_range())
    }

    #[cold]
    fn out_of_range(&self) -> Error {
        Error::OutOfRange { law: self.spec.record.name }
    }

    /// Samples at held velocities; the friction at the end of each. Where one of them is no number, the
    /// contact stays as it is.
    ///
    /// `channels` yields what else reaches the contact at a sample.
    pub fn simulate(
        &mut self,
        velocity: &[f64],
        dt: f64,
        channels: impl Fn(usize) -> Channels<f64>,
        friction: &mut [f64],
    ) -> Result<()> {
        let before = self.state.clone();
        with_law_and_state!(&self.law, &mut self.state, |law, state| {
            let chunks = velocity.chunks(CHUNK).zip(friction.chunks_mut(CHUNK));
            for (chunk, (velocity, friction)) in chunks.enumerate() {
                if interrupt::due() {
                    self.state = before;
                    return Err(Error::Interrupted);
                }
                state.make_room(CHUNK + EVENT_ROOM);
                for (k, (v, f)) in velocity.iter().zip(friction).enumerate() {
                    let mut held = Held::new(*v, channels(chunk * CHUNK + k));
                    through_events(&mut held, law, state, dt);
                    *f = held.outcome.force;
                }
            }
        });
        self.keep_or_return(before, finite::check("friction", friction).is_ok())
    }

    /// Friction and ∂friction/∂velocity of a sample, leaving the state as it is.
    pub fn trial(
        &mut self,
        velocity: f64,
        dt: f64,
        channels: &Channels<f64>,
    ) -> Result<(f64, f64)> {
        self.proposed = None;
        let mut held = Held::new(velocity, *channels);
        let quiet = self.law.quiet_step(&self.state, &held, dt);
        let (proposed, force, slope) = if let Some((trial, outcome)) = quiet {
            (Proposed::Step(trial), outcome.force, outcome.slope)
        } else {
            let mut next = self.state.clone();
            with_law_and_state!(&self.law, &mut next, |law, state| {
                through_events(&mut held, law, state, dt);
            });
            let slope = self.slope_through_events(velocity, dt, channels);
            (Proposed::State(Box::new(next)), held.outcome.force, slope)
        };
        if !(force.is_finite() && slope.is_finite()) {
            return Err(self.out_of_range());
        }
        if !self.needs_no_watch(velocity, dt, channels) {
            self.commits(&proposed)?;
        }
        self.proposed = Some(proposed);
        Ok((force, slope))
    }

    /// Refuses a step that leads to a state which is none.
    #[cold]
    fn commits(&self, proposed: &Proposed) -> Result<()> {
        let mut after = self.clone();
        after.accept(proposed.clone());
        after.keep_or_return(self.state.clone(), true)
    }

    fn accept(&mut self, proposed: Proposed) {
        match proposed {
            Proposed::Step(trial) => self.law.commit(&mut self.state, &trial),
            Proposed::State(next) => self.state = *next,
        }
    }

    /// The slope of a step that changes mode, by a dual velocity: rare, so its cost is no matter.
    fn slope_through_events(&self, velocity: f64, dt: f64, channels: &Channels<f64>) -> f64 {
        let values: Vec<Dual> = self.spec.values.iter().map(|v| Dual::constant(*v)).collect();
        let law = self.spec.law(&values);
        let mut state = self.state.lift::<Dual>();
        let lifted = Channels {
            effort: Dual::constant(channels.effort),
            load: Dual::constant(channels.load),
            level: Dual::constant(channels.level),
            viscous_level: Dual::constant(channels.viscous_level),
            temperature: channels.temperature,
        };
        let outcome: Outcome<Dual> = with_law_and_state!(&law, &mut state, |law, state| {
            let mut held = Held::new(Dual::variable(velocity, 0), lifted);
            through_events(&mut held, law, state, Dual::constant(dt));
            held.outcome
        });
        const { assert!(COLUMNS > 0) };
        Scalar::partial(outcome.force, 0)
    }

    /// Accepts the last trial; false when there was none since the state last changed.
    pub fn commit(&mut self) -> bool {
        let proposed = self.proposed.take();
        let any = proposed.is_some();
        if let Some(proposed) = proposed {
            self.accept(proposed);
        }
        any
    }

    /// Back to a contact that was never moved.
    pub fn reset(&mut self) {
        self.proposed = None;
        self.state = self.law.initial();
        self.range.forget();
    }

    /// The state as named entries.
    pub fn entries(&self) -> Vec<(&'static str, Entry)> {
        with_state!(&self.state, |state| state.entries())
    }

    /// Sets the state from named entries.
    pub fn restore(&mut self, entries: &[(String, Entry)]) -> Result<()> {
        self.state = self.law.restore(entries)?;
        self.proposed = None;
        self.range.forget();
        self.range.meet(entries.iter().map(|(_, entry)| entry));
        Ok(())
    }

    /// Branch counters.
    pub fn statistics(&self) -> Statistics {
        with_state!(&self.state, |state| state.statistics())
    }

    /// Greatest ∂force/∂position.
    pub fn greatest_stiffness(&self) -> f64 {
        use crate::friction::FrictionLaw;
        with_law!(&self.law, |law| law.greatest_stiffness())
    }
}
