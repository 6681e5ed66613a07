//! A motor over some number type, on its way.

use super::MotorSpec;
use super::applied::{AHEAD, Ahead, Applied, Notes};
use super::column::{Rows, Showing, Told};
use crate::friction::{AnyState, FrictionLaw, Law, LawState, Statistics};
use crate::integrate::{
    Division, Glide, Integrator, Longest, MOST_PARTS, Plain, Steps, finer, parts, sample,
};
use crate::math::scalar::Scalar;
use crate::plant::drive::{Way, arriving};
use crate::plant::{Before, ByPlace, Machine, Run};
use crate::simulate::model::CHUNK;
use crate::simulate::range::{Range, ordinary_motor};
use crate::support::error::{Error, Result};
use crate::support::samples::{PerSample, Surroundings};
use crate::support::work::{self, Meter};

fn whole_parts(parts: f64, most: f64, dt: f64) -> Result<u32> {
    if parts <= most {
        return Ok(parts as u32);
    }
    Err(Error::TooLong { given: dt, longest: dt * most / parts })
}

/// A motor over some number type, with its running state.
#[derive(Debug, Clone)]
pub struct Running<S: Scalar> {
    /// Everything but friction.
    pub machine: Machine<S>,
    /// Friction law.
    pub law: Law<S>,
    /// Friction state.
    pub state: AnyState<S>,
    /// Body.
    pub run: Run<S>,
    /// Inputs on their way to the drive, where an effect delays them or lets them lag.
    pub way: Option<Way<S>>,
    /// Integrator.
    pub integrator: Integrator,
    /// What its steps hold at most.
    pub longest: Longest,
    /// Parts of a sample above which it refuses to go on.
    pub most_parts: f64,
    /// Within what a step needs no watch.
    pub(crate) range: Range,
    /// Work that the next runs may make together; what their samples allow without it.
    pub(crate) allowance: Option<f64>,
}

impl<S: Scalar> Running<S> {
    /// Branch counters of the contact.
    pub fn statistics(&self) -> Statistics {
        with_state!(&self.state, |state| state.statistics())
    }

    /// At rest at 0, never moved.
    pub fn new(spec: &MotorSpec, values: &[S]) -> Self {
        let (machine, law) = spec.build(values);
        let state = law.initial();
        let zero = S::constant(0.0);
        let run = machine.start(zero, zero);
        let own = &machine.effects;
        let (delay, slowness, lag) = (own.delay(), own.slowness(), own.lag());
        let any = delay.is_some() || slowness.is_some() || lag.is_some();
        let way = any.then(|| Way::new(delay, slowness, lag));
        let integrator = spec.integrator;
        let plain: Vec<f64> = values.iter().map(|value| value.re()).collect();
        let a_second = with_law!(&law, |law| parts(&machine, law, 1.0, Longest::USUAL));
        // How finely the reference divides hangs on its state.
        let ordinary = integrator == Integrator::Fast && ordinary_motor(spec, &plain);
        let range = Range::new(ordinary, a_second);
        Self {
            machine,
            law,
            state,
            run,
            way,
            integrator,
            longest: Longest::USUAL,
            most_parts: MOST_PARTS,
            range,
            allowance: None,
        }
    }

    /// Goes on from where another motor is; its state depends on no parameter of this one.
    pub fn resume(&mut self, from: &Running<f64>) {
        self.state = from.state.lift();
        self.run = from.run.lift();
        self.machine.effects.resume(&from.machine.effects);
        self.machine.refresh(&mut self.run);
        self.range.follow(&from.range);
        if let (Some(way), Some(from)) = (&mut self.way, &from.way) {
            way.resume(from);
        }
    }

    /// Refuses a sample that is too long.
    pub(crate) fn check_step(&self, dt: f64) -> Result<()> {
        whole_parts(self.parts(dt), self.most_parts, dt).map(|_| ())
    }

    /// What a sample of this duration costs at least, see [`crate::support::work`].
    pub(crate) fn cost(&self, dt: f64) -> f64 {
        self.parts(dt) * self.of_step() as f64
    }

    /// The same where this run is under that load.
    pub(crate) fn cost_here(&self, load: f64, dt: f64) -> f64 {
        let Division { steps, .. } = self.division(dt);
        with_law_and_state!(&self.law, &self.state, |law, state| {
            let finer = finer(
                &self.machine,
                law,
                &self.run,
                (S::constant(0.0), S::constant(load)),
                dt / steps,
            );
            let whole = (steps * finer).max(self.integrator.inner(law, state, dt));
            whole * self.of_step() as f64
        })
    }

    /// What a step costs.
    fn of_step(&self) -> u64 {
        with_law!(&self.law, |law| self.integrator.of_step::<S>(steep(law)))
    }

