//! Parallel elasto-slide elements without number: pre-sliding hysteresis that ends in sliding.

mod plain;

use super::elements::spring::{SpringState, Walk};
use super::elements::yield_curve::YieldCurve;
use super::{
    Channels, Entry, EntryReader, FrictionLaw, LawState, Motion, Outcome, PlainSteps, Rest,
    Statistics,
};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

/// What a plain step on a curve that is not exponential takes, see [`FrictionLaw::glide_cost`].
const OF_ANY_CURVE: u64 = 2;

parameters! {
    /// Parameters of [`MaxwellSlip`].
    pub struct MaxwellSlipParameters {
        coulomb: Effort, "friction once every element slides, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "slope right after a reversal, all elements sticking, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        yield_shape: One, "spread of the yield points: 1/2 even, 0 exponential, below 0 with a long tail, near 1 all at once, κ",
            default Value(0.0), neutral None, typical 0.2, bounds -2.0, 0.9;
        weight_1: One, "weight of the elements that yield first, up to 1/4 of the mean yield displacement",
            default Value(1.0), neutral Some(1.0), typical 1.0, bounds 0.02, 50.0;
        weight_2: One, "weight of those that yield from 1/4 to 1/2 of it; those from 1/2 to 1 weigh 1",
            default Value(1.0), neutral Some(1.0), typical 1.0, bounds 0.02, 50.0;
        weight_4: One, "weight of those that yield from 1 to 2 of it",
            default Value(1.0), neutral Some(1.0), typical 1.0, bounds 0.02, 50.0;
        weight_5: One, "weight of those that yield from 2 to 3 of it",
            default Value(1.0), neutral Some(1.0), typical 1.0, bounds 0.02, 50.0;
        weight_6: One, "weight of those that yield from 3 of it on",
            default Value(1.0), neutral Some(1.0), typical 1.0, bounds 0.02, 50.0;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`MaxwellSlip`] may bring along.
    pub struct MaxwellSlipStart {
        force: Effort, "force of the elements at the start, on the first loading curve; levels off from 98 % of F_c on, below F_c",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
        turned: One, "where the contact turned round before, on the first loading curve, as a share of F_c; 0 where it never did, and forgotten where the force is beyond it",
            default Value(0.0), neutral Some(0.0), typical 0.5, bounds -0.999, 0.999;
        turned_again: One, "where it turned round after that, as a share of F_c; 0 where it did not; forgotten where the force is beyond it, and the first turn where this one is beyond that",
            default Value(0.0), neutral Some(0.0), typical 0.3, bounds -0.999, 0.999;
    }
}

/// Pre-sliding hysteresis with reverse-point memory that goes over into sliding at F_c.
///
/// F = L·σ(x) + F_v·v, σ on [`YieldCurve`] with Masing branches: the limit of a Maxwell-slip model
/// with ever more elements, evaluated in closed form, so that no step of a finite ladder imitates
/// creep or dwell.
///
/// At v = 0 the force stays where it is: no creep, no drift. Memory: reverse points. Passive.
/// The weights spread the yield points as one likes; with all of them 1 the spread is κ's.
/// Source: Iwan, J. Appl. Mech. 33 (1966); Lampaert, Al-Bender, Swevers, Physcon 2003; the
/// one-parameter family of yield distributions is ours.
#[derive(Debug, Clone)]
pub struct MaxwellSlip<S> {
    parameters: MaxwellSlipParameters<S>,
    curve: YieldCurve<S>,
}

/// State of [`MaxwellSlip`]; forces are those at level 1.
#[derive(Debug, Clone)]
pub struct MaxwellSlipState<S> {
    spring: SpringState<S>,
    statistics: Statistics,
}

/// A step of [`MaxwellSlip`].
#[derive(Debug, Clone, Copy)]
pub struct MaxwellSlipTrial<S> {
    walk: Walk<S>,
    outcome: Outcome<S>,
    undamped: S,
}

impl<S: Scalar> MaxwellSlipState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> MaxwellSlipState<T> {
        MaxwellSlipState { spring: self.spring.map(convert), statistics: self.statistics }
    }
}

impl<S: Scalar> LawState<S> for MaxwellSlipState<S> {
    const OUTPUTS: &'static [&'static str] = &["spring", "spring_force"];

    fn output(&self, index: usize) -> S {
        if index == 0 { self.spring.position } else { self.spring.force }
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        let count = |n: u64| Entry::Number(n as f64);
        let mut entries = self.spring.entries();
        entries.extend([
            ("reversals", count(self.statistics.reversals)),
            ("closings", count(self.statistics.closings)),
            ("memory_peak", count(self.statistics.memory_peak)),
        ]);
        entries
    }

    fn statistics(&self) -> Statistics {
        Statistics {
            memory_growths: self.spring.memory.growths(),
            memory_merged: self.spring.memory.merged(),
            ..self.statistics
        }
    }

    fn make_room(&mut self, steps: usize) {
        self.spring.memory.make_room(steps);
    }
}

