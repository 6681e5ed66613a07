//! Dry friction with true stick, viscous friction and, as an option, a Stribeck fall.

mod abreast;
mod plain;

use super::elements::abreast::SideBySide;
use super::elements::rigid::{Rigid, held};
use super::elements::stribeck::{check_levels, fall, steepest};
use super::{
    Channels, Entry, EntryReader, Event, FrictionLaw, LawState, Motion, Outcome, PlainSteps,
    Statistics,
};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`Coulomb`].
    pub struct CoulombParameters {
        coulomb: Effort, "friction while sliding fast, F_c",
            default Ratio { of: "breakaway", factor: 0.7, otherwise: 0.35 }, neutral Some(0.0),
            typical 0.35, bounds 0.0, 1e9;
        breakaway: Effort, "greatest effort that a resting contact holds, F_s; equal to coulomb unless stated",
            default Ratio { of: "coulomb", factor: 1.0, otherwise: 0.35 }, neutral None,
            typical 0.5, bounds 0.0, 1e9;
        stribeck_velocity: Velocity, "speed scale of the fall from F_s to F_c, v_s",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-9, 1e6;
        stribeck_exponent: One, "shape of the fall, δ",
            default Value(2.0), neutral None, typical 2.0, bounds 0.3, 5.0;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

/// Friction that holds a resting body rigidly and opposes a sliding one.
///
/// F(v) = sgn(v)·(F_c + (F_s − F_c)·exp(−|v/v_s|^δ)) + F_v·v
///
/// At v = 0 the force is whatever holds the body, at most F_s; beyond that the body slides.
/// Memory: stick or slip. Neutral: F_s = F_c leaves the Stribeck fall out.
/// Source: Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30 (1994), §2; stick as in
/// Karnopp, J. Dyn. Syst. Meas. Control 107 (1985), without his velocity window: the zero of the
/// velocity is located inside the step instead.
#[derive(Debug, Clone)]
pub struct Coulomb<S> {
    parameters: CoulombParameters<S>,
    falls: bool,
}

/// Contact mode of [`Coulomb`].
#[derive(Debug, Clone, Copy)]
pub struct CoulombState<S>(Rigid<S>);

/// A step of [`Coulomb`].
#[derive(Debug, Clone, Copy)]
pub struct CoulombTrial<S> {
    mode: f64,
    outcome: Outcome<S>,
}

impl<S: Scalar> CoulombState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> CoulombState<T> {
        CoulombState(self.0.map(convert))
    }
}

impl<S: Scalar> LawState<S> for CoulombState<S> {
    const OUTPUTS: &'static [&'static str] = &["mode"];

    fn output(&self, _index: usize) -> S {
        S::constant(self.0.mode)
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        self.0.entries()
    }

    fn statistics(&self) -> Statistics {
        self.0.statistics
    }
}

impl<S: Scalar> Coulomb<S> {
    /// Force and its slope by velocity while sliding in direction `mode`.
    #[inline(always)]
    fn sliding(&self, mode: f64, velocity: S, channels: &Channels<S>) -> (S, S) {
        let p = &self.parameters;
        let viscous = p.viscous * channels.viscous_level;
        if !self.falls {
            return (p.coulomb * channels.level * mode + viscous * velocity, viscous);
        }
        let (left, steepness) = fall(velocity, p.stribeck_velocity, p.stribeck_exponent);
        let excess = p.breakaway - p.coulomb;
        let level = (p.coulomb + excess * left) * channels.level;
        // By velocity, not by speed: the level stands with the sign of the mode.
        let steepness = excess * steepness * channels.level * (mode * sign(velocity.re()));
        (level * mode + viscous * velocity, steepness + viscous)
    }
}