    /// Steps of a sample of this duration.
    fn parts(&self, dt: f64) -> f64 {
        self.division(dt).steps
    }

    /// How a sample of this duration is divided, but for what effects make of it.
    pub fn division(&self, dt: f64) -> Division {
        let (machine, longest) = (&self.machine, self.longest);
        with_law!(&self.law, |law| Division::of(machine, law, dt, longest, self.integrator))
    }

    /// Takes what acts beside input and load in a sample to the run.
    pub(crate) fn surround(&mut self, around: &Surroundings<'_>, sample: usize) {
        self.run.transmitted = around.transmitted_at(sample);
        self.run.temperature = around.temperature_at(sample);
        self.run.enabled = around.enabled_at(sample);
    }

    /// One sample, at the temperature of the run.
    #[inline]
    pub fn step(&mut self, input: f64, load: f64, dt: f64) -> Result<()> {
        self.step_within(input, load, dt, &mut Meter::of_a_sample())
    }

    /// The same where its work is counted with that of others.
    #[inline]
    pub(crate) fn step_within(
        &mut self,
        input: f64,
        load: f64,
        dt: f64,
        meter: &mut Meter,
    ) -> Result<()> {
        self.step_moved((input, load), [None, None], dt, meter)
    }

    /// The same with something added to input and load that may depend on parameters.
    #[inline(always)]
    pub(crate) fn step_moved(
        &mut self,
        (input, load): (f64, f64),
        [more_input, more_load]: [Option<S>; 2],
        dt: f64,
        meter: &mut Meter,
    ) -> Result<()> {
        with_law_and_state!(&self.law, &mut self.state, |law, state| {
            let Division { steps, pieces } =
                Division::of(&self.machine, law, dt, self.longest, self.integrator);
            let finer = finer(
                &self.machine,
                law,
                &self.run,
                (S::constant(input), S::constant(load)),
                dt / steps,
            );
            let parts = pieces * whole_parts(steps * finer, self.most_parts, dt)?;
            state.make_room(parts as usize + CHUNK / 4);
            let before = Before::of(&self.run);
            let arrived = arriving(&mut self.way.as_mut(), input, more_input, dt);
            let load = more_load.map_or(S::constant(load), |more| more + load);
            let whole =
                if self.machine.is_bare() { sample::<_, _, true> } else { sample::<_, _, false> };
            whole(
                &self.machine,
                law,
                state,
                &mut self.run,
                arrived,
                load,
                dt,
                (0..parts, pieces),
                self.integrator,
                meter,
            )?;
            self.machine.wind(&mut self.run, arrived, dt);
            self.machine.remember(before, &mut self.run);
            Ok(())
        })
    }

    /// Samples; `row` sees the body, the machine and one state of the law after each.
    pub fn simulate(
        &mut self,
        inputs: &[f64],
        around: Surroundings<'_>,
        dt: PerSample<'_>,
        row: impl FnMut(usize, &Run<S>, &Machine<S>, &dyn Fn(usize) -> S),
    ) -> Result<()> {
        self.simulate_under(inputs, around, |_| S::constant(0.0), dt, row)
    }

    /// As [`Self::simulate`], with a load added that may depend on parameters.
    pub(crate) fn simulate_under(
        &mut self,
        inputs: &[f64],
        around: Surroundings<'_>,
        added: impl Fn(usize) -> S,
        dt: PerSample<'_>,
        row: impl FnMut(usize, &Run<S>, &Machine<S>, &dyn Fn(usize) -> S),
    ) -> Result<()> {
        self.simulate_rows(inputs, around, added, dt, Told(row))
    }

    /// As [`Self::simulate_under`], for one who sees the samples in the loop itself.
    pub(crate) fn simulate_rows(
        &mut self,
        inputs: &[f64],
        around: Surroundings<'_>,
        added: impl Fn(usize) -> S,
        dt: PerSample<'_>,
        rows: impl Rows<S>,
    ) -> Result<()> {
        let longest = dt.greatest();
        whole_parts(self.parts(longest), self.most_parts, longest)?;
        let mut meter = Meter::new(self.allowance.unwrap_or_else(|| work::allowed(inputs.len())));
        meter.foresee(self.foreseen(&around, dt, inputs.len()))?;
        let by_place = if S::CARRIES { None } else { self.by_place(&around) };
        let effort_alone = by_place.is_some_and(|it| it.is_effort_alone());
        let done = if self.goes_bare(&around) {
            self.simulate_kind::<true, false>(inputs, around, added, dt, rows, None, &mut meter)
        } else if !S::CARRIES && effort_alone {
            // Not with derivatives, where a third kind would be as much code again.
            self.simulate_kind::<false, false>(
                inputs, around, added, dt, rows, by_place, &mut meter,
            )
        } else {
            self.simulate_kind::<false, true>(inputs, around, added, dt, rows, by_place, &mut meter)
        };
        self.allowance = self.allowance.map(|_| meter.left());
        done
    }

