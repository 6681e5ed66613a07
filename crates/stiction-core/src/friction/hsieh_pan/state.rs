//! What the contact keeps, and what a step would make of it.

use super::super::elements::loading::Curve;
use super::super::elements::spring::{SpringState, Walk};
use super::super::{Entry, LawState, Outcome, Statistics};
use crate::math::scalar::Scalar;

/// State of [`HsiehPan`]; forces are those at level 1.
#[derive(Debug, Clone)]
pub struct HsiehPanState<S> {
    /// 0 sticks, ±1 slides in that direction.
    pub(super) mode: f64,
    /// Spring; while sliding only its force is meaningful.
    pub(super) spring: SpringState<S>,
    /// Force through the series: that of the spring, plus the damper's where it sits there.
    pub(super) series: S,
    pub(super) plastic: S,
    pub(super) hardening: S,
    /// Level at which the slide began.
    pub(super) latched: S,
    /// Series force behind a lag of τ.
    pub(super) filtered: S,
    /// Break-away level at the end of the last step.
    pub(super) breakaway: S,
    pub(super) curve: Curve<S>,
    pub(super) statistics: Statistics,
}

/// A step of [`HsiehPan`].
#[derive(Debug, Clone, Copy)]
pub struct HsiehPanTrial<S> {
    pub(super) outcome: Outcome<S>,
    /// Force without the part that the velocity at the end damps.
    pub(super) undamped: S,
    pub(super) series: S,
    pub(super) filtered: S,
    pub(super) breakaway: S,
    pub(super) mode: Mode<S>,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Mode<S> {
    Stick {
        walk: Walk<S>,
        plastic: S,
        hardening: S,
    },
    /// `pull` is T − s·σ: how far the force lags behind its sliding level.
    Slip {
        pull: S,
    },
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
        Statistics {
            memory_growths: self.spring.memory.growths(),
            memory_merged: self.spring.memory.merged(),
            ..self.statistics
        }
    }

    fn make_room(&mut self, steps: usize) {
        self.spring.memory.make_room(steps);
    }
}
