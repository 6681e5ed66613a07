//! Plain steps of eight contacts at once: what [`FrictionLaw::glide`] does, without a choice.
//!
//! Sticking and sliding lanes go through a pass each, which is left out where a block has none.

use super::{HsiehPan, HsiehPanState};
use crate::exponential::{faded, fading};
use crate::friction::elements::spring::{Loading, SYNCHRONISED, short_way};
use crate::lanes::{Bodies, Contacts, Row, WIDTH};
use crate::scalar::{SHORT, SHORTER, Scalar, second_share, sign};

/// Contacts of [`HsiehPan`] whose limit of hardening is a square, whose level falls as a bell and
/// whose damper sits beside the spring.
#[derive(Debug, Clone, Default)]
#[repr(align(64))]
pub struct Lanes {
    /// 0 sticks, ±1 slides.
    mode: Row,
    /// Force of spring and series.
    force: Row,
    position: Row,
    slope: Row,
    steps: Row,
    plastic: Row,
    hardening: Row,
    /// Of the branch: its direction, where it closes, and the share of d_0 that a displacement is.
    direction: Row,
    target: Row,
    per_displacement: Row,
    /// Where the branch begins, the way along it per displacement and the force per force on it.
    origin: Row,
    origin_force: Row,
    stretch: Row,
    scale: Row,
    /// Of the curve: k_0 − k_inf, that times d_0, and 1/d_0.
    fading: Row,
    faded_force: Row,
    inverse_distance: Row,
    initial_stiffness: Row,
    final_stiffness: Row,
    /// Creep: c, 2·c, α·h and the product of those two.
    coefficient: Row,
    twice_coefficient: Row,
    progress: Row,
    pace: Row,
    damping: Row,
    /// Displacement per velocity and inertia, less what damping at the start takes off: see `Verlet`.
    stride: Row,
    kept: Row,
    /// 1/(J + h/2·C_s) and h/2 of that.
    share: Row,
    braking: Row,
    greatest: Row,
    /// Of the slide.
    coulomb: Row,
    excess: Row,
    per_velocity: Row,
    viscous: Row,
    per_distance: Row,
    /// ℓ·k_inf.
    least: Row,
    sticks: bool,
    slides: bool,
}

/// Whether these contacts can go through plain steps abreast.
pub fn fits<S: Scalar>(law: &HsiehPan<S>) -> bool {
    let p = &law.parameters;
    let bell = p.stribeck_exponent.re() == 2.0 || p.breakaway.re().is_infinite();
    bell && law.plastic.is_square() && !law.damper_on_spring && !law.rated
}

impl<S: Scalar> Contacts<S, HsiehPan<S>> for Lanes {
    fn fit(&mut self, lane: usize, law: &HsiehPan<S>, bodies: &Bodies) {
        let p = &law.parameters;
        let damping = p.damping.re();
        let half = bodies.half.0[lane];
        let share = 1.0 / (bodies.inertia.0[lane] + half * damping);
        let [_, fading, distance] = law.curve.numbers();
        self.fading.0[lane] = fading;
        self.faded_force.0[lane] = fading * distance;
        self.inverse_distance.0[lane] = 1.0 / distance;
        self.initial_stiffness.0[lane] = law.curve.initial_stiffness().re();
        self.final_stiffness.0[lane] = p.final_stiffness.re();
        self.coefficient.0[lane] = law.plastic.coefficient.re();
        self.twice_coefficient.0[lane] = law.plastic.coefficient.re() * 2.0;
        self.progress.0[lane] = law.plastic.rate.re() * bodies.span.0[lane];
        self.pace.0[lane] = self.progress.0[lane] * self.twice_coefficient.0[lane];
        self.damping.0[lane] = damping;
        self.stride.0[lane] = bodies.span.0[lane] - bodies.lever.0[lane] * damping;
        self.kept.0[lane] = bodies.inertia.0[lane] - half * damping;
        self.share.0[lane] = share;
        self.braking.0[lane] = half * share;
        self.greatest.0[lane] = p.breakaway.re();
        self.coulomb.0[lane] = p.coulomb.re();
        self.per_velocity.0[lane] = 1.0 / p.stribeck_velocity.re();
        self.viscous.0[lane] = p.viscous.re();
        self.per_distance.0[lane] = 1.0 / p.slip_distance.re();
        self.least.0[lane] = p.slip_distance.re() * p.final_stiffness.re();
    }