impl<S: Scalar> FrictionLaw<S> for Coulomb<S> {
    type State = CoulombState<S>;
    type Trial = CoulombTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = CoulombParameters::<f64>::SPECS;
    const OPTIONAL: &'static [&'static str] =
        &["breakaway", "stribeck_velocity", "stribeck_exponent"];
    const RIGID: bool = true;
    const SUMMARY: &'static str =
        "dead zone with true stick; viscous friction and a Stribeck fall as options";
    const SOURCE: &'static str =
        "Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30 (1994); stick: Karnopp (1985)";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let parameters = CoulombParameters::from_values(values);
        // A gradient by breakaway is asked for at F_s = F_c as well, hence the second condition.
        let excess = parameters.breakaway - parameters.coulomb;
        let falls = excess.re() != 0.0 || excess.derivative_is_nonzero();
        Self { parameters, falls }
    }

    fn check(values: &[f64]) -> Result<()> {
        let p = CoulombParameters::from_values(values);
        check_levels(p.coulomb, p.breakaway)
    }

    fn initial(&self) -> CoulombState<S> {
        CoulombState(Rigid::at_rest())
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<CoulombState<S>> {
        let mut read = EntryReader::new(entries);
        let state = CoulombState(Rigid::restore(&mut read)?);
        read.finish()?;
        Ok(state)
    }

    fn sliding_force(&self) -> S {
        self.parameters.breakaway
    }

    fn greatest_stiffness(&self) -> f64 {
        0.0
    }

    fn greatest_damping(&self) -> f64 {
        self.parameters.viscous.re()
    }

    fn steepest_fall(&self) -> f64 {
        let p = &self.parameters;
        let excess = p.breakaway.re() - p.coulomb.re();
        steepest(excess, p.stribeck_velocity.re(), p.stribeck_exponent.re())
    }

    #[inline]
    fn force(&self, state: &CoulombState<S>, velocity: S, channels: &Channels<S>) -> S {
        let mode = state.0.mode_at(velocity);
        if mode == 0.0 {
            return state.0.force;
        }
        self.sliding(mode, velocity, channels).0
    }

    #[inline]
    fn advance(
        &self,
        state: &CoulombState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> CoulombTrial<S> {
        self.advance_within(state, motion, channels)
    }

    #[inline(always)]
    fn advance_within(
        &self,
        state: &CoulombState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> CoulombTrial<S> {
        let mode = state.0.mode_over(motion);
        if mode == 0.0 {
            let force = held(channels.effort, self.parameters.breakaway * channels.level);
            // Set-valued at rest; the viscous slope is what a host's Newton step can use.
            let slope = self.parameters.viscous * channels.viscous_level;
            return CoulombTrial { mode, outcome: Outcome { force, slope, damping: slope } };
        }
        let (force, slope) = self.sliding(mode, motion.velocity, channels);
        // A falling flank is left explicit: implicit, it could outweigh the inertia.
        let damping = if slope.re() > 0.0 { slope } else { S::constant(0.0) };
        CoulombTrial { mode, outcome: Outcome { force, slope, damping } }
    }

    #[inline]
    fn outcome(&self, trial: &CoulombTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    #[inline]
    fn commit(&self, state: &mut CoulombState<S>, trial: &CoulombTrial<S>) {
        state.0.accept(trial.mode, trial.outcome.force);
    }

    #[inline(always)]
    fn glides(&self) -> bool {
        true
    }

    #[inline(always)]
    fn glide<G: PlainSteps<S, CoulombState<S>>>(&self, state: &mut CoulombState<S>, glide: &mut G) {
        self.glide_on(state, glide);
    }

    fn abreast<T: SideBySide<S, Self>>(&self, team: T) -> Option<T::Output> {
        abreast::fits(self).then(|| team.with::<abreast::Lanes>())
    }

    #[inline]
    fn holds(&self, state: &mut CoulombState<S>, channels: &Channels<S>) -> bool {
        state.0.holds(channels.effort, self.parameters.breakaway * channels.level)
    }

    #[inline]
    fn pending(&self, state: &CoulombState<S>, velocity: S) -> Option<Event> {
        state.0.turned(velocity).then_some(Event::Reversal)
    }

    #[inline]
    fn event(
        &self,
        state: &CoulombState<S>,
        trial: &CoulombTrial<S>,
        motion: &Motion<S>,
    ) -> Option<Event> {
        state.0.stops_over(trial.mode, motion).then_some(Event::Reversal)
    }

    #[inline]
    fn margin(
        &self,
        _state: &CoulombState<S>,
        trial: &CoulombTrial<S>,
        motion: &Motion<S>,
        _event: Event,
    ) -> S {
        motion.velocity * trial.mode
    }

    fn switch(&self, state: &mut CoulombState<S>, _event: Event) {
        state.0.stick();
    }
}
