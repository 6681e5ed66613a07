//! The pre-sliding model of Hsieh and Pan: plastic module, nonlinear spring, damper and hook.

use super::elements::lag::follow;
use super::elements::plastic::{Creep, Plastic};
use super::elements::reachable::reachable;
use super::elements::series;
use super::elements::spring::{Curve, Loading, SpringState, VirginCurve, Walk};
use super::elements::stribeck::{check_levels, fall, steepest};
use super::{
    Channels, Entry, EntryReader, Event, FrictionLaw, INTERNAL, LawState, Motion, Outcome,
    Rest, Statistics,
};
use crate::error::{Error, Result};
use crate::integrate::{Glide, Seen};
use crate::parameter::{OptionSpec, ParameterSpec};
use crate::parameters;
use crate::scalar::{Scalar, sign};

/// 60 arc-seconds.
const SIXTY_ARC_SECONDS: f64 = 2.908_882_086_657_216e-4;

parameters! {
    /// Parameters of [`HsiehPan`].
    pub struct HsiehPanParameters {
        initial_stiffness: Stiffness, "slope of the spring right after a reversal, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        final_stiffness: Stiffness, "slope of the spring far from a reversal, k_inf < k_0",
            default Ratio { of: "initial_stiffness", factor: 0.27, otherwise: 810.0 },
            neutral None, typical 800.0, bounds 1e-9, 1e15;
        decay_distance: Position, "distance over which the slope falls, d_0",
            default Value(SIXTY_ARC_SECONDS), neutral None, typical SIXTY_ARC_SECONDS,
            bounds 1e-15, 1e6;
        hardening_coefficient: Hardening, "c of the greatest work hardening f(s) = c·s^n",
            default Value(1.6e-3), neutral Some(0.0), typical 1.6e-3, bounds 0.0, 1e9;
        hardening_exponent: One, "n of f(s) = c·s^n, above 1 so that f'(0) = 0",
            default Value(2.0), neutral None, typical 2.0, bounds 1.0001, 10.0;
        creep_rate: Rate, "rate at which creep approaches its end, α",
            default Value(2.0), neutral Some(0.0), typical 2.0, bounds 0.0, 1e6;
        damping: Damping, "damper that acts while the hook sticks, C_s",
            default Value(0.45), neutral Some(0.0), typical 0.45, bounds 0.0, 1e9;
        breakaway: Effort, "force at which the hook breaks away when loaded slowly, F_s; inf never slips",
            default Ratio { of: "coulomb", factor: 1.0, otherwise: f64::INFINITY },
            neutral Some(f64::INFINITY), typical 0.5, bounds 1e-12, f64::INFINITY;
        coulomb: Effort, "friction while sliding fast, F_c",
            default Ratio { of: "breakaway", factor: 0.7, otherwise: f64::INFINITY },
            neutral None, typical 0.35, bounds 0.0, f64::INFINITY;
        stribeck_velocity: Velocity, "speed scale of the fall from break-away to F_c, v_s",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-9, 1e6;
        stribeck_exponent: One, "shape of the fall, δ",
            default Value(2.0), neutral None, typical 2.0, bounds 0.3, 5.0;
        viscous: Damping, "friction per speed while sliding, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
        slip_distance: Position, "distance over which a slide forgets its initial force, ℓ",
            default Value(2e-5), neutral None, typical 2e-5, bounds 1e-12, 1e6;
        loading_rate: EffortRate, "loading rate at which break-away has fallen to 1/e of F_s − F_c, r_0; inf: no dependence",
            default Value(f64::INFINITY), neutral Some(f64::INFINITY), typical 5.0,
            bounds 1e-9, f64::INFINITY;
        loading_time: Time, "averaging time of the loading rate, τ",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-6, 1e3;
    }
}

parameters! {
    /// What a contact of [`HsiehPan`] may bring along.
    pub struct HsiehPanStart {
        force: Effort, "force of the spring at the start, on the first loading curve; levels off from 98 % of F_s on, σ_0",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
        hardening: Position, "work hardening at the start, h_0",
            default Value(0.0), neutral Some(0.0), typical 5e-5, bounds 0.0, 1e6;
    }
}