    /// What samples cost at least.
    pub(crate) fn foreseen(
        &self,
        around: &Surroundings<'_>,
        dt: PerSample<'_>,
        samples: usize,
    ) -> f64 {
        let parts = match dt {
            PerSample::Same(dt) => self.parts(dt) * samples as f64,
            PerSample::Each(values) => self.parts(values.iter().sum()),
        };
        let plain = self.has_rows();
        let cost = with_law!(&self.law, |law| if plain && law.glides() {
            work::in_a_row::<S>() * (law.glide_cost() + self.cost_in_a_row(around))
        } else {
            self.of_step()
        });
        parts * cost as f64
    }

    /// Whether efforts are made of inputs and loads alone, and may be ahead of the row.
    fn goes_bare(&self, around: &Surroundings<'_>) -> bool {
        let ahead = !S::CARRIES || self.way.is_none();
        self.machine.is_bare() && around.is_steady() && ahead
    }

    /// What goes by the place, where that is all there is beside a bare machine.
    fn by_place(&self, around: &Surroundings<'_>) -> Option<ByPlace> {
        if around.is_steady() && self.way.is_none() { self.machine.by_place() } else { None }
    }

    /// Whether plain steps of this motor go in rows.
    fn has_rows(&self) -> bool {
        self.machine.has_rows() && self.integrator == Integrator::Fast
    }

    /// What a step in a row costs beside that of its law.
    fn cost_in_a_row(&self, around: &Surroundings<'_>) -> u64 {
        if self.goes_bare(around) {
            return 0;
        }
        self.machine.effects.cost_in_a_row() + u64::from(self.machine.drive.servo.is_some())
    }

