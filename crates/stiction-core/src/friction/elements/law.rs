//! The trait that every friction law fulfils.

use super::abreast::SideBySide;
use super::contact::{Arrival, Channels, Event, Motion, Outcome, Push, Rest, Statistics};
use super::entry::Entry;
use super::plain_steps::PlainSteps;
use crate::math::scalar::Scalar;
use crate::support::error::Result;
use crate::support::parameter::{OptionSpec, ParameterSpec};

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
    /// Whether friction falls with speed in some modes of the contact alone, which [`FrictionLaw::falls`]
    /// tells: in the others a sample is not divided for the fall.
    const FALLS_AT_TIMES: bool = false;
    /// Whether friction may fall with speed in the present mode.
    #[inline(always)]
    fn falls(&self, _state: &Self::State) -> bool {
        true
    }
    /// Fastest rate at which internal variables decay at this state: an explicit step of the reference
    /// integrator that is longer runs away.
    fn decay_rate(&self, _state: &Self::State) -> f64 {
        0.0
    }
    /// Fastest rate of the internal variables at this state, events counted (reference integrator).
    fn fastest_rate(&self, state: &Self::State) -> f64 {
        self.decay_rate(state)
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
    /// The same as part of the loop that asks for it.
    #[inline(always)]
    fn advance_within(
        &self,
        state: &Self::State,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> Self::Trial {
        self.advance(state, motion, channels)
    }
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
    /// What a step of [`FrictionLaw::glide`] takes, in steps in a row of a law with one exponential
    /// ([`crate::support::work`]).
    #[inline(always)]
    fn glide_cost(&self) -> u64 {
        1
    }
    /// Goes on through plain steps of a bare body for as long as there are any: steps in which
    /// nothing turns round and no mode changes, at level 1. The same to the bit as `advance` and
    /// `commit` step by step, in a loop that the law keeps short.
    #[inline]
    fn glide<G: PlainSteps<S, Self::State>>(&self, _state: &mut Self::State, _glide: &mut G) {}
    /// The damping beside a spring where that is all that [`FrictionLaw::glide`] goes through from
    /// this state: long runs then take its steps longer.
    fn springs(&self, _state: &Self::State) -> Option<f64> {
        None
    }
    /// Tells who takes contacts like this one side by side in which form they run, where they have
    /// one; see [`super::abreast`].
    fn abreast<T: SideBySide<S, Self>>(&self, _team: T) -> Option<T::Output> {
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
