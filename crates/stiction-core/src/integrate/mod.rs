//! Integrators: how a machine and its friction get from one sample to the next.
//!
//! A step is attempted as a whole. Where the law reports that it ran past a change of contact
//! mode, the change is located inside the step, the step is shortened to it, and the rest is
//! attempted in the new mode. Held velocities, the fast integrator and the reference integrator
//! all go through the same loop.

mod adaptive;
mod clock;
mod contact;
mod events;
mod fast;
mod glide;
mod plain;
mod reference;
mod response;
mod row;
mod steep;
mod swing;

pub use adaptive::{Account, Adaptive};
pub use clock::after_steps;
pub use contact::{Along, Held};
use events::through_likely_events;
pub use events::{Stepper, quiet, through_events};
pub use glide::{Acting, Efforts, Glide, Places, Plain, Seen, Stillness};

use std::ops::Range;

use crate::friction::FrictionLaw;
use crate::math::scalar::Scalar;
use crate::plant::{Machine, Run, Work};
use crate::support::error::{Error, Result};
use crate::support::work::{self, Meter};

/// Which integrator advances the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Integrator {
    /// Velocity Verlet with trapezoidal damping: one friction evaluation a step, second order.
    #[default]
    Fast,
    /// Classical Runge-Kutta of fourth order on all internal variables.
    Reference,
}

/// ω·h above which the fast integrator divides a sample: the phase error of its ring is then
/// (ω·h)²/24 ≤ 2e-4 of the phase.
pub const LONGEST_PHASE: f64 = 0.065;
/// (C/J)·h above which a sample is divided: a speed then dies out by (C/J·h)²/12 = 5e-3 too fast.
const LONGEST_DAMPING: f64 = 0.25;
/// The same where a simulation is held against readings: 2e-4, as of a ring.
const CLOSE_DAMPING: f64 = 0.05;

/// What may happen within a step: beyond it a sample is divided.
#[derive(Debug, Clone, Copy)]
pub struct Longest {
    /// ω·h of what swings.
    pub phase: f64,
    /// (C/J)·h of what is damped.
    damping: f64,
}

impl Longest {
    /// As motions are simulated where nobody says otherwise.
    pub const USUAL: Self = Self { phase: LONGEST_PHASE, damping: LONGEST_DAMPING };

    /// Where a simulation is held against readings, and rings followed up to that phase.
    pub fn close(phase: f64) -> Self {
        Self { phase, damping: CLOSE_DAMPING }
    }

    /// (C/J)·h; where rings are followed coarsely twice their ω·h, which is that of a ring that is damped
    /// critically.
    fn damped(self) -> f64 {
        if self.phase > LONGEST_PHASE {
            self.damping.max(2.0 * self.phase).max(LONGEST_DAMPING)
        } else {
            self.damping
        }
    }
}
/// Where friction falls with speed a sample is divided further, to follow the fall, but not
/// without end: the steeper it is, the shorter it lasts.
const MOST_PARTS_FOR_A_FALL: f64 = 16.0;
/// λ·h above which the reference integrator divides a sample for the law's internal variables.
const LONGEST_RATE: f64 = 0.3;
/// A sample that needs more parts than this is a mistake in the units, not a stiff machine; and what a
/// sample may cost is bounded by it.
pub const MOST_PARTS: f64 = 1e4;
/// The reference integrator divides no further for internal variables, however fast they are,
const MOST_INNER: f64 = 1e5;
/// and λ·h above which its steps would run away: its formula is stable up to 2.78.
const STABLE_RATE: f64 = 2.5;

/// A step of the reference integrator, in steps of the fast one.
const REFERENCE: u64 = 5;
/// A step on friction that rises too steeply to be linearised, likewise.
const STEEP: u64 = 10;
/// What the reference makes of such a step.
const STEEP_REFERENCE: u64 = 80;

impl Integrator {
    /// What a step costs, see [`crate::support::work`].
    pub(crate) const fn of_step<S: Scalar>(self, steep: bool) -> u64 {
        let steps = match (self, steep) {
            (Self::Fast, false) => 1,
            (Self::Fast, true) => STEEP,
            (Self::Reference, false) => REFERENCE,
            (Self::Reference, true) => STEEP_REFERENCE,
        };
        work::STEP * steps * if S::CARRIES { work::DERIVATIVES } else { 1 }
    }

