//! What acts on a motor in a row of plain steps, sample by sample.

use super::column::OfMachine;
use crate::integrate::{Acting, Efforts, Stillness};
use crate::math::scalar::Scalar;
use crate::plant::drive::{Way, arriving};
use crate::plant::effects::{Effects, Situation};
use crate::plant::{Before, ByPlace, Machine, Run};
use crate::simulate::model::CHUNK;
use crate::support::samples::{PerSample, Surroundings};

/// What is noted from sample to sample.
pub(super) struct Notes<'a, S: Scalar> {
    /// Whether anything is.
    any: bool,
    /// Whether the machine takes note of samples that have ended.
    takes: bool,
    /// What holds the input up.
    way: Option<&'a mut Way<S>>,
    /// What has arrived of it in the present sample, and the effort that it makes with the load.
    arrived: Option<S>,
    held: Option<S>,
    /// Where the run was before that sample.
    pub(super) before: Before<S>,
    /// Where a second mass is and how fast at the end of a step that is looked at.
    second: (S, S),
}

impl<'a, S: Scalar> Notes<'a, S> {
    /// Of a machine whose inputs come along a way, where they have not arrived ahead of the row.
    pub(super) fn new(machine: &Machine<S>, way: Option<&'a mut Way<S>>, run: &Run<S>) -> Self {
        let takes = machine.notes_samples();
        let (any, before) = (takes || way.is_some(), Before::of(run));
        let second = (run.second_position, run.second_velocity);
        Self { any, takes, way, arrived: None, held: None, before, second }
    }

    /// Whether there is anything to note.
    pub(super) fn any(&self) -> bool {
        self.any
    }

    /// Whether inputs are on their way for long.
    pub(super) fn holds_up(&self) -> bool {
        self.way.is_some()
    }

    /// A sample begins where a run is.
    pub(super) fn begin(&mut self, run: &Run<S>) {
        self.before = Before::of(run);
    }

    /// What arrives in the present sample, once.
    pub(super) fn arriving(&mut self, input: f64, dt: f64) -> S {
        self.held = None;
        self.arrived.take().unwrap_or_else(|| arriving(&mut self.way, input, None, dt))
    }

    /// The present sample is given up.
    pub(super) fn give_up(&mut self) {
        (self.arrived, self.held) = (None, None);
    }
}

/// All effort but friction on a bare machine; on another, that of the drive and the load. One without
/// levels has nothing else but efforts that go by the place.
pub(super) struct Applied<'a, 'b, S: Scalar, A, const BARE: bool, const LEVELS: bool> {
    pub(super) machine: &'a mut Machine<S>,
    pub(super) inputs: &'a [f64],
    pub(super) around: Surroundings<'a>,
    pub(super) added: &'a A,
    pub(super) ahead: &'a mut Ahead,
    /// What is noted of the samples, where anything is.
    pub(super) notes: &'a mut Notes<'b, S>,
    /// What goes by the place, where nothing else acts on a machine that is not bare.
    pub(super) by_place: &'a mut Option<ByPlace>,
    /// Whether inputs are data and nothing takes note of samples or swings.
    pub(super) plainly: bool,
    /// Whether the drive goes by place and speed.
    pub(super) drives_by_place: bool,
    /// Whether a second mass swings.
    pub(super) swings: bool,
    /// Duration of a sample, and of a step.
    pub(super) dt: f64,
    pub(super) span: S,
    /// The first sample that is not in the row.
    pub(super) end: usize,
    /// Whether the work of the contact is counted, in steps as rough as that.
    pub(super) counts: bool,
    pub(super) rough: f64,
}