const OPTIONS: &[OptionSpec] = &[
    OptionSpec {
        name: "virgin_curve",
        meaning: "first loading, before any reversal",
        choices: &[
            ("masing", "half-size branch: the first loop closes at its mirror point"),
            ("same", "a full branch from the origin"),
        ],
    },
    OptionSpec {
        name: "damper",
        meaning: "where the damper sits",
        choices: &[
            ("hook", "between body and hook, beside spring and plastic module"),
            ("spring", "across the spring only; its force drives creep and break-away"),
        ],
    },
    OptionSpec {
        name: "after_slip",
        meaning: "work hardening once the hook sticks again",
        choices: &[
            ("reset", "starts from zero: the junctions are new"),
            ("keep", "goes on from where it was"),
        ],
    },
];

/// Pre-sliding friction that creeps, hardens, remembers reverse points, breaks away and slides.
///
/// While the hook sticks, x = x_hook + x_p + x_s and F = σ(x_s) + C_s·x'. The spring σ is
/// [`Curve`] with reverse-point memory, the plastic module x_p is [`Plastic`], driven by σ. The
/// hook breaks away when |σ| reaches F_break and then follows
/// T = F_c + (F_b − F_c)·exp(−|v/v_s|^δ) + F_v·|v| over the distance ℓ, F_b being the level at
/// which it broke away. It sticks again where the velocity, or the velocity of the hook, reaches
/// zero.
///
/// At v = 0 a sticking contact relaxes by creep; a sliding one sticks. Memory: reverse points,
/// hardening, latched break-away level, filtered force. A level multiplier L scales all forces of
/// spring and hook at fixed displacement.
/// Source: Hsieh, Pan, Wear 242 (2000), §2.2 and §3; the formulas of f, G and of the slide are
/// reconstructions from the stated properties (see docs/theory/hsieh-pan.md).
#[derive(Debug, Clone)]
pub struct HsiehPan<S> {
    parameters: HsiehPanParameters<S>,
    curve: Curve<S>,
    plastic: Plastic<S>,
    damper_on_spring: bool,
    keeps_hardening: bool,
    /// Break-away depends on the loading rate.
    rated: bool,
}

/// State of [`HsiehPan`]; forces are those at level 1.
#[derive(Debug, Clone)]
pub struct HsiehPanState<S> {
    /// 0 sticks, ±1 slides in that direction.
    mode: f64,
    /// Spring; while sliding only its force is meaningful.
    spring: SpringState<S>,
    /// Force through the series: that of the spring, plus the damper's where it sits there.
    series: S,
    plastic: S,
    hardening: S,
    /// Level at which the slide began.
    latched: S,
    /// Series force behind a lag of τ.
    filtered: S,
    /// Break-away level at the end of the last step.
    breakaway: S,
    curve: Curve<S>,
    statistics: Statistics,
}

/// A step of [`HsiehPan`].
#[derive(Debug, Clone, Copy)]
pub struct HsiehPanTrial<S> {
    outcome: Outcome<S>,
    /// Force without the part that the velocity at the end damps.
    undamped: S,
    series: S,
    filtered: S,
    breakaway: S,
    mode: Mode<S>,
}

#[derive(Debug, Clone, Copy)]
enum Mode<S> {
    Stick { walk: Walk<S>, plastic: S, hardening: S },
    /// `pull` is T − s·σ: how far the force lags behind its sliding level.
    Slip { pull: S },
}

impl<S: Scalar> HsiehPanState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> HsiehPanState<T> {
        HsiehPanState {
            mode: self.mode,
            spring: self.spring.map(&convert),
            series: convert(self.series),
            plastic: convert(self.plastic),
            hardening: convert(self.hardening),
            latched: convert(self.latched),
            filtered: convert(self.filtered),
            breakaway: convert(self.breakaway),
            curve: self.curve.map(&convert),
            statistics: self.statistics,
        }
    }
}

