//! A linear spring, then a nonlinear one, then rolling: Futami's two regions.

use super::elements::loading::{Loading, Response, masing};
use super::elements::reachable::reachable;
use super::elements::spring::{SpringState, Walk};
use super::{
    Channels, Entry, EntryReader, FrictionLaw, LawState, Motion, Outcome, Rest, Statistics,
};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`Futami`].
    pub struct FutamiParameters {
        coulomb: Effort, "friction while it rolls, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "stiffness of the linear spring, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        linear_share: One, "share of F_c up to which the spring is linear, λ: x_1 = λ·F_c/k_0",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-6, 0.95;
        curve_exponent: One, "how slowly the nonlinear spring gives way, p: x_2 = x_1 + p·(1 − λ)·F_c/k_0",
            default Value(3.0), neutral None, typical 3.0, bounds 1.2, 2000.0;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`Futami`] may bring along.
    pub struct FutamiStart {
        force: Effort, "force of the spring at the start, on the first loading curve; levels off from 98 % of F_c on, below F_c",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
        turned: One, "where the contact turned round before, on the first loading curve, as a share of F_c; 0 where it never did, and forgotten where the force is beyond it",
            default Value(0.0), neutral Some(0.0), typical 0.5, bounds -0.999, 0.999;
        turned_again: One, "where it turned round after that, as a share of F_c; 0 where it did not; forgotten where the force is beyond it, and the first turn where this one is beyond that",
            default Value(0.0), neutral Some(0.0), typical 0.3, bounds -0.999, 0.999;
    }
}

/// A spring that is linear up to x_1, gives way up to x_2 and rolls beyond.
///
/// V(x) = k_0·x up to x_1;  F_c·(1 − (1 − λ)·(1 − y)^p), y = (x − x_1)/(x_2 − x_1), up to x_2; F_c
///
/// Branches from a reverse point are G(d) = 2·V(d/2) (Masing), with memory and wiping out;
/// F = L·σ + F_v·v. The slope is continuous at x_1 and x_2.
///
/// At v = 0 the force stays where it is: no creep, no damper. Memory: reverse points. Passive.
/// Source: Futami, Furutani, Yoshida, Nanotechnology 1 (1990) 31-37, as told by Hsieh and Pan, Wear
/// 242 (2000): regions and their lengths are theirs; the nonlinear curve, which they do not give,
/// is ours.
#[derive(Debug, Clone)]
pub struct Futami<S> {
    parameters: FutamiParameters<S>,
    curve: RegionCurve<S>,
}

/// First loading through the three regions.
#[derive(Debug, Clone, Copy)]
struct RegionCurve<S> {
    coulomb: S,
    stiffness: S,
    share: S,
    exponent: S,
    /// x_1 and x_2 − x_1.
    linear: S,
    width: S,
}

impl<S: Scalar> RegionCurve<S> {
    fn new(p: &FutamiParameters<S>) -> Self {
        let reach = p.coulomb / p.initial_stiffness;
        Self {
            coulomb: p.coulomb,
            stiffness: p.initial_stiffness,
            share: p.linear_share,
            exponent: p.curve_exponent,
            linear: reach * p.linear_share,
            width: -(reach * (p.linear_share - 1.0) * p.curve_exponent),
        }
    }

    /// Force and slope at x ≥ 0.
    #[inline]
    fn loading(&self, x: S) -> Response<S> {
        if x.re() <= self.linear.re() {
            return Response { force: self.stiffness * x, slope: self.stiffness };
        }
        let left = -((x - self.linear) / self.width - 1.0);
        if left.re() <= 0.0 {
            return Response { force: self.coulomb, slope: S::constant(0.0) };
        }
        let steepness = left.power_of_magnitude(self.exponent - 1.0);
        let missing = -(self.share - 1.0) * steepness * left;
        Response { force: -(self.coulomb * (missing - 1.0)), slope: self.stiffness * steepness }
    }