impl<S: Scalar, A: Fn(usize) -> S, const BARE: bool, const LEVELS: bool>
    Applied<'_, '_, S, A, BARE, LEVELS>
{
    #[inline(always)]
    fn load(&self, sample: usize) -> S {
        (self.added)(sample) + self.around.load.at(sample)
    }

    /// Begins a row with this sample.
    pub(super) fn begin(&mut self, sample: usize) {
        if self.notes.arrived.is_none() {
            self.arrive(sample);
        }
    }

    /// Where the second mass gets to while a run comes to a place within `span`: noted for when it is there.
    /// Gives what it does to the motor then.
    #[inline(never)] // once for all laws
    fn swing(&mut self, run: &Run<S>, at: &Situation<S>, span: S) -> S {
        let second = (run.second_position, run.second_velocity);
        let Some(shaft) = &self.machine.shaft else { return S::constant(0.0) };
        self.notes.second = shaft.swing(&run.situation(), at, span, second);
        self.machine.shaft(at, self.notes.second.0, self.notes.second.1)
    }

    /// What arrives in a sample of an input that is on its way for long.
    fn arrive(&mut self, sample: usize) {
        let notes = &mut *self.notes;
        let Some(way) = &mut notes.way else { return };
        let input = way.pass(self.inputs[sample], None, self.dt);
        notes.arrived = Some(input);
        if self.drives_by_place {
            return;
        }
        let load = self.load(sample);
        let held = self.machine.driven_anywhere(input, load);
        self.ahead.hold(sample, held.re());
        self.notes.held = Some(held);
    }

    /// Takes note of a sample that has ended, and begins the next.
    #[inline(never)] // as a part of the loop it would take registers from rows that note nothing
    fn note(&mut self, sample: usize, run: &mut Run<S>) {
        let notes = &mut *self.notes;
        let arrived = notes.arrived.take();
        notes.held = None;
        if notes.takes {
            let goal = arrived.unwrap_or(S::constant(self.inputs[sample]));
            self.machine.wind(run, goal, self.dt);
            self.machine.remember(notes.before, run);
            notes.before = Before::of(run);
        }
        if sample + 1 < self.end {
            self.arrive(sample + 1);
        }
    }

    /// Effort of the drive and the load at a place, where nothing goes by anything else.
    #[inline(always)]
    fn driving_by_place(&self, sample: usize, place: f64) -> S {
        match &*self.by_place {
            Some(by_place) if LEVELS && by_place.has_ripple() => {
                let input = by_place.input(self.inputs[sample], place);
                self.machine.drive.direct(input) + self.load(sample)
            }
            _ => self.at(sample),
        }
    }

    /// Effort of a drive that goes by place and speed, and the load.
    #[inline(always)]
    fn driving_at(&self, sample: usize, at: &Situation<S>) -> S {
        let input = self.notes.arrived.unwrap_or(S::constant(self.inputs[sample]));
        self.machine.driven_there(input, at) + self.load(sample)
    }
}

impl<S: Scalar, A, const BARE: bool, const LEVELS: bool> OfMachine<S>
    for Applied<'_, '_, S, A, BARE, LEVELS>
{
    #[inline(always)]
    fn machine(&self) -> &Machine<S> {
        self.machine
    }
}