    /// What a sample without derivatives costs at most.
    pub(crate) fn dearest_sample(self) -> f64 {
        let parts = if self == Self::Fast { MOST_PARTS } else { MOST_INNER };
        parts * self.of_step::<f64>(true) as f64
    }

    /// Parts of a sample for the internal variables of the law, as fast as they are now; 0 for the fast
    /// integrator, which follows them without.
    #[inline(always)]
    pub(crate) fn inner<S: Scalar, L: FrictionLaw<S>>(
        self,
        law: &L,
        state: &L::State,
        dt: f64,
    ) -> f64 {
        match self {
            Self::Fast => 0.0,
            Self::Reference => (dt * law.fastest_rate(state) / LONGEST_RATE).min(MOST_INNER).ceil(),
        }
    }
}

/// Number of equal parts that a sample of this duration is divided into, so that a step holds no more
/// than `longest`; above [`MOST_PARTS`] the sample is too long for the machine.
pub fn parts<S: Scalar, L: FrictionLaw<S>>(
    machine: &Machine<S>,
    law: &L,
    dt: f64,
    longest: Longest,
) -> f64 {
    let (smooth, falling) = asked_for(machine, law, dt, longest);
    smooth.max(falling).ceil().max(1.0)
}

/// Into how many parts a sample of this duration is to be divided for what swings and is damped, and for
/// the fall of friction with speed.
fn asked_for<S: Scalar, L: FrictionLaw<S>>(
    machine: &Machine<S>,
    law: &L,
    dt: f64,
    longest: Longest,
) -> (f64, f64) {
    let lightest = machine.inertia.re();
    let phase = machine.phase(law.greatest_stiffness(), dt) / longest.phase;
    let damping = dt * (law.greatest_damping() + machine.servo().1) / lightest;
    let calming = damping / longest.damped();
    let falling = dt * law.steepest_fall() / lightest / LONGEST_DAMPING;
    (phase.max(calming), falling.min(MOST_PARTS_FOR_A_FALL))
}

/// How a sample is divided: into steps, and those while friction falls with speed into pieces.
#[derive(Debug, Clone, Copy)]
pub struct Division {
    /// Equal steps of a sample, a whole number.
    pub steps: f64,
    /// Equal pieces of a step that begins where friction falls, and the shortest of one in which it comes
    /// to that.
    pub pieces: u32,
}

impl Division {
    /// That of a sample of this duration, so that a step holds no more than `longest`.
    ///
    /// What falls with speed at times alone, a contact that has broken away, is followed at those times: while
    /// it holds, a fall that is not there asks for nothing.
    pub fn of<S: Scalar, L: FrictionLaw<S>>(
        machine: &Machine<S>,
        law: &L,
        dt: f64,
        longest: Longest,
        integrator: Integrator,
    ) -> Self {
        if !L::FALLS_AT_TIMES || integrator == Integrator::Reference {
            return Self { steps: parts(machine, law, dt, longest), pieces: 1 };
        }
        let (smooth, falling) = asked_for(machine, law, dt, longest);
        let steps = smooth.ceil().max(1.0);
        Self { steps, pieces: (falling / steps).ceil().max(1.0) as u32 }
    }
}

/// The steps of a sample, as numbers.
#[derive(Debug, Clone, Copy)]
pub struct Steps<S> {
    /// Duration of a step.
    pub span: S,
    /// Pieces of one, and how long they last.
    pub pieces: u32,
    /// Duration of a piece.
    pub piece: S,
}

impl<S: Scalar> Steps<S> {
    /// Those of a sample of this duration, divided so.
    #[inline(always)]
    pub fn of(dt: f64, steps: u32, pieces: u32) -> Self {
        let span = S::constant(dt / f64::from(steps));
        let piece = if pieces == 1 {
            span
        } else {
            S::constant(dt / (f64::from(steps) * f64::from(pieces)))
        };
        Self { span, pieces, piece }
    }

    /// Whether a step from here is made in pieces.
    #[inline(always)]
    pub fn goes_in_pieces<L: FrictionLaw<S>>(&self, law: &L, state: &L::State) -> bool {
        L::FALLS_AT_TIMES && self.pieces > 1 && law.falls(state)
    }
}

/// Level of friction up to which a sample is divided as at level 1: ω·h and (C/J)·h may be larger than
/// their limits by far before a step runs away, and most levels are near 1.
const MOST_LEVEL: f64 = 4.0;

/// Whether a machine that does not damp needs no finer steps at these levels, whatever else there is.
#[inline(always)]
fn levels_are_fine<S: Scalar>((level, viscous): (S, S)) -> bool {
    level.re() <= MOST_LEVEL && viscous.re() <= MOST_LEVEL
}

