//! The pre-sliding model of Hsieh and Pan: plastic module, nonlinear spring, damper and hook.

mod abreast;
mod parameters;
mod plain;
mod slide;
mod softest;
mod state;
mod stick;

use super::elements::abreast::SideBySide;
use super::elements::loading::{Curve, Loading, VirginCurve};
use super::elements::plastic::Plastic;
use super::elements::reachable::reachable;
use super::elements::series;
use super::elements::spring::SpringState;
use super::elements::stribeck::{check_levels, steepest};
use super::{
    Channels, Entry, EntryReader, Event, FrictionLaw, INTERNAL, Motion, Outcome, PlainSteps, Rest,
    Statistics,
};
use crate::math::scalar::{Scalar, sign};
use crate::support::error::{Error, Result};
use crate::support::parameter::{OptionSpec, ParameterSpec};

use parameters::OPTIONS;
pub use parameters::{HsiehPanParameters, HsiehPanStart};
use softest::Softest;
use state::Mode;
pub use state::{HsiehPanState, HsiehPanTrial};

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
    softest: Softest,
    /// 1/v_s and 1/ℓ.
    per_velocity: S,
    per_distance: S,
}

impl<S: Scalar> HsiehPan<S> {
    /// Force through the series and creep rate at an instant.
    fn series_force(&self, spring: S, hardening: S, velocity: S) -> (S, S) {
        if self.damper_on_spring {
            let damper = self.parameters.damping;
            return series::instant(&self.plastic, damper, spring, hardening, velocity);
        }
        (spring, self.plastic.hardening_rate(hardening, spring))
    }

    /// Force at which it breaks away however it is loaded.
    fn strongest(&self) -> S {
        let p = &self.parameters;
        if p.coulomb.re() > p.breakaway.re() { p.coulomb } else { p.breakaway }
    }

    /// Whether the hook goes on whatever the slope of the spring. A force at its break-away level
    /// cannot stick; with the damper on the spring the series cannot stop short: it catches at rest.
    #[inline(always)]
    fn drags(&self, trial: &HsiehPanTrial<S>, pull: S) -> bool {
        let least = self.parameters.slip_distance * self.parameters.final_stiffness - pull;
        let held_down = trial.breakaway.re() - trial.series.re().abs();
        least.re() > 0.0 || held_down <= 0.0 || self.damper_on_spring
    }

    /// Whether the hook turned back in a slide: x_hook' = x' − x_s' with σ' = (T − σ)·x'/ℓ, so where the
    /// pull exceeds ℓ times the stiffness.
    #[inline(always)]
    fn catches(&self, trial: &HsiehPanTrial<S>) -> bool {
        let Mode::Slip { pull } = trial.mode else { return false };
        if self.drags(trial, pull) {
            return false;
        }
        let (reach, force) = (self.parameters.slip_distance.re(), trial.series.re().abs());
        if reach * self.softest.up_to(force) > pull.re() {
            return false;
        }
        let at = self.curve.virgin_inverse(trial.series);
        (self.parameters.slip_distance * self.curve.virgin(at).slope - pull).re() <= 0.0
    }
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
    const SPRINGS: bool = true;
    const FALLS_AT_TIMES: bool = true;
    const SUMMARY: &'static str =
        "pre-sliding with creep, work hardening and reverse-point memory; breaks away and slides";
    const SOURCE: &'static str = "Hsieh, Pan, Wear 242 (2000) 1-17; partly reconstructed";

