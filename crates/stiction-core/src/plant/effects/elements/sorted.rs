//! The effects of a plant, sorted by where they enter.

use stiction_dispatch::Task;

use super::situation::{
    LevelChange, MEMORY, Memory, Passage, Reading, Relaxation, SecondMass, Situation,
};
use crate::friction::{Entry, EntryReader};
use crate::math::scalar::Scalar;
use crate::math::wave::Wave;
use crate::plant::effects::{AnyEffect, Effect, Hook};
use crate::plant::place::Followed;
use crate::support::error::{Error, Result};

/// An effect with what it remembers.
#[derive(Debug, Clone)]
struct Kept<S: Scalar> {
    effect: AnyEffect<S>,
    memory: Memory<S>,
}

/// What an effect adds, as a loop asks for it: what most plants have without a call.
#[derive(Debug, Clone, Copy)]
enum Term<S: Scalar> {
    Even(S),
    Wave(Wave<S>),
    /// Of the effect at this index.
    Other(usize),
}

impl<S: Scalar> Term<S> {
    fn followed(&self) -> Option<Followed> {
        match self {
            Self::Even(value) => Some(Followed::Even(value.re())),
            Self::Wave(wave) => Some(Followed::wave(wave)),
            Self::Other(_) => None,
        }
    }
}

/// The effects of a plant, sorted once by where they enter.
#[derive(Debug, Clone)]
pub struct Effects<S: Scalar> {
    kept: Vec<Kept<S>>,
    /// What they add to the friction level and to the effort; indices of those on the input and the sensor.
    levels: Vec<Term<S>>,
    efforts: Vec<Term<S>>,
    /// Sum of the efforts, where all are the same everywhere and always and nothing else is changed but what
    /// the sensor reads and the input, which neither place nor speed change.
    even_effort: Option<S>,
    inputs: Vec<usize>,
    /// Whether any of those on the input goes by place or speed.
    by_place: bool,
    sensors: Vec<usize>,
    delay: Option<S>,
    slowness: Option<S>,
    lag: Option<S>,
    relaxations: Vec<Relaxation<S>>,
    second_masses: Vec<SecondMass<S>>,
    remembers: bool,
    damps: bool,
    asks_speed: bool,
    changes_in_time: bool,
    /// Levels and effort without any effect: 1, 1 and 0, seeded where derivatives by them are wanted.
    unit: (S, S, S),
}

impl<S: Scalar> Effects<S> {
    /// Name of what effects remember, as an entry of a state.
    pub const ENTRY: &'static str = "effect_memory";

    /// Sorts effects by hook. Delays and lags add up; of limited rates the last one counts.
    pub fn new(effects: impl IntoIterator<Item = AnyEffect<S>>) -> Self {
        let mut sorted = Self {
            kept: Vec::new(),
            levels: Vec::new(),
            efforts: Vec::new(),
            even_effort: Some(S::constant(0.0)),
            inputs: Vec::new(),
            by_place: false,
            sensors: Vec::new(),
            delay: None,
            slowness: None,
            lag: None,
            relaxations: Vec::new(),
            second_masses: Vec::new(),
            remembers: false,
            damps: false,
            asks_speed: false,
            changes_in_time: false,
            unit: (S::constant(1.0), S::constant(1.0), S::constant(0.0)),
        };
        for effect in effects {
            let place = sorted.kept.len();
            for hook in effect.hooks() {
                match hook {
                    Hook::FrictionLevel => {
                        let wave = with_effect!(&effect, |e| e.level_wave());
                        sorted.levels.push(wave.map_or(Term::Other(place), Term::Wave));
                        sorted.asks_speed |= effect.asks_speed();
                        sorted.changes_in_time |= effect.changes_in_time();
                    }
                    Hook::AddedEffort => {
                        let even = with_effect!(&effect, |e| e.even_effort());
                        let wave = with_effect!(&effect, |e| e.effort_wave());
                        let wave = wave.map_or(Term::Other(place), Term::Wave);
                        sorted.even_effort = sum_of_all(sorted.even_effort, even);
                        sorted.efforts.push(even.map_or(wave, Term::Even));
                    }
                    Hook::InputMap => {
                        sorted.inputs.push(place);
                        sorted.by_place |= effect.maps_by_place();
                    }
                    Hook::SensorMap => sorted.sensors.push(place),
                    Hook::InputDelay => {
                        sorted.delay = sum(sorted.delay, with_effect!(&effect, |e| e.delay()));
                    }
                    Hook::InputRate => {
                        sorted.slowness = with_effect!(&effect, |e| e.slowness());
                    }
                    Hook::InputLag => {
                        sorted.lag = sum(sorted.lag, with_effect!(&effect, |e| e.lag()));
                    }
                    Hook::StateRelaxation => {
                        sorted.relaxations.extend(with_effect!(&effect, |e| e.relaxation()));
                    }
                    Hook::SecondMass => {
                        sorted.second_masses.extend(with_effect!(&effect, |e| e.second_mass()));
                    }
                }
            }
            sorted.remembers |= effect.remembers();
            sorted.damps |= with_effect!(&effect, |e| e.damping(1.0)) != 0.0;
            let memory = with_effect!(&effect, |e| e.fresh());
            sorted.kept.push(Kept { effect, memory });
        }
        let of_body = |hook: &Hook| {
            matches!(hook, Hook::FrictionLevel | Hook::StateRelaxation | Hook::SecondMass)
        };
        let mut hooks = sorted.kept.iter().flat_map(|kept| kept.effect.hooks());
        if sorted.remembers || sorted.by_place || hooks.any(of_body) {
            sorted.even_effort = None;
        }
        sorted
    }

