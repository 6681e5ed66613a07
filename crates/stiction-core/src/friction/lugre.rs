//! The LuGre model: bristles that slip more, the further they are bent.

mod abreast;

use super::elements::abreast::SideBySide;
use super::elements::bristle::{self, Bent, Bristle, BristleState, BristleTrial, Slip};
use super::elements::lag::{follow, follow_within};
use super::elements::stribeck::{SlidingLevel, check_levels};
use super::{Channels, Entry, FrictionLaw, Motion, Outcome, PlainSteps, Rest};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`LuGre`].
    pub struct LuGreParameters {
        coulomb: Effort, "friction while sliding fast, F_c",
            default Ratio { of: "breakaway", factor: 0.7, otherwise: 0.35 }, neutral None,
            typical 0.35, bounds 1e-12, 1e9;
        breakaway: Effort, "friction of very slow sliding, F_s; equal to coulomb where that alone is stated",
            default Ratio { of: "coulomb", factor: 1.0, otherwise: 0.5 }, neutral None,
            typical 0.5, bounds 1e-12, 1e9;
        stribeck_velocity: Velocity, "speed scale of the fall from F_s to F_c, v_s",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-9, 1e6;
        stribeck_exponent: One, "shape of the fall, δ",
            default Value(2.0), neutral None, typical 2.0, bounds 0.3, 5.0;
        initial_stiffness: Stiffness, "stiffness of the bristles, σ_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        damping: Damping, "damping of the bristles, σ_1",
            default Value(1.0), neutral Some(0.0), typical 1.0, bounds 0.0, 1e9;
        damping_velocity: Velocity, "speed at which that damping has fallen to 1/e, v_d; inf: no fall",
            default Value(f64::INFINITY), neutral Some(f64::INFINITY), typical 0.1,
            bounds 1e-9, f64::INFINITY;
        viscous: Damping, "friction per speed, σ_2",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`LuGre`] may bring along.
    pub struct LuGreStart {
        force: Effort, "force of the bristles at the start, σ_0·z; levels off from 98 % of F_s on, below F_s",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
    }
}

/// Friction of bristles: elastic at first, then sliding at a level that falls with speed.
///
/// z' = v − σ₀·|v|·z/g(v);  g(v) = F_c + (F_s − F_c)·exp(−|v/v_s|^δ)
/// F = L·(σ₀·z + σ₁·exp(−(v/v_d)²)·z') + σ₂·v
///
/// At v = 0 the bristles stay as they are: no creep under a held force, no true stick. They slip a
/// little at any force, so that a ripple below F_c drifts. Memory: z. Passive only where
/// [`bristle::passive`] says so. Neutral: v_d = ∞, F_s = F_c.
/// Source: Canudas de Wit, Olsson, Åström, Lischinsky, IEEE Trans. Autom. Control 40 (1995); eqs.
/// (6)-(8) of Hsieh and Pan, Wear 242 (2000). σ₁ that falls with speed: Olsson's thesis (1996).
#[derive(Debug, Clone)]
pub struct LuGre<S>(Bristle<S>);

/// g at a velocity, its slope by speed and its reciprocal.
#[derive(Debug, Clone, Copy)]
struct Level<S> {
    force: S,
    steepness: S,
    reciprocal: S,
}

impl<S: Scalar> LuGre<S> {
    #[inline(always)]
    fn level(&self, velocity: S) -> Level<S> {
        let (force, steepness) = self.0.level.at(velocity);
        Level { force, steepness, reciprocal: S::constant(1.0) / force }
    }

    /// The same as part of the loop that asks for it.
    #[inline(always)]
    fn level_within(&self, velocity: S) -> Level<S> {
        let (force, steepness) = self.0.level.at_within(velocity);
        Level { force, steepness, reciprocal: S::constant(1.0) / force }
    }

    /// t = σ₀·|z|/g(v), signed by the direction of motion.
    #[inline(always)]
    fn slip(force: S, velocity: S, level: &Level<S>) -> Slip<S> {
        let by_force = level.reciprocal;
        let share = force * sign(velocity.re()) * by_force;
        Slip { share, by_force, by_speed: -(share * (level.steepness * by_force)) }
    }

    /// The bristles follow g over the path ∫σ₀·|dx|/g, exactly where the velocity is held; g at the
    /// start and at the end.
    #[inline(always)]
    fn bend(
        &self,
        state: &BristleState<S>,
        motion: &Motion<S>,
        from: &Level<S>,
        to: &Level<S>,
    ) -> Bent<S> {
        let bristle = &self.0;
        let force = bristle.stiffness * state.deflection;
        let s = sign(motion.displacement.re());
        if s == 0.0 {
            let by_velocity = bristle.stiffness * motion.duration;
            return Bent { force, by_velocity, by_end: S::constant(0.0) };
        }
        let path = bristle.stiffness * motion.displacement.abs();
        if motion.start_velocity.re() == motion.velocity.re() {
            return Self::bend_steadily(motion, force, s, path, (to.force, to.steepness));
        }
        let z = path * (from.reciprocal * 0.5 + to.reciprocal * 0.5);
        let followed = follow_within(force * s, from.force, to.force, z);
        let by_end = to.steepness * followed.end_share;
        Bent { force: followed.value * s, by_velocity: by_end, by_end }
    }