/// How many times the parts of a sample that [`parts`] tells are to be, because of what effects make of
/// the contact where a run is and within such a part, of duration `dt`.
pub fn finer<S: Scalar, L: FrictionLaw<S>>(
    machine: &Machine<S>,
    law: &L,
    run: &Run<S>,
    (input, load): (S, S),
    dt: f64,
) -> f64 {
    if !machine.effects.strains() {
        return 1.0;
    }
    let (level, viscous) = if machine.effects.changes_levels() {
        let at = run.situation();
        let effort = machine.driven(input, &at) + load + run.ambient;
        machine.effects.levels(&machine.at_contact(&at, effort, load))
    } else {
        (S::constant(1.0), S::constant(1.0))
    };
    let share = dt / machine.inertia.re() / (MOST_LEVEL * LONGEST_DAMPING);
    let raised = level.re().max(viscous.re());
    let calming = if raised > MOST_LEVEL { law.greatest_damping() * raised } else { 0.0 };
    let damping = machine.effects.damping(machine.reached(run, input, load, dt));
    let calming = (calming + damping) * share;
    (level.re() / MOST_LEVEL).sqrt().max(calming).ceil().max(1.0)
}

/// One step of the fast integrator under a held input and load, in which a mode is likely to change;
/// `BARE` as in [`sample`].
#[inline]
pub fn step<S: Scalar, L: FrictionLaw<S>, const BARE: bool>(
    machine: &Machine<S>,
    law: &L,
    state: &mut L::State,
    run: &mut Run<S>,
    input: S,
    load: S,
    steps: Steps<S>,
) {
    let whole = !steps.goes_in_pieces(law, state);
    let mut stepper = fast::Fast::<S, BARE> { machine, run, input, load, piece: steps.piece.re() };
    let (number, span) = if whole { (1, steps.span) } else { (steps.pieces, steps.piece) };
    for _ in 0..number {
        through_likely_events(&mut stepper, law, state, span);
    }
}

