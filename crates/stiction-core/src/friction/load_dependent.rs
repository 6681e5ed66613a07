//! Friction of servo gears: it grows with the effort of the motor and with the load.

use super::elements::rigid::{Rigid, held};
use super::elements::stribeck::{check_levels, fall, steepest};
use super::{
    Channels, Entry, EntryReader, Event, FrictionLaw, LawState, Motion, Outcome, Statistics,
};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`LoadDependent`].
    pub struct LoadDependentParameters {
        coulomb: Effort, "friction while sliding fast without load, F_c",
            default Ratio { of: "breakaway", factor: 0.7, otherwise: 0.35 }, neutral Some(0.0),
            typical 0.35, bounds 0.0, 1e9;
        breakaway: Effort, "greatest friction at rest without load, F_s",
            default Ratio { of: "coulomb", factor: 1.0, otherwise: 0.5 }, neutral None,
            typical 0.5, bounds 0.0, 1e9;
        drive: One, "dry friction per effort of the motor, K_m",
            default Value(0.1), neutral Some(0.0), typical 0.1, bounds 0.0, 10.0;
        back_drive: One, "dry friction per load, K_e; equal to drive unless stated",
            default Ratio { of: "drive", factor: 1.0, otherwise: 0.1 }, neutral Some(0.0),
            typical 0.15, bounds 0.0, 10.0;
        drive_stribeck: One, "further dry friction per effort of the motor at rest, K_ms",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 10.0;
        back_drive_stribeck: One, "further dry friction per load at rest, K_es; equal to drive_stribeck unless stated",
            default Ratio { of: "drive_stribeck", factor: 1.0, otherwise: 0.0 }, neutral Some(0.0),
            typical 0.1, bounds 0.0, 10.0;
        drive_quadratic: PerEffort, "further dry friction at rest per squared load, while the motor drives, K_d",
            default Value(0.0), neutral Some(0.0), typical 0.01, bounds 0.0, 1e9;
        back_drive_quadratic: PerEffort, "further dry friction at rest per squared effort of the motor, while the load drives, K_b",
            default Value(0.0), neutral Some(0.0), typical 0.01, bounds 0.0, 1e9;
        stribeck_velocity: Velocity, "speed scale of the fall from rest to sliding fast, v_s",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-9, 1e6;
        stribeck_exponent: One, "shape of the fall, δ",
            default Value(2.0), neutral None, typical 2.0, bounds 0.3, 5.0;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

/// Friction of a gear that is loaded from both sides, by its motor and by what it moves.
///
/// F(v) = L·(A + B·exp(−|v/v_s|^δ))·sgn v + F_v·v
///
/// A = F_c + |K_m·m − K_e·q|,  B = F_s − F_c + |K_ms·m − K_es·q| + Q
///
/// Q = K_d·q² where the motor drives (m·q < 0, |q| ≤ |m|), K_b·m² where the load does
/// (m·q < 0, |m| < |q|), else 0. q is the load with gravity, m all other effort.
///
/// At v = 0 the force is whatever holds the body, at most L·(A + B); beyond that the body slides.
/// Memory: stick or slip. Neutral: every K 0 leaves `coulomb`; F_s = F_c leaves the fall out.
/// Source: Duclusaud, Passault, Padois, Ly, Extended Friction Models for the Physics Simulation of
/// Servo Actuators (2025), models M1 to M6, and their published code; stick is ours.
#[derive(Debug, Clone)]
pub struct LoadDependent<S> {
    parameters: LoadDependentParameters<S>,
    /// Whether there is anything that falls with speed.
    falls: bool,
}

/// Contact mode of [`LoadDependent`].
#[derive(Debug, Clone, Copy)]
pub struct LoadDependentState<S>(Rigid<S>);

/// A step of [`LoadDependent`].
#[derive(Debug, Clone, Copy)]
pub struct LoadDependentTrial<S> {
    mode: f64,
    outcome: Outcome<S>,
}

impl<S: Scalar> LoadDependentState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> LoadDependentState<T> {
        LoadDependentState(self.0.map(convert))
    }
}

impl<S: Scalar> LawState<S> for LoadDependentState<S> {
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

/// What the efforts on a gear make of its dry friction.
struct Budget<S> {
    /// Friction while sliding fast, A.
    sliding: S,
    /// What is added at rest, B.
    excess: S,
}

impl<S: Scalar> LoadDependent<S> {
    #[inline]
    fn budget(&self, channels: &Channels<S>) -> Budget<S> {
        let p = &self.parameters;
        let load = channels.load;
        let motor = channels.effort - load;
        let sliding = p.coulomb + (p.drive * motor - p.back_drive * load).abs();
        if !self.falls {
            return Budget { sliding, excess: S::constant(0.0) };
        }
        let loaded = (p.drive_stribeck * motor - p.back_drive_stribeck * load).abs();
        let mut excess = p.breakaway - p.coulomb + loaded;
        if motor.re() * load.re() < 0.0 {
            excess += if load.re().abs() <= motor.re().abs() {
                p.drive_quadratic * load * load
            } else {
                p.back_drive_quadratic * motor * motor
            };
        }
        Budget { sliding, excess }
    }

    /// Greatest effort that a resting contact holds.
    #[inline]
    fn greatest(&self, channels: &Channels<S>) -> S {
        let budget = self.budget(channels);
        (budget.sliding + budget.excess) * channels.level
    }

