//! A linear spring behind a slider: the elastic-perfectly plastic contact of structural mechanics.

use super::elements::reachable::reachable;
use super::elements::slip_hardening::SlipHardening;
use super::{
    Channels, Entry, EntryReader, Event, FrictionLaw, LawState, Motion, Outcome, Rest, Statistics,
};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`ElasticPerfectlyPlastic`].
    pub struct ElasticPerfectlyPlasticParameters {
        coulomb: Effort, "level of sliding, once hardened, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "stiffness of the contact below that level, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        unhardened_share: One, "share of F_c at which a contact slides that never slid before, h; 1 is without hardening",
            default Value(1.0), neutral Some(1.0), typical 0.6, bounds 0.01, 1.0;
        hardening_distance: Position, "way of sliding, in either direction, over which the level rises to F_c, κ_0",
            default Value(1e-4), neutral None, typical 1e-4, bounds 1e-12, 1e6;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`ElasticPerfectlyPlastic`] may bring along.
    pub struct ElasticPerfectlyPlasticStart {
        force: Effort, "force of the spring at the start; levels off from 98 % of the level of sliding on, below it",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
    }
}

/// Elastic up to the level of sliding, then perfectly plastic.
///
/// x = x_e + x_p, σ = k_0·x_e, |σ| ≤ F_y(κ), x_p' ≠ 0 only at |σ| = F_y and then along σ, κ' = |x_p'|
///
/// F_y = F_c·(1 − (1 − h)·e^(−κ/κ_0)), F = L·σ + F_v·v
///
/// At v = 0 the force stays where it is. Memory: σ and κ. Passive. Neutral: h = 1 leaves the
/// hardening out. One element of a Maxwell-slip ladder where nothing hardens.
/// Source: Fredriksson, Comput. Struct. 6 (1976) 281-290; Curnier, Int. J. Solids Struct. 20
/// (1984) 637-647; from memory, the exponential of the hardening is ours.
#[derive(Debug, Clone)]
pub struct ElasticPerfectlyPlastic<S> {
    parameters: ElasticPerfectlyPlasticParameters<S>,
    level: SlipHardening<S>,
}

/// State of [`ElasticPerfectlyPlastic`]; forces are those at level 1.
#[derive(Debug, Clone, Copy)]
pub struct ElasticPerfectlyPlasticState<S> {
    force: S,
    slid: S,
    /// ±1 slides in that direction, 0 is elastic; the force does not depend on it.
    mode: f64,
    statistics: Statistics,
}

/// A step of [`ElasticPerfectlyPlastic`].
#[derive(Debug, Clone, Copy)]
pub struct ElasticPerfectlyPlasticTrial<S> {
    force: S,
    slid: S,
    mode: f64,
    outcome: Outcome<S>,
}

impl<S: Scalar> ElasticPerfectlyPlasticState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> ElasticPerfectlyPlasticState<T> {
        let (force, slid) = (convert(self.force), convert(self.slid));
        ElasticPerfectlyPlasticState { force, slid, mode: self.mode, statistics: self.statistics }
    }
}

impl<S: Scalar> LawState<S> for ElasticPerfectlyPlasticState<S> {
    const OUTPUTS: &'static [&'static str] = &["spring_force", "hardening"];

    fn output(&self, index: usize) -> S {
        if index == 0 { self.force } else { self.slid }
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        vec![
            ("spring_force", Entry::Number(self.force.re())),
            ("hardening", Entry::Number(self.slid.re())),
            ("mode", Entry::Number(self.mode)),
            ("breakaways", Entry::Number(self.statistics.breakaways as f64)),
            ("sticks", Entry::Number(self.statistics.sticks as f64)),
        ]
    }

    fn statistics(&self) -> Statistics {
        self.statistics
    }
}

