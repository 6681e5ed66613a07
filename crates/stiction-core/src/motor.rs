//! A motor: machine, friction and the way they run together.

use crate::body::Body;
use crate::drive::{Drive, Way};
use crate::effects::{AnyEffect, EffectRecord, Effects, effect_record};
use crate::error::{Error, Result};
use crate::follow::arriving;
use crate::friction::{AnyState, Entry, FrictionLaw, Law, LawState, Statistics};
use crate::integrate::{Integrator, LONGEST_PHASE, MOST_PARTS, Machine, Run, Seen, parts, sample};
use crate::model::{CHUNK, LawSpec};
use crate::parameter::resolve;
use crate::scalar::Scalar;
use crate::sensitivity::MeasuredMotion;
use crate::sensor::Sensor;
use crate::servo::Servo;
use crate::shoot::{Pull, Windows};

/// An effect with every parameter decided.
#[derive(Debug, Clone)]
pub struct EffectSpec {
    /// Catalogue entry.
    pub record: &'static EffectRecord,
    /// Values in the order of the record's parameters.
    pub values: Vec<f64>,
}

impl PartialEq for EffectSpec {
    fn eq(&self, other: &Self) -> bool {
        self.record.name == other.record.name && self.values == other.values
    }
}

impl EffectSpec {
    /// The effect called `name`; what is not stated takes its default, gains 0.
    pub fn new(name: &str, stated: &[(String, f64)]) -> Result<Self> {
        let record = effect_record(name)?;
        Ok(Self { record, values: resolve(name, record.parameters, stated)? })
    }

    /// The effect called `name` at its neutral point, in the shape stated.
    pub fn candidate(name: &str, shape: &[(String, f64)]) -> Result<Self> {
        let effect = Self::new(name, shape)?;
        let gains = effect.record.facts.gains;
        if let Some((gain, value)) = shape.iter().find(|(word, _)| gains.contains(&word.as_str())) {
            let shapes = effect.record.parameters.iter().map(|p| p.name);
            let shapes: Vec<&str> = shapes.filter(|word| !gains.contains(word)).collect();
            return Err(Error::Gain {
                effect: name.to_owned(),
                gain: gain.clone(),
                given: *value,
                shapes: if shapes.is_empty() { "nothing".to_owned() } else { shapes.join(", ") },
            });
        }
        Ok(effect)
    }
}

/// Everything that defines a motor, in plain numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct MotorSpec {
    /// Inertia (mass).
    pub inertia: f64,
    /// Effort per unit of input.
    pub gain: f64,
    /// Greatest magnitude of the input that gets through.
    pub input_limit: f64,
    /// What makes an effort of a goal position, where the input is one.
    pub servo: Option<Servo>,
    /// Amplitude of the pendulum torque.
    pub gravity_amplitude: f64,
    /// Position at which the pendulum hangs.
    pub gravity_zero: f64,
    /// Constant weight against positive motion.
    pub weight: f64,
    /// Size of a sensor count, 0 for none.
    pub count: f64,
    /// Friction law.
    pub friction: LawSpec,
    /// Effects.
    pub effects: Vec<EffectSpec>,
    /// Which integrator runs it.
    pub integrator: Integrator,
}

impl MotorSpec {
    /// A motor with inertia, gain and friction alone.
    pub fn new(inertia: f64, gain: f64, friction: LawSpec) -> Self {
        Self {
            inertia,
            gain,
            input_limit: f64::INFINITY,
            servo: None,
            gravity_amplitude: 0.0,
            gravity_zero: 0.0,
            weight: 0.0,
            count: 0.0,
            friction,
            effects: Vec::new(),
            integrator: Integrator::Fast,
        }
    }