impl<S: Scalar> LawState<S> for HsiehPanState<S> {
    const OUTPUTS: &'static [&'static str] =
        &["plastic", "hardening", "spring", "spring_force", "mode", "breakaway_level"];

    fn output(&self, index: usize) -> S {
        match index {
            0 => self.plastic,
            1 => self.hardening,
            2 if self.mode == 0.0 => self.spring.position,
            2 => self.curve.virgin_inverse(self.series),
            3 => self.series,
            4 => S::constant(self.mode),
            _ => self.breakaway,
        }
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        let number = |x: S| Entry::Number(x.re());
        let count = |n: u64| Entry::Number(n as f64);
        let mut entries = self.spring.entries();
        entries.extend([
            ("mode", Entry::Number(self.mode)),
            ("series_force", number(self.series)),
            ("plastic", number(self.plastic)),
            ("hardening", number(self.hardening)),
            ("latched_breakaway", number(self.latched)),
            ("filtered_force", number(self.filtered)),
            ("breakaway_level", number(self.breakaway)),
            ("reversals", count(self.statistics.reversals)),
            ("closings", count(self.statistics.closings)),
            ("breakaways", count(self.statistics.breakaways)),
            ("sticks", count(self.statistics.sticks)),
            ("memory_peak", count(self.statistics.memory_peak)),
        ]);
        entries
    }

    fn statistics(&self) -> Statistics {
        Statistics { memory_growths: self.spring.memory.growths(), ..self.statistics }
    }

    fn make_room(&mut self, steps: usize) {
        self.spring.memory.make_room(steps);
    }
}

/// The slope right after a reversal: rare, and a function so that nobody waits for the choice.
#[cold]
#[inline(never)]
fn after_reversal<S: Scalar>(curve: &Curve<S>) -> S {
    curve.initial_stiffness()
}

impl<S: Scalar> HsiehPan<S> {
    /// Sliding level T at this speed and its slope by speed, at level 1.
    #[inline]
    fn sliding_level(&self, latched: S, velocity: S, channels: &Channels<S>) -> (S, S) {
        let p = &self.parameters;
        let (left, steepness) = fall(velocity, p.stribeck_velocity, p.stribeck_exponent);
        let excess = latched - p.coulomb;
        let viscous = p.viscous * channels.viscous_level / channels.level;
        (p.coulomb + excess * left + viscous * velocity.abs(), excess * steepness + viscous)
    }

    /// Force through the series and creep rate at an instant.
    fn series_force(&self, spring: S, hardening: S, velocity: S) -> (S, S) {
        if self.damper_on_spring {
            let damper = self.parameters.damping;
            return series::instant(&self.plastic, damper, spring, hardening, velocity);
        }
        (spring, self.plastic.hardening_rate(hardening, spring))
    }

    /// Filtered force and break-away level after the series force went from `from` to `to`.
    #[inline]
    fn breakaway_after(&self, filtered: S, from: S, to: S, duration: S) -> (S, S) {
        let p = &self.parameters;
        if !self.rated {
            return (filtered, p.breakaway);
        }
        let filtered = follow(filtered, from, to, duration / p.loading_time).value;
        (filtered, self.breakaway_at((to - filtered).abs() / p.loading_time))
    }

    #[inline]
    fn breakaway_at(&self, rate: S) -> S {
        let p = &self.parameters;
        p.coulomb + (p.breakaway - p.coulomb) * (-(rate / p.loading_rate)).exp()
    }

