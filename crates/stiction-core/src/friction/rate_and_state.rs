//! Rate-and-state friction: a direct effect of speed and an age of the contact.

use super::elements::arcsinh::{Balance, Series, arcsinh_of_exp};
use super::{
    Arrival, Channels, Entry, EntryReader, FrictionLaw, LawState, Motion, Outcome, Push, Statistics,
};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::{OptionSpec, ParameterSpec};

parameters! {
    /// Parameters of [`RateAndState`].
    pub struct RateAndStateParameters {
        coulomb: Effort, "friction of steady sliding at the reference speed, F_0 (μ_0·N)",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        direct_effect: One, "share of it by which friction rises at once when speed grows e times, a/μ_0",
            default Value(0.015), neutral None, typical 0.015, bounds 1e-4, 10.0;
        evolution_effect: One, "share of it by which friction then falls with distance, b/μ_0",
            default Value(0.02), neutral Some(0.0), typical 0.02, bounds 0.0, 10.0;
        slip_distance: Position, "distance over which a contact forgets its age, D_c",
            default Value(1e-5), neutral None, typical 1e-5, bounds 1e-12, 1e6;
        reference_velocity: Velocity, "speed at which steady friction is F_0, v_0; no fit can tell it from F_0",
            default Value(1e-3), neutral None, typical 1e-3, bounds 1e-12, 1e6;
        compliance: Compliance, "yielding of the contact and of what moves it, 1/k: 0 is rigid",
            default Value(0.0), neutral Some(0.0), typical 3e-4, bounds 0.0, 1e6;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`RateAndState`] may bring along.
    pub struct RateAndStateStart {
        log_age: One, "logarithm of the age of the contact over its age in steady sliding at the reference speed",
            default Value(0.0), neutral Some(0.0), typical 1.0, bounds -60.0, 60.0;
        force: Effort, "force at the start, of a contact that yields",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
    }
}

/// A compliance up to this is none: its reciprocal would leave the range of floats.
const RIGID: f64 = 1e-30;
/// Share of a displacement by which it is varied for a slope.
const NUDGE: f64 = 1e-5;

/// Rate-and-state friction, regularised so that it is defined at v = 0.
///
/// F = L·a·arsinh(v/(2·v_0)·e^((F_0 + b·φ)/a)) + F_v·v,  a and b as forces, φ = ln(v_0·θ/D_c)
///
/// θ' = 1 − |v|·θ/D_c (`evolution="ageing"`) or −(|v|·θ/D_c)·ln(|v|·θ/D_c) (`"slip"`).
///
/// With a compliance 1/k, F' = k·(v − v_s) and v_s, the speed of slip, takes the place of v above.
///
/// A body never sticks for good: under half its limit it creeps at v_0·e^(−μ_0/(2a)). A velocity of
/// exactly 0 is one that is too slow to be known; friction is then whatever holds, up to what the
/// reference speed needs at this age. Memory: φ, and F where the contact yields. Neutral: b = 0 leaves the age out.
/// Source: Dieterich, J. Geophys. Res. 84 (1979); Ruina, ibid. 88 (1983); regularised as in Rice,
/// Lapusta, Ranjith, J. Mech. Phys. Solids 49 (2001).
#[derive(Debug, Clone)]
pub struct RateAndState<S> {
    parameters: RateAndStateParameters<S>,
    ages: bool,
    yields: bool,
}

/// Memory of [`RateAndState`].
#[derive(Debug, Clone, Copy)]
pub struct RateAndStateState<S> {
    log_age: S,
    /// At level 1, without its viscous part: what a velocity of 0 does not tell.
    dry: S,
    /// ±1 above the reference speed, 0 below; the force does not depend on it.
    mode: f64,
    statistics: Statistics,
}

/// A step of [`RateAndState`].
#[derive(Debug, Clone, Copy)]
pub struct RateAndStateTrial<S> {
    after: RateAndStateState<S>,
    outcome: Outcome<S>,
}

/// Impulse of the direct effect over inertia, in rad/s or m/s: below it there is no friction.
const FAINT: f64 = 1e-150;

impl<S: Scalar> RateAndStateState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> RateAndStateState<T> {
        let (log_age, dry) = (convert(self.log_age), convert(self.dry));
        RateAndStateState { log_age, dry, mode: self.mode, statistics: self.statistics }
    }
}

