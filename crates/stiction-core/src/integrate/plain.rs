//! What a machine is in plain steps, and how it holds a body at rest.

use super::glide::{Acting, Stillness};
use super::levels_are_fine;
use crate::friction::FrictionLaw;
use crate::math::scalar::Scalar;
use crate::math::verlet::Verlet;
use crate::plant::effects::Situation;
use crate::plant::{Machine, Run};

impl<S: Scalar> Machine<S> {
    /// Whether a run is as a step of this bare machine leaves it.
    pub fn glides(&self, run: &Run<S>) -> bool {
        run.ambient.re().to_bits() == self.weight().re().to_bits()
    }

    /// The share of this machine in a step of this duration.
    #[inline]
    pub fn verlet(&self, span: S) -> Verlet<S> {
        Verlet::new(span, self.inertia, self.lightness)
    }

    /// What acts on this machine and its contact where a step leads that is in a row; `driving` says the effort
    /// of the drive and a load there, `load` that load; `pull` is what a second mass does.
    #[inline(always)]
    pub fn acting(
        &self,
        at: &Situation<S>,
        driving: impl FnOnce(&Situation<S>) -> S,
        load: impl FnOnce() -> S,
        pull: Option<S>,
    ) -> Acting<S> {
        let beside = self.surroundings(at);
        let ambient = pull.map_or(beside, |pull| beside + pull);
        let driving = driving(at);
        if !self.effects.changes_levels() {
            return Acting { driving, ..Acting::plain(ambient) };
        }
        let at = self.at_contact(at, driving + ambient, load());
        Acting { driving, ambient, levels: self.effects.levels(&at) }
    }

    /// Levels of its contact where a run is, under the effort of the drive and a load, and that load; `arrived`
    /// is what was said of the place before the velocity was known.
    #[inline(always)]
    pub fn levels_of(
        &self,
        run: &Run<S>,
        acting: impl FnOnce() -> (S, S),
        arrived: Option<&Acting<S>>,
    ) -> (S, S) {
        match arrived {
            _ if !self.effects.changes_levels() => Acting::plain(run.ambient).levels,
            Some(arrived) if !self.effects.asks_speed() && !self.effects.remembers() => arrived.levels,
            _ => {
                let (effort, load) = acting();
                let at = self.at_contact(&run.situation(), effort + run.ambient, load);
                self.effects.levels(&at)
            }
        }
    }

    /// Whether a sample of this machine that begins under these levels, this effort and at this speed needs no
    /// finer steps than `span`.
    #[inline(always)]
    pub fn is_fine(&self, speed: f64, effort: f64, levels: (S, S), span: f64) -> bool {
        levels_are_fine(levels) && (!self.effects.damps() || self.is_calm(speed, effort, span))
    }

    /// The same of what damps.
    #[inline(never)]
    fn is_calm(&self, speed: f64, effort: f64, span: f64) -> bool {
        let gained = effort.abs() * span / self.inertia.re();
        let damping = self.effects.damping(gained + speed.abs());
        // What `reached` says is no faster, and effects damp no less at a speed than below it.
        damping * (span / self.inertia.re()) <= 0.999
    }

    /// What changes around a contact of this machine at rest, under efforts up to that.
    pub fn stillness(&self, run: &Run<S>, greatest: f64, levels: (S, S), span: S) -> Stillness {
        let mut settled = *run;
        self.refresh(&mut settled);
        let same = settled.ambient.re().to_bits() == run.ambient.re().to_bits();
        let rough = || self.roughness(0.0, span.re());
        let paid = !self.counts_work() || run.budget.taken.re() >= -rough() * run.budget.swing;
        if !(same && paid && self.is_fine(0.0, greatest, levels, span.re())) {
            Stillness::Not
        } else if self.effects.changes_in_time() {
            Stillness::Changing
        } else {
            Stillness::Whole
        }
    }
}

/// Holds a resting body for `span` where the contact can: nothing moves but slow creep.
#[inline]
pub(super) fn hold<S: Scalar, L: FrictionLaw<S>>(
    machine: &Machine<S>,
    run: &mut Run<S>,
    (input, load): (S, S),
    law: &L,
    state: &mut L::State,
    span: S,
) -> bool {
    let at = run.situation();
    let effort = machine.driven(input, &at) + load + run.ambient;
    if !law.holds(state, &machine.channels(&at, effort, load)) {
        return false;
    }
    run.friction = effort;
    run.time += span;
    // A second mass goes on swinging on the shaft of a motor that is held.
    machine.swing(&at, &at, span, run);
    if machine.relaxes() {
        let (hardened, crept) = machine.relax(run.relaxed, effort, span);
        let crept =
            machine.not_faster(effort, machine.not_beyond(effort, crept), run.relaxed, span);
        run.relaxed = hardened;
        run.position += crept;
        run.moved += crept;
        run.path += crept.abs();
    }
    machine.refresh(run);
    true
}