    /// Refuses values that no motor has.
    pub fn check(&self) -> Result<()> {
        let bounded = [
            ("inertia", self.inertia, 1e-15, 1e15),
            ("gain", self.gain, -1e12, 1e12),
            ("input_limit", self.input_limit, 0.0, f64::INFINITY),
            ("gravity_amplitude", self.gravity_amplitude, -1e12, 1e12),
            ("gravity_zero", self.gravity_zero, -1e12, 1e12),
            ("weight", self.weight, -1e12, 1e12),
            ("count", self.count, 0.0, 1e6),
        ];
        for (name, given, lower, upper) in bounded {
            if given.is_nan() {
                return Err(Error::NotFinite { name: name.to_owned(), given });
            }
            if given < lower || given > upper {
                let unit = String::new();
                return Err(Error::OutOfBounds {
                    name: name.to_owned(),
                    given,
                    lower,
                    upper,
                    unit,
                });
            }
        }
        Ok(())
    }

    /// Path of the effort per unit: of input, or of a servo's current.
    fn gain_path(&self) -> &'static str {
        if self.servo.is_some() { "drive.torque_constant" } else { "drive.gain" }
    }

    /// Paths and values of all parameters: `body.inertia`, `friction.coulomb`,
    /// `effects.cogging.cosine` … in a fixed order.
    pub fn parameters(&self) -> Vec<(String, f64)> {
        let mut list = vec![
            ("body.inertia".to_owned(), self.inertia),
            (self.gain_path().to_owned(), self.gain),
            ("body.gravity_amplitude".to_owned(), self.gravity_amplitude),
            ("body.gravity_zero_rad".to_owned(), self.gravity_zero),
            ("body.weight_n".to_owned(), self.weight),
        ];
        let friction = self.friction.record.parameters.iter().zip(&self.friction.values);
        list.extend(friction.map(|(spec, v)| (format!("friction.{}", spec.name), *v)));
        for effect in &self.effects {
            let name = effect.record.name;
            let values = effect.record.parameters.iter().zip(&effect.values);
            list.extend(values.map(|(spec, v)| (format!("effects.{name}.{}", spec.name), *v)));
        }
        list
    }

    /// Machine and law over some number type; `values` in the order of [`Self::parameters`].
    pub fn build<S: Scalar>(&self, values: &[S]) -> (Machine<S>, Law<S>) {
        let (first, rest) = values.split_at(5);
        let (friction, mut rest) = rest.split_at(self.friction.values.len());
        let effects = self.effects.iter().map(|effect| {
            let own;
            (own, rest) = rest.split_at(effect.values.len());
            AnyEffect::build(effect.record.name, own).expect("the record's own name is in the list")
        });
        let effects = Effects::new(effects);
        let law = self.friction.law(friction);
        let machine = Machine::new(
            Drive { gain: first[1], limit: self.input_limit, servo: self.servo },
            Body::new(first[0], first[2], first[3], first[4]),
            effects,
            Sensor { count: self.count },
            law.sliding_force(),
        );
        (machine, law)
    }
}

/// What a trajectory can show beside the law's own states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Column {
    /// Position.
    Position,
    /// Velocity.
    Velocity,
    /// Friction.
    Friction,
    /// What the sensor reads.
    Measured,
    /// A state of the law, by its index.
    Law(usize),
}

impl Column {
    /// Names of the columns of a motor with this law, in the order of a trajectory.
    pub fn names(law: &LawSpec) -> Vec<&'static str> {
        let mut names = vec!["position", "velocity", "friction", "measured"];
        names.extend(law.record.outputs);
        names
    }

    /// The column called `name`.
    pub fn named(law: &LawSpec, name: &str) -> Result<Self> {
        let names = Self::names(law);
        let index = names.iter().position(|known| *known == name);
        let index = index.ok_or_else(|| Error::unknown("output", name, names))?;
        Ok(match index {
            0 => Self::Position,
            1 => Self::Velocity,
            2 => Self::Friction,
            3 => Self::Measured,
            own => Self::Law(own - 4),
        })
    }

    /// What it shows of a motor after a sample.
    #[inline]
    pub fn read(
        self,
        run: &Run<f64>,
        machine: &Machine<f64>,
        output: &dyn Fn(usize) -> f64,
    ) -> f64 {
        match self {
            Self::Position => run.position,
            Self::Velocity => run.velocity,
            Self::Friction => run.friction,
            Self::Measured => machine.sensor.read(machine.effects.sensor(run.position)),
            Self::Law(index) => output(index),
        }
    }
}