impl<S: Scalar> LawState<S> for RateAndStateState<S> {
    const OUTPUTS: &'static [&'static str] = &["log_age"];

    fn output(&self, _index: usize) -> S {
        self.log_age
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        vec![
            ("log_age", Entry::Number(self.log_age.re())),
            ("dry_friction", Entry::Number(self.dry.re())),
            ("mode", Entry::Number(self.mode)),
            ("breakaways", Entry::Number(self.statistics.breakaways as f64)),
            ("sticks", Entry::Number(self.statistics.sticks as f64)),
        ]
    }

    fn statistics(&self) -> Statistics {
        self.statistics
    }
}

/// (1 − e^(−x))/x for x ≥ 0.
#[inline]
fn mean_left<S: Scalar>(x: S) -> S {
    let z = x.re();
    if z < 1e-3 {
        let value = 1.0 - z * (0.5 - z * (1.0 / 6.0 - z * (1.0 / 24.0 - z / 120.0)));
        return x.chain(value, -0.5 + z * (1.0 / 3.0 - z * (0.125 - z / 30.0)));
    }
    let value = -(-z).exp_m1() / z;
    x.chain(value, ((-z).exp() - value) / z)
}

impl<S: Scalar> RateAndState<S> {
    /// φ after a way in a time, the speed held, and its slope by the way.
    #[inline]
    fn aged(&self, log_age: S, way: S, duration: S) -> (S, S) {
        let p = &self.parameters;
        let worn = way / p.slip_distance;
        if duration.re() <= 0.0 {
            return (log_age, S::constant(0.0));
        }
        if self.ages {
            // v_0·θ/D_c = e^φ decays and grows at once: linear in θ.
            let left = (log_age - worn).exp();
            let grown = duration * p.reference_velocity / p.slip_distance;
            let share = mean_left(worn);
            let age = left + grown * share;
            // By the definition of the mean: d/dx of it is (e^(−x) − mean)/x.
            let bend = if worn.re() < 1e-3 {
                worn * (-(worn * 0.125) + 1.0 / 3.0) - 0.5
            } else {
                ((-worn).exp() - share) / worn
            };
            return (age.ln(), (grown * bend - left) / age / p.slip_distance);
        }
        if way.re() <= 0.0 {
            return (log_age, S::constant(0.0));
        }
        // ln(|v|·θ/D_c) decays.
        let speed = (way / (duration * p.reference_velocity)).ln();
        let left = (-worn).exp();
        let gone = -(-worn).exp_m1();
        let slope = -((log_age + speed) * left / p.slip_distance) - gone / way;
        (log_age * left - speed * gone, slope)
    }

    /// (F_0 + b·φ)/a.
    #[inline]
    fn exponent(&self, log_age: S) -> S {
        let p = &self.parameters;
        (p.evolution_effect * log_age + 1.0) / p.direct_effect
    }

    /// Direct effect as a force.
    #[inline]
    fn direct(&self) -> S {
        self.parameters.coulomb * self.parameters.direct_effect
    }

    /// Dry friction at level 1 at a velocity that is not 0, its slope by velocity and by φ.
    fn dry(&self, velocity: S, log_age: S) -> (S, S, S) {
        let p = &self.parameters;
        let speed = velocity.abs();
        let at = (speed / (p.reference_velocity * 2.0)).ln() + self.exponent(log_age);
        let (size, slope) = arcsinh_of_exp(at);
        let side = sign(velocity.re());
        let direct = self.direct();
        let by_age = p.coulomb * p.evolution_effect * slope * side;
        (direct * size * side, direct * slope / speed, by_age)
    }

    /// z = F/a and φ after a displacement of a contact that yields.
    #[inline]
    fn slip(&self, state: &RateAndStateState<S>, displacement: S, duration: S) -> (S, S) {
        let yielding = self.direct() * self.parameters.compliance;
        let z = state.dry / self.direct();
        let side = if displacement.re() < 0.0 { -1.0 } else { 1.0 };
        let series = |log_age: S| Series {
            way: displacement * side / yielding,
            creep: duration * self.parameters.reference_velocity / yielding,
            exponent: self.exponent(log_age),
        };
        // The age changes on the way: predicted, then taken from where it counts.
        let (mut counted, mut result) = (state.log_age, (z, state.log_age));
        for _ in 0..2 {
            let (end, share) = series(counted).advance(z * side);
            let slipped = (displacement - yielding * (end * side - z)).abs();
            let log_age = self.aged(state.log_age, slipped, duration).0;
            counted = state.log_age + (log_age - state.log_age) * share;
            result = (end * side, log_age);
        }
        result
    }