    /// A step of a sticking hook.
    #[inline(always)]
    fn stick(
        &self,
        state: &HsiehPanState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> HsiehPanTrial<S> {
        if self.damper_on_spring {
            let step = series::step(
                &state.spring,
                &self.curve,
                &self.plastic,
                self.parameters.damping,
                state.hardening,
                motion,
            );
            let outcome = Outcome {
                force: step.force * channels.level,
                slope: step.slope * channels.level,
                damping: step.damping * channels.level,
            };
            let undamped = outcome.force - outcome.damping * motion.velocity;
            return self.stuck(state, motion, step.walk, step.force, step.creep, (outcome, undamped));
        }
        let creep = self.plastic.creep(
            state.hardening,
            state.spring.force,
            |direction| state.spring.slope_towards(&self.curve, direction),
            motion.displacement,
            motion.duration,
        );
        let walk = state.spring.walk(&self.curve, creep.left);
        let damping = self.parameters.damping;
        let undamped = walk.end.force * channels.level;
        let force = undamped + damping * motion.velocity;
        let slope = walk.end.slope * channels.level * motion.duration
            * (-(creep.share - 1.0))
            + damping;
        let outcome = Outcome { force, slope, damping };
        self.stuck(state, motion, walk, walk.end.force, creep, (outcome, undamped))
    }

    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // what a step has found, apart and not in a struct
    fn stuck(
        &self,
        state: &HsiehPanState<S>,
        motion: &Motion<S>,
        walk: Walk<S>,
        series: S,
        creep: Creep<S>,
        (outcome, undamped): (Outcome<S>, S),
    ) -> HsiehPanTrial<S> {
        let (filtered, breakaway) =
            self.breakaway_after(state.filtered, state.series, series, motion.duration);
        HsiehPanTrial {
            outcome,
            undamped,
            series,
            filtered,
            breakaway,
            mode: Mode::Stick {
                walk,
                plastic: state.plastic + creep.displacement,
                hardening: state.hardening + creep.hardening,
            },
        }
    }

    /// Plain steps of a sticking hook whose damper sits beside the spring.
    #[inline]
    fn glide_sticking<const SQUARE: bool, E: Fn(usize) -> S, V: Seen<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut Glide<S, E, V>,
    ) {
        let damping = self.parameters.damping;
        let greatest = self.parameters.breakaway.re();
        let span = glide.verlet.span();
        let branch = state.spring.present(&self.curve);
        let mut here = state.spring.here();
        let (mut plastic, mut hardening) = (state.plastic, state.hardening);
        let mut velocity = glide.run.velocity;
        while let Some(effort) = glide.next() {
            let net = effort - (here.force + damping * velocity);
            let (displacement, predicted) = glide.verlet.depart(velocity, net);
            let towards = |direction| {
                if direction == here.direction { here.slope } else { after_reversal(&self.curve) }
            };
            let creep =
                self.plastic.plain_creep::<SQUARE>(hardening, here.force, towards, displacement, span);
            let Some(creep) = creep else { return };
            let (unbraked, braking) = glide.verlet.unbraked(velocity, net + effort, damping);
            let Some(there) = here.onward(&self.curve, &branch, creep.left) else { return };
            let arrived = unbraked - braking * there.force;
            if there.force.re().abs() >= greatest && arrived.re() * there.force.re() > 0.0 {
                return;
            }
            here = there;
            velocity = arrived;
            plastic += creep.displacement;
            hardening += creep.hardening;
            state.spring.slide(&here);
            state.series = here.force;
            state.plastic = plastic;
            state.hardening = hardening;
            let friction = here.force + damping * predicted + damping * (velocity - predicted);
            glide.accept(displacement, velocity, friction, state);
        }
    }

    /// A force rising from `from` to `to` while the body moves by `distance`, limited to what the
    /// spring gains when the hook stands still: a hook dragged backwards would give back work
    /// that nobody did. Returns the stiffness where the limit holds.
    #[inline]
    fn no_faster_than_the_spring(&self, from: S, to: S, distance: S) -> (S, Option<S>) {
        let least = from + self.parameters.final_stiffness * distance;
        if to.re() <= least.re() {
            return (to, None);
        }
        let limit = self.curve.virgin(self.curve.virgin_inverse(from) + distance);
        if to.re() <= limit.force.re() { (to, None) } else { (limit.force, Some(limit.slope)) }
    }