/// What acts on a machine beside its input.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    /// External effort, positive along +x.
    pub load: PerSample<'a>,
    /// Temperature in °C, where it is known.
    pub temperature: Option<PerSample<'a>>,
    /// Whether the drive is on, 0 where it is not; always on without it.
    pub enabled: Option<PerSample<'a>>,
}

impl Surroundings<'_> {
    /// No load, a temperature that nobody knows, and a drive that is on.
    pub const NONE: Self = Self { load: PerSample::Same(0.0), temperature: None, enabled: None };

    /// Whether the drive is on in a sample.
    #[inline]
    pub fn enabled_at(&self, k: usize) -> bool {
        self.enabled.is_none_or(|each| each.at(k) != 0.0)
    }

    /// Whether the drive is always on and the temperature always the same.
    fn is_steady(&self) -> bool {
        let changes = matches!(self.temperature, Some(PerSample::Each(_)));
        self.enabled.is_none() && !changes
    }

    /// The temperature at a sample.
    #[inline]
    pub fn temperature_at(&self, k: usize) -> Option<f64> {
        self.temperature.map(|each| each.at(k))
    }

    /// Those from one sample to before another.
    pub fn between(&self, from: usize, to: usize) -> Self {
        Self {
            load: self.load.between(from, to),
            temperature: self.temperature.map(|each| each.between(from, to)),
            enabled: self.enabled.map(|each| each.between(from, to)),
        }
    }

    /// Refuses numbers that are not as many as the samples.
    pub fn check(&self, wanted: usize) -> Result<()> {
        self.load.check("load", wanted)?;
        for (name, each) in [("temperature", self.temperature), ("enabled", self.enabled)] {
            each.map_or(Ok(()), |each| each.check(name, wanted))?;
        }
        Ok(())
    }
}

impl<'a> From<PerSample<'a>> for Surroundings<'a> {
    fn from(load: PerSample<'a>) -> Self {
        Self { load, ..Surroundings::NONE }
    }
}

/// A number for every sample, or one for all.
#[derive(Debug, Clone, Copy)]
pub enum PerSample<'a> {
    /// The same for all.
    Same(f64),
    /// One each.
    Each(&'a [f64]),
}

impl PerSample<'_> {
    /// The number at a sample.
    #[inline]
    pub fn at(&self, k: usize) -> f64 {
        match self {
            Self::Same(value) => *value,
            Self::Each(values) => values[k],
        }
    }

    /// Refuses numbers that are not as many as the samples.
    pub fn check(&self, name: &str, wanted: usize) -> Result<()> {
        match self {
            Self::Each(values) if values.len() != wanted => {
                Err(Error::Length { name: name.to_owned(), given: values.len(), wanted })
            }
            Self::Same(_) | Self::Each(_) => Ok(()),
        }
    }

    /// The sample from which on the number is another one, at most `end`.
    fn same_until(&self, from: usize, end: usize) -> usize {
        match self {
            Self::Same(_) => end,
            Self::Each(values) => {
                let now = values[from];
                let other = values[from..end].iter().position(|value| *value != now);
                other.map_or(end, |after| from + after)
            }
        }
    }

    /// The numbers from one sample to before another.
    pub fn between(&self, from: usize, to: usize) -> Self {
        match self {
            Self::Same(value) => Self::Same(*value),
            Self::Each(values) => Self::Each(&values[from..to]),
        }
    }
}

fn whole_parts(parts: f64, dt: f64) -> Result<u32> {
    if parts <= MOST_PARTS {
        return Ok(parts as u32);
    }
    Err(Error::TooLong { given: dt, longest: dt * MOST_PARTS / parts })
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
    /// ω·h above which it divides a sample.
    pub longest_phase: f64,
}

impl<S: Scalar> Running<S> {
    /// At rest at 0, never moved.
    pub fn new(spec: &MotorSpec, values: &[S]) -> Self {
        let (machine, law) = spec.build(values);
        let state = law.initial();
        let zero = S::constant(0.0);
        let run = machine.start(zero, zero);
        let (delay, lag) = (machine.effects.delay(), machine.effects.lag());
        let way = (delay.is_some() || lag.is_some()).then(|| Way::new(delay, lag));
        let integrator = spec.integrator;
        Self { machine, law, state, run, way, integrator, longest_phase: LONGEST_PHASE }
    }