    /// A step of a contact that yields.
    fn stretch(
        &self,
        state: &RateAndStateState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> RateAndStateTrial<S> {
        let (way, duration) = (motion.displacement, motion.duration);
        let viscous = self.parameters.viscous * channels.viscous_level;
        let (z, log_age) = self.slip(state, way, duration);
        let dry = self.direct() * z;
        // A slope that only solvers of a host's own ask for.
        let step = (self.direct() * self.parameters.compliance).re().max(way.re().abs()) * NUDGE;
        let at = |way: S| self.slip(state, way, duration).0;
        let by_way = (at(way + step) - at(way - step)) * self.direct() / (2.0 * step);
        let outcome = Outcome {
            force: dry * channels.level + viscous * motion.velocity,
            slope: by_way * channels.level * duration + viscous,
            damping: viscous,
        };
        let after = self.after(state, log_age, dry, motion.velocity.re());
        RateAndStateTrial { after, outcome }
    }

    /// The state after a step, with its slides counted.
    #[inline]
    fn after(
        &self,
        before: &RateAndStateState<S>,
        log_age: S,
        dry: S,
        velocity: f64,
    ) -> RateAndStateState<S> {
        let slides = velocity.abs() > self.parameters.reference_velocity.re();
        let mode = if slides { sign(velocity) } else { 0.0 };
        let mut statistics = before.statistics;
        if mode != before.mode {
            statistics.sticks += u64::from(before.mode != 0.0);
            statistics.breakaways += u64::from(mode != 0.0);
        }
        RateAndStateState { log_age, dry, mode, statistics }
    }
}

impl<S: Scalar> FrictionLaw<S> for RateAndState<S> {
    type State = RateAndStateState<S>;
    type Trial = RateAndStateTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = RateAndStateParameters::<f64>::SPECS;
    const OPTIONAL: &'static [&'static str] = &["reference_velocity", "compliance"];
    const START: &'static [ParameterSpec] = RateAndStateStart::<f64>::SPECS;
    const OPTIONS: &'static [OptionSpec] = &[OptionSpec {
        name: "evolution",
        meaning: "how the age of the contact changes",
        choices: &[
            ("ageing", "at rest it grows with time (Dieterich)"),
            ("slip", "it changes by slip alone (Ruina)"),
        ],
    }];
    const STEEP: bool = true;
    const SUMMARY: &'static str = "logarithms of speed and of contact age: rises at once with speed, then falls with distance";
    const SOURCE: &'static str = "Dieterich (1979); Ruina (1983); Rice, Lapusta, Ranjith (2001)";

    fn build(values: &[S], choices: &[usize]) -> Self {
        let ages = choices.first().is_none_or(|choice| *choice == 0);
        let parameters = RateAndStateParameters::from_values(values);
        Self { parameters, ages, yields: parameters.compliance.re() > RIGID }
    }

    fn check(_values: &[f64]) -> Result<()> {
        Ok(())
    }

    fn initial(&self) -> RateAndStateState<S> {
        let zero = S::constant(0.0);
        RateAndStateState { log_age: zero, dry: zero, mode: 0.0, statistics: Statistics::default() }
    }

    fn primed(&self, values: &[S]) -> RateAndStateState<S> {
        let start = RateAndStateStart::from_values(values);
        RateAndStateState { log_age: start.log_age, dry: start.force, ..self.initial() }
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<RateAndStateState<S>> {
        let mut read = EntryReader::new(entries);
        let state = RateAndStateState {
            log_age: S::constant(read.number("log_age", false)?),
            dry: S::constant(read.number("dry_friction", false)?),
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
        // After a sudden step friction changes by b over D_c; it must not be stepped over.
        let p = &self.parameters;
        let spring = if self.yields { 1.0 / p.compliance.re() } else { 0.0 };
        spring + p.coulomb.re() * p.evolution_effect.re() / p.slip_distance.re()
    }

    fn greatest_damping(&self) -> f64 {
        self.parameters.viscous.re()
    }

    #[inline]
    fn force(&self, state: &RateAndStateState<S>, velocity: S, channels: &Channels<S>) -> S {
        let known = velocity.re() != 0.0 && !self.yields;
        let dry = if known { self.dry(velocity, state.log_age).0 } else { state.dry };
        dry * channels.level + self.parameters.viscous * channels.viscous_level * velocity
    }

    fn advance(
        &self,
        state: &RateAndStateState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> RateAndStateTrial<S> {
        let p = &self.parameters;
        let (log_age, by_way) =
            self.aged(state.log_age, motion.displacement.abs(), motion.duration);
        let viscous = p.viscous * channels.viscous_level;
        let level = channels.level;
        if self.yields {
            return self.stretch(state, motion, channels);
        }
        if motion.velocity.re() == 0.0 {
            // Too slow to be known: what the reference speed needs is the most that it holds.
            let most = self.dry(p.reference_velocity, log_age).0;
            let held = channels.effort.re().abs() <= (most * level).re() && level.re() > 0.0;
            let dry =
                if held { channels.effort / level } else { most * sign(channels.effort.re()) };
            let outcome = Outcome { force: dry * level, slope: viscous, damping: viscous };
            return RateAndStateTrial { after: self.after(state, log_age, dry, 0.0), outcome };
        }
        let (dry, by_velocity, by_age) = self.dry(motion.velocity, log_age);
        let damping = by_velocity * level + viscous;
        let by_way = by_way * motion.duration * sign(motion.displacement.re());
        let outcome = Outcome {
            force: dry * level + viscous * motion.velocity,
            slope: damping + by_age * by_way * level,
            damping,
        };
        RateAndStateTrial { after: self.after(state, log_age, dry, motion.velocity.re()), outcome }
    }

    #[inline]
    fn outcome(&self, trial: &RateAndStateTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    #[inline]
    fn commit(&self, state: &mut RateAndStateState<S>, trial: &RateAndStateTrial<S>) {
        *state = trial.after;
    }

    // J·(v₁ − v₀) = h·(E − F̄) over the step: see [`Balance`].
    fn arrive(
        &self,
        trial: &RateAndStateTrial<S>,
        push: &Push<S>,
        channels: &Channels<S>,
    ) -> Arrival<S> {
        let (span, before) = (push.span, push.velocity);
        let drag = self.parameters.viscous * channels.viscous_level * span * 0.5;
        let direct = self.direct() * channels.level;
        if self.yields {
            // A spring: Verlet's way, and the mean of the forces at its ends.
            let pace = (push.effort - push.friction) / push.inertia;
            let dry = trial.after.dry * channels.level;
            let slowed = push.friction - before * drag * 2.0 / span + dry;
            let impulse = (push.inertia - drag) * before + span * (push.effort - slowed * 0.5);
            let velocity = impulse / (push.inertia + drag);
            return Arrival { velocity, displacement: span * (before + pace * span * 0.5) };
        }
        let impulse = (push.inertia - drag) * before + span * push.effort;
        // Of a level that hardly is a number the body does not feel anything either.
        if (span * direct).re() <= FAINT * push.inertia.re() {
            let velocity = impulse / (push.inertia + drag);
            return Arrival { velocity, displacement: (before + velocity) * span * 0.5 };
        }
        let balance = Balance {
            heavy: (push.inertia + drag) / (span * direct),
            wanted: impulse / (span * direct),
            old: (push.friction - before * drag * 2.0 / span) / direct,
            scale: self.parameters.reference_velocity,
            exponent: self.exponent(trial.after.log_age),
        };
        let (root, velocity) = balance.solve();
        let displacement = (before + velocity) * span * 0.5;

        // What a body brakes on its way to rest is done before the step ends.
        let (changed, pace) = (velocity - before, (push.effort - push.friction) / push.inertia);
        let braking = changed.re() * before.re() < 0.0 && changed.re() * pace.re() > 0.0;
        if !braking || changed.re().abs() >= pace.re().abs() * span.re() {
            return Arrival { velocity, displacement };
        }
        let square = (root - balance.old) * (root - balance.old);
        let early = (span - changed / pace) * square / (square + 1.0);
        Arrival { velocity, displacement: displacement + early * changed * 0.5 }
    }
}