    fn build(values: &[S], choices: &[usize]) -> Self {
        let p = HsiehPanParameters::from_values(values);
        let choice = |k: usize| choices.get(k).copied().unwrap_or(0);
        let virgin = if choice(0) == 0 { VirginCurve::Masing } else { VirginCurve::Same };
        let curve = Curve::new(p.initial_stiffness, p.final_stiffness, p.decay_distance, virgin);
        Self {
            curve,
            softest: Softest::of(&curve, p.breakaway.re()),
            plastic: Plastic {
                coefficient: p.hardening_coefficient,
                exponent: p.hardening_exponent,
                rate: p.creep_rate,
            },
            damper_on_spring: choice(1) == 1,
            keeps_hardening: choice(2) == 1,
            per_velocity: S::constant(1.0) / p.stribeck_velocity,
            per_distance: S::constant(1.0) / p.slip_distance,
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
        let greatest = self.parameters.breakaway;
        // Where it never breaks away the spring gives way by so much.
        let level = if greatest.re().is_finite() { greatest } else { self.curve.yielding() };
        let turns = [start.turned, start.turned_again].map(|share| share * level);
        let force = reachable(start.force, greatest);
        let mut state = self.initial();
        let inverse = |force| self.curve.virgin_inverse(force);
        state.spring.come_back(&self.curve, inverse, turns, force);
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
            memory_merged: 0,
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

    #[inline(always)]
    fn falls(&self, state: &HsiehPanState<S>) -> bool {
        state.mode != 0.0
    }

    fn decay_rate(&self, state: &HsiehPanState<S>) -> f64 {
        let force = state.series.re().abs();
        if force == 0.0 {
            return self.plastic.rate.re();
        }
        let limit = self.plastic.limit(state.series).re();
        let gain = self.plastic.exponent.re() * limit / force * self.greatest_stiffness();
        self.plastic.rate.re() * (1.0 + gain)
    }

    #[inline(always)]
    fn force(&self, state: &HsiehPanState<S>, velocity: S, channels: &Channels<S>) -> S {
        if state.mode == 0.0 && !self.damper_on_spring {
            return state.series * channels.level + self.parameters.damping * velocity;
        }
        state.series * channels.level
    }

    #[inline(always)]
    fn friction(
        &self,
        state: &HsiehPanState<S>,
        _velocity: S,
        channels: &Channels<S>,
    ) -> (S, Option<S>) {
        let beside = state.mode == 0.0 && !self.damper_on_spring;
        (state.series * channels.level, beside.then_some(self.parameters.damping))
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

    #[inline(always)]
    fn advance_within(
        &self,
        state: &HsiehPanState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> HsiehPanTrial<S> {
        if state.mode == 0.0 {
            self.stick(state, motion, channels)
        } else {
            self.slip_within(state, motion, channels)
        }
    }

    #[inline(always)]
    fn outcome(&self, trial: &HsiehPanTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    #[inline(always)]
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

    #[inline(always)]
    fn glides(&self) -> bool {
        !self.damper_on_spring && !self.rated
    }

    #[inline(always)]
    fn glide<G: PlainSteps<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut G,
    ) {
        self.glide_in_mode(state, glide);
    }

    fn springs(&self, state: &HsiehPanState<S>) -> Option<f64> {
        (self.glides() && state.mode == 0.0).then(|| self.parameters.damping.re())
    }

    fn abreast<T: SideBySide<S, Self>>(&self, team: T) -> Option<T::Output> {
        abreast::fits(self).then(|| team.with::<abreast::Lanes>())
    }

    #[inline(always)]
    fn pending(&self, state: &HsiehPanState<S>, velocity: S) -> Option<Event> {
        (state.mode * velocity.re() < 0.0).then_some(Event::Reversal)
    }

    #[inline(always)]
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
                if self.catches(trial) {
                    Some(Event::HookReturn)
                } else if state.mode * motion.velocity.re() <= 0.0 {
                    Some(Event::Reversal)
                } else {
                    None
                }
            }
        }
    }

    #[inline(always)]
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
                if self.drags(trial, pull) {
                    let least =
                        self.parameters.slip_distance * self.parameters.final_stiffness - pull;
                    return S::constant(least.re().abs().max(f64::MIN_POSITIVE));
                }
                // In slopes: the force at a slope needs no inverse of the curve, but has a pole at the
                // least slope, which a hook that catches at a large force comes within 1e-7 of a step of.
                let at = self.curve.virgin_inverse(trial.series);
                self.parameters.slip_distance * self.curve.virgin(at).slope - pull
            }
            // A force that its level fell below stays where it is until motion loads it further.
            _ if self.rated => trial.breakaway - trial.series * sign(motion.velocity.re()),
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
        let (series, mut creep) = self.series_force(walk.end.force, hardening, motion.velocity);
        // An attempt may go on past break-away, where creep would outrun the displacement and hide it.
        let most = self.strongest();
        if !self.damper_on_spring && series.re().abs() > most.re() {
            creep = self.plastic.hardening_rate(hardening, most);
        }
        let extra =
            if self.damper_on_spring { zero } else { self.parameters.damping * motion.velocity };
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
        let (filtered, breakaway) = self.breakaway_ahead(state, filtered, series, motion.duration);
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