/// Advances body and friction by these pieces of the equal steps of a sample whose input and load are held
/// (the reference integrator by all of it, in steps of its own); a step is one piece where `pieces` is 1.
/// Where that is too much work, it ends in the middle. `BARE` promises
/// [`Machine::is_bare`]: the same to the bit, without asking at every step for what is not there.
#[allow(clippy::too_many_arguments)] // the parts of a motor, borrowed apart
pub fn sample<S: Scalar, L: FrictionLaw<S>, const BARE: bool>(
    machine: &Machine<S>,
    law: &L,
    state: &mut L::State,
    run: &mut Run<S>,
    input: S,
    load: S,
    dt: f64,
    (steps, pieces): (Range<u32>, u32),
    integrator: Integrator,
    meter: &mut Meter,
) -> Result<()> {
    let parts = steps.end / pieces;
    let cost = integrator.of_step::<S>(L::STEEP);
    match integrator {
        Integrator::Fast => {
            let each = Steps::<S>::of(dt, parts, pieces);
            let piece = each.piece.re();
            let mut stepper = fast::Fast::<S, BARE> { machine, run, input, load, piece };
            let counts = !BARE && machine.counts_work();
            let rough = |span: S| machine.roughness(law.greatest_stiffness(), span.re());
            let mut work =
                counts.then(|| Work::begin(machine, stepper.run, (input, load), (0.0, 0.0)));
            let mut passed = steps.start;
            while passed < steps.end {
                // A step that was begun in pieces is ended so.
                let begun = L::FALLS_AT_TIMES && passed % pieces != 0;
                let whole = !begun && !each.goes_in_pieces(law, state);
                let (span, taken) = if whole { (each.span, pieces) } else { (each.piece, 1) };
                through_events(&mut stepper, law, state, span);
                if let Some(work) = &mut work {
                    (work.rough, work.span) = (rough(span), span.re());
                    work.count(machine, stepper.run);
                }
                meter.take(cost)?;
                passed += taken;
            }
        }
        Integrator::Reference => {
            let mut left = parts.max(integrator.inner(law, state, dt) as u32);
            let mut parts = left;
            let mut stepper = reference::Reference { machine, run, input, load };
            let span = dt / f64::from(parts);
            let rough = machine.roughness(law.greatest_stiffness(), span);
            let mut work = Work::begin(machine, stepper.run, (input, load), (rough, span));
            while left > 0 && !stepper.run.is_lost() {
                let before = (law.decay_rate(state) > 0.0).then(|| (state.clone(), *stepper.run));
                through_events(&mut stepper, law, state, S::constant(dt / f64::from(parts)));
                meter.take(cost)?;
                // What has become faster in it than so long a step can follow is gone through again.
                let rate = law.decay_rate(state);
                let followed = dt * rate <= f64::from(parts) * STABLE_RATE;
                if let Some((state_before, run_before)) = before
                    && !followed
                {
                    if f64::from(parts) >= MOST_INNER {
                        let longest = MOST_INNER * STABLE_RATE / rate.max(MOST_INNER / dt);
                        return Err(Error::TooLong { given: dt, longest });
                    }
                    (*state, *stepper.run) = (state_before, run_before);
                    (left, parts) = (2 * left, 2 * parts);
                    continue;
                }
                left -= 1;
                if !BARE && machine.counts_work() {
                    work.count(machine, stepper.run);
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::FrictionLaw;
    use crate::friction::coulomb::Coulomb;
    use crate::friction::elements::plastic::Plastic;
    use crate::plant::Shaft;
    use crate::plant::body::Body;
    use crate::plant::drive::Drive;
    use crate::plant::effects::Effects;
    use crate::plant::sensor::Sensor;

    const INERTIA: f64 = 0.01;

    fn machine() -> Machine<f64> {
        Machine::new(
            Drive { gain: 1.0, limit: f64::INFINITY, servo: None },
            Body::new(INERTIA, 0.0, 0.0, 0.0),
            Effects::new([]),
            Sensor::default(),
            1.0,
        )
    }

    /// F_c, F_s, v_s, δ, F_v.
    fn coulomb(level: f64) -> Coulomb<f64> {
        Coulomb::build(&[level, level, 0.1, 2.0, 0.0], &[])
    }

    fn run(
        machine: &Machine<f64>,
        law: &Coulomb<f64>,
        input: f64,
        integrator: Integrator,
    ) -> Vec<Run<f64>> {
        let (mut state, mut run) = (law.initial(), machine.start(0.0, 0.0));
        let dt = 1e-4;
        let parts = parts(machine, law, dt, Longest::USUAL) as u32;
        (0..5000)
            .map(|_| {
                sample::<_, _, false>(
                    machine,
                    law,
                    &mut state,
                    &mut run,
                    input,
                    0.0,
                    dt,
                    (0..parts, 1),
                    integrator,
                    &mut Meter::of_a_sample(),
                )
                .unwrap();
                run
            })
            .collect()
    }

    #[test]
    fn a_second_mass_swings_on_its_shaft() {
        let (share, stiffness, input) = (0.4, 50.0, 0.2);
        let mut machine = machine();
        let inertia = INERTIA * share;
        machine.shaft =
            Some(Shaft { inertia, stiffness, damping: 0.0, play: None, load_damping: 0.0 });
        machine.inertia = INERTIA * (1.0 - share);
        machine.lightness = 1.0 / machine.inertia;
        let omega = (stiffness / (INERTIA * share * (1.0 - share))).sqrt();
        for integrator in [Integrator::Fast, Integrator::Reference] {
            for (k, run) in run(&machine, &coulomb(0.0), input, integrator).iter().enumerate() {
                let t = (k + 1) as f64 * 1e-4;
                // The centre of mass accelerates evenly; the twist swings about its mean.
                let centre = 0.5 * input / INERTIA * t * t;
                let twist = input * share / stiffness * (1.0 - (omega * t).cos());
                let position = centre + share * twist;
                let swing = 2.0 * input * share / stiffness;
                assert!((run.position - position).abs() < 2e-3 * share * swing);
                let held_back = run.position - run.second_position;
                assert!((held_back - twist).abs() < 2e-3 * swing);
            }
        }
    }

    #[test]
    fn a_relaxing_contact_creeps_while_it_holds() {
        let mut machine = machine();
        machine.relaxation = Some(Plastic { coefficient: 1e-3, exponent: 2.0, rate: 3.0 });
        let runs = run(&machine, &coulomb(1.0), 0.5, Integrator::Fast);
        for (k, run) in runs.iter().enumerate() {
            let t = (k + 1) as f64 * 1e-4;
            let exact = 1e-3 * 0.25 * (1.0 - (-3.0 * t).exp());
            assert!((run.position - exact).abs() < 1e-12);
            assert_eq!(run.friction, 0.5);
        }
    }
}