    /// Goes on from where another motor is; its state depends on no parameter of this one.
    pub fn resume(&mut self, from: &Running<f64>) {
        self.state = from.state.lift();
        self.run = from.run.lift();
        self.machine.effects.resume(&from.machine.effects);
        self.machine.refresh(&mut self.run);
        if let (Some(way), Some(from)) = (&mut self.way, &from.way) {
            way.resume(from);
        }
    }

    /// One sample, at the temperature of the run.
    #[inline]
    pub fn step(&mut self, input: f64, load: f64, dt: f64) -> Result<()> {
        with_law_and_state!(&self.law, &mut self.state, |law, state| {
            let parts = whole_parts(parts(&self.machine, law, dt, self.longest_phase), dt)?;
            state.make_room(parts as usize + CHUNK / 4);
            let before = self.run;
            let arrived = arriving(&mut self.way.as_mut(), input, dt);
            let whole =
                if self.machine.is_bare() { sample::<_, _, true> } else { sample::<_, _, false> };
            whole(
                &self.machine,
                law,
                state,
                &mut self.run,
                arrived,
                S::constant(load),
                dt,
                0..parts,
                self.integrator,
            );
            self.machine.wind(&mut self.run, arrived, dt);
            self.machine.remember(&before, &mut self.run);
        });
        Ok(())
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
    fn simulate_rows(
        &mut self,
        inputs: &[f64],
        around: Surroundings<'_>,
        added: impl Fn(usize) -> S,
        dt: PerSample<'_>,
        rows: impl Rows<S>,
    ) -> Result<()> {
        if self.machine.is_bare() {
            self.simulate_kind::<true>(inputs, around, added, dt, rows)
        } else {
            self.simulate_kind::<false>(inputs, around, added, dt, rows)
        }
    }

    fn simulate_kind<const BARE: bool>(
        &mut self,
        inputs: &[f64],
        around: Surroundings<'_>,
        added: impl Fn(usize) -> S,
        dt: PerSample<'_>,
        mut rows: impl Rows<S>,
    ) -> Result<()> {
        let mut way = self.way.as_mut();
        let plain = BARE && self.integrator == Integrator::Fast && around.is_steady();
        with_law_and_state!(&self.law, &mut self.state, |law, state| {
            let glides = plain && glides(law);
            let mut known = f64::NAN;
            let mut divided = 1;
            let mut room = 0;
            let mut index = 0;
            while index < inputs.len() {
                let dt_now = dt.at(index);
                if dt_now != known {
                    divided =
                        whole_parts(parts(&self.machine, law, dt_now, self.longest_phase), dt_now)?;
                    known = dt_now;
                }
                self.run.temperature = around.temperature_at(index);
                self.run.enabled = around.enabled_at(index);
                let mut passed = 0;
                if glides && self.machine.glides(&self.run) {
                    let span = S::constant(dt_now / f64::from(divided));
                    let applied = |k: usize| (S::constant(inputs[k]), added(k) + around.load.at(k));
                    let machine = &self.machine;
                    let seen = Showing { machine, rows: &mut rows };
                    // Not to the end, which would be looked for anew after every event.
                    let end = inputs.len().min(index + 8 * CHUNK);
                    let samples = index..dt.same_until(index, end);
                    let mut glide =
                        machine.glide(self.run, applied, seen, samples, (span, divided));
                    law.glide(state, &mut glide);
                    (index, passed) = (glide.samples.start, glide.part);
                    let more = index < glide.samples.end;
                    self.run = glide.run;
                    if !more {
                        continue;
                    }
                }
                let left = divided - passed;
                if room < left {
                    // Once a chunk where samples are not divided, never inside a step.
                    room = (CHUNK as u32).max(left);
                    state.make_room(room as usize + CHUNK / 4);
                }
                room -= left;
                let before = self.run;
                let arrived = arriving(&mut way, inputs[index], dt_now);
                sample::<_, _, BARE>(
                    &self.machine,
                    law,
                    state,
                    &mut self.run,
                    arrived,
                    added(index) + around.load.at(index),
                    dt_now,
                    passed..divided,
                    self.integrator,
                );
                self.machine.wind(&mut self.run, arrived, dt_now);
                self.machine.remember(&before, &mut self.run);
                let seen = &*state;
                rows.see(index, &self.run, &self.machine, |column| seen.output(column));
                index += 1;
            }
        });
        Ok(())
    }
}

/// Who sees body, machine and states of the law after each sample.
trait Rows<S: Scalar> {
    fn see(
        &mut self,
        sample: usize,
        run: &Run<S>,
        machine: &Machine<S>,
        output: impl Fn(usize) -> S,
    );
}

/// A function that is told.
struct Told<F>(F);

impl<S: Scalar, F> Rows<S> for Told<F>
where
    F: FnMut(usize, &Run<S>, &Machine<S>, &dyn Fn(usize) -> S),
{
    #[inline(always)]
    fn see(
        &mut self,
        sample: usize,
        run: &Run<S>,
        machine: &Machine<S>,
        output: impl Fn(usize) -> S,
    ) {
        (self.0)(sample, run, machine, &output);
    }
}

/// The columns that a trajectory shows; empty where one is not wanted.
struct Columns<'a, 'b> {
    position: &'a mut [f64],
    velocity: &'a mut [f64],
    friction: &'a mut [f64],
    others: &'a mut [(Column, &'b mut [f64])],
}