    /// A step of a sliding hook.
    #[inline(never)]
    fn slip(
        &self,
        state: &HsiehPanState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> HsiehPanTrial<S> {
        let slide = self.slide(state.mode, state.latched, state.series, motion, channels);
        let (filtered, breakaway) =
            self.breakaway_after(state.filtered, state.series, slide.series, motion.duration);
        HsiehPanTrial {
            outcome: slide.outcome,
            undamped: slide.outcome.force - slide.outcome.damping * motion.velocity,
            series: slide.series,
            filtered,
            breakaway,
            mode: Mode::Slip { pull: slide.pull },
        }
    }

    /// What a slide in direction `s` does: the force follows the sliding level over the distance ℓ.
    #[inline(always)]
    fn slide(
        &self,
        s: f64,
        latched: S,
        series: S,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> Slide<S> {
        let (to, steepness) = self.sliding_level(latched, motion.velocity, channels);
        let (from, from_steepness) = if motion.start_velocity.re() == motion.velocity.re() {
            (to, steepness)
        } else {
            self.sliding_level(latched, motion.start_velocity, channels)
        };
        let distance = motion.displacement.abs();
        let per_distance = S::constant(1.0) / self.parameters.slip_distance;
        let followed = follow(series * s, from, to, distance * per_distance);
        let (sigma, held_back) =
            self.no_faster_than_the_spring(series * s, followed.value, distance);
        let turning = sign(motion.velocity.re());
        let damping = steepness * followed.end_share * channels.level * (s * turning);
        let damping =
            if damping.re() > 0.0 && held_back.is_none() { damping } else { S::constant(0.0) };
        // Held velocity: start and end level move together, and the distance with them.
        let held = steepness * followed.end_share
            + from_steepness * (-(followed.end_share - 1.0) - followed.remainder);
        let catching_up =
            (to - series * s) * followed.remainder * motion.duration * per_distance;
        let slope = match held_back {
            None => (held + catching_up) * (s * turning),
            Some(stiffness) => stiffness * motion.duration,
        };
        let slope = slope * channels.level;
        let outcome = Outcome { force: sigma * channels.level * s, slope, damping };
        Slide { outcome, series: sigma * s, pull: to - sigma }
    }

    /// Plain steps of a sliding hook.
    #[inline]
    fn glide_sliding<E: Fn(usize) -> S, V: Seen<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut Glide<S, E, V>,
    ) {
        let (mode, latched) = (state.mode, state.latched);
        let least = self.parameters.slip_distance * self.parameters.final_stiffness;
        let greatest = self.parameters.breakaway.re();
        let (mut series, mut velocity) = (state.series, glide.run.velocity);
        while let Some(effort) = glide.next() {
            if mode * velocity.re() < 0.0 {
                return;
            }
            let net = effort - series;
            let (displacement, predicted) = glide.verlet.depart(velocity, net);
            let duration = glide.verlet.span();
            let motion =
                Motion { displacement, duration, start_velocity: velocity, velocity: predicted };
            let slide = self.slide(mode, latched, series, &motion, &Channels::default());
            let Outcome { force, damping, .. } = slide.outcome;
            let undamped = force - damping * predicted;
            let arrived = glide.verlet.arrive(velocity, net + effort, damping, undamped);
            // As `margin` says; what it has to solve for is not plain.
            let held = (least - slide.pull).re() > 0.0 || greatest - force.re().abs() <= 0.0;
            if !held || mode * arrived.re() <= 0.0 {
                return;
            }
            series = slide.series;
            velocity = arrived;
            state.series = series;
            state.spring.force = series;
            let friction = force + damping * (velocity - predicted);
            glide.accept(displacement, velocity, friction, state);
        }
    }
}

/// A step of a slide.
#[derive(Debug, Clone, Copy)]
struct Slide<S> {
    outcome: Outcome<S>,
    series: S,
    /// T − s·σ: how far the force lags behind its sliding level.
    pull: S,
}

impl<S: Scalar> FrictionLaw<S> for HsiehPan<S> {
    type State = HsiehPanState<S>;
    type Trial = HsiehPanTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = HsiehPanParameters::<f64>::SPECS;
    const OPTIONAL: &'static [&'static str] = &[
        "stribeck_velocity",
        "stribeck_exponent",
        "slip_distance",
        "loading_rate",
        "loading_time",
    ];
    const START: &'static [ParameterSpec] = HsiehPanStart::<f64>::SPECS;
    const OPTIONS: &'static [OptionSpec] = OPTIONS;
    const REMEMBERS: bool = true;
    const SUMMARY: &'static str =
        "pre-sliding with creep, work hardening and reverse-point memory; breaks away and slides";
    const SOURCE: &'static str = "Hsieh, Pan, Wear 242 (2000) 1-17; partly reconstructed";