impl<S: Scalar> MaxwellSlip<S> {
    /// A step in which the spring goes this way.
    #[inline(always)]
    fn moved(
        &self,
        walk: Walk<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> MaxwellSlipTrial<S> {
        let damping = self.parameters.viscous * channels.viscous_level;
        let undamped = walk.end.force * channels.level;
        let force = undamped + damping * motion.velocity;
        let slope = walk.end.slope * channels.level * motion.duration + damping;
        MaxwellSlipTrial { walk, outcome: Outcome { force, slope, damping }, undamped }
    }
}

impl<S: Scalar> FrictionLaw<S> for MaxwellSlip<S> {
    type State = MaxwellSlipState<S>;
    type Trial = MaxwellSlipTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = MaxwellSlipParameters::<f64>::SPECS;
    const START: &'static [ParameterSpec] = MaxwellSlipStart::<f64>::SPECS;
    const REMEMBERS: bool = true;
    const SPRINGS: bool = true;
    const SUMMARY: &'static str =
        "elasto-slide elements in parallel: hysteresis with memory that goes over into sliding";
    const SOURCE: &'static str =
        "Iwan (1966); Lampaert, Al-Bender, Swevers (2003); yield distribution ours";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = MaxwellSlipParameters::from_values(values);
        let weights =
            [p.weight_1, p.weight_2, S::constant(1.0), p.weight_4, p.weight_5, p.weight_6];
        let curve = YieldCurve::new(p.coulomb, p.initial_stiffness, p.yield_shape, weights);
        Self { parameters: p, curve }
    }

    fn initial(&self) -> MaxwellSlipState<S> {
        MaxwellSlipState {
            spring: SpringState::relaxed(&self.curve),
            statistics: Statistics::default(),
        }
    }

    fn primed(&self, values: &[S]) -> MaxwellSlipState<S> {
        let start = MaxwellSlipStart::from_values(values);
        let turns = [start.turned, start.turned_again].map(|share| share * self.parameters.coulomb);
        let force = self.curve.reachable(start.force);
        let mut state = self.initial();
        let inverse = |force| self.curve.virgin_inverse(force);
        state.spring.come_back(&self.curve, inverse, turns, force);
        state
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<MaxwellSlipState<S>> {
        let mut read = EntryReader::new(entries);
        let mut state = self.initial();
        state.spring.restore(&mut read)?;
        state.statistics = Statistics {
            reversals: read.count("reversals")?,
            closings: read.count("closings")?,
            memory_peak: read.count("memory_peak")?,
            ..Statistics::default()
        };
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
    fn force(&self, state: &MaxwellSlipState<S>, velocity: S, channels: &Channels<S>) -> S {
        state.spring.force * channels.level
            + self.parameters.viscous * channels.viscous_level * velocity
    }

    #[inline]
    fn advance(
        &self,
        state: &MaxwellSlipState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> MaxwellSlipTrial<S> {
        self.moved(state.spring.walk(&self.curve, motion.displacement), motion, channels)
    }

    #[inline(always)]
    fn advance_within(
        &self,
        state: &MaxwellSlipState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> MaxwellSlipTrial<S> {
        self.moved(state.spring.walk_within(&self.curve, motion.displacement), motion, channels)
    }

    #[inline(always)]
    fn friction(
        &self,
        state: &MaxwellSlipState<S>,
        _velocity: S,
        channels: &Channels<S>,
    ) -> (S, Option<S>) {
        let damping = self.parameters.viscous * channels.viscous_level;
        (state.spring.force * channels.level, Some(damping))
    }

    #[inline]
    fn outcome(&self, trial: &MaxwellSlipTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    #[inline(always)]
    fn undamped(&self, trial: &MaxwellSlipTrial<S>, _velocity: S) -> S {
        trial.undamped
    }

    #[inline(always)]
    fn glides(&self) -> bool {
        true
    }

    fn glide_cost(&self) -> u64 {
        if self.curve.is_exponential() { 1 } else { OF_ANY_CURVE }
    }

    #[inline(always)]
    fn glide<G: PlainSteps<S, MaxwellSlipState<S>>>(
        &self,
        state: &mut MaxwellSlipState<S>,
        glide: &mut G,
    ) {
        if self.curve.is_exponential() {
            self.glide_on::<G, true>(state, glide);
        } else {
            self.glide_on::<G, false>(state, glide);
        }
    }

    fn springs(&self, _state: &MaxwellSlipState<S>) -> Option<f64> {
        self.curve.is_exponential().then(|| self.parameters.viscous.re())
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &MaxwellSlipState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, MaxwellSlipTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline]
    fn commit(&self, state: &mut MaxwellSlipState<S>, trial: &MaxwellSlipTrial<S>) {
        state.spring.accept(&trial.walk);
        state.spring.count(&trial.walk, &mut state.statistics);
    }
}