    /// Whether any effect changes the friction level.
    #[inline]
    pub fn changes_levels(&self) -> bool {
        !self.levels.is_empty()
    }

    /// Multipliers of friction and of viscous friction: 1 and what effects add, at least 0.
    #[inline]
    pub fn levels(&self, at: &Situation<S>) -> (S, S) {
        self.levels_within(at)
    }

    /// The same as part of whoever asks for it.
    #[inline(always)]
    pub(crate) fn levels_within(&self, at: &Situation<S>) -> (S, S) {
        let (friction, viscous) = self.sums(at);
        (never_driving(friction), never_driving(viscous))
    }

    /// The same wherever they end: proportional to a gain, however far that is.
    #[inline(always)]
    pub(crate) fn sums(&self, at: &Situation<S>) -> (S, S) {
        let (mut friction, mut viscous, _) = self.unit;
        for term in &self.levels {
            match term {
                Term::Even(share) => friction += *share,
                Term::Wave(wave) => friction += wave.at(at.position),
                Term::Other(place) => {
                    let change = self.level_of(*place, at);
                    friction += change.friction;
                    viscous += change.viscous;
                }
            }
        }
        (friction, viscous)
    }

    /// Share that one of them adds to the friction levels.
    #[inline(always)]
    fn level_of(&self, place: usize, at: &Situation<S>) -> LevelChange<S> {
        let kept = &self.kept[place];
        if S::CARRIES { kept.level(at) } else { kept.level_apart(at) }
    }

    /// Seeds the levels of dry and viscous friction and an added effort of 0, to differentiate by
    /// them.
    pub fn seed(&mut self, friction: S, viscous: S, effort: S) {
        self.unit = (friction, viscous, effort);
    }

    /// Whether there is any effect.
    #[inline]
    pub fn any(&self) -> bool {
        !self.kept.is_empty()
    }

    /// Whether any effect remembers what happened before.
    #[inline]
    pub fn remembers(&self) -> bool {
        self.remembers
    }

    /// Takes a sample into all memories.
    #[inline(never)] // once for all laws
    pub fn remember(&mut self, passage: &Passage<S>) {
        if self.remembers {
            S::run(Remembering { kept: &mut self.kept, passage });
        }
    }

    /// Back to a contact that was never moved.
    pub fn forget(&mut self) {
        for Kept { effect, memory } in &mut self.kept {
            *memory = with_effect!(effect, |e| e.fresh());
        }
    }

    /// Takes over what the effects of another plant remember, which depends on no parameter of this
    /// one; effects beyond those of the other start afresh.
    pub fn resume(&mut self, other: &Effects<f64>) {
        for (kept, other) in self.kept.iter_mut().zip(&other.kept) {
            kept.memory = other.memory.map(S::constant);
        }
    }

    /// Takes over what those of another plant remember that stand at these places there, in the order of
    /// these effects.
    pub fn take(&mut self, other: &Effects<f64>, places: &[usize]) {
        for (kept, place) in self.kept.iter_mut().zip(places) {
            kept.memory = other.kept[*place].memory.map(S::constant);
        }
    }

    fn remembering(&self) -> impl Iterator<Item = &Kept<S>> {
        self.kept.iter().filter(|kept| kept.effect.remembers())
    }

    /// Memories as an entry of a state: rows of two numbers, as many for each effect that remembers.
    pub fn entry(&self) -> (&'static str, Entry) {
        let numbers: Vec<f64> =
            self.remembering().flat_map(|kept| kept.memory).map(Scalar::re).collect();
        let (rows, _) = numbers.as_chunks::<2>();
        (Self::ENTRY, Entry::Pairs(rows.to_vec()))
    }