    fn build(values: &[S], choices: &[usize]) -> Self {
        let p = HsiehPanParameters::from_values(values);
        let choice = |k: usize| choices.get(k).copied().unwrap_or(0);
        let virgin = if choice(0) == 0 { VirginCurve::Masing } else { VirginCurve::Same };
        Self {
            curve: Curve::new(p.initial_stiffness, p.final_stiffness, p.decay_distance, virgin),
            plastic: Plastic {
                coefficient: p.hardening_coefficient,
                exponent: p.hardening_exponent,
                rate: p.creep_rate,
            },
            damper_on_spring: choice(1) == 1,
            keeps_hardening: choice(2) == 1,
            rated: p.loading_rate.re().is_finite() && p.breakaway.re().is_finite(),
            parameters: p,
        }
    }

    fn check(values: &[f64]) -> Result<()> {
        let p = HsiehPanParameters::from_values(values);
        if p.final_stiffness >= p.initial_stiffness {
            return Err(Error::Order {
                lesser: "final_stiffness".to_owned(),
                lesser_value: p.final_stiffness,
                relation: "stay below",
                greater: "initial_stiffness".to_owned(),
                greater_value: p.initial_stiffness,
            });
        }
        check_levels(p.coulomb, p.breakaway)
    }

    fn initial(&self) -> HsiehPanState<S> {
        let zero = S::constant(0.0);
        HsiehPanState {
            mode: 0.0,
            spring: SpringState::relaxed(&self.curve),
            series: zero,
            plastic: zero,
            hardening: zero,
            latched: zero,
            filtered: zero,
            breakaway: self.parameters.breakaway,
            curve: self.curve,
            statistics: Statistics::default(),
        }
    }