    #[expect(clippy::too_many_arguments, reason = "one loop, which has all of them")]
    fn simulate_kind<const BARE: bool, const LEVELS: bool>(
        &mut self,
        inputs: &[f64],
        around: Surroundings<'_>,
        added: impl Fn(usize) -> S,
        dt: PerSample<'_>,
        mut rows: impl Rows<S>,
        mut by_place: Option<ByPlace>,
        meter: &mut Meter,
    ) -> Result<()> {
        let plain = self.has_rows();
        let strains = LEVELS && self.machine.effects.strains();
        // What is said of the drive without asking where the body is holds while it is on.
        let drives_by_place = LEVELS && (self.machine.drives_by_place() || !around.is_steady());
        let swings = LEVELS && self.machine.shaft.is_some();
        // How finely a sample goes hangs on its input before anything holds that up.
        let alone = LEVELS && (!around.is_steady() || (strains && self.way.is_some()));
        let beside = self.cost_in_a_row(&around);
        let mut way = self.way.as_mut();
        let mut early = if BARE { way.take() } else { None };
        // Whether what becomes of inputs is made ahead of the row.
        let changed =
            BARE && !S::CARRIES && (early.is_some() || self.machine.effects.maps_inputs());
        let mut notes = Notes::new(&self.machine, way, &self.run);
        let notes_any = notes.any();
        with_law_and_state!(&self.law, &mut self.state, |law, state| {
            let glides = plain && law.glides();
            let each = law.glide_cost() + beside;
            let mut known = f64::NAN;
            let (mut plainly, mut divided, mut pieces) = (1.0, 1, 1);
            let (longest, integrator) = (self.longest, self.integrator);
            let mut room = 0;
            let mut ahead = Ahead::default();
            let mut index = 0;
            while index < inputs.len() {
                let dt_now = dt.at(index);
                if dt_now != known {
                    let division = Division::of(&self.machine, law, dt_now, longest, integrator);
                    (plainly, pieces) = (division.steps, division.pieces);
                    divided = whole_parts(plainly, self.most_parts, dt_now)?;
                    known = dt_now;
                }
                self.run.transmitted = around.transmitted_at(index);
                self.run.temperature = around.temperature_at(index);
                self.run.enabled = around.enabled_at(index);
                if strains {
                    let load = added(index) + around.load.at(index);
                    let finer = finer(
                        &self.machine,
                        law,
                        &self.run,
                        (S::constant(inputs[index]), load),
                        dt_now / plainly,
                    );
                    divided = whole_parts(plainly * finer, self.most_parts, dt_now)?;
                }
                let mut passed = 0;
                if glides && (!BARE || self.machine.glides(&self.run)) {
                    let steps = Steps::of(dt_now, divided, pieces);
                    let finely = steps.goes_in_pieces(law, state);
                    let (span, parts) = if finely {
                        (steps.piece, divided * pieces)
                    } else {
                        (steps.span, divided)
                    };
                    let machine = &mut self.machine;
                    let asked = S::CARRIES || drives_by_place || notes.holds_up();
                    if changed {
                        let effort = |k: usize, input: f64| {
                            machine.bare_effort(input, added(k) + around.load.at(k)).re()
                        };
                        let through = (&machine.effects, effort);
                        ahead.reach_through(index, inputs, dt, &mut early, through);
                    } else if !asked {
                        ahead.reach(index, inputs, around.load, |k, input, load| {
                            let load = added(k) + load;
                            let effort = if BARE {
                                machine.bare_effort(input, load)
                            } else {
                                machine.driven_directly(input, load)
                            };
                            effort.re()
                        });
                    }
                    // Not to the end, which would be looked for anew after every event.
                    let end = if asked { inputs.len().min(index + AHEAD) } else { ahead.end() };
                    let end = if alone { index + 1 } else { dt.same_until(index, end) };
                    let most = if S::CARRIES { MOST_AT_ONCE / 8 } else { MOST_AT_ONCE };
                    let end = end.min(index + 1 + most / parts as usize);
                    notes.begin(&self.run);
                    let verlet = machine.verlet(span);
                    let (counts, rough) = if !LEVELS {
                        (false, 0.0)
                    } else {
                        let rough = machine.roughness(law.greatest_stiffness(), span.re());
                        (machine.counts_work(), rough)
                    };
                    let mut efforts = Applied::<_, _, BARE, LEVELS> {
                        machine,
                        inputs,
                        around,
                        added: &added,
                        ahead: &mut ahead,
                        notes: &mut notes,
                        by_place: &mut by_place,
                        plainly: !drives_by_place && !swings && !notes_any,
                        drives_by_place,
                        swings,
                        dt: dt_now,
                        span,
                        end,
                        counts,
                        rough,
                    };
                    if LEVELS {
                        efforts.begin(index);
                    }
                    let begun = index;
                    let (samples, state) = (index..end, &mut *state);
                    let step = (verlet, parts);
                    (self.run, index, passed) = if S::CARRIES {
                        let seen = Showing(&mut rows);
                        let mut glide = Glide::new(self.run, efforts, seen, samples, step);
                        S::run(Plain { law, state, glide: &mut glide });
                        (glide.run, glide.samples.start, glide.part)
                    } else if !LEVELS && let Some(places) = rows.places(samples.clone()) {
                        let glide = Glide::new(self.run, efforts, places, samples, step);
                        S::run(Plain { law, state, glide })
                    } else {
                        let seen = Showing(&mut rows);
                        let glide = Glide::new(self.run, efforts, seen, samples, step);
                        S::run(Plain { law, state, glide })
                    };
                    room = 0; // what the glide has left of it nobody counted
                    if !finely {
                        passed *= pieces;
                    }
                    let steps = (index - begun) as u64 * u64::from(parts);
                    let begin = if alone { work::A_ROW } else { 0 };
                    meter.take((begin + steps * each) * work::in_a_row::<S>())?;
                    // Also what needs other steps from here on.
                    if index == end || (strains && index > begun && passed == 0) {
                        continue;
                    }
                }
                if self.run.is_lost() {
                    let seen = &*state;
                    rows.see(index, &self.run, &self.machine, |column| seen.output(column));
                    notes.give_up();
                    index += 1;
                    continue;
                }
                let left = divided * pieces - passed;
                if room < left {
                    // Once a chunk where samples are not divided, never inside a step.
                    room = (CHUNK as u32).max(left);
                    state.make_room(room as usize + CHUNK / 4);
                }
                room -= left;
                if passed == 0 {
                    notes.begin(&self.run);
                }
                let arrived = match (&mut early, ahead.arrived(index)) {
                    (Some(_), Some(arrived)) => S::constant(arrived),
                    (Some(way), None) => way.pass(inputs[index], None, dt_now),
                    (None, _) => notes.arriving(inputs[index], dt_now),
                };
                sample::<_, _, BARE>(
                    &self.machine,
                    law,
                    state,
                    &mut self.run,
                    arrived,
                    added(index) + around.load.at(index),
                    dt_now,
                    (passed..divided * pieces, pieces),
                    integrator,
                    meter,
                )?;
                self.machine.wind(&mut self.run, arrived, dt_now);
                self.machine.remember(notes.before, &mut self.run);
                let seen = &*state;
                rows.see(index, &self.run, &self.machine, |column| seen.output(column));
                index += 1;
            }
        });
        Ok(())
    }
}

/// Whether friction of a law rises too steeply to be linearised.
const fn steep<S: Scalar, L: FrictionLaw<S>>(_: &L) -> bool {
    L::STEEP
}

/// Steps of a row of plain steps after which is asked whether to go on.
const MOST_AT_ONCE: usize = 1 << 15;
