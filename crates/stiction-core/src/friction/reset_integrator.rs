//! A bond that is integrated until it tears: Haessig and Friedland's second model.

use super::elements::bond::{Bond, BondTrial, DampedBond};
use super::elements::stribeck::check_levels;
use super::{Channels, Entry, EntryReader, Event, FrictionLaw, Motion, Outcome};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`ResetIntegrator`].
    pub struct ResetIntegratorParameters {
        coulomb: Effort, "friction while it slips, F_c",
            default Ratio { of: "breakaway", factor: 0.7, otherwise: 0.35 }, neutral None,
            typical 0.35, bounds 1e-12, 1e9;
        breakaway: Effort, "force of the bond when it tears, F_s = (1 + a)·F_c",
            default Ratio { of: "coulomb", factor: 1.0, otherwise: 0.5 }, neutral None,
            typical 0.5, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "stiffness while it sticks, k_0 = (1 + a)·σ_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        damping: Damping, "damping while it sticks, β",
            default Value(0.45), neutral Some(0.0), typical 0.45, bounds 0.0, 1e9;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

/// A bond that stretches, tears at z_0 and is dragged along until the motion turns.
///
/// z' = v while |z| < z_0 or the motion turns, else 0;  F = L·(1 + a(z))·σ_0·z + β·z' + F_v·v
///
/// a(z) = a while it sticks (|z| < z_0), 0 while it slips (|z| = z_0); F_c = σ_0·z_0,
/// F_s = (1 + a)·F_c, k_0 = (1 + a)·σ_0.
///
/// At v = 0 the force stays where it is; a slip that comes to rest sticks, stretched by z_0. Memory: z.
/// Passive. Neutral: β = 0, and F_s = F_c leaves the fall out.
/// Source: Haessig, Friedland, J. Dyn. Syst. Meas. Control 113 (1991) 354-362; from memory.
#[derive(Debug, Clone)]
pub struct ResetIntegrator<S> {
    bond: DampedBond<S>,
    /// Force of the bond at its limit.
    breakaway: S,
}

impl<S: Scalar> FrictionLaw<S> for ResetIntegrator<S> {
    type State = Bond<S>;
    type Trial = BondTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = ResetIntegratorParameters::<f64>::SPECS;
    const SUMMARY: &'static str =
        "a damped spring that tears at its limit and is dragged along until the motion turns";
    const SOURCE: &'static str = "Haessig, Friedland (1991), from memory";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = ResetIntegratorParameters::from_values(values);
        let bond = DampedBond {
            stiffness: p.initial_stiffness,
            limit: p.breakaway / p.initial_stiffness,
            dragged: p.coulomb,
            damping: p.damping,
            viscous: p.viscous,
        };
        Self { bond, breakaway: p.breakaway }
    }

    fn check(values: &[f64]) -> Result<()> {
        let p = ResetIntegratorParameters::from_values(values);
        check_levels(p.coulomb, p.breakaway)
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
