//! Friction laws: the trait they fulfil and the one list of them.
//!
//! A law is one file in this folder plus one line in [`laws!`] below. From that line it appears in
//! simulation, binding, command line, documentation and the generic tests.

pub mod elements;

use crate::error::{Error, Result};
use crate::integrate::{Efforts, Glide, Seen};
use crate::lanes::Abreast;
use crate::parameter::{OptionSpec, ParameterSpec};
use crate::scalar::Scalar;

/// A displacement of the contact over a step.
#[derive(Debug, Clone, Copy)]
pub struct Motion<S> {
    /// Displacement Δx over the step.
    pub displacement: S,
    /// Duration of the step; may be 0, which asks for the present force.
    pub duration: S,
    /// Velocity at the start of the step.
    pub start_velocity: S,
    /// Velocity at the end of the step, where the friction is wanted.
    pub velocity: S,
}

impl<S: Scalar> Motion<S> {
    /// A velocity held over the step.
    #[inline]
    pub fn held(velocity: S, duration: S) -> Self {
        let displacement = velocity * duration;
        Self { displacement, duration, start_velocity: velocity, velocity }
    }
}

/// What reaches the contact besides its motion.
#[derive(Debug, Clone, Copy)]
pub struct Channels<S> {
    /// All other effort on the body, positive along +x: what a stuck contact has to hold.
    pub effort: S,
    /// Load on the contact, gravity with it, positive along +x; 0 is neutral.
    pub load: S,
    /// Multiplier of the friction level; 1 is neutral.
    pub level: S,
    /// Multiplier of viscous friction; 1 is neutral.
    pub viscous_level: S,
    /// Temperature in °C, where known.
    pub temperature: Option<f64>,
}

impl<S: Scalar> Default for Channels<S> {
    fn default() -> Self {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        Self { effort: zero, load: zero, level: one, viscous_level: one, temperature: None }
    }
}

/// Friction at the end of a step.
#[derive(Debug, Clone, Copy)]
pub struct Outcome<S> {
    /// Friction, positive when it resists positive motion.
    pub force: S,
    /// ∂force/∂velocity for a velocity held over the step, at fixed duration.
    pub slope: S,
    /// ∂force/∂(velocity at the end) at fixed displacement, where it calms the motion; 0 where
    /// friction falls with speed.
    pub damping: S,
}

/// What carries a body on through a step.
#[derive(Debug, Clone, Copy)]
pub struct Push<S> {
    /// Velocity at the start.
    pub velocity: S,
    /// Friction at the start.
    pub friction: S,
    /// All other effort, the mean over the step.
    pub effort: S,
    /// Inertia.
    pub inertia: S,
    /// Duration.
    pub span: S,
}

/// Where a step takes a body.
#[derive(Debug, Clone, Copy)]
pub struct Arrival<S> {
    /// Velocity at the end.
    pub velocity: S,
    /// Displacement over the step.
    pub displacement: S,
}

/// What a contact does while its body rests under a held effort.
#[derive(Debug, Clone, Copy)]
pub struct Rest<S, T> {
    /// The whole of it, to be committed as a step.
    pub trial: T,
    /// How far the body creeps.
    pub displacement: S,
    /// Its velocity at the end.
    pub velocity: S,
}

impl<S: Scalar, T> Rest<S, T> {
    /// Nothing moves: the rest of a contact whose force stays where the body does.
    #[inline]
    pub fn still<L: FrictionLaw<S, Trial = T>>(
        law: &L,
        state: &L::State,
        channels: &Channels<S>,
        duration: S,
    ) -> Self {
        let zero = S::constant(0.0);
        let trial = law.advance(state, &Motion::held(zero, duration), channels);
        Self { trial, displacement: zero, velocity: zero }
    }
}

/// A change of contact mode inside a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// The contact reaches its break-away level and starts to slide.
    BreakAway,
    /// The sliding velocity reaches zero.
    Reversal,
    /// The hook would be dragged backwards and sticks while the body still moves.
    HookReturn,
}

/// How often each branch was taken; equal counts mean that two runs took the same branches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Statistics {
    /// The spring turned round.
    pub reversals: u64,
    /// Loops closed and wiped out.
    pub closings: u64,
    /// Break-aways.
    pub breakaways: u64,
    /// Slides that ended in sticking.
    pub sticks: u64,
    /// Most reverse points held at once.
    pub memory_peak: u64,
    /// How often room for reverse points was added, between chunks of samples.
    pub memory_growths: u64,
}

