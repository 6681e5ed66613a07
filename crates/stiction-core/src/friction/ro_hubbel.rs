//! Micro and macro dynamics about a reference position: Ro and Hubbel's model.

use super::elements::bond::{Bond, BondTrial, DampedBond};
use super::{Channels, Entry, EntryReader, Event, FrictionLaw, Motion, Outcome};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`RoHubbel`].
    pub struct RoHubbelParameters {
        coulomb: Effort, "force of the spring from which on macro dynamics hold, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "stiffness of micro dynamics, K_fr",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        damping: Damping, "damping of micro dynamics, B_fr",
            default Value(0.45), neutral Some(0.0), typical 0.45, bounds 0.0, 1e9;
        viscous: Damping, "friction per speed of both, B",
            default Value(0.05), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

/// A damped spring to a reference position that stays (micro) or moves along (macro dynamics).
///
/// F = B·u' + B_fr·(u' − u_md') + L·K_fr·(u − u_md);  u_md' = 0 (micro) or u' (macro)
///
/// Micro turns into macro dynamics at |u − u_md| = F_c/K_fr, macro into micro where the velocity
/// reaches zero.
///
/// At v = 0 the force stays where it is. Memory: u − u_md and the mode. Passive. Neutral: B_fr = 0.
/// Source: Ro, Hubbel (1993), eqs. (2) to (4) of Hsieh and Pan, Wear 242 (2000); when the modes
/// change is not in that excerpt and ours.
#[derive(Debug, Clone)]
pub struct RoHubbel<S> {
    bond: DampedBond<S>,
    /// Force of the bond at its limit.
    breakaway: S,
}

impl<S: Scalar> FrictionLaw<S> for RoHubbel<S> {
    type State = Bond<S>;
    type Trial = BondTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = RoHubbelParameters::<f64>::SPECS;
    const SUMMARY: &'static str =
        "a damped spring to a reference position that stays or, in macro dynamics, moves along";
    const SOURCE: &'static str = "Ro, Hubbel (1993), as told by Hsieh, Pan (2000)";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = RoHubbelParameters::from_values(values);
        let bond = DampedBond {
            stiffness: p.initial_stiffness,
            limit: p.coulomb / p.initial_stiffness,
            dragged: p.coulomb,
            damping: p.damping,
            viscous: p.viscous,
        };
        Self { bond, breakaway: p.coulomb }
    }

    fn initial(&self) -> Bond<S> {
        Bond::relaxed()
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<Bond<S>> {
        let mut read = EntryReader::new(entries);
        let state = Bond::restore(&mut read)?;
        read.finish()?;
        Ok(state)
    }

    fn sliding_force(&self) -> S {
        self.breakaway
    }

    fn greatest_stiffness(&self) -> f64 {
        self.bond.stiffness.re()
    }

    fn greatest_damping(&self) -> f64 {
        self.bond.damping.re() + self.bond.viscous.re()
    }

    #[inline]
    fn force(&self, state: &Bond<S>, velocity: S, channels: &Channels<S>) -> S {
        self.bond.at(state.mode, state.stretch, velocity, channels).0
    }

    #[inline]
    fn advance(&self, state: &Bond<S>, motion: &Motion<S>, channels: &Channels<S>) -> BondTrial<S> {
        self.bond.advance(state, motion, channels)
    }

    #[inline]
    fn outcome(&self, trial: &BondTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    #[inline]
    fn commit(&self, state: &mut Bond<S>, trial: &BondTrial<S>) {
        state.stretch = trial.stretch;
    }

    #[inline]
    fn pending(&self, state: &Bond<S>, velocity: S) -> Option<Event> {
        state.pending(velocity)
    }

    #[inline]
    fn event(&self, state: &Bond<S>, trial: &BondTrial<S>, motion: &Motion<S>) -> Option<Event> {
        state.event(self.bond.limit, trial.stretch, motion)
    }

    #[inline]
    fn margin(
        &self,
        state: &Bond<S>,
        _trial: &BondTrial<S>,
        motion: &Motion<S>,
        event: Event,
    ) -> S {
        state.margin(self.bond.limit, motion, event)
    }

    fn switch(&self, state: &mut Bond<S>, event: Event) {
        state.switch(self.bond.limit, event);
    }
}