    /// Where the first loading has a force below F_c.
    fn inverse(&self, force: S) -> S {
        let s = if force.re() < 0.0 { -1.0 } else { 1.0 };
        let share = force * s / self.coulomb;
        if share.re() <= self.share.re() {
            return force / self.stiffness;
        }
        let missing = (share - 1.0) / (self.share - 1.0);
        let left = missing.power_of_magnitude(S::constant(1.0) / self.exponent);
        (self.linear - self.width * (left - 1.0)) * s
    }
}

impl<S: Scalar> Loading<S> for RegionCurve<S> {
    #[inline]
    fn initial_stiffness(&self) -> S {
        self.stiffness
    }

    #[inline]
    fn branch(&self, d: S) -> Response<S> {
        debug_assert!(d.re() >= 0.0, "branch evaluated behind its reverse point: {d:?}");
        let half = self.loading(d * 0.5);
        Response { force: half.force * 2.0, slope: half.slope }
    }

    #[inline]
    fn virgin(&self, x: S) -> Response<S> {
        masing(self, x)
    }

    #[inline]
    fn closes_at_mirror(&self) -> bool {
        true
    }
}

/// State of [`Futami`]; forces are those at level 1.
#[derive(Debug, Clone)]
pub struct FutamiState<S> {
    spring: SpringState<S>,
    statistics: Statistics,
}

/// A step of [`Futami`].
#[derive(Debug, Clone, Copy)]
pub struct FutamiTrial<S> {
    walk: Walk<S>,
    outcome: Outcome<S>,
}

impl<S: Scalar> FutamiState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> FutamiState<T> {
        FutamiState { spring: self.spring.map(convert), statistics: self.statistics }
    }
}

impl<S: Scalar> LawState<S> for FutamiState<S> {
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

impl<S: Scalar> Futami<S> {
    #[inline]
    fn moved(
        &self,
        state: &FutamiState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> FutamiTrial<S> {
        let walk = state.spring.walk(&self.curve, motion.displacement);
        let damping = self.parameters.viscous * channels.viscous_level;
        let force = walk.end.force * channels.level + damping * motion.velocity;
        let slope = walk.end.slope * channels.level * motion.duration + damping;
        FutamiTrial { walk, outcome: Outcome { force, slope, damping } }
    }
}

impl<S: Scalar> FrictionLaw<S> for Futami<S> {
    type State = FutamiState<S>;
    type Trial = FutamiTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = FutamiParameters::<f64>::SPECS;
    const START: &'static [ParameterSpec] = FutamiStart::<f64>::SPECS;
    const REMEMBERS: bool = true;
    const SUMMARY: &'static str =
        "a spring that is linear at first, gives way with hysteresis and rolls at last";
    const SOURCE: &'static str = "Futami, Furutani, Yoshida (1990); the nonlinear curve is ours";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let parameters = FutamiParameters::from_values(values);
        Self { parameters, curve: RegionCurve::new(&parameters) }
    }

    fn initial(&self) -> FutamiState<S> {
        FutamiState { spring: SpringState::relaxed(&self.curve), statistics: Statistics::default() }
    }

    fn primed(&self, values: &[S]) -> FutamiState<S> {
        let (start, greatest) = (FutamiStart::from_values(values), self.parameters.coulomb);
        let turns = [start.turned, start.turned_again].map(|share| share * greatest);
        let force = reachable(start.force, greatest);
        let mut state = self.initial();
        let inverse = |force| self.curve.inverse(force);
        state.spring.come_back(&self.curve, inverse, turns, force);
        state
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<FutamiState<S>> {
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
    fn force(&self, state: &FutamiState<S>, velocity: S, channels: &Channels<S>) -> S {
        state.spring.force * channels.level
            + self.parameters.viscous * channels.viscous_level * velocity
    }

    #[inline]
    fn advance(
        &self,
        state: &FutamiState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> FutamiTrial<S> {
        self.moved(state, motion, channels)
    }

    #[inline]
    fn outcome(&self, trial: &FutamiTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &FutamiState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, FutamiTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline]
    fn commit(&self, state: &mut FutamiState<S>, trial: &FutamiTrial<S>) {
        state.spring.accept(&trial.walk);
        state.spring.count(&trial.walk, &mut state.statistics);
    }
}