impl<'a, 'b> Columns<'a, 'b> {
    /// These columns, those of the body first, so that they need no looking up.
    fn new(columns: &'a mut [(Column, &'b mut [f64])]) -> Self {
        let rank = |column: Column| match column {
            Column::Position => 0,
            Column::Velocity => 1,
            Column::Friction => 2,
            Column::Measured | Column::Law(_) => 3,
        };
        columns.sort_unstable_by_key(|(column, _)| rank(*column));
        let (position, columns) = taken(columns, Column::Position);
        let (velocity, columns) = taken(columns, Column::Velocity);
        let (friction, others) = taken(columns, Column::Friction);
        Self { position, velocity, friction, others }
    }
}

/// The first column where it is this one, else nothing, and the rest.
fn taken<'a, 'b>(
    columns: &'a mut [(Column, &'b mut [f64])],
    wanted: Column,
) -> (&'a mut [f64], &'a mut [(Column, &'b mut [f64])]) {
    if columns.first().is_none_or(|(column, _)| *column != wanted) {
        return (&mut [], columns);
    }
    let (first, rest) = columns.split_at_mut(1);
    (&mut *first[0].1, rest)
}

impl Rows<f64> for Columns<'_, '_> {
    #[inline(always)] // where it is called, the motion is in registers
    fn see(
        &mut self,
        sample: usize,
        run: &Run<f64>,
        machine: &Machine<f64>,
        output: impl Fn(usize) -> f64,
    ) {
        if let Some(place) = self.position.get_mut(sample) {
            *place = run.position;
        }
        if let Some(place) = self.velocity.get_mut(sample) {
            *place = run.velocity;
        }
        if let Some(place) = self.friction.get_mut(sample) {
            *place = run.friction;
        }
        for (column, values) in self.others.iter_mut() {
            values[sample] = match column {
                Column::Position => run.position,
                Column::Velocity => run.velocity,
                Column::Friction => run.friction,
                Column::Measured => machine.sensor.read(machine.effects.sensor(run.position)),
                Column::Law(index) => output(*index),
            };
        }
    }
}

/// Shows the samples of a glide.
struct Showing<'a, S: Scalar, R> {
    machine: &'a Machine<S>,
    rows: &'a mut R,
}

impl<S: Scalar, T: LawState<S>, R: Rows<S>> Seen<S, T> for Showing<'_, S, R> {
    #[inline(always)]
    fn see(&mut self, sample: usize, run: &Run<S>, contact: &T) {
        self.rows.see(sample, run, self.machine, |column| contact.output(column));
    }
}