    /// The same at a held velocity.
    #[inline(never)]
    fn bend_steadily(
        motion: &Motion<S>,
        force: S,
        s: f64,
        path: S,
        (to, steepness): (S, S),
    ) -> Bent<S> {
        let z = path / to;
        let followed = follow(force * s, to, to, z);
        let apart = (force * s - to) * followed.remainder;
        let speed = motion.velocity.abs();
        let by_speed = steepness * (-(followed.remainder - 1.0)) - apart * z / speed
            + apart * z * steepness / to;
        let by_end = steepness * followed.end_share;
        Bent { force: followed.value * s, by_velocity: by_speed, by_end }
    }
}

impl<S: Scalar> FrictionLaw<S> for LuGre<S> {
    type State = BristleState<S>;
    type Trial = BristleTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = LuGreParameters::<f64>::SPECS;
    const OPTIONAL: &'static [&'static str] =
        &["breakaway", "stribeck_velocity", "stribeck_exponent", "damping_velocity"];
    const START: &'static [ParameterSpec] = LuGreStart::<f64>::SPECS;
    const SUMMARY: &'static str =
        "bristles: pre-sliding, frictional lag, Stribeck fall, break-away that falls with the rate";
    const SOURCE: &'static str =
        "Canudas de Wit, Olsson, Åström, Lischinsky, IEEE Trans. Autom. Control 40 (1995)";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = LuGreParameters::from_values(values);
        let level =
            SlidingLevel::new(p.coulomb, p.breakaway, p.stribeck_velocity, p.stribeck_exponent);
        Self(Bristle {
            stiffness: p.initial_stiffness,
            level,
            damping: p.damping,
            damping_velocity: p.damping_velocity,
            viscous: p.viscous,
        })
    }

    fn check(values: &[f64]) -> Result<()> {
        let p = LuGreParameters::from_values(values);
        check_levels(p.coulomb, p.breakaway)
    }

    fn passive(values: &[f64]) -> bool {
        bristle::passive(&LuGre::build(values, &[]).0)
    }

    fn initial(&self) -> BristleState<S> {
        BristleState::straight()
    }

    fn primed(&self, values: &[S]) -> BristleState<S> {
        self.0.bent_by(LuGreStart::from_values(values).force)
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<BristleState<S>> {
        BristleState::restore(entries)
    }

    fn sliding_force(&self) -> S {
        self.0.level.greatest()
    }

    fn greatest_stiffness(&self) -> f64 {
        // Right after a reversal of steady sliding. Bent by F_s at a level of F_c they are steeper
        // still, but over a distance that shortens as much, which the exponential passes over.
        2.0 * self.0.stiffness.re()
    }

    fn greatest_damping(&self) -> f64 {
        self.0.damping.re() + self.0.viscous.re()
    }

    fn steepest_fall(&self) -> f64 {
        self.0.level.steepest_fall()
    }

    #[inline]
    fn force(&self, state: &BristleState<S>, velocity: S, channels: &Channels<S>) -> S {
        let level = self.level(velocity);
        let slip = Self::slip(self.0.stiffness * state.deflection, velocity, &level);
        self.0.force(state.deflection, &slip, velocity, channels)
    }

    fn advance(
        &self,
        state: &BristleState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> BristleTrial<S> {
        let to = self.level(motion.velocity);
        let held = motion.start_velocity.re() == motion.velocity.re();
        let from = if held { to } else { self.level(motion.start_velocity) };
        let bent = self.bend(state, motion, &from, &to);
        let slip = Self::slip(bent.force, motion.velocity, &to);
        self.0.settled(state, &bent, &slip, motion.velocity, channels)
    }

    #[inline(always)]
    fn outcome(&self, trial: &BristleTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    #[inline(always)]
    fn glides(&self) -> bool {
        true
    }

    #[inline(always)]
    fn glide_cost(&self) -> u64 {
        3
    }

    #[inline(always)]
    fn glide<G: PlainSteps<S, BristleState<S>>>(&self, state: &mut BristleState<S>, glide: &mut G) {
        let (bristle, verlet) = (&self.0, *glide.verlet());
        let duration = glide.verlet().span();
        // g at the end of a step is that at the start of the next.
        let (mut now, mut start_velocity) = (*state, glide.velocity());
        let mut from = self.level_within(start_velocity);
        while let Some(effort) = glide.next() {
            let slip = Self::slip(bristle.stiffness * now.deflection, start_velocity, &from);
            let channels = glide.channels();
            let net = effort - bristle.force(now.deflection, &slip, start_velocity, &channels);
            let displacement = verlet.displacement(start_velocity, net);
            let velocity = verlet.predicted(start_velocity, net);
            let motion = Motion { displacement, duration, start_velocity, velocity };
            let effort_then = glide.there(effort, displacement, || velocity);
            let channels = glide.channels_there();
            let to = self.level_within(velocity);
            let bent = self.bend(&now, &motion, &from, &to);
            let slip = Self::slip(bent.force, velocity, &to);
            let BristleTrial { after, outcome } =
                bristle.settled(&now, &bent, &slip, velocity, &channels);
            let Outcome { force, damping, .. } = outcome;
            let undamped = force - damping * velocity;
            let arrived = verlet.arrive(start_velocity, net + effort_then, damping, undamped);
            now = after;
            let friction = undamped + damping * arrived;
            start_velocity = glide.accept(displacement, arrived, friction, &now);
            from = self.level_within(start_velocity);
        }
        *state = now;
    }

    fn abreast<T: SideBySide<S, Self>>(&self, team: T) -> Option<T::Output> {
        abreast::fits(self).then(|| team.with::<abreast::Lanes>())
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &BristleState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, BristleTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline(always)]
    fn commit(&self, state: &mut BristleState<S>, trial: &BristleTrial<S>) {
        *state = trial.after;
    }
}