    fn primed(&self, values: &[S]) -> HsiehPanState<S> {
        let start = HsiehPanStart::from_values(values);
        let force = reachable(start.force, self.parameters.breakaway);
        let mut state = self.initial();
        state.spring.place_on_virgin(&self.curve, force);
        state.series = force;
        // As after a long time at this force: its loading rate is 0.
        state.filtered = force;
        state.hardening = start.hardening;
        state
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<HsiehPanState<S>> {
        let mut read = EntryReader::new(entries);
        let mut state = self.initial();
        state.mode = read.choice("mode", &[-1.0, 0.0, 1.0])?;
        if state.mode != 0.0 && !self.parameters.breakaway.re().is_finite() {
            return Err(Error::State {
                name: "mode".to_owned(),
                problem: format!("is {}, allowed is 0: this contact never slips", state.mode),
            });
        }
        state.spring.restore(&mut read)?;
        state.series = S::constant(read.number("series_force", false)?);
        state.plastic = S::constant(read.number("plastic", false)?);
        state.hardening = S::constant(read.number("hardening", false)?);
        state.latched = S::constant(read.number("latched_breakaway", false)?);
        state.filtered = S::constant(read.number("filtered_force", false)?);
        state.breakaway = S::constant(read.number("breakaway_level", true)?);
        state.statistics = Statistics {
            reversals: read.count("reversals")?,
            closings: read.count("closings")?,
            breakaways: read.count("breakaways")?,
            sticks: read.count("sticks")?,
            memory_peak: read.count("memory_peak")?,
            memory_growths: 0,
        };
        read.finish()?;
        Ok(state)
    }

    fn sliding_force(&self) -> S {
        self.parameters.breakaway
    }

    fn greatest_stiffness(&self) -> f64 {
        self.parameters.initial_stiffness.re()
    }

    fn greatest_damping(&self) -> f64 {
        self.parameters.damping.re().max(self.parameters.viscous.re())
    }

    fn steepest_fall(&self) -> f64 {
        let p = &self.parameters;
        if !p.breakaway.re().is_finite() {
            return 0.0;
        }
        let excess = p.breakaway.re() - p.coulomb.re();
        steepest(excess, p.stribeck_velocity.re(), p.stribeck_exponent.re())
    }

    fn fastest_rate(&self, state: &HsiehPanState<S>) -> f64 {
        let force = state.series.re().abs();
        if force == 0.0 {
            return self.plastic.rate.re();
        }
        let limit = self.plastic.limit(state.series).re();
        let gain = self.plastic.exponent.re() * limit / force * self.greatest_stiffness();
        self.plastic.rate.re() * (1.0 + gain)
    }

    #[inline]
    fn force(&self, state: &HsiehPanState<S>, velocity: S, channels: &Channels<S>) -> S {
        if state.mode == 0.0 && !self.damper_on_spring {
            return state.series * channels.level + self.parameters.damping * velocity;
        }
        state.series * channels.level
    }

    #[inline(always)]
    fn advance(
        &self,
        state: &HsiehPanState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> HsiehPanTrial<S> {
        if state.mode == 0.0 {
            self.stick(state, motion, channels)
        } else {
            self.slip(state, motion, channels)
        }
    }

    #[inline]
    fn outcome(&self, trial: &HsiehPanTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    #[inline]
    fn undamped(&self, trial: &HsiehPanTrial<S>, _velocity: S) -> S {
        trial.undamped
    }

    #[inline(always)]
    fn commit(&self, state: &mut HsiehPanState<S>, trial: &HsiehPanTrial<S>) {
        state.series = trial.series;
        state.filtered = trial.filtered;
        state.breakaway = trial.breakaway;
        match &trial.mode {
            Mode::Stick { walk, plastic, hardening } => {
                state.spring.accept(walk);
                state.plastic = *plastic;
                state.hardening = *hardening;
                state.spring.count(walk, &mut state.statistics);
            }
            Mode::Slip { .. } => state.spring.force = trial.series,
        }
    }

    // At a held force h → f at the rate α, and the spring stays as it is.
    fn rest(
        &self,
        state: &HsiehPanState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, HsiehPanTrial<S>>> {
        let force = state.spring.force;
        let (filtered, breakaway) = self.breakaway_after(state.filtered, force, force, duration);
        // The loading rate only falls: a level that is out of reach now stays so.
        let (_, now) = self.breakaway_after(state.filtered, force, force, S::constant(0.0));
        if state.mode != 0.0 || force.re().abs() >= now.re() {
            return None;
        }
        let side = sign(force.re());
        let creep = self.plastic.creep(
            state.hardening,
            force,
            |_| S::constant(0.0),
            S::constant(0.0),
            duration,
        );
        let hardening = state.hardening + creep.hardening;
        let velocity = self.plastic.hardening_rate(hardening, force) * side;
        let damping = self.parameters.damping;
        let walk = state.spring.walk(&self.curve, S::constant(0.0));
        let dragged = if self.damper_on_spring { S::constant(0.0) } else { damping * velocity };
        let trial = HsiehPanTrial {
            outcome: Outcome { force: force * channels.level + dragged, slope: damping, damping },
            undamped: force * channels.level,
            series: force,
            filtered,
            breakaway,
            mode: Mode::Stick { walk, plastic: state.plastic + creep.displacement, hardening },
        };
        Some(Rest { trial, displacement: creep.displacement, velocity })
    }

    const GLIDES: bool = true;

    #[inline]
    fn glide<E: Fn(usize) -> S, V: Seen<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut Glide<S, E, V>,
    ) {
        if self.damper_on_spring || self.rated {
            return;
        }
        if state.mode == 0.0 {
            if self.plastic.is_square() {
                self.glide_sticking::<true, _, _>(state, glide);
            } else {
                self.glide_sticking::<false, _, _>(state, glide);
            }
        } else {
            self.glide_sliding(state, glide);
        }
    }

    #[inline]
    fn pending(&self, state: &HsiehPanState<S>, velocity: S) -> Option<Event> {
        (state.mode * velocity.re() < 0.0).then_some(Event::Reversal)
    }

    #[inline]
    fn event(
        &self,
        state: &HsiehPanState<S>,
        trial: &HsiehPanTrial<S>,
        motion: &Motion<S>,
    ) -> Option<Event> {
        match trial.mode {
            Mode::Stick { .. } => {
                let reached = trial.series.re().abs() >= trial.breakaway.re();
                // Only motion that loads the spring further breaks it away; without that
                // condition a falling level would start a slide that runs backwards.
                (reached && motion.velocity.re() * trial.series.re() > 0.0)
                    .then_some(Event::BreakAway)
            }
            Mode::Slip { .. } => {
                if self.margin(state, trial, motion, Event::HookReturn).re() <= 0.0 {
                    Some(Event::HookReturn)
                } else if state.mode * motion.velocity.re() <= 0.0 {
                    Some(Event::Reversal)
                } else {
                    None
                }
            }
        }
    }

    #[inline]
    fn margin(
        &self,
        state: &HsiehPanState<S>,
        trial: &HsiehPanTrial<S>,
        motion: &Motion<S>,
        event: Event,
    ) -> S {
        match (event, trial.mode) {
            (Event::Reversal, _) => motion.velocity * state.mode,
            (Event::HookReturn, Mode::Slip { pull }) => {
                // x_hook' = x' − x_s' with σ' = (T − σ)·x'/ℓ: the hook turns back where the pull
                // exceeds ℓ times the stiffness. A force at its break-away level cannot stick.
                let reach = self.parameters.slip_distance;
                // With the damper on the spring the series cannot stop short: it catches at rest.
                let least = reach * self.parameters.final_stiffness - pull;
                let held_down = trial.breakaway.re() - trial.series.re().abs();
                if least.re() > 0.0 || held_down <= 0.0 || self.damper_on_spring {
                    return S::constant(least.re().abs().max(f64::MIN_POSITIVE));
                }
                let at = self.curve.virgin_inverse(trial.series);
                reach * self.curve.virgin(at).slope - pull
            }
            _ => trial.breakaway - trial.series.abs(),
        }
    }

    fn switch(&self, state: &mut HsiehPanState<S>, event: Event) {
        if event == Event::BreakAway {
            state.mode = sign(state.series.re());
            // Latched: a level that went on following the loading rate would let it chatter.
            state.latched = state.breakaway;
            if self.damper_on_spring {
                // The damper lets go with the hook; its share must not turn into spring force.
                state.series = state.spring.force;
            }
            state.spring.place_on_virgin(&self.curve, state.series);
            state.statistics.breakaways += 1;
        } else {
            state.mode = 0.0;
            state.spring.place_on_virgin(&self.curve, state.series);
            if !self.keeps_hardening {
                state.hardening = S::constant(0.0);
            }
            state.statistics.sticks += 1;
        }
    }

    fn internal(&self, state: &HsiehPanState<S>) -> [S; INTERNAL] {
        [state.plastic, state.hardening, state.filtered]
    }

    fn rates(
        &self,
        state: &HsiehPanState<S>,
        motion: &Motion<S>,
        internal: &[S; INTERNAL],
        channels: &Channels<S>,
    ) -> (S, [S; INTERNAL]) {
        let zero = S::constant(0.0);
        if state.mode != 0.0 {
            // The relaxation over ℓ is stiff and its solution known: no rate is needed.
            return (self.slip(state, motion, channels).outcome.force, [zero; INTERNAL]);
        }
        let [plastic, hardening, filtered] = *internal;
        let walk = state.spring.walk(&self.curve, motion.displacement - (plastic - state.plastic));
        let (series, creep) =
            self.series_force(walk.end.force, hardening, motion.velocity);
        let extra = if self.damper_on_spring {
            zero
        } else {
            self.parameters.damping * motion.velocity
        };
        let lag = (series - filtered) / self.parameters.loading_time;
        let lag = if self.rated { lag } else { zero };
        (series * channels.level + extra, [creep * sign(series.re()), creep, lag])
    }

    fn settle(
        &self,
        state: &HsiehPanState<S>,
        motion: &Motion<S>,
        internal: &[S; INTERNAL],
        channels: &Channels<S>,
    ) -> HsiehPanTrial<S> {
        if state.mode != 0.0 {
            return self.slip(state, motion, channels);
        }
        let [plastic, hardening, filtered] = *internal;
        let walk = state.spring.walk(&self.curve, motion.displacement - (plastic - state.plastic));
        let (force, _) = self.rates(state, motion, internal, channels);
        let (series, _) = self.series_force(walk.end.force, hardening, motion.velocity);
        let breakaway = if self.rated {
            self.breakaway_at((series - filtered).abs() / self.parameters.loading_time)
        } else {
            self.parameters.breakaway
        };
        let damping = self.parameters.damping;
        let slope = walk.end.slope * channels.level * motion.duration + damping;
        HsiehPanTrial {
            outcome: Outcome { force, slope, damping },
            undamped: force - damping * motion.velocity,
            series,
            filtered,
            breakaway,
            mode: Mode::Stick { walk, plastic, hardening },
        }
    }
}
