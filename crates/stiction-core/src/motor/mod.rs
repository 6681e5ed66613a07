//! A motor: machine, friction and the way they run together.

mod column;
mod running;
mod spec;
mod surroundings;

use crate::drive::Way;
use crate::effects::Effects;
use crate::error::{Error, Result};
use crate::follow::{Efforts, SeesAbout};
use crate::friction::{AnyState, Entry, LawState, Statistics};
use crate::integrate::Budget;
use crate::kernel::RowKernel;
use crate::sensitivity::MeasuredMotion;
use crate::shoot::{Pull, Windows};

pub use column::Column;
use column::Columns;
pub(crate) use column::Rows;
pub use running::Running;
pub use spec::{EffectSpec, MotorSpec};
pub use surroundings::{PerSample, Surroundings};

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
    /// as long as there are samples, and about the end of each (see [`Running::follow_about`]).
    pub fn follow(&mut self, motion: &MeasuredMotion<'_>, efforts: [&mut [f64]; 4]) -> Result<()> {
        motion.check()?;
        let wanted = motion.samples();
        let [driven, ambient, friction, ahead] = efforts;
        for array in [&driven, &ambient, &friction, &ahead] {
            if array.len() != wanted {
                let name = "out".to_owned();
                return Err(Error::Length { name, given: array.len(), wanted });
            }
        }
        self.running.follow_about(motion, &mut EffortRows([driven, ambient, friction, ahead]));
        Ok(())
    }

    /// Measured minus needed effort along given positions, seen through a kernel: all of an effort
    /// residual but the load and the inertia term of what the sensor shows.
    pub fn follow_rows(
        &mut self,
        motion: &MeasuredMotion<'_>,
        kernel: &RowKernel<'_>,
    ) -> Result<Vec<f64>> {
        motion.check()?;
        let mut traces = [(); 3].map(|()| vec![0.0; motion.samples()]);
        let places = traces.each_mut().map(Vec::as_mut_slice);
        self.running.follow_about(motion, &mut ColumnTraces(places));
        let mut rows = vec![0.0; kernel.rows(motion.samples())];
        kernel.column(traces.each_ref().map(Vec::as_slice), &mut rows);
        Ok(rows)
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
        self.running.run.budget = Budget::unknown();
    }

    /// Replaces the friction state, from another model of the same law and parameters.
    pub fn set_friction_state(&mut self, state: AnyState<f64>) {
        let moved = with_state!(&state, |state| state.entries())
            != with_state!(&self.running.law.initial(), |state| state.entries());
        if moved {
            self.running.run.budget = Budget::unknown();
        }
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
        if effects.any() {
            entries
                .extend(BUDGET.into_iter().zip([run.budget.taken, run.budget.swing].map(number)));
        }
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
                || (effects.any() && BUDGET.contains(&name))
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
        // A state may say nothing of it: one that was put together by hand.
        let counted = effects.any() && body.iter().any(|(name, _)| BUDGET.contains(&name.as_str()));
        run.budget = Budget::unknown();
        if counted {
            run.budget.taken = read.number(BUDGET[0], true)?;
            run.budget.swing = read.at_least_zero(BUDGET[1])?;
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

/// What a contact beside effects has taken in, and the greatest kinetic energy so far.
const BUDGET: [&str; 2] = ["contact_work", "kinetic_peak"];

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

/// Rows of the efforts of the drive, of gravity and added efforts, of friction and of how far the
/// centre of mass is ahead.
struct EffortRows<'a>([&'a mut [f64]; 4]);

impl SeesAbout<f64> for EffortRows<'_> {
    #[inline(always)]
    fn see(&mut self, k: usize, efforts: &Efforts<f64>) {
        let Efforts { driven, ambient, friction, ahead, .. } = *efforts;
        for (row, value) in self.0.iter_mut().zip([driven, ambient, friction, ahead]) {
            row[k] = value;
        }
    }
}

/// Rows of what a column is made of, see [`RowKernel::column`].
struct ColumnTraces<'a>([&'a mut [f64]; 3]);

impl SeesAbout<f64> for ColumnTraces<'_> {
    #[inline(always)]
    fn see(&mut self, k: usize, efforts: &Efforts<f64>) {
        let needed = efforts.friction - efforts.ambient;
        for (row, value) in self.0.iter_mut().zip([needed, efforts.driven, efforts.ahead]) {
            row[k] = value;
        }
    }
}
