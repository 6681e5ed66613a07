//! Dahl's curve of any exponent, solved in closed form over a displacement.

mod abreast;

use super::elements::abreast::SideBySide;
use super::elements::plain_steps::glide_on;
use super::elements::reachable::reachable;
use super::{
    Channels, Entry, EntryReader, FrictionLaw, LawState, Motion, Outcome, PlainSteps, Rest,
    Statistics,
};
use crate::math::scalar::{Scalar, logarithmic_mean, sign};
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`Dahl`].
    pub struct DahlParameters {
        coulomb: Effort, "force that a long motion approaches, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "slope of the force at zero force, γ",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        exponent: One, "shape of the curve, i: 0 straight up to F_c, 1 exponential, above 1 with a long tail",
            default Value(2.0), neutral None, typical 1.5, bounds 0.0, 5.0;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`Dahl`] may bring along.
    pub struct DahlStart {
        force: Effort, "force at the start; levels off from 98 % of F_c on, below F_c",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
    }
}

/// Friction whose slope falls with the force itself.
///
/// dF_d/dx = γ·|1 − (F_d/F_c)·sgn v|^i·sgn(1 − (F_d/F_c)·sgn v);  F = L·F_d + F_v·v
///
/// With r = 1 − (F_d/F_c)·sgn v and η = γ·|Δx|/F_c that is dr/dη = −|r|^i·sgn r, hence
/// r = r₀·(1 − (1 − i)·η·|r₀|^(i−1))₊^(1/(1−i)) over any displacement in one direction.
///
/// At v = 0 the force stays where it is: no creep, no true stick. A reversed branch does not find
/// its reverse point again: cycles of force drift. Memory: the force F_d. Passive.
/// Source: Dahl, AIAA J. 14 (1976) 1675-1682, by eq. (1) of Hsieh and Pan, Wear 242 (2000).
#[derive(Debug, Clone)]
pub struct Dahl<S>(DahlParameters<S>);

/// Force of [`Dahl`] at level 1, without its viscous part.
#[derive(Debug, Clone, Copy)]
pub struct DahlState<S> {
    dry: S,
    /// Direction of the last motion.
    direction: f64,
    reversals: u64,
}

/// A step of [`Dahl`].
#[derive(Debug, Clone, Copy)]
pub struct DahlTrial<S> {
    after: DahlState<S>,
    outcome: Outcome<S>,
    undamped: S,
}

impl<S: Scalar> DahlState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> DahlState<T> {
        DahlState { dry: convert(self.dry), direction: self.direction, reversals: self.reversals }
    }
}

impl<S: Scalar> LawState<S> for DahlState<S> {
    const OUTPUTS: &'static [&'static str] = &["dry_friction"];

    fn output(&self, _index: usize) -> S {
        self.dry
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        vec![
            ("dry_friction", Entry::Number(self.dry.re())),
            ("direction", Entry::Number(self.direction)),
            ("reversals", Entry::Number(self.reversals as f64)),
        ]
    }

    fn statistics(&self) -> Statistics {
        Statistics { reversals: self.reversals, ..Statistics::default() }
    }
}

/// What is left of r₀ after η: the solution of dr/dη = −|r|^i·sgn r.
#[inline(always)]
fn left_over<S: Scalar>(r: S, exponent: S, eta: S) -> S {
    if r.re() == 0.0 {
        return r;
    }
    let pace = eta * r.power_of_magnitude(exponent - 1.0);
    if exponent.re() == 2.0 && !exponent.derivative_is_nonzero() {
        // The same in a quotient.
        return r / (pace + 1.0);
    }
    any_left_over(r, exponent, pace)
}

/// The same of any exponent, η·|r₀|^(i−1) known.
#[cold]
#[inline(never)]
fn any_left_over<S: Scalar>(r: S, exponent: S, pace: S) -> S {
    let u = pace * (-(exponent - 1.0));
    if u.re() >= 1.0 {
        return S::constant(0.0);
    }
    r * (-(pace * logarithmic_mean(u))).exp()
}

impl<S: Scalar> Dahl<S> {
    /// |r|^i, the slope by displacement as a share of γ.
    #[inline(always)]
    fn share(&self, r: S) -> S {
        if r.re() == 0.0 {
            S::constant(0.0)
        } else {
            r.power_of_magnitude(self.0.exponent) * sign(r.re())
        }
    }
}

