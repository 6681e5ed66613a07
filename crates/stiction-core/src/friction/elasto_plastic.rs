//! Bristles with an elastic region: LuGre that does not drift.

use super::elements::approach::approach_bending;
use super::elements::bristle::{self, Bent, Bristle, BristleState, BristleTrial, Slip};
use super::elements::stribeck::{SlidingLevel, check_levels};
use super::{Channels, Entry, FrictionLaw, Motion, Outcome, Rest};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;
use crate::support::work;

/// Share of g by which it is moved for the slope of a held velocity.
const NUDGE: f64 = 1e-6;

parameters! {
    /// Parameters of [`ElastoPlastic`].
    pub struct ElastoPlasticParameters {
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
        elastic_share: One, "share of F_c up to which the bristles are elastic, ρ = σ_0·z_ba/F_c",
            default Value(0.9), neutral None, typical 0.8, bounds 0.0, 0.99;
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
    /// What a contact of [`ElastoPlastic`] may bring along.
    pub struct ElastoPlasticStart {
        force: Effort, "force of the bristles at the start, σ_0·z; levels off from 98 % of F_s on, below F_s",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
    }
}

/// Bristles that are elastic up to a force, and slip the more the nearer they are to sliding.
///
/// z' = v·(1 − α(z, v)·σ₀·z·sgn(v)/g(v));  α = 0 below z_ba and where z opposes v, 1 from
/// z_ss = g(v)/σ₀ on, between them α = (1 + sin(π·(|z| − (z_ss + z_ba)/2)/(z_ss − z_ba)))/2
/// F = L·(σ₀·z + σ₁·exp(−(v/v_d)²)·z') + σ₂·v, g as in LuGre
///
/// At v = 0 the bristles stay as they are: no creep, no true stick. A ripple that stays below
/// ρ·F_c is elastic and leaves no drift. Memory: z. Passive as LuGre is. Neutral: v_d = ∞, F_s = F_c.
/// Source: Dupont, Hayward, Armstrong, Altpeter, IEEE Trans. Autom. Control 47 (2002); z_ba is given
/// as the share ρ of F_c, which keeps it below z_ss.
#[derive(Debug, Clone)]
pub struct ElastoPlastic<S> {
    bristle: Bristle<S>,
    /// ρ·F_c.
    elastic: S,
}

impl<S: Scalar> ElastoPlastic<S> {
    /// t = α·σ₀·|z|/g(v).
    #[inline]
    fn slip(&self, force: S, velocity: S) -> Slip<S> {
        let s = sign(velocity.re());
        let along = force * s;
        let (level, steepness) = self.bristle.level.at(velocity);
        let bent = along / level;
        if along.re() <= self.elastic.re() || s == 0.0 {
            let zero = S::constant(0.0);
            return Slip { share: zero, by_force: zero, by_speed: zero };
        }
        if along.re() >= level.re() {
            let by_force = S::constant(1.0) / level;
            return Slip { share: bent, by_force, by_speed: -(bent * steepness / level) };
        }
        let width = level - self.elastic;
        let left = (level - along) / width;
        let (sine, cosine) = (left * std::f64::consts::PI).sin_cos();
        let alpha = (cosine + 1.0) * 0.5;
        let steep = sine * (0.5 * std::f64::consts::PI) / width;
        Slip {
            share: alpha * bent,
            by_force: alpha / level + bent * steep,
            by_speed: -(bent * steepness * (alpha / level + steep * -(left - 1.0))),
        }
    }

    /// Force in the direction of motion after a path σ₀·|Δx| at this g.
    #[inline]
    fn followed(&self, along: S, path: S, level: S) -> S {
        let (mut along, mut left) = (along, path);
        if along.re() < self.elastic.re() {
            let room = self.elastic - along;
            if left.re() <= room.re() {
                return along + left;
            }
            left -= room;
            along = self.elastic;
        }
        work::spend(work::STEP / 2); // an exponential or sines, beside a power in the level
        let way = left / level;
        if along.re() >= level.re() {
            return level + (along - level) * (-way).exp();
        }
        let whole = -(self.elastic / level - 1.0);
        // r = 1 − σ₀·z/g; 1 − α is the square of a sine.
        let steep = S::constant(0.5 * std::f64::consts::PI) / whole;
        let r = approach_bending(-(along / level - 1.0), way, steep * steep, |r| {
            let sine = (r / whole * (0.5 * std::f64::consts::PI)).sin();
            let square = sine * sine;
            square / r - (square - 1.0)
        });
        level * -(r - 1.0)
    }

    #[inline]
    fn bend(&self, state: &BristleState<S>, motion: &Motion<S>) -> Bent<S> {
        let bristle = &self.bristle;
        let force = bristle.stiffness * state.deflection;
        let by_end = S::constant(0.0);
        let s = sign(motion.displacement.re());
        if s == 0.0 {
            return Bent { force, by_velocity: bristle.stiffness * motion.duration, by_end };
        }
        let path = bristle.stiffness * motion.displacement * s;
        let (mut level, steepness) = bristle.level.at(motion.velocity);
        let held = motion.start_velocity.re() == motion.velocity.re();
        if !held {
            level = (level + bristle.level.at(motion.start_velocity).0) * 0.5;
        }
        let along = self.followed(force * s, path, level);
        let bends = -(self.slip(along * s, motion.velocity).share - 1.0);
        let mut by_velocity = bristle.stiffness * motion.duration * bends;
        if held && steepness.re() != 0.0 && along.re() > self.elastic.re() {
            // A slope that only solvers of a host's own ask for.
            let step = level.re() * NUDGE;
            let at = |step: f64| self.followed(force * s, path, level + step);
            by_velocity += (at(step) - at(-step)) * steepness / (2.0 * step);
        }
        Bent { force: along * s, by_velocity, by_end }
    }
}

impl<S: Scalar> FrictionLaw<S> for ElastoPlastic<S> {
    type State = BristleState<S>;
    type Trial = BristleTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = ElastoPlasticParameters::<f64>::SPECS;
    const OPTIONAL: &'static [&'static str] =
        &["breakaway", "stribeck_velocity", "stribeck_exponent", "damping_velocity"];
    const START: &'static [ParameterSpec] = ElastoPlasticStart::<f64>::SPECS;
    const SUMMARY: &'static str =
        "bristles with an elastic region: LuGre's sliding without its drift under ripple";
    const SOURCE: &'static str =
        "Dupont, Hayward, Armstrong, Altpeter, IEEE Trans. Autom. Control 47 (2002)";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = ElastoPlasticParameters::from_values(values);
        let level =
            SlidingLevel::new(p.coulomb, p.breakaway, p.stribeck_velocity, p.stribeck_exponent);
        let bristle = Bristle {
            stiffness: p.initial_stiffness,
            level,
            damping: p.damping,
            damping_velocity: p.damping_velocity,
            viscous: p.viscous,
        };
        Self { bristle, elastic: p.elastic_share * p.coulomb }
    }

    fn check(values: &[f64]) -> Result<()> {
        let p = ElastoPlasticParameters::from_values(values);
        check_levels(p.coulomb, p.breakaway)
    }

    fn passive(values: &[f64]) -> bool {
        bristle::passive(&ElastoPlastic::build(values, &[]).bristle)
    }

    fn initial(&self) -> BristleState<S> {
        BristleState::straight()
    }

    fn primed(&self, values: &[S]) -> BristleState<S> {
        self.bristle.bent_by(ElastoPlasticStart::from_values(values).force)
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<BristleState<S>> {
        BristleState::restore(entries)
    }

    fn sliding_force(&self) -> S {
        self.bristle.level.greatest()
    }

    fn greatest_stiffness(&self) -> f64 {
        self.bristle.stiffness.re()
    }

    fn greatest_damping(&self) -> f64 {
        self.bristle.damping.re() + self.bristle.viscous.re()
    }

    fn steepest_fall(&self) -> f64 {
        self.bristle.level.steepest_fall()
    }

    #[inline]
    fn force(&self, state: &BristleState<S>, velocity: S, channels: &Channels<S>) -> S {
        let slip = self.slip(self.bristle.stiffness * state.deflection, velocity);
        self.bristle.force(state.deflection, &slip, velocity, channels)
    }

    #[inline]
    fn advance(
        &self,
        state: &BristleState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> BristleTrial<S> {
        let bent = self.bend(state, motion);
        let slip = self.slip(bent.force, motion.velocity);
        self.bristle.settled(state, &bent, &slip, motion.velocity, channels)
    }

    #[inline]
    fn outcome(&self, trial: &BristleTrial<S>) -> Outcome<S> {
        trial.outcome
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

    #[inline]
    fn commit(&self, state: &mut BristleState<S>, trial: &BristleTrial<S>) {
        *state = trial.after;
    }
}