impl<S: Scalar, A: Fn(usize) -> S, const BARE: bool, const LEVELS: bool> Efforts<S>
    for Applied<'_, '_, S, A, BARE, LEVELS>
{
    const HELD: bool = BARE;
    const LEVELS: bool = LEVELS;

    #[inline(always)]
    fn driving(&self, sample: usize, run: &Run<S>) -> S {
        if !LEVELS || self.plainly || !self.drives_by_place {
            self.at(sample)
        } else if !S::CARRIES && self.by_place.is_some() {
            self.driving_by_place(sample, run.position.re())
        } else {
            self.driving_at(sample, &run.situation())
        }
    }

    #[inline(always)]
    fn acting(
        &mut self,
        sample: usize,
        run: &Run<S>,
        (displacement, velocity): (S, S),
        span: S,
        there: &mut Acting<S>,
    ) {
        if !S::CARRIES
            && let Some(by_place) = self.by_place
        {
            let place = (run.position + displacement).re();
            there.ambient = S::constant(by_place.effort(place));
            if LEVELS {
                by_place.follow_ripple(place);
                there.levels.0 = S::constant(by_place.level(place));
            }
            there.driving = self.driving_by_place(sample, place);
            return;
        }
        let mut at = run.situation().after(displacement, velocity, span);
        if self.plainly {
            let driving = |_: &Situation<S>| self.at(sample);
            self.machine.acting(&mut at, driving, || self.load(sample), None, there);
            return;
        }
        let pull = if self.swings { Some(self.swing(run, &at, span)) } else { None };
        let driving = |at: &Situation<S>| {
            if self.drives_by_place { self.driving_at(sample, at) } else { self.at(sample) }
        };
        self.machine.acting(&mut at, driving, || self.load(sample), pull, there);
    }

    #[inline(always)]
    fn levels(
        &self,
        sample: usize,
        run: &Run<S>,
        arrived: Option<&Acting<S>>,
        levels: &mut (S, S),
    ) {
        if LEVELS {
            let acting = || (self.driving(sample, run), self.load(sample));
            self.machine.levels_of(run, acting, arrived, levels);
        }
    }

    #[inline(always)]
    fn settle(&mut self, sample: usize, run: &mut Run<S>, from: (S, S), mut efforts: (S, S)) {
        if !LEVELS {
            return;
        }
        if !self.plainly && self.swings {
            (run.second_position, run.second_velocity) = self.notes.second;
        }
        if self.counts {
            if !self.plainly && self.drives_by_place {
                // At the speed that it has got, not at the one that the step was shown.
                efforts.1 = self.driving(sample, run) + run.ambient;
            }
            self.machine.settle(run, from, efforts, (self.rough, self.span.re()));
        }
    }

    #[inline(always)]
    fn is_fine(&self, speed: f64, effort: f64, levels: (S, S)) -> bool {
        !LEVELS || self.machine.is_fine(speed, effort, levels, self.span.re())
    }

    fn stillness(&self, run: &Run<S>, greatest: f64, levels: (S, S)) -> Stillness {
        match self.machine.stillness(run, greatest, levels, self.span) {
            Stillness::Whole if self.notes.any || self.swings => Stillness::Changing,
            stillness => stillness,
        }
    }

    #[inline(always)]
    fn held(&mut self, run: &mut Run<S>, span: S) {
        if LEVELS && !self.plainly && (self.swings || self.notes.takes) {
            let at = run.situation();
            self.machine.swing(&at, &at, span, run);
            self.machine.refresh(run);
        }
    }

    #[inline(always)]
    fn ended(&mut self, sample: usize, run: &mut Run<S>) {
        if LEVELS && !self.plainly && self.notes.any {
            self.note(sample, run);
        }
    }

    #[inline(always)]
    fn at(&self, sample: usize) -> S {
        if !S::CARRIES {
            return S::constant(self.ahead.at(sample));
        }
        if LEVELS && let Some(held) = self.notes.held {
            return held;
        }
        let load = self.load(sample);
        if BARE && self.machine.effects.maps_inputs() {
            let input = S::constant(self.inputs[sample]);
            self.machine.driven_anywhere(input, load) + self.machine.weight()
        } else if BARE {
            self.machine.bare_effort(self.inputs[sample], load)
        } else {
            self.machine.driven_directly(self.inputs[sample], load)
        }
    }

    #[inline(always)]
    fn within(&self, samples: std::ops::Range<usize>, greatest: f64) -> usize {
        let plain = |effort: &f64| effort.abs() <= greatest;
        if S::CARRIES {
            return samples.take_while(|k| plain(&self.at(*k).re())).count();
        }
        // Without a choice in eight of them they become vectors.
        let efforts = self.ahead.of(samples);
        let eights = efforts.chunks_exact(8);
        let whole = |eight: &&[f64]| eight.iter().fold(true, |all, effort| all & plain(effort));
        let passed = 8 * eights.take_while(whole).count();
        passed + efforts[passed..].iter().take_while(|effort| plain(effort)).count()
    }
}