/// One entry of a law's state, as users read and write it.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// A number.
    Number(f64),
    /// Rows of two numbers.
    Pairs(Vec<[f64; 2]>),
}

impl std::fmt::Display for Entry {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(x) => write!(formatter, "{x}"),
            Self::Pairs(rows) => write!(formatter, "an array of shape ({}, 2)", rows.len()),
        }
    }
}

/// State of a law: owned by the caller, changed by `commit` and `switch` alone.
pub trait LawState<S: Scalar>: Clone + std::fmt::Debug + Send + Sync {
    /// Names of the states that a trajectory can show.
    const OUTPUTS: &'static [&'static str];
    /// The state behind name `index` of [`Self::OUTPUTS`].
    fn output(&self, index: usize) -> S;
    /// Everything needed to continue to the bit.
    fn entries(&self) -> Vec<(&'static str, Entry)>;
    /// Branch counters.
    fn statistics(&self) -> Statistics;
    /// Makes room for the next `steps` steps so that none of them allocates.
    fn make_room(&mut self, _steps: usize) {}
}

/// Internal variables that the reference integrator advances itself.
pub const INTERNAL: usize = 3;

/// A friction law.
///
/// `advance` evaluates a step without changing anything, `commit` accepts it. Mode changes are
/// found by the caller (`event`, `margin`), who shortens the step to the event, commits, calls
/// `switch` and goes on with the rest: see [`crate::integrate::through_events`].
pub trait FrictionLaw<S: Scalar>: Clone + std::fmt::Debug + Send + Sync {
    /// What the law remembers.
    type State: LawState<S>;
    /// What a step would change.
    type Trial: Copy + std::fmt::Debug;

