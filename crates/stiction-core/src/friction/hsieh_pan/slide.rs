//! Steps of a sliding hook.

use super::super::elements::lag::follow_by;
use super::super::elements::loading::Loading;
use super::super::elements::stribeck::{fall_power_by, fall_slope};
use super::super::{Channels, Motion, Outcome};
use super::HsiehPan;
use super::state::{HsiehPanState, HsiehPanTrial, Mode};
use crate::math::exponential::fading_twice_and_faded_of;
use crate::math::scalar::{Scalar, sign};

/// Of a force, what is more than round-off.
pub(super) const ROUNDING: f64 = 1e-13;

/// A step of a slide.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slide<S> {
    pub(super) outcome: Outcome<S>,
    pub(super) series: S,
    /// T − s·σ: how far the force lags behind its sliding level.
    pub(super) pull: S,
}

impl<S: Scalar> HsiehPan<S> {
    /// Sliding level T at this speed and its slope by speed, at level 1, where this is left of the
    /// fall.
    #[inline(always)]
    fn sliding_level(
        &self,
        latched: S,
        velocity: S,
        (power, left): (S, S),
        channels: &Channels<S>,
    ) -> (S, S) {
        let p = &self.parameters;
        let steepness = fall_slope(velocity, p.stribeck_exponent, power, left);
        let excess = latched - p.coulomb;
        // At level 0 there is no force for it to be a share of.
        let viscous = if channels.level.re() == 0.0 {
            S::constant(0.0)
        } else {
            p.viscous * channels.viscous_level / channels.level
        };
        (p.coulomb + excess * left + viscous * velocity.abs(), excess * steepness + viscous)
    }

    /// A force rising from `from` to `to` while the body moves by `distance`, limited to what the
    /// spring gains when the hook stands still: a hook dragged backwards would give back work
    /// that nobody did. Returns the stiffness where the limit holds.
    #[inline(always)]
    pub(super) fn no_faster_than_the_spring(&self, from: S, to: S, distance: S) -> (S, Option<S>) {
        let least = from + self.parameters.final_stiffness * distance;
        if to.re() <= least.re() {
            return (to, None);
        }
        self.held_back(from, to, distance)
    }

    #[cold]
    #[inline(never)]
    fn held_back(&self, from: S, to: S, distance: S) -> (S, Option<S>) {
        let (behind, now) = (from.re(), to.re());
        let most = behind.abs().max(now.abs());
        if most <= self.parameters.breakaway.re() {
            let sure = self.softest.up_to(most) * distance.re();
            if now <= behind - ROUNDING * behind.abs() + sure {
                return (to, None);
            }
        }
        let limit = self.curve.virgin(self.curve.virgin_inverse(from) + distance);
        if to.re() <= limit.force.re() { (to, None) } else { (limit.force, Some(limit.slope)) }
    }

    /// A step of a sliding hook.
    #[inline(never)]
    pub(super) fn slip(
        &self,
        state: &HsiehPanState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> HsiehPanTrial<S> {
        self.slip_within(state, motion, channels)
    }

    /// The same as part of the loop that asks for it.
    #[inline(always)]
    pub(super) fn slip_within(
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
    pub(super) fn slide(
        &self,
        s: f64,
        latched: S,
        series: S,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> Slide<S> {
        let p = &self.parameters;
        // Not through a closure, which would not be part of the loop.
        let (per_velocity, exponent) = (self.per_velocity, p.stribeck_exponent);
        let before = fall_power_by(motion.start_velocity, per_velocity, exponent);
        let after = fall_power_by(motion.velocity, per_velocity, exponent);
        let distance = motion.displacement.abs();
        let per_distance = self.per_distance;
        let z = distance * per_distance;
        let [left, left_before, gone] = fading_twice_and_faded_of(-after, -before, -z);
        let (to, steepness) = self.sliding_level(latched, motion.velocity, (after, left), channels);
        let (from, from_steepness) =
            self.sliding_level(latched, motion.start_velocity, (before, left_before), channels);
        let followed = follow_by(series * s, from, to, z, gone);
        let (sigma, held_back) =
            self.no_faster_than_the_spring(series * s, followed.value, distance);
        let turning = sign(motion.velocity.re());
        let damping = steepness * followed.end_share * channels.level * (s * turning);
        let damping =
            if damping.re() > 0.0 && held_back.is_none() { damping } else { S::constant(0.0) };
        // Held velocity: start and end level move together, and the distance with them.
        let held = steepness * followed.end_share
            + from_steepness * (-(followed.end_share - 1.0) - followed.remainder);
        let catching_up = (to - series * s) * followed.remainder * motion.duration * per_distance;
        let slope = match held_back {
            None => (held + catching_up) * (s * turning),
            Some(stiffness) => stiffness * motion.duration,
        };
        let slope = slope * channels.level;
        let outcome = Outcome { force: sigma * channels.level * s, slope, damping };
        Slide { outcome, series: sigma * s, pull: to - sigma }
    }
}