/// Samples that a row of plain steps goes on at most.
pub(super) const AHEAD: usize = 8 * CHUNK;

/// Efforts of some samples, made before the loop that asks for them one by one: by themselves they
/// become vectors.
pub(super) struct Ahead {
    from: usize,
    number: usize,
    efforts: [f64; AHEAD],
    /// What has arrived of the inputs, where something holds them up.
    arrived: Vec<f64>,
}

impl Default for Ahead {
    fn default() -> Self {
        Self { from: 0, number: 0, efforts: [0.0; AHEAD], arrived: Vec::new() }
    }
}

impl Ahead {
    /// Has the effort of this sample and of those behind it, made of sample, input and load.
    #[inline(always)]
    pub(super) fn reach(
        &mut self,
        sample: usize,
        inputs: &[f64],
        loads: PerSample<'_>,
        effort: impl Fn(usize, f64, f64) -> f64,
    ) {
        if self.has(sample) {
            return;
        }
        self.from = sample;
        self.number = AHEAD.min(inputs.len() - sample);
        let end = self.end();
        let places = self.efforts[..self.number].iter_mut();
        let given = (sample..end).zip(&inputs[sample..end]);
        // What the loop had to ask of each sample would keep it from vectors.
        if let PerSample::Same(load) = loads {
            for (place, (k, input)) in places.zip(given) {
                *place = effort(k, *input, load);
            }
        } else {
            for (place, (k, input)) in places.zip(given) {
                *place = effort(k, *input, loads.at(k));
            }
        }
    }

    /// The same of inputs that come along a way, where there is one, and are mapped; made of sample and what
    /// becomes of the input.
    pub(super) fn reach_through<S: Scalar>(
        &mut self,
        sample: usize,
        inputs: &[f64],
        dt: PerSample<'_>,
        way: &mut Option<&mut Way<S>>,
        (effects, effort): (&Effects<S>, impl Fn(usize, f64) -> f64),
    ) {
        if self.has(sample) {
            return;
        }
        self.from = sample;
        self.number = AHEAD.min(inputs.len() - sample);
        let given = &inputs[sample..self.end()];
        let efforts = &mut self.efforts[..given.len()];
        if let Some(way) = way {
            let pass = |(k, input): (usize, &f64)| way.pass(*input, None, dt.at(k)).re();
            self.arrived.clear();
            self.arrived.extend((sample..).zip(given).map(pass));
            efforts.copy_from_slice(&self.arrived);
        } else {
            efforts.copy_from_slice(given);
        }
        effects.map_inputs(efforts);
        for (place, k) in efforts.iter_mut().zip(sample..) {
            *place = effort(k, *place);
        }
    }

    fn has(&self, sample: usize) -> bool {
        self.from <= sample && sample < self.end()
    }

    /// What has arrived in a sample, where it is known.
    pub(super) fn arrived(&self, sample: usize) -> Option<f64> {
        let place = sample.checked_sub(self.from)?;
        self.arrived.get(place).copied()
    }

    /// Has this effort in a sample, and that of no other one.
    fn hold(&mut self, sample: usize, effort: f64) {
        (self.from, self.number, self.efforts[0]) = (sample, 1, effort);
    }

    /// The first sample that it does not have.
    pub(super) fn end(&self) -> usize {
        self.from + self.number
    }

    #[inline(always)]
    fn at(&self, sample: usize) -> f64 {
        self.efforts[sample - self.from]
    }

    #[inline(always)]
    fn of(&self, samples: std::ops::Range<usize>) -> &[f64] {
        &self.efforts[samples.start - self.from..samples.end - self.from]
    }
}