fn glides<S: Scalar, L: FrictionLaw<S>>(_law: &L) -> bool {
    L::GLIDES
}

/// A motor in plain numbers: what `Motor` is in Python.
#[derive(Debug, Clone)]
pub struct Motor {
    spec: MotorSpec,
    running: Running<f64>,
}

impl Motor {
    /// At rest at 0, never moved.
    pub fn new(spec: MotorSpec) -> Result<Self> {
        spec.check()?;
        let values: Vec<f64> = spec.parameters().into_iter().map(|(_, value)| value).collect();
        let running = Running::new(&spec, &values);
        Ok(Self { spec, running })
    }

    /// What defines it.
    pub fn spec(&self) -> &MotorSpec {
        &self.spec
    }

    /// Its parts and state.
    pub fn running(&self) -> &Running<f64> {
        &self.running
    }

    pub(crate) fn running_mut(&mut self) -> &mut Running<f64> {
        &mut self.running
    }

    /// One sample; position and velocity at its end.
    #[inline]
    pub fn step(&mut self, input: f64, load: f64, dt: f64) -> Result<(f64, f64)> {
        self.running.step(input, load, dt)?;
        Ok((self.running.run.position, self.running.run.velocity))
    }

    /// Samples; fills the columns asked for, each as long as `inputs`.
    pub fn simulate(
        &mut self,
        inputs: &[f64],
        around: Surroundings<'_>,
        dt: PerSample<'_>,
        columns: &mut [(Column, &mut [f64])],
    ) -> Result<()> {
        around.check(inputs.len())?;
        dt.check("dt", inputs.len())?;
        for (_, values) in columns.iter() {
            if values.len() != inputs.len() {
                return Err(Error::Length {
                    name: "out".to_owned(),
                    given: values.len(),
                    wanted: inputs.len(),
                });
            }
        }
        self.running.simulate_rows(inputs, around, |_| 0.0, dt, Columns::new(columns))
    }

    /// Efforts along given positions, one more than there are samples: of the drive, of gravity and
    /// added efforts, and friction; then how far the centre of mass is ahead of the reading. Each is
    /// as long as there are samples.
    pub fn follow(
        &mut self,
        positions: &[f64],
        inputs: PerSample<'_>,
        around: Surroundings<'_>,
        dt: PerSample<'_>,
        efforts: [&mut [f64]; 4],
    ) -> Result<()> {
        let wanted = positions.len().saturating_sub(1);
        inputs.check("input", wanted)?;
        around.check(wanted)?;
        dt.check("dt", wanted)?;
        let [driven, ambient, friction, ahead] = efforts;
        for array in [&driven, &ambient, &friction, &ahead] {
            if array.len() != wanted {
                let name = "out".to_owned();
                return Err(Error::Length { name, given: array.len(), wanted });
            }
        }
        self.running.follow(positions, inputs, around, dt, |k, efforts| {
            driven[k] = efforts.driven;
            ambient[k] = efforts.ambient;
            friction[k] = efforts.friction;
            ahead[k] = efforts.ahead;
        });
        Ok(())
    }

    /// What each window along given positions comes to (see [`Running::shoot`]).
    pub fn shoot(
        &mut self,
        motion: &MeasuredMotion<'_>,
        windows: &Windows<'_>,
    ) -> Result<Vec<f64>> {
        let mut sums = Vec::with_capacity(windows.number(motion.samples()));
        self.running.shoot(motion, windows, |_, sum| sums.push(sum))?;
        Ok(sums)
    }

    /// Readings and pulls of a run that is drawn to given positions (see [`Running::accompany`]).
    pub fn accompany(
        &mut self,
        motion: &MeasuredMotion<'_>,
        pull: Pull,
    ) -> Result<(Vec<f64>, Vec<f64>)> {
        let mut rows = (Vec::new(), Vec::new());
        self.running.accompany(motion, pull, |_, reading, effort| {
            rows.0.push(reading);
            rows.1.push(effort);
        })?;
        Ok(rows)
    }