    #[inline]
    fn load(&mut self, lane: usize, law: &HsiehPan<S>, state: &HsiehPanState<S>) {
        let spring = &state.spring;
        let branch = spring.present(&law.curve);
        self.mode.0[lane] = state.mode;
        self.force.0[lane] = if state.mode == 0.0 { spring.force } else { state.series }.re();
        self.position.0[lane] = spring.position.re();
        self.slope.0[lane] = spring.slope.re();
        self.steps.0[lane] = f64::from(spring.steps);
        self.plastic.0[lane] = state.plastic.re();
        self.hardening.0[lane] = state.hardening.re();
        self.direction.0[lane] = spring.direction;
        self.target.0[lane] = branch.target;
        self.per_displacement.0[lane] = law.curve.per_displacement(&branch, spring.direction).re();
        let s = spring.direction;
        let (stretch, scale) = match (branch.first, law.curve.closes_at_mirror()) {
            (true, true) => (2.0 * s, 0.5 * s),
            _ => (s, s),
        };
        self.origin.0[lane] = branch.origin;
        let anchor = spring.memory.points().last();
        self.origin_force.0[lane] = anchor.map_or(0.0, |anchor| anchor.force.re());
        self.stretch.0[lane] = stretch;
        self.scale.0[lane] = scale;
        self.excess.0[lane] = (state.latched - law.parameters.coulomb).re();
        self.sticks = self.mode.0.contains(&0.0);
        self.slides = self.mode.0.iter().any(|mode| *mode != 0.0);
    }

    #[inline]
    fn store(&self, lane: usize, state: &mut HsiehPanState<S>) {
        let number = |row: &Row| S::constant(row.0[lane]);
        state.series = number(&self.force);
        state.spring.force = number(&self.force);
        if state.mode == 0.0 {
            state.spring.position = number(&self.position);
            state.spring.slope = number(&self.slope);
            state.spring.steps = self.steps.0[lane] as u32;
            state.plastic = number(&self.plastic);
            state.hardening = number(&self.hardening);
        }
    }

    #[inline(always)]
    fn step(&mut self, bodies: &mut Bodies) {
        bodies.missed = [0; WIDTH];
        if self.sticks {
            for lane in 0..WIDTH {
                let here = self.mode.0[lane] == 0.0;
                let plain = self.stick::<false>(lane, here, bodies);
                bodies.missed[lane] = u64::from(here & !plain);
            }
            if bodies.misses() {
                for lane in 0..WIDTH {
                    let here = bodies.missed[lane] != 0;
                    let plain = self.stick::<true>(lane, here, bodies);
                    bodies.missed[lane] = u64::from(here & !plain);
                }
            }
        }
        if !self.slides {
            return;
        }
        for lane in 0..WIDTH {
            let here = self.mode.0[lane] != 0.0;
            let plain = self.slide(lane, here, bodies);
            bodies.missed[lane] |= u64::from(here & !plain);
        }
    }
}

impl Lanes {
    /// A step of a sticking hook, accepted `here` where it is plain; whether it was. `AFRESH` evaluates
    /// the spring from its reverse point, which is due now and then and after a long way.
    #[inline(always)]
    fn stick<const AFRESH: bool>(&mut self, lane: usize, here: bool, bodies: &mut Bodies) -> bool {
        let (effort, velocity) = (bodies.effort.0[lane], bodies.velocity.0[lane]);
        let (force, slope) = (self.force.0[lane], self.slope.0[lane]);
        let (damping, progress) = (self.damping.0[lane], self.progress.0[lane]);
        let push = effort - force;
        let displacement = self.stride.0[lane] * velocity + bodies.lever.0[lane] * push;

        // `Plastic::plain_creep`.
        let s = 1.0_f64.copysign(force);
        let margin = self.coefficient.0[lane] * (force * force) - self.hardening.0[lane];
        let starts = margin > 0.0;
        let held = if starts { progress * margin } else { 0.0 };
        let towards = displacement - s * held;
        let side = if towards == 0.0 { -s } else { 1.0_f64.copysign(towards) };
        let stiffness =
            if side == self.direction.0[lane] { slope } else { self.initial_stiffness.0[lane] };
        let gain = self.twice_coefficient.0[lane] * force.abs() * stiffness;
        let pace = self.pace.0[lane] * force.abs() * stiffness;
        let risen = gain * (displacement * s);
        let z = progress + pace;
        let second = second_share(z);
        let mean = 1.0 - z * second;
        let outrun = (risen < 0.0) & (margin * (1.0 - z * mean) + risen * mean < 0.0);
        let overtakes = (risen > 0.0) & (margin + risen > 0.0);
        let lagged = second * (held * s * z - pace * displacement);
        let gained = held - lagged * s;
        let rest = (displacement - held * s) + lagged;
        let idle = (force == 0.0) | (self.coefficient.0[lane] == 0.0);
        let creeps = starts & !idle;
        let long = z >= SHORTER;
        let creep_plain = if starts { !long & !outrun } else { !overtakes };
        let hardened = if creeps { gained } else { 0.0 };
        let crept = if creeps { gained * s } else { 0.0 };
        let left = if creeps { rest } else { displacement };

        // `Here::onward`.
        let direction = self.direction.0[lane];
        let position = self.position.0[lane] + left;
        let along = left * self.per_displacement.0[lane];
        let far = (self.steps.0[lane] >= f64::from(SYNCHRONISED)) | (along >= SHORT);
        let (onward, steeper) = if AFRESH {
            let way = (position - self.origin.0[lane]) * self.stretch.0[lane];
            let gone = faded(-(way * self.inverse_distance.0[lane]));
            let gained = self.final_stiffness.0[lane] * way + self.faded_force.0[lane] * gone;
            let stiffness = self.initial_stiffness.0[lane] - self.fading.0[lane] * gone;
            (self.origin_force.0[lane] + gained * self.scale.0[lane], stiffness)
        } else {
            let excess = slope - self.final_stiffness.0[lane];
            let [force, slope] = short_way(force, slope, excess, left, along);
            (force, slope)
        };
        let back = direction * left < 0.0;
        let closes = direction * (position - self.target.0[lane]) >= 0.0;
        let stays = !back
            & (direction != 0.0)
            & (far == AFRESH)
            & !closes;

        let unbraked =
            (self.kept.0[lane] * velocity + bodies.half.0[lane] * (push + effort)) * self.share.0[lane];
        let arrived = unbraked - self.braking.0[lane] * onward;
        let breaks = (onward.abs() >= self.greatest.0[lane]) & (arrived * onward > 0.0);

        let plain = (idle | creep_plain) & stays & !breaks;
        let accepted = here & plain;
        self.force.take(lane, accepted, onward);
        self.slope.take(lane, accepted, steeper);
        self.position.take(lane, accepted, position);
        let counted = self.steps.0[lane] + if left != 0.0 { 1.0 } else { 0.0 };
        self.steps.take(lane, accepted, if AFRESH { 0.0 } else { counted });
        self.plastic.add(lane, accepted, crept);
        self.hardening.add(lane, accepted, hardened);
        let friction = onward + damping * arrived;
        bodies.accept(lane, accepted, displacement, arrived, friction);
        plain
    }