impl<S: Scalar> FrictionLaw<S> for ElasticPerfectlyPlastic<S> {
    type State = ElasticPerfectlyPlasticState<S>;
    type Trial = ElasticPerfectlyPlasticTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = ElasticPerfectlyPlasticParameters::<f64>::SPECS;
    const OPTIONAL: &'static [&'static str] = &["unhardened_share", "hardening_distance"];
    const START: &'static [ParameterSpec] = ElasticPerfectlyPlasticStart::<f64>::SPECS;
    const REMEMBERS: bool = true;
    const SUMMARY: &'static str =
        "a linear spring behind a slider, whose level may harden with the way slid";
    const SOURCE: &'static str = "Fredriksson (1976); Curnier (1984); from memory";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = ElasticPerfectlyPlasticParameters::from_values(values);
        let level = SlipHardening::new(p.coulomb, p.unhardened_share, p.hardening_distance);
        Self { parameters: p, level }
    }

    fn initial(&self) -> ElasticPerfectlyPlasticState<S> {
        let zero = S::constant(0.0);
        let statistics = Statistics::default();
        ElasticPerfectlyPlasticState { force: zero, slid: zero, mode: 0.0, statistics }
    }

    fn primed(&self, values: &[S]) -> ElasticPerfectlyPlasticState<S> {
        let start = ElasticPerfectlyPlasticStart::from_values(values);
        let state = self.initial();
        ElasticPerfectlyPlasticState {
            force: reachable(start.force, self.level.level(state.slid).0),
            ..state
        }
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<ElasticPerfectlyPlasticState<S>> {
        let mut read = EntryReader::new(entries);
        let state = ElasticPerfectlyPlasticState {
            force: S::constant(read.number("spring_force", false)?),
            slid: S::constant(read.at_least_zero("hardening")?),
            mode: read.choice("mode", &[-1.0, 0.0, 1.0])?,
            statistics: Statistics {
                breakaways: read.count("breakaways")?,
                sticks: read.count("sticks")?,
                ..Statistics::default()
            },
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
    fn force(
        &self,
        state: &ElasticPerfectlyPlasticState<S>,
        velocity: S,
        channels: &Channels<S>,
    ) -> S {
        state.force * channels.level + self.parameters.viscous * channels.viscous_level * velocity
    }

    #[inline]
    fn advance(
        &self,
        state: &ElasticPerfectlyPlasticState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> ElasticPerfectlyPlasticTrial<S> {
        let stiffness = self.parameters.initial_stiffness;
        let pull = state.force + stiffness * motion.displacement;
        let (level, _) = self.level.level(state.slid);
        let (force, slid, mode, rise) = if pull.re().abs() <= level.re() {
            // Sliding ends when the spring unloads, not at a rest nor at the round-off of its start.
            let slides = state.mode * motion.displacement.re() >= 0.0;
            (pull, state.slid, if slides { state.mode } else { 0.0 }, stiffness)
        } else {
            let s = sign(pull.re());
            let slid = state.slid + self.level.slip(state.slid, pull * s, stiffness);
            let (level, rise) = self.level.level(slid);
            // Spring and hardening in series.
            (level * s, slid, s, stiffness * rise / (stiffness + rise))
        };
        let damping = self.parameters.viscous * channels.viscous_level;
        let outcome = Outcome {
            force: force * channels.level + damping * motion.velocity,
            slope: rise * channels.level * motion.duration + damping,
            damping,
        };
        ElasticPerfectlyPlasticTrial { force, slid, mode, outcome }
    }

    #[inline]
    fn outcome(&self, trial: &ElasticPerfectlyPlasticTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &ElasticPerfectlyPlasticState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, ElasticPerfectlyPlasticTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline]
    fn commit(
        &self,
        state: &mut ElasticPerfectlyPlasticState<S>,
        trial: &ElasticPerfectlyPlasticTrial<S>,
    ) {
        if trial.mode != state.mode {
            state.statistics.sticks += u64::from(state.mode != 0.0);
            state.statistics.breakaways += u64::from(trial.mode != 0.0);
        }
        (state.force, state.slid, state.mode) = (trial.force, trial.slid, trial.mode);
    }

    // The force has a kink where sliding begins, at full speed: located, or gradients would miss
    // that its place depends on the parameters.
    #[inline]
    fn event(
        &self,
        state: &ElasticPerfectlyPlasticState<S>,
        trial: &ElasticPerfectlyPlasticTrial<S>,
        _motion: &Motion<S>,
    ) -> Option<Event> {
        (trial.mode != 0.0 && trial.mode != state.mode).then_some(Event::BreakAway)
    }

    #[inline]
    fn margin(
        &self,
        state: &ElasticPerfectlyPlasticState<S>,
        _trial: &ElasticPerfectlyPlasticTrial<S>,
        motion: &Motion<S>,
        _event: Event,
    ) -> S {
        let pull = state.force + self.parameters.initial_stiffness * motion.displacement;
        let (level, _) = self.level.level(state.slid);
        // What slides one way breaks away the other.
        let against = if state.mode == 0.0 { pull.abs() } else { -(pull * state.mode) };
        level - against
    }

    fn switch(&self, state: &mut ElasticPerfectlyPlasticState<S>, _event: Event) {
        state.statistics.sticks += u64::from(state.mode != 0.0);
        state.statistics.breakaways += 1;
        state.mode = sign(state.force.re());
    }
}