impl<S: Scalar> FrictionLaw<S> for Dahl<S> {
    type State = DahlState<S>;
    type Trial = DahlTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = DahlParameters::<f64>::SPECS;
    const START: &'static [ParameterSpec] = DahlStart::<f64>::SPECS;
    const SUMMARY: &'static str =
        "pre-sliding whose slope falls with the force; forgets its reverse points";
    const SOURCE: &'static str = "Dahl, AIAA J. 14 (1976); eq. (1) of Hsieh, Pan, Wear 242 (2000)";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        Self(DahlParameters::from_values(values))
    }

    fn initial(&self) -> DahlState<S> {
        DahlState { dry: S::constant(0.0), direction: 0.0, reversals: 0 }
    }

    fn primed(&self, values: &[S]) -> DahlState<S> {
        let dry = reachable(DahlStart::from_values(values).force, self.0.coulomb);
        DahlState { dry, direction: sign(dry.re()), ..self.initial() }
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<DahlState<S>> {
        let mut read = EntryReader::new(entries);
        let state = DahlState {
            dry: S::constant(read.number("dry_friction", false)?),
            direction: read.choice("direction", &[-1.0, 0.0, 1.0])?,
            reversals: read.count("reversals")?,
        };
        read.finish()?;
        Ok(state)
    }

    fn sliding_force(&self) -> S {
        self.0.coulomb
    }

    fn greatest_stiffness(&self) -> f64 {
        // Right after a reversal at the Coulomb level, where r = 2.
        self.0.initial_stiffness.re() * 2.0_f64.powf(self.0.exponent.re())
    }

    fn greatest_damping(&self) -> f64 {
        self.0.viscous.re()
    }

    #[inline(always)]
    fn force(&self, state: &DahlState<S>, velocity: S, channels: &Channels<S>) -> S {
        state.dry * channels.level + self.0.viscous * channels.viscous_level * velocity
    }

    #[inline(always)]
    fn advance(
        &self,
        state: &DahlState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> DahlTrial<S> {
        let p = &self.0;
        let damping = p.viscous * channels.viscous_level;
        // ±1: a product with it is exact in any order, this one waits least.
        let way = motion.displacement.re();
        let moving = if way == 0.0 { 0.0 } else { 1.0_f64.copysign(way) };
        let per_force = S::constant(1.0) / p.coulomb;
        let share = state.dry * per_force;
        let remaining = |s: f64| -(share * s - 1.0);
        let (dry, share) = if moving == 0.0 {
            // The slope differs to either side: the mean of the two.
            let (up, down) = (remaining(1.0), remaining(-1.0));
            (state.dry, (self.share(up) + self.share(down)) * 0.5)
        } else {
            let eta = p.initial_stiffness * per_force * motion.displacement.abs();
            let r = left_over(remaining(moving), p.exponent, eta);
            (-(r - 1.0) * (p.coulomb * moving), self.share(r))
        };
        let direction = if moving == 0.0 { state.direction } else { moving };
        let turned = u64::from(direction * state.direction < 0.0);
        let slope = p.initial_stiffness * share * channels.level * motion.duration + damping;
        let undamped = dry * channels.level;
        let force = undamped + damping * motion.velocity;
        DahlTrial {
            after: DahlState { dry, direction, reversals: state.reversals + turned },
            outcome: Outcome { force, slope, damping },
            undamped,
        }
    }

    #[inline(always)]
    fn friction(
        &self,
        state: &DahlState<S>,
        _velocity: S,
        channels: &Channels<S>,
    ) -> (S, Option<S>) {
        (state.dry * channels.level, Some(self.0.viscous * channels.viscous_level))
    }

    #[inline(always)]
    fn outcome(&self, trial: &DahlTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    #[inline(always)]
    fn undamped(&self, trial: &DahlTrial<S>, _velocity: S) -> S {
        trial.undamped
    }

    #[inline(always)]
    fn glides(&self) -> bool {
        true
    }

    #[inline(always)]
    fn glide<G: PlainSteps<S, DahlState<S>>>(&self, state: &mut DahlState<S>, glide: &mut G) {
        glide_on(self, state, glide);
    }

    fn abreast<T: SideBySide<S, Self>>(&self, team: T) -> Option<T::Output> {
        abreast::fits(self).then(|| team.with::<abreast::Lanes>())
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &DahlState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, DahlTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline(always)]
    fn commit(&self, state: &mut DahlState<S>, trial: &DahlTrial<S>) {
        *state = trial.after;
    }
}