    /// Takes the memories from an entry of a state.
    pub fn restore(&mut self, read: &mut EntryReader<'_>) -> Result<()> {
        let rows = read.pairs(Self::ENTRY)?;
        let (given, wanted) = (rows.len(), self.remembering().count() * MEMORY / 2);
        if given != wanted {
            let problem = format!("has {given} rows where the effects need {wanted}");
            return Err(Error::State { name: Self::ENTRY.to_owned(), problem });
        }
        let mut numbers = rows.as_flattened().iter();
        let remembering = self.kept.iter_mut().filter(|kept| kept.effect.remembers());
        for slot in remembering.flat_map(|kept| &mut kept.memory) {
            *slot = S::constant(numbers.next().copied().unwrap_or(0.0));
        }
        Ok(())
    }

    /// Sum of the added efforts.
    #[inline]
    pub fn effort(&self, at: &Situation<S>) -> S {
        self.effort_within(at)
    }

    /// The same as part of whoever asks for it.
    #[inline(always)]
    pub(crate) fn effort_within(&self, at: &Situation<S>) -> S {
        let (_, _, mut sum) = self.unit;
        for term in &self.efforts {
            sum += match term {
                Term::Even(effort) => *effort,
                Term::Wave(wave) => wave.at(at.position),
                Term::Other(place) => {
                    let kept = &self.kept[*place];
                    if S::CARRIES { kept.effort(at) } else { kept.effort_apart(at) }
                }
            };
        }
        sum
    }

    /// The added efforts in the order of their sum; None for one that goes by more than the place.
    pub(crate) fn followed_efforts(&self) -> impl Iterator<Item = Option<Followed>> {
        self.efforts.iter().map(Term::followed)
    }

    /// The share that the one effect on the input adds to it, where that is a wave.
    pub(crate) fn followed_input(&self) -> Option<Followed> {
        let [place] = self.inputs[..] else { return None };
        let wave = with_effect!(&self.kept[place].effect, |e| e.input_wave());
        wave.as_ref().map(Followed::wave)
    }

    /// What is added to the friction level, likewise.
    pub(crate) fn followed_levels(&self) -> impl Iterator<Item = Option<Followed>> {
        self.levels.iter().map(Term::followed)
    }

    /// Sum of the added efforts, where it is the same everywhere and always and nothing else is changed but
    /// what the sensor reads and the input, which neither place nor speed change.
    #[inline(always)]
    pub fn even_effort(&self) -> Option<S> {
        if self.is_seeded() { None } else { self.even_effort }
    }

    /// Whether any effect adds an effort.
    #[inline]
    pub fn adds_efforts(&self) -> bool {
        !self.efforts.is_empty() || self.unit.2.derivative_is_nonzero()
    }

    /// Whether inputs, efforts and levels are as they are without any effect.
    pub fn lets_pass(&self) -> bool {
        self.inputs.is_empty() && !self.adds_efforts() && !self.changes_levels()
    }

    /// What effects add to a step in a row, in steps of a bare body: of those that are asked where it is, of
    /// memories with their exponentials, and of second masses.
    pub fn cost_in_a_row(&self) -> u64 {
        let asked = self.levels.len() + self.efforts.len() + self.inputs.len();
        let late =
            usize::from(self.delay.is_some() || self.slowness.is_some() || self.lag.is_some());
        let remembering = self.remembering().count();
        (asked + late + 3 * remembering + 4 * self.second_masses.len()) as u64
    }

    /// Whether derivatives are wanted by the levels or by an added effort, see [`Self::seed`].
    pub fn is_seeded(&self) -> bool {
        let (friction, viscous, effort) = self.unit;
        [friction, viscous, effort].iter().any(|seed| seed.derivative_is_nonzero())
    }

    /// Whether any effect changes the input.
    #[inline(always)]
    pub fn maps_inputs(&self) -> bool {
        !self.inputs.is_empty()
    }

    /// Whether any changes it by where the body is or how fast.
    pub fn maps_by_place(&self) -> bool {
        self.by_place
    }

    /// What the input becomes.
    #[inline]
    pub fn input(&self, input: S, at: &Situation<S>) -> S {
        self.input_within(input, at)
    }

    /// The same as part of whoever asks for it.
    #[inline(always)]
    pub(crate) fn input_within(&self, input: S, at: &Situation<S>) -> S {
        self.inputs.iter().fold(input, |input, place| {
            with_effect!(&self.kept[*place].effect, |e| e.input(input, at))
        })
    }

    /// What many inputs become, where neither place nor speed are asked.
    pub fn map_inputs(&self, inputs: &mut [f64]) {
        let resting = Situation::resting();
        for place in &self.inputs {
            with_effect!(&self.kept[*place].effect, |e| for input in &mut *inputs {
                *input = e.input(S::constant(*input), &resting).re();
            });
        }
    }

    /// What the sensor reads.
    #[inline]
    pub fn sensor(&self, position: S) -> S {
        self.sensors.iter().fold(position, |x, place| {
            x + with_effect!(&self.kept[*place].effect, |e| e.sensor(x)).error
        })
    }