    /// A step of a sliding hook likewise.
    #[inline(always)]
    fn slide(&mut self, lane: usize, here: bool, bodies: &mut Bodies) -> bool {
        let (effort, velocity) = (bodies.effort.0[lane], bodies.velocity.0[lane]);
        let (mode, series) = (self.mode.0[lane], self.force.0[lane]);
        let net = effort - series;
        let displacement = bodies.span.0[lane] * velocity + bodies.lever.0[lane] * net;
        let predicted = velocity + bodies.pace.0[lane] * net;

        // `HsiehPan::sliding_level`.
        let (coulomb, excess) = (self.coulomb.0[lane], self.excess.0[lane]);
        let viscous = self.viscous.0[lane];
        let level = |velocity: f64| {
            let share = velocity * self.per_velocity.0[lane];
            let power = share * share;
            let left = fading(-power);
            (coulomb + excess * left + viscous * velocity.abs(), left, power)
        };
        let (to, left, power) = level(predicted);
        let (from, _, _) = level(velocity);
        let fall = if predicted == 0.0 { 0.0 } else { -(left * (2.0 * power / predicted.abs())) };
        let steepness = excess * fall + viscous;

        // `follow`.
        let distance = displacement.abs();
        let z = distance * self.per_distance.0[lane];
        let gone = faded(-z);
        let remainder = -(gone - 1.0);
        let mean = if z < 1e-5 { -(z * 0.5 - 1.0) } else { gone * (1.0 / z) };
        let end_share = -(mean - 1.0);
        let behind = series * mode;
        let sigma = from + (to - from) * end_share + (behind - from) * remainder;
        let follows = sigma <= behind + self.final_stiffness.0[lane] * distance;

        let damping = steepness * end_share * (mode * sign(predicted));
        let damping = if damping > 0.0 { damping } else { 0.0 };
        let force = sigma * mode;
        let undamped = force - damping * predicted;
        let share = 1.0 / (bodies.inertia.0[lane] + bodies.half.0[lane] * damping);
        let unbraked =
            (bodies.inertia.0[lane] * velocity + bodies.half.0[lane] * (net + effort)) * share;
        let arrived = unbraked - bodies.half.0[lane] * share * undamped;
        let pull = to - sigma;
        let held = (self.least.0[lane] - pull > 0.0) | (self.greatest.0[lane] - force.abs() <= 0.0);

        let (turned, stops) = (mode * velocity < 0.0, mode * arrived <= 0.0);
        let plain = follows & held & !turned & !stops;
        let accepted = here & plain;
        self.force.take(lane, accepted, force);
        let friction = undamped + damping * arrived;
        bodies.accept(lane, accepted, displacement, arrived, friction);
        plain
    }
}
