//! Steps of a sticking hook.

use super::super::elements::lag::follow;
use super::super::elements::plastic::Creep;
use super::super::elements::series;
use super::super::elements::spring::Walk;
use super::super::{Channels, Motion, Outcome};
use super::HsiehPan;
use super::state::{HsiehPanState, HsiehPanTrial, Mode};
use crate::math::scalar::Scalar;

/// Steps of the reference integrator above this share of τ: Runge-Kutta is good to the fifth power of it.
const LONGEST_FILTER: f64 = 0.3;

impl<S: Scalar> HsiehPan<S> {
    /// A step of a sticking hook.
    #[inline(always)]
    pub(super) fn stick(
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
            return self.stuck(
                state,
                motion,
                step.walk,
                step.force,
                step.creep,
                (outcome, undamped),
            );
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
        let slope =
            walk.end.slope * channels.level * motion.duration * (-(creep.share - 1.0)) + damping;
        let outcome = Outcome { force, slope, damping };
        self.stuck(state, motion, walk, walk.end.force, creep, (outcome, undamped))
    }

    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // what a step has found, apart and not in a struct
    pub(super) fn stuck(
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

    /// Filtered force and break-away level after the series force went from `from` to `to`.
    #[inline(always)]
    pub(super) fn breakaway_after(&self, filtered: S, from: S, to: S, duration: S) -> (S, S) {
        let p = &self.parameters;
        if !self.rated {
            return (filtered, p.breakaway);
        }
        let filtered = follow(filtered, from, to, duration / p.loading_time).value;
        (filtered, self.breakaway_at((to - filtered).abs() / p.loading_time))
    }

    /// The same for the reference integrator, which came to this filtered force by itself. A step of many
    /// averaging times is beyond what Runge-Kutta is stable for, and is taken as the fast one does.
    pub(super) fn breakaway_ahead(
        &self,
        state: &HsiehPanState<S>,
        filtered: S,
        series: S,
        duration: S,
    ) -> (S, S) {
        let p = &self.parameters;
        if !self.rated || duration.re() > LONGEST_FILTER * p.loading_time.re() {
            return self.breakaway_after(state.filtered, state.series, series, duration);
        }
        (filtered, self.breakaway_at((series - filtered).abs() / p.loading_time))
    }

    #[inline(always)]
    pub(super) fn breakaway_at(&self, rate: S) -> S {
        let p = &self.parameters;
        p.coulomb + (p.breakaway - p.coulomb) * (-(rate / p.loading_rate)).exp()
    }
}
