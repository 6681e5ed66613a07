//! Dahl's curve on the reverse-point memory of the spring: loops that close.

use super::maxwell_slip::{MaxwellSlip, MaxwellSlipState, MaxwellSlipTrial};
use super::{Channels, Entry, FrictionLaw, Motion, Outcome, PlainSteps, Rest};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`DahlWithMemory`].
    pub struct DahlWithMemoryParameters {
        coulomb: Effort, "force that a long motion approaches, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "slope at zero force of the loop between -F_c and F_c, γ",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        exponent: One, "shape of the curve, i: 1 exponential, above 1 with a long tail",
            default Value(2.0), neutral None, typical 1.5, bounds 0.1, 5.0;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`DahlWithMemory`] may bring along.
    pub struct DahlWithMemoryStart {
        force: Effort, "force at the start, on the first loading curve; levels off from 98 % of F_c on, below F_c",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
        turned: One, "where the contact turned round before, on the first loading curve, as a share of F_c; 0 where it never did, and forgotten where the force is beyond it",
            default Value(0.0), neutral Some(0.0), typical 0.5, bounds -0.999, 0.999;
        turned_again: One, "where it turned round after that, as a share of F_c; 0 where it did not; forgotten where the force is beyond it, and the first turn where this one is beyond that",
            default Value(0.0), neutral Some(0.0), typical 0.3, bounds -0.999, 0.999;
    }
}

/// Dahl's loop as the branch of a spring that remembers its reverse points.
///
/// branch: σ = F_r + s·G(s·(x − x_r)), G Dahl's own way from −F_c: G = F_c·(2 − r),
/// r = 2·(1 − (1 − i)·2^(i−1)·γ·d/F_c)₊^(1/(1−i));  first loading V(x) = G(2·x)/2;  F = L·σ + F_v·v
///
/// At v = 0 the force stays where it is. Loops close and are forgotten. Memory: reverse points.
/// Passive. Between −F_c and F_c it is [`super::dahl::Dahl`] itself; within, it is not. It is also
/// [`MaxwellSlip`] with κ = 1 − i and k_0 = 2^i·γ, and evaluated as that.
/// Source: a reconstruction: Osborne and Rittenhouse (1974) put "logic and memory" around Dahl's
/// curve, by Hsieh, Pan, Wear 242 (2000), §2.3; what they were is not published.
#[derive(Debug, Clone)]
pub struct DahlWithMemory<S>(MaxwellSlip<S>);

impl<S: Scalar> FrictionLaw<S> for DahlWithMemory<S> {
    type State = MaxwellSlipState<S>;
    type Trial = MaxwellSlipTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = DahlWithMemoryParameters::<f64>::SPECS;
    const START: &'static [ParameterSpec] = DahlWithMemoryStart::<f64>::SPECS;
    const REMEMBERS: bool = true;
    const SUMMARY: &'static str = "Dahl's loop with a memory of reverse points: loops close";
    const SOURCE: &'static str =
        "a reconstruction of Osborne, Rittenhouse (1974) from Hsieh, Pan, Wear 242 (2000), §2.3";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = DahlWithMemoryParameters::from_values(values);
        let steepest = p.initial_stiffness * (p.exponent * std::f64::consts::LN_2).exp();
        let (shape, even) = (-(p.exponent - 1.0), S::constant(1.0));
        let values = [p.coulomb, steepest, shape, even, even, even, even, even, p.viscous];
        Self(MaxwellSlip::build(&values, &[]))
    }

    fn initial(&self) -> MaxwellSlipState<S> {
        self.0.initial()
    }

    fn primed(&self, values: &[S]) -> MaxwellSlipState<S> {
        self.0.primed(values)
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<MaxwellSlipState<S>> {
        self.0.restore(entries)
    }

    fn sliding_force(&self) -> S {
        self.0.sliding_force()
    }

    fn greatest_stiffness(&self) -> f64 {
        self.0.greatest_stiffness()
    }

    fn greatest_damping(&self) -> f64 {
        self.0.greatest_damping()
    }

    #[inline]
    fn force(&self, state: &MaxwellSlipState<S>, velocity: S, channels: &Channels<S>) -> S {
        self.0.force(state, velocity, channels)
    }

    #[inline]
    fn advance(
        &self,
        state: &MaxwellSlipState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> MaxwellSlipTrial<S> {
        self.0.advance(state, motion, channels)
    }

    #[inline(always)]
    fn friction(
        &self,
        state: &MaxwellSlipState<S>,
        velocity: S,
        channels: &Channels<S>,
    ) -> (S, Option<S>) {
        self.0.friction(state, velocity, channels)
    }

    #[inline]
    fn outcome(&self, trial: &MaxwellSlipTrial<S>) -> Outcome<S> {
        self.0.outcome(trial)
    }

    #[inline(always)]
    fn undamped(&self, trial: &MaxwellSlipTrial<S>, velocity: S) -> S {
        self.0.undamped(trial, velocity)
    }

    #[inline(always)]
    fn glides(&self) -> bool {
        self.0.glides()
    }

    #[inline(always)]
    fn glide_cost(&self) -> u64 {
        3
    }

    #[inline(always)]
    fn glide<G: PlainSteps<S, MaxwellSlipState<S>>>(
        &self,
        state: &mut MaxwellSlipState<S>,
        glide: &mut G,
    ) {
        self.0.glide(state, glide);
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
        self.0.commit(state, trial);
    }
}