    /// Whether the sensor reads anything but the position.
    #[inline]
    pub fn misreads(&self) -> bool {
        !self.sensors.is_empty()
    }

    /// The position at which the sensor reads this.
    pub fn behind(&self, reading: S) -> S {
        self.sensors.iter().rev().fold(reading, |reading, place| {
            with_effect!(&self.kept[*place].effect, |e| behind(reading, |x| e.sensor(x)))
        })
    }

    /// How late the input arrives, where an effect delays it.
    pub fn delay(&self) -> Option<S> {
        self.delay
    }

    /// Time that the input takes for one unit of a change, where an effect limits its rate.
    pub fn slowness(&self) -> Option<S> {
        self.slowness
    }

    /// Time constant with which the effort follows the input, where an effect lets it lag.
    pub fn lag(&self) -> Option<S> {
        self.lag
    }

    /// What gives way in series with the law.
    pub fn relaxations(&self) -> &[Relaxation<S>] {
        &self.relaxations
    }

    /// Second masses behind shafts and gaps.
    pub fn second_masses(&self) -> &[SecondMass<S>] {
        &self.second_masses
    }

    /// Sum of the stiffnesses that effects add to a contact with this friction of slow sliding.
    pub fn stiffness(&self, sliding: f64) -> f64 {
        self.kept.iter().map(|kept| with_effect!(&kept.effect, |e| e.stiffness(sliding))).sum()
    }

    /// Whether any effect damps, or changes what friction there is: then steps may have to be finer than
    /// a contact at level 1 needs them.
    #[inline]
    pub fn strains(&self) -> bool {
        self.damps || self.changes_levels()
    }

    /// Whether any effect damps.
    #[inline]
    pub fn damps(&self) -> bool {
        self.damps
    }

    /// Whether levels go by speed or load, and not by where and when the contact is alone.
    #[inline]
    pub fn asks_speed(&self) -> bool {
        self.asks_speed
    }

    /// Whether levels change while nothing moves, or with the load.
    #[inline]
    pub fn changes_in_time(&self) -> bool {
        self.changes_in_time
    }

    /// Sum of the dampings that effects add at this velocity.
    pub fn damping(&self, velocity: f64) -> f64 {
        self.kept.iter().map(|kept| with_effect!(&kept.effect, |e| e.damping(velocity))).sum()
    }
}

impl<S: Scalar> Kept<S> {
    #[inline(always)]
    fn level(&self, at: &Situation<S>) -> LevelChange<S> {
        with_effect!(&self.effect, |e| e.level(at, &self.memory))
    }

    #[inline(always)]
    fn effort(&self, at: &Situation<S>) -> S {
        with_effect!(&self.effect, |e| e.effort(at, &self.memory))
    }

    /// The same as a call: what all effects need is not compiled into every loop.
    #[inline(never)]
    fn level_apart(&self, at: &Situation<S>) -> LevelChange<S> {
        self.level(at)
    }

    #[inline(never)]
    fn effort_apart(&self, at: &Situation<S>) -> S {
        self.effort(at)
    }
}

/// All memories, as a task: rows of derivatives want the widest vectors.
struct Remembering<'a, S: Scalar> {
    kept: &'a mut [Kept<S>],
    passage: &'a Passage<S>,
}

impl<S: Scalar> Task for Remembering<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for Kept { effect, memory } in self.kept {
            with_effect!(effect, |e| e.remember(memory, self.passage));
        }
    }
}

/// A level at which friction resists, or 0: below it would drive. There nothing depends on it any more.
#[inline(always)]
pub(crate) fn never_driving<S: Scalar>(level: S) -> S {
    if level.re() < 0.0 { S::constant(0.0) } else { level }
}

fn sum_of_all<S: Scalar>(sum: Option<S>, more: Option<S>) -> Option<S> {
    Some(sum? + more?)
}

fn sum<S: Scalar>(one: Option<S>, other: Option<S>) -> Option<S> {
    match (one, other) {
        (Some(one), Some(other)) => Some(one + other),
        (one, other) => one.or(other),
    }
}

/// Newton's iteration for the position behind a reading; the last pass carries the derivatives.
fn behind<S: Scalar>(reading: S, sensor: impl Fn(S) -> Reading<S>) -> S {
    let mut x = S::constant(reading.re());
    for _ in 0..50 {
        let read = sensor(x);
        let next = x - (x + read.error - reading) / (read.slope + 1.0);
        let moved = (next.re() - x.re()).abs();
        x = next;
        if moved <= 4.0 * f64::EPSILON * reading.re().abs() {
            break;
        }
    }
    let read = sensor(S::constant(x.re()));
    S::constant(x.re()) - (read.error + (x.re()) - reading) / (read.slope + 1.0)
}