    /// Parameters, in the order of [`FrictionLaw::build`]'s values.
    const PARAMETERS: &'static [ParameterSpec];
    /// Parameters that a fit leaves alone unless they are stated: terms beyond the core of the law.
    const OPTIONAL: &'static [&'static str] = &[];
    /// Whether friction rises so steeply from rest that the velocity at the end of a step has to be
    /// solved for together with it ([`FrictionLaw::arrive`]); both integrators then do so, and a
    /// trial holds the whole state after a step.
    const STEEP: bool = false;
    /// What a contact may bring along from before a recording, in the order of
    /// [`FrictionLaw::primed`]'s values; at 0, the neutral value of each, it was never moved.
    const START: &'static [ParameterSpec] = &[];
    /// Whether it remembers where it turned round, so that small loops close.
    const REMEMBERS: bool = false;
    /// Whether a body without viscous friction on it makes much of little: it stops and breaks away
    /// where the phase of a ring says, so that two runs that differ by one part in 10⁹ go apart.
    const SENSITIVE: bool = false;
    /// Whether it holds a body without giving way: then friction jumps inside samples, and along a
    /// motion its mean over each says more than its value at the end.
    const RIGID: bool = false;
    /// Options; the first choice of each is the default.
    const OPTIONS: &'static [OptionSpec] = &[];
    /// One sentence: what the law is.
    const SUMMARY: &'static str;
    /// Where it comes from.
    const SOURCE: &'static str;

    /// The law with these values and these choices (indices into each option's choices).
    fn build(values: &[S], choices: &[usize]) -> Self;
    /// Refuses values that single bounds cannot exclude.
    fn check(_values: &[f64]) -> Result<()> {
        Ok(())
    }
    /// Whether a contact with these values never gives back more than it took, at constant levels.
    fn passive(_values: &[f64]) -> bool {
        true
    }
    /// The state of a contact that was never moved.
    fn initial(&self) -> Self::State;
    /// The state of a contact that brings these values of [`FrictionLaw::START`] along.
    fn primed(&self, _values: &[S]) -> Self::State {
        self.initial()
    }
    /// Rebuilds a state from its entries.
    fn restore(&self, entries: &[(String, Entry)]) -> Result<Self::State>;
    /// Greatest ∂force/∂position at level 1: sets the longest stable step.
    fn greatest_stiffness(&self) -> f64;
    /// Greatest ∂force/∂velocity at fixed displacement that lasts: limits the step as well.
    fn greatest_damping(&self) -> f64;
    /// Force at level 1 beyond which a contact that is loaded slowly slides; infinite where it never does.
    fn sliding_force(&self) -> S;
    /// Steepest fall of friction with speed: limits the step to a few parts.
    fn steepest_fall(&self) -> f64 {
        0.0
    }
    /// Fastest rate of the internal variables at this state (reference integrator).
    fn fastest_rate(&self, _state: &Self::State) -> f64 {
        0.0
    }

    /// Friction at the present state.
    fn force(&self, state: &Self::State, velocity: S, channels: &Channels<S>) -> S;
    /// The same, where a part of it is damping times velocity without that part, and the damping.
    #[inline(always)]
    fn friction(&self, state: &Self::State, velocity: S, channels: &Channels<S>) -> (S, Option<S>) {
        (self.force(state, velocity, channels), None)
    }
    /// Evaluates a step inside the present contact mode.
    fn advance(
        &self,
        state: &Self::State,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> Self::Trial;
    /// Friction, slope and damping of a step.
    fn outcome(&self, trial: &Self::Trial) -> Outcome<S>;
    /// Friction of a step less its damping times the velocity at the end: what does not change with
    /// the velocity that an integrator solves for.
    #[inline]
    fn undamped(&self, trial: &Self::Trial, velocity: S) -> S {
        let outcome = self.outcome(trial);
        outcome.force - outcome.damping * velocity
    }
    /// Whether [`FrictionLaw::springs`] may tell of a damping.
    const SPRINGS: bool = false;
    /// Whether a contact like this one has [`FrictionLaw::glide`].
    #[inline(always)]
    fn glides(&self) -> bool {
        false
    }
    /// Goes on through plain steps of a bare body for as long as there are any: steps in which
    /// nothing turns round and no mode changes, at level 1. The same to the bit as `advance` and
    /// `commit` step by step, in a loop that the law keeps short.
    #[inline]
    fn glide<E: Efforts<S>, V: Seen<S, Self::State>>(
        &self,
        _state: &mut Self::State,
        _glide: &mut Glide<S, E, V>,
    ) {
    }
    /// The damping beside a spring where that is all that [`FrictionLaw::glide`] goes through from
    /// this state: long runs then take its steps longer.
    fn springs(&self, _state: &Self::State) -> Option<f64> {
        None
    }
    /// What takes motors with contacts like this one through their samples side by side; see
    /// [`crate::lanes`].
    fn abreast(&self) -> Option<Abreast<S, Self>> {
        None
    }
    /// Accepts a step.
    fn commit(&self, state: &mut Self::State, trial: &Self::Trial);

    /// Where a step takes a body whose contact ends it in the state of this trial. Asked of a law
    /// alone whose friction is [`FrictionLaw::STEEP`].
    fn arrive(&self, _trial: &Self::Trial, push: &Push<S>, _channels: &Channels<S>) -> Arrival<S> {
        Arrival { velocity: push.velocity, displacement: push.velocity * push.span }
    }

    /// What a contact does over any duration, exactly, while friction balances an effort that is
    /// held: long runs pass a rest in one evaluation of it. A duration of 0 asks for the velocity.
    /// `None` where the law cannot tell, or is about to slide: then it is stepped as ever.
    #[inline]
    fn rest(
        &self,
        _state: &Self::State,
        _channels: &Channels<S>,
        _duration: S,
    ) -> Option<Rest<S, Self::Trial>> {
        None
    }
    /// Whether a contact at velocity 0 holds this effort rigidly. May start a slide instead.
    fn holds(&self, _state: &mut Self::State, _channels: &Channels<S>) -> bool {
        false
    }
    /// The event that is due before any motion at this velocity.
    #[inline]
    fn pending(&self, _state: &Self::State, _velocity: S) -> Option<Event> {
        None
    }
    /// The event that a step with this velocity at its end runs past. A law without contact modes
    /// has none: every step is taken whole.
    #[inline]
    fn event(
        &self,
        _state: &Self::State,
        _trial: &Self::Trial,
        _motion: &Motion<S>,
    ) -> Option<Event> {
        None
    }
    /// Positive before the event, zero at it, negative past it.
    fn margin(
        &self,
        _state: &Self::State,
        _trial: &Self::Trial,
        _motion: &Motion<S>,
        _event: Event,
    ) -> S {
        S::constant(1.0)
    }
    /// Changes mode at an event.
    fn switch(&self, _state: &mut Self::State, _event: Event) {}

    /// Internal variables at the start of a step (reference integrator). A law whose force follows
    /// from the displacement has none, and Runge-Kutta nothing of it to integrate.
    fn internal(&self, _state: &Self::State) -> [S; INTERNAL] {
        [S::constant(0.0); INTERNAL]
    }
    /// Friction and the rates of the internal variables at a stage (reference integrator).
    fn rates(
        &self,
        state: &Self::State,
        motion: &Motion<S>,
        _internal: &[S; INTERNAL],
        channels: &Channels<S>,
    ) -> (S, [S; INTERNAL]) {
        let trial = self.advance(state, motion, channels);
        (self.outcome(&trial).force, [S::constant(0.0); INTERNAL])
    }
    /// The step that ends with these internal variables (reference integrator).
    fn settle(
        &self,
        state: &Self::State,
        motion: &Motion<S>,
        _internal: &[S; INTERNAL],
        channels: &Channels<S>,
    ) -> Self::Trial {
        self.advance(state, motion, channels)
    }
}

