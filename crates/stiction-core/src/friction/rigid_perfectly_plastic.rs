//! Rigid until the level of sliding, which rises with the way slid.

use super::elements::rigid::{Rigid, held};
use super::elements::slip_hardening::SlipHardening;
use super::{
    Channels, Entry, EntryReader, Event, FrictionLaw, LawState, Motion, Outcome, Statistics,
};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`RigidPerfectlyPlastic`].
    pub struct RigidPerfectlyPlasticParameters {
        coulomb: Effort, "level of sliding, once hardened, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        unhardened_share: One, "share of F_c at which a contact slides that never slid before, h; 1 is without hardening",
            default Value(0.7), neutral Some(1.0), typical 0.6, bounds 0.01, 1.0;
        hardening_distance: Position, "way of sliding, in either direction, over which the level rises to F_c, κ_0",
            default Value(1e-2), neutral None, typical 1e-2, bounds 1e-12, 1e6;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

/// Rigid below the level of sliding, perfectly plastic at it.
///
/// |F_d| ≤ F_y(κ), v ≠ 0 only at |F_d| = F_y and then along F_d, κ' = |v|
///
/// F_y = F_c·(1 − (1 − h)·e^(−κ/κ_0)), F = L·F_d + F_v·v
///
/// At v = 0 the force is whatever holds the body, at most L·F_y(κ). Memory: stick or slip, and κ.
/// Neutral: h = 1 leaves the hardening out, and what remains is `coulomb` with F_s = F_c.
/// Source: Fredriksson, Comput. Struct. 6 (1976) 281-290, without the elastic part; from memory,
/// the exponential of the hardening is ours.
#[derive(Debug, Clone)]
pub struct RigidPerfectlyPlastic<S> {
    parameters: RigidPerfectlyPlasticParameters<S>,
    level: SlipHardening<S>,
}

/// State of [`RigidPerfectlyPlastic`].
#[derive(Debug, Clone, Copy)]
pub struct RigidPerfectlyPlasticState<S> {
    contact: Rigid<S>,
    slid: S,
}

/// A step of [`RigidPerfectlyPlastic`].
#[derive(Debug, Clone, Copy)]
pub struct RigidPerfectlyPlasticTrial<S> {
    mode: f64,
    slid: S,
    outcome: Outcome<S>,
}

impl<S: Scalar> RigidPerfectlyPlasticState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> RigidPerfectlyPlasticState<T> {
        let slid = convert(self.slid);
        RigidPerfectlyPlasticState { contact: self.contact.map(convert), slid }
    }
}

impl<S: Scalar> LawState<S> for RigidPerfectlyPlasticState<S> {
    const OUTPUTS: &'static [&'static str] = &["mode", "hardening"];

    fn output(&self, index: usize) -> S {
        if index == 0 { S::constant(self.contact.mode) } else { self.slid }
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        let mut entries = self.contact.entries();
        entries.push(("hardening", Entry::Number(self.slid.re())));
        entries
    }

    fn statistics(&self) -> Statistics {
        self.contact.statistics
    }
}

impl<S: Scalar> FrictionLaw<S> for RigidPerfectlyPlastic<S> {
    type State = RigidPerfectlyPlasticState<S>;
    type Trial = RigidPerfectlyPlasticTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = RigidPerfectlyPlasticParameters::<f64>::SPECS;
    const RIGID: bool = true;
    const SUMMARY: &'static str =
        "true stick below a level of sliding that hardens with the way slid";
    const SOURCE: &'static str = "Fredriksson (1976) without its elastic part; from memory";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = RigidPerfectlyPlasticParameters::from_values(values);
        let level = SlipHardening::new(p.coulomb, p.unhardened_share, p.hardening_distance);
        Self { parameters: p, level }
    }

    fn initial(&self) -> RigidPerfectlyPlasticState<S> {
        RigidPerfectlyPlasticState { contact: Rigid::at_rest(), slid: S::constant(0.0) }
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<RigidPerfectlyPlasticState<S>> {
        let mut read = EntryReader::new(entries);
        let contact = Rigid::restore(&mut read)?;
        let slid = S::constant(read.at_least_zero("hardening")?);
        read.finish()?;
        Ok(RigidPerfectlyPlasticState { contact, slid })
    }

    fn sliding_force(&self) -> S {
        self.parameters.coulomb
    }

    fn greatest_stiffness(&self) -> f64 {
        // The level rises with the way slid, but nothing springs back: no ring to follow.
        0.0
    }

    fn greatest_damping(&self) -> f64 {
        self.parameters.viscous.re()
    }

    #[inline]
    fn force(
        &self,
        state: &RigidPerfectlyPlasticState<S>,
        velocity: S,
        channels: &Channels<S>,
    ) -> S {
        let mode = state.contact.mode_at(velocity);
        if mode == 0.0 {
            return state.contact.force;
        }
        let (level, _) = self.level.level(state.slid);
        level * channels.level * mode + self.parameters.viscous * channels.viscous_level * velocity
    }

    #[inline]
    fn advance(
        &self,
        state: &RigidPerfectlyPlasticState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> RigidPerfectlyPlasticTrial<S> {
        let mode = state.contact.mode_over(motion);
        let viscous = self.parameters.viscous * channels.viscous_level;
        if mode == 0.0 {
            let (level, _) = self.level.level(state.slid);
            let force = held(channels.effort, level * channels.level);
            // Set-valued at rest; the viscous slope is what a host's Newton step can use.
            let outcome = Outcome { force, slope: viscous, damping: viscous };
            return RigidPerfectlyPlasticTrial { mode, slid: state.slid, outcome };
        }
        let slid = state.slid + motion.displacement.abs();
        let (level, rise) = self.level.level(slid);
        let outcome = Outcome {
            force: level * channels.level * mode + viscous * motion.velocity,
            slope: rise * channels.level * motion.duration + viscous,
            damping: viscous,
        };
        RigidPerfectlyPlasticTrial { mode, slid, outcome }
    }

    #[inline]
    fn outcome(&self, trial: &RigidPerfectlyPlasticTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    #[inline]
    fn commit(
        &self,
        state: &mut RigidPerfectlyPlasticState<S>,
        trial: &RigidPerfectlyPlasticTrial<S>,
    ) {
        state.contact.accept(trial.mode, trial.outcome.force);
        state.slid = trial.slid;
    }

    #[inline]
    fn holds(&self, state: &mut RigidPerfectlyPlasticState<S>, channels: &Channels<S>) -> bool {
        let (level, _) = self.level.level(state.slid);
        state.contact.holds(channels.effort, level * channels.level)
    }

    #[inline]
    fn pending(&self, state: &RigidPerfectlyPlasticState<S>, velocity: S) -> Option<Event> {
        state.contact.turned(velocity).then_some(Event::Reversal)
    }

    #[inline]
    fn event(
        &self,
        state: &RigidPerfectlyPlasticState<S>,
        trial: &RigidPerfectlyPlasticTrial<S>,
        motion: &Motion<S>,
    ) -> Option<Event> {
        state.contact.stops_over(trial.mode, motion).then_some(Event::Reversal)
    }

    #[inline]
    fn margin(
        &self,
        _state: &RigidPerfectlyPlasticState<S>,
        trial: &RigidPerfectlyPlasticTrial<S>,
        motion: &Motion<S>,
        _event: Event,
    ) -> S {
        motion.velocity * trial.mode
    }

    fn switch(&self, state: &mut RigidPerfectlyPlasticState<S>, _event: Event) {
        state.contact.stick();
    }
}
