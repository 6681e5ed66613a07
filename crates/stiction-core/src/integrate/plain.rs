//! What a machine is in plain steps, and how it holds a body at rest.

use stiction_dispatch::Task;

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

    /// Puts into its place what acts on this machine and its contact where a step of a row leads; `driving`
    /// says the effort of the drive and a load there, `load` that load; `pull` is what a second mass does.
    #[inline(always)]
    pub fn acting(
        &self,
        at: &mut Situation<S>,
        driving: impl FnOnce(&Situation<S>) -> S,
        load: impl FnOnce() -> S,
        pull: Option<S>,
        there: &mut Acting<S>,
    ) {
        there.driving = driving(at);
        if S::CARRIES {
            return self.acting_apart(at, load(), pull.as_ref(), there);
        }
        let beside = self.added_apart(at);
        there.ambient = pull.map_or(beside, |pull| beside + pull);
        if self.effects.changes_levels() {
            there.levels = self.levels_apart(at, there.driving + there.ambient, load());
        }
    }

    /// The same once for all laws.
    #[inline(never)]
    fn acting_apart(
        &self,
        at: &mut Situation<S>,
        load: S,
        pull: Option<&S>,
        there: &mut Acting<S>,
    ) {
        S::run(ActingThere { machine: self, at, load: &load, pull, there });
    }

    /// Levels of its contact where a run is, likewise.
    #[inline(never)]
    fn levels_of_run(&self, run: &Run<S>, acting: [&S; 2], levels: &mut (S, S)) {
        S::run(LevelsOf { machine: self, run, acting, levels });
    }

    /// Puts into their place the levels of its contact where a run is, under the effort of the drive and a
    /// load, and that load; `arrived` is what was said of the place before the velocity was known.
    #[inline(always)]
    pub fn levels_of(
        &self,
        run: &Run<S>,
        acting: impl FnOnce() -> (S, S),
        arrived: Option<&Acting<S>>,
        levels: &mut (S, S),
    ) {
        match arrived {
            _ if !self.effects.changes_levels() => (),
            Some(arrived) if !self.effects.asks_speed() && !self.effects.remembers() => {
                *levels = arrived.levels;
            }
            _ => {
                let (effort, load) = acting();
                if S::CARRIES {
                    return self.levels_of_run(run, [&effort, &load], levels);
                }
                *levels = self.levels_apart(&mut run.situation(), effort + run.ambient, load);
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

/// What acts where a step leads, as a task: rows of derivatives want the widest vectors.
struct ActingThere<'a, S: Scalar> {
    machine: &'a Machine<S>,
    at: &'a mut Situation<S>,
    load: &'a S,
    pull: Option<&'a S>,
    there: &'a mut Acting<S>,
}

impl<S: Scalar> Task for ActingThere<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { machine, at, load, pull, there } = self;
        there.ambient = machine.added_there(at);
        if let Some(pull) = pull {
            there.ambient += *pull;
        }
        if machine.effects.changes_levels() {
            there.levels = machine.levels_there(at, there.driving + there.ambient, *load);
        }
    }
}

/// Levels where a run is, likewise.
struct LevelsOf<'a, S: Scalar> {
    machine: &'a Machine<S>,
    run: &'a Run<S>,
    acting: [&'a S; 2],
    levels: &'a mut (S, S),
}

impl<S: Scalar> Task for LevelsOf<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { machine, run, acting: [effort, load], levels } = self;
        *levels = machine.levels_there(&mut run.situation(), *effort + run.ambient, *load);
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