/// A law as the catalogue knows it.
#[derive(Debug, Clone, Copy)]
pub struct LawRecord {
    /// Canonical name.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Parameters.
    pub parameters: &'static [ParameterSpec],
    /// Parameters that a fit leaves alone unless they are stated.
    pub optional: &'static [&'static str],
    /// What a contact may bring along from before a recording.
    pub start: &'static [ParameterSpec],
    /// Whether it remembers where it turned round.
    pub remembers: bool,
    /// Whether a body without viscous friction on it makes much of little.
    pub sensitive: bool,
    /// Options.
    pub options: &'static [OptionSpec],
    /// States that a trajectory can show.
    pub outputs: &'static [&'static str],
}

macro_rules! laws {
    ($($module:ident => $law:ident,)*) => {
        $(pub mod $module;)*

        /// Any law of the catalogue.
        #[derive(Debug, Clone)]
        pub enum Law<S: Scalar> {
            $(#[doc = stringify!($module)] $law($module::$law<S>),)*
        }

        /// The state of any law of the catalogue.
        #[derive(Debug, Clone)]
        pub enum AnyState<S: Scalar> {
            $(#[doc = stringify!($module)] $law(<$module::$law<S> as FrictionLaw<S>>::State),)*
        }

        /// A step of any law of the catalogue, evaluated and not yet accepted.
        #[derive(Debug, Clone, Copy)]
        pub enum AnyTrial<S: Scalar> {
            $(#[doc = stringify!($module)] $law(<$module::$law<S> as FrictionLaw<S>>::Trial),)*
        }

        /// Every law, in the order of the list.
        pub const LAWS: &[LawRecord] = &[$(LawRecord {
            name: stringify!($module),
            summary: <$module::$law<f64> as FrictionLaw<f64>>::SUMMARY,
            source: <$module::$law<f64> as FrictionLaw<f64>>::SOURCE,
            parameters: <$module::$law<f64> as FrictionLaw<f64>>::PARAMETERS,
            optional: <$module::$law<f64> as FrictionLaw<f64>>::OPTIONAL,
            start: <$module::$law<f64> as FrictionLaw<f64>>::START,
            remembers: <$module::$law<f64> as FrictionLaw<f64>>::REMEMBERS,
            sensitive: <$module::$law<f64> as FrictionLaw<f64>>::SENSITIVE,
            options: <$module::$law<f64> as FrictionLaw<f64>>::OPTIONS,
            outputs: <<$module::$law<f64> as FrictionLaw<f64>>::State as LawState<f64>>::OUTPUTS,
        },)*];

        impl<S: Scalar> Law<S> {
            /// The law called `name` with these values and choices.
            pub fn build(name: &str, values: &[S], choices: &[usize]) -> Result<Self> {
                match name {
                    $(stringify!($module) => {
                        Ok(Self::$law($module::$law::build(values, choices)))
                    })*
                    _ => Err(unknown_law(name)),
                }
            }

            /// Refuses values that single bounds cannot exclude.
            pub fn check(name: &str, values: &[f64]) -> Result<()> {
                match name {
                    $(stringify!($module) => {
                        <$module::$law<f64> as FrictionLaw<f64>>::check(values)
                    })*
                    _ => Err(unknown_law(name)),
                }
            }
        }

        impl Law<f64> {
            /// Whether a contact with these values never gives back more than it took.
            pub fn passive(name: &str, values: &[f64]) -> Result<bool> {
                match name {
                    $(stringify!($module) => {
                        Ok(<$module::$law<f64> as FrictionLaw<f64>>::passive(values))
                    })*
                    _ => Err(unknown_law(name)),
                }
            }
        }

        impl Law<f64> {
            /// Whether motors with contacts like this one go through their samples side by side.
            pub fn goes_abreast(&self) -> bool {
                match self { $(Self::$law(law) => law.abreast().is_some(),)* }
            }

            /// Takes motors with contacts of one kind that go abreast through their samples.
            pub fn take_abreast(job: &$crate::lanes::Job<'_>, motors: Vec<$crate::lanes::Motor<'_>>) {
                let Some(first) = motors.first() else { return };
                match &first.running.law {
                    $(Self::$law(law) => {
                        let Some(walk) = law.abreast() else { return };
                        let members = motors.into_iter().filter_map(|motor| {
                            let (number, own) = (motor.number, motor.own);
                            let $crate::motor::Running { machine, law, state, run, .. } = motor.running;
                            match (&*law, state) {
                                (Self::$law(law), AnyState::$law(state)) => {
                                    Some($crate::lanes::Member { number, machine, law, state, run, own })
                                }
                                #[allow(unreachable_patterns)] // a catalogue of one law has no other
                                _ => unreachable!("motors of an ensemble have one law"),
                            }
                        });
                        walk(&mut $crate::lanes::Team { members: members.collect(), job });
                    })*
                }
            }
        }

        impl<S: Scalar> AnyState<S> {
            /// The same state over another number type, with no parameter dependence.
            pub fn lift<T: Scalar>(&self) -> AnyState<T> {
                match self {
                    $(Self::$law(state) => AnyState::$law(state.map(|x| T::constant(x.re()))),)*
                }
            }
        }

        /// Runs an expression with the concrete law.
        macro_rules! with_law {
            ($any:expr, |$inner:ident| $body:expr) => {
                match $any { $($crate::friction::Law::$law($inner) => $body,)* }
            };
        }

        /// Runs an expression with the concrete state.
        macro_rules! with_state {
            ($any:expr, |$inner:ident| $body:expr) => {
                match $any { $($crate::friction::AnyState::$law($inner) => $body,)* }
            };
        }

        /// Runs an expression with the concrete law and its state.
        macro_rules! with_law_and_state {
            ($any:expr, $state:expr, |$inner:ident, $held:ident| $body:expr) => {
                match ($any, $state) {
                    $(($crate::friction::Law::$law($inner),
                       $crate::friction::AnyState::$law($held)) => $body,)*
                    #[allow(unreachable_patterns)] // a catalogue of one law has no other
                    _ => unreachable!("a state is only ever made by its own law"),
                }
            };
        }

        impl<S: Scalar> Law<S> {
            /// A step at a held velocity, where no contact mode changes in it.
            pub fn quiet_step(
                &self,
                state: &AnyState<S>,
                held: &$crate::integrate::Held<S>,
                span: S,
            ) -> Option<(AnyTrial<S>, Outcome<S>)> {
                match (self, state) {
                    $((Self::$law(law), AnyState::$law(state)) => {
                        $crate::integrate::quiet(held, law, state, span)
                            .map(|trial| (AnyTrial::$law(trial), law.outcome(&trial)))
                    })*
                    #[allow(unreachable_patterns)] // a catalogue of one law has no other
                    _ => unreachable!("a state is only ever made by its own law"),
                }
            }

            /// Accepts a step of this law.
            pub fn commit(&self, state: &mut AnyState<S>, trial: &AnyTrial<S>) {
                match (self, state, trial) {
                    $((Self::$law(law), AnyState::$law(state), AnyTrial::$law(trial)) => {
                        state.make_room(1);
                        law.commit(state, trial);
                    })*
                    #[allow(unreachable_patterns)] // a catalogue of one law has no other
                    _ => unreachable!("a trial is only ever made by its own law"),
                }
            }

            /// Force at level 1 beyond which a contact that is loaded slowly slides; infinite where it never does.
            pub fn sliding_force(&self) -> S {
                match self { $(Self::$law(law) => law.sliding_force(),)* }
            }

            /// The state of a contact that was never moved.
            pub fn initial(&self) -> AnyState<S> {
                match self { $(Self::$law(law) => AnyState::$law(law.initial()),)* }
            }

            /// The state of a contact that brings these start values along.
            pub fn primed(&self, values: &[S]) -> AnyState<S> {
                match self { $(Self::$law(law) => AnyState::$law(law.primed(values)),)* }
            }

            /// Rebuilds a state from its entries.
            pub fn restore(&self, entries: &[(String, Entry)]) -> Result<AnyState<S>> {
                match self { $(Self::$law(law) => law.restore(entries).map(AnyState::$law),)* }
            }
        }
    };
}

laws! {
    bouc_wen => BoucWen,
    bristle => Bristle,
    coulomb => Coulomb,
    dahl => Dahl,
    dahl_with_memory => DahlWithMemory,
    elastic_perfectly_plastic => ElasticPerfectlyPlastic,
    elasto_plastic => ElastoPlastic,
    futami => Futami,
    gms => Gms,
    hsieh_pan => HsiehPan,
    leuven => Leuven,
    load_dependent => LoadDependent,
    lugre => LuGre,
    maxwell_slip => MaxwellSlip,
    parallel_elements => ParallelElements,
    prandtl_ishlinskii => PrandtlIshlinskii,
    preisach => Preisach,
    rate_and_state => RateAndState,
    reset_integrator => ResetIntegrator,
    rigid_perfectly_plastic => RigidPerfectlyPlastic,
    ro_hubbel => RoHubbel,
}

/// The record of the law called `name`.
pub fn law_record(name: &str) -> Result<&'static LawRecord> {
    LAWS.iter().find(|law| law.name == name).ok_or_else(|| unknown_law(name))
}

fn unknown_law(name: &str) -> Error {
    Error::unknown("law", name, LAWS.iter().map(|law| law.name))
}

/// Takes the entries of a state one by one and complains about missing or surplus ones.
#[derive(Debug)]
pub struct EntryReader<'a> {
    entries: &'a [(String, Entry)],
    used: Vec<bool>,
}

impl<'a> EntryReader<'a> {
    /// Reads from these entries.
    pub fn new(entries: &'a [(String, Entry)]) -> Self {
        Self { entries, used: vec![false; entries.len()] }
    }

    fn take(&mut self, name: &str) -> Result<&'a Entry> {
        let found = self.entries.iter().position(|(n, _)| n == name);
        found.map_or_else(
            || Err(Error::State { name: name.to_owned(), problem: "is missing".to_owned() }),
            |index| {
                self.used[index] = true;
                Ok(&self.entries[index].1)
            },
        )
    }

    /// A finite number (or an infinite one where `infinite` allows it).
    pub fn number(&mut self, name: &str, infinite: bool) -> Result<f64> {
        match self.take(name)? {
            Entry::Number(x) if x.is_finite() || (infinite && !x.is_nan()) => Ok(*x),
            other => Err(Error::State {
                name: name.to_owned(),
                problem: format!("is {other}, not a finite number"),
            }),
        }
    }

    /// A finite number from 0 on.
    pub fn at_least_zero(&mut self, name: &str) -> Result<f64> {
        let x = self.number(name, false)?;
        if x < 0.0 {
            return Err(Error::State {
                name: name.to_owned(),
                problem: format!("is {x}, not a number from 0"),
            });
        }
        Ok(x)
    }

    /// A count.
    pub fn count(&mut self, name: &str) -> Result<u64> {
        let x = self.number(name, false)?;
        // Counters fit the integers that a float holds exactly.
        if x < 0.0 || x.fract() != 0.0 || x > 9.007e15 {
            return Err(Error::State {
                name: name.to_owned(),
                problem: format!("is {x}, not a whole number from 0"),
            });
        }
        Ok(x as u64)
    }

    /// A number out of a few allowed ones.
    pub fn choice(&mut self, name: &str, allowed: &[f64]) -> Result<f64> {
        let x = self.number(name, false)?;
        if !allowed.contains(&x) {
            return Err(Error::State {
                name: name.to_owned(),
                problem: format!("is {x}, allowed are {allowed:?}"),
            });
        }
        Ok(x)
    }

    /// Rows of two finite numbers.
    pub fn pairs(&mut self, name: &str) -> Result<&'a [[f64; 2]]> {
        match self.take(name)? {
            Entry::Pairs(rows) if rows.iter().flatten().all(|x| x.is_finite()) => Ok(rows),
            _ => Err(Error::State {
                name: name.to_owned(),
                problem: "is not an array of shape (n, 2) of finite numbers".to_owned(),
            }),
        }
    }

    /// Refuses entries that nobody asked for.
    pub fn finish(self) -> Result<()> {
        match self.used.iter().position(|used| !used) {
            Some(index) => Err(Error::State {
                name: self.entries[index].0.clone(),
                problem: "is not part of this law's state".to_owned(),
            }),
            None => Ok(()),
        }
    }
}