    /// Back to rest, or to this position and velocity, with friction never moved.
    pub fn reset(&mut self, position: f64, velocity: f64) {
        self.running.state = self.running.law.initial();
        self.running.run = self.running.machine.start(position, velocity);
        self.running.machine.effects.forget();
        if let Some(way) = &mut self.running.way {
            way.clear();
        }
    }

    /// Sets the temperature in °C that the next steps have.
    pub fn set_temperature(&mut self, temperature: Option<f64>) {
        self.running.run.temperature = temperature;
    }

    /// Switches the drive on or off for the next steps.
    pub fn set_enabled(&mut self, enabled: bool) {
        self.running.run.enabled = enabled;
    }

    /// Sets the session clock and the path travelled so far.
    pub fn set_clock(&mut self, time: f64, path: f64) {
        self.running.run.time = time;
        self.running.run.path = path;
    }

    /// Replaces the friction state by that of a contact that brings these values along, in the
    /// order of the law's start quantities.
    pub fn prime(&mut self, start: &[f64]) {
        self.running.state = self.running.law.primed(start);
    }

    /// Replaces the friction state, from another model of the same law and parameters.
    pub fn set_friction_state(&mut self, state: AnyState<f64>) {
        self.running.state = state;
    }

    /// Body and friction state as named entries.
    pub fn entries(&self) -> Vec<(&'static str, Entry)> {
        let run = &self.running.run;
        let number = Entry::Number;
        let mut entries = vec![
            ("position", number(run.position)),
            ("velocity", number(run.velocity)),
            ("time", number(run.time)),
            ("path", number(run.path)),
            ("friction", number(run.friction)),
            ("second_position", number(run.second_position)),
            ("second_velocity", number(run.second_velocity)),
            ("relaxed", number(run.relaxed)),
            ("wound", number(run.wound)),
            ("ambient", number(run.ambient())),
        ];
        entries.extend(self.running.way.iter().flat_map(Way::entries));
        let effects = &self.running.machine.effects;
        entries.extend(effects.remembers().then(|| effects.entry()));
        entries.extend(with_state!(&self.running.state, |state| state.entries()));
        entries
    }

    /// Sets body and friction state from named entries.
    pub fn restore(&mut self, entries: &[(String, Entry)]) -> Result<()> {
        let mut way = self.running.way.clone();
        let mut effects = self.running.machine.effects.clone();
        let own = |name: &str| {
            BODY.contains(&name)
                || way.iter().flat_map(Way::names).any(|own| own == name)
                || (effects.remembers() && name == Effects::<f64>::ENTRY)
        };
        let (body, law): (Vec<_>, Vec<_>) =
            entries.iter().cloned().partition(|(name, _)| own(name.as_str()));
        let mut read = crate::friction::EntryReader::new(&body);
        let mut run = self.running.run;
        run.position = read.number("position", false)?;
        run.velocity = read.number("velocity", false)?;
        run.time = read.number("time", false)?;
        run.path = read.number("path", false)?;
        run.friction = read.number("friction", false)?;
        run.second_position = read.number("second_position", false)?;
        run.second_velocity = read.number("second_velocity", false)?;
        run.relaxed = read.number("relaxed", false)?;
        run.wound = read.number("wound", false)?;
        if let Some(way) = &mut way {
            way.restore(&mut read)?;
        }
        if effects.remembers() {
            effects.restore(&mut read)?;
        }
        let state = self.running.law.restore(&law)?;
        // As it was, not recomputed: it belongs to the end of the last step, to the bit.
        run.set_ambient(read.number("ambient", false)?);
        self.running.state = state;
        self.running.run = run;
        self.running.way = way;
        self.running.machine.effects = effects;
        Ok(())
    }

    /// Branch counters.
    pub fn statistics(&self) -> Statistics {
        with_state!(&self.running.state, |state| state.statistics())
    }
}

const BODY: [&str; 10] = [
    "position",
    "velocity",
    "time",
    "path",
    "friction",
    "second_position",
    "second_velocity",
    "relaxed",
    "wound",
    "ambient",
];