    /// Force and its slope by velocity while sliding in direction `mode`.
    #[inline]
    fn sliding(&self, mode: f64, velocity: S, channels: &Channels<S>) -> (S, S) {
        let p = &self.parameters;
        let budget = self.budget(channels);
        let viscous = p.viscous * channels.viscous_level;
        if !self.falls {
            return (budget.sliding * channels.level * mode + viscous * velocity, viscous);
        }
        let (left, steepness) = fall(velocity, p.stribeck_velocity, p.stribeck_exponent);
        let level = (budget.sliding + budget.excess * left) * channels.level;
        // By velocity, not by speed: the level stands with the sign of the mode.
        let steepness = budget.excess * steepness * channels.level * (mode * sign(velocity.re()));
        (level * mode + viscous * velocity, steepness + viscous)
    }
}

impl<S: Scalar> FrictionLaw<S> for LoadDependent<S> {
    type State = LoadDependentState<S>;
    type Trial = LoadDependentTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = LoadDependentParameters::<f64>::SPECS;
    const OPTIONAL: &'static [&'static str] = &[
        "breakaway",
        "back_drive",
        "drive_stribeck",
        "back_drive_stribeck",
        "drive_quadratic",
        "back_drive_quadratic",
        "stribeck_velocity",
        "stribeck_exponent",
    ];
    const RIGID: bool = true;
    const SUMMARY: &'static str =
        "true stick, and friction that grows with the effort of the motor and with the load";
    const SOURCE: &'static str =
        "Duclusaud, Passault, Padois, Ly (2025), models M1 to M6; stick: Karnopp (1985)";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = LoadDependentParameters::from_values(values);
        // A gradient by each of these is asked for where it is 0 as well, hence the second condition.
        let there = |gain: S| gain.re() != 0.0 || gain.derivative_is_nonzero();
        let falls = there(p.breakaway - p.coulomb)
            || there(p.drive_stribeck)
            || there(p.back_drive_stribeck)
            || there(p.drive_quadratic)
            || there(p.back_drive_quadratic);
        Self { parameters: p, falls }
    }

    fn check(values: &[f64]) -> Result<()> {
        let p = LoadDependentParameters::from_values(values);
        check_levels(p.coulomb, p.breakaway)
    }

    fn initial(&self) -> LoadDependentState<S> {
        LoadDependentState(Rigid::at_rest())
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<LoadDependentState<S>> {
        let mut read = EntryReader::new(entries);
        let state = LoadDependentState(Rigid::restore(&mut read)?);
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
        // How large the efforts will be is not known here: as large as what they have to overcome.
        let shares = p.drive_stribeck.re() + p.back_drive_stribeck.re();
        let excess = p.breakaway.re() - p.coulomb.re() + shares * p.breakaway.re();
        steepest(excess, p.stribeck_velocity.re(), p.stribeck_exponent.re())
    }

    #[inline]
    fn force(&self, state: &LoadDependentState<S>, velocity: S, channels: &Channels<S>) -> S {
        let mode = state.0.mode_at(velocity);
        if mode == 0.0 {
            return state.0.force;
        }
        self.sliding(mode, velocity, channels).0
    }

    #[inline]
    fn advance(
        &self,
        state: &LoadDependentState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> LoadDependentTrial<S> {
        let mode = state.0.mode_over(motion);
        if mode == 0.0 {
            let force = held(channels.effort, self.greatest(channels));
            // Set-valued at rest; the viscous slope is what a host's Newton step can use.
            let slope = self.parameters.viscous * channels.viscous_level;
            return LoadDependentTrial { mode, outcome: Outcome { force, slope, damping: slope } };
        }
        let (force, slope) = self.sliding(mode, motion.velocity, channels);
        // A falling flank is left explicit: implicit, it could outweigh the inertia.
        let damping = if slope.re() > 0.0 { slope } else { S::constant(0.0) };
        LoadDependentTrial { mode, outcome: Outcome { force, slope, damping } }
    }

    #[inline]
    fn outcome(&self, trial: &LoadDependentTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    #[inline]
    fn commit(&self, state: &mut LoadDependentState<S>, trial: &LoadDependentTrial<S>) {
        state.0.accept(trial.mode, trial.outcome.force);
    }

    #[inline]
    fn holds(&self, state: &mut LoadDependentState<S>, channels: &Channels<S>) -> bool {
        state.0.holds(channels.effort, self.greatest(channels))
    }

    #[inline]
    fn pending(&self, state: &LoadDependentState<S>, velocity: S) -> Option<Event> {
        state.0.turned(velocity).then_some(Event::Reversal)
    }

    #[inline]
    fn event(
        &self,
        state: &LoadDependentState<S>,
        trial: &LoadDependentTrial<S>,
        motion: &Motion<S>,
    ) -> Option<Event> {
        state.0.stops_over(trial.mode, motion).then_some(Event::Reversal)
    }

    #[inline]
    fn margin(
        &self,
        _state: &LoadDependentState<S>,
        trial: &LoadDependentTrial<S>,
        motion: &Motion<S>,
        _event: Event,
    ) -> S {
        motion.velocity * trial.mode
    }

    fn switch(&self, state: &mut LoadDependentState<S>, _event: Event) {
        state.0.stick();
    }
}
