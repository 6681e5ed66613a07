//! A motor: machine, friction and the way they run together.

mod applied;
mod column;
mod contact;
mod cost;
mod running;
mod spec;
mod state;
mod watch;

use std::borrow::Cow;

use crate::friction::{AnyState, Entry, LawState, Statistics};
use crate::plant::Budget;
use crate::support::error::{Error, Result};
use crate::support::interrupt::due;

pub use crate::plant::effects::EffectSpec;
pub use crate::support::samples::{PerSample, Surroundings};
pub use column::Column;
use column::Columns;
pub(crate) use column::Rows;
pub use running::Running;
pub use spec::MotorSpec;
pub use watch::Standing;

/// A motor in plain numbers: what `Motor` is in Python.
#[derive(Debug, Clone)]
pub struct Motor {
    pub(crate) spec: MotorSpec,
    pub(crate) running: Running<f64>,
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

    /// One sample; position and velocity at its end. Where it leads to no number, the motor stays
    /// where it is.
    #[inline]
    pub fn step(&mut self, input: f64, load: f64, dt: f64) -> Result<(f64, f64)> {
        self.running.step_or_stay(input, load, dt)?;
        Ok((self.running.run.position, self.running.run.velocity))
    }

    /// Samples; fills the columns asked for, each as long as `inputs`. Where they lead to no number,
    /// or cannot be gone through, the motor stays where it is; whether they did not.
    pub fn simulate(
        &mut self,
        inputs: &[f64],
        around: Surroundings<'_>,
        dt: PerSample<'_>,
        columns: &mut [(Column, &mut [f64])],
    ) -> Result<bool> {
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
        self.or_stay(|running| {
            running.simulate_rows(inputs, around, |_| 0.0, dt, Columns::new(columns))
        })
        .map(|((), sound)| sound)
    }

    /// Goes on, or stays where it is where that leads to no number; whether it went.
    pub(crate) fn or_stay<T>(
        &mut self,
        go: impl FnOnce(&mut Running<f64>) -> Result<T>,
    ) -> Result<(T, bool)> {
        let before = self.running.standing();
        let done = go(&mut self.running);
        // What an interrupted run leaves is for nobody.
        let sound = done.is_ok() && !due() && self.running.is_sound(&before);
        if !sound {
            self.running.return_to(before);
        }
        done.map(|done| (done, sound)).map_err(|error| self.spec.blame(error))
    }

    /// State of body, drive, effects and friction as named entries.
    pub fn entries(&self) -> Vec<(Cow<'static, str>, Entry)> {
        self.running.entries()
    }

    /// The friction state alone, as a [`crate::simulate::model::FrictionModel`] has it.
    pub fn friction_entries(&self) -> Vec<(&'static str, Entry)> {
        self.running.friction_entries()
    }

    /// Sets the state from named entries; where one of them is wrong, nothing changes.
    pub fn restore(&mut self, entries: &[(String, Entry)]) -> Result<()> {
        self.running.restore(entries)
    }

    /// Branch counters.
    pub fn statistics(&self) -> Statistics {
        self.running.statistics()
    }

    /// Back to rest, or to this position and velocity, with friction never moved. Where the effort
    /// there is no number, the motor stays where it is.
    pub fn reset(&mut self, position: f64, velocity: f64) -> Result<()> {
        let before = self.standing();
        let running = &mut self.running;
        running.machine.effects.forget();
        running.state = running.law.initial();
        running.run = running.machine.start(position, velocity);
        if let Some(way) = &mut running.way {
            way.clear();
        }
        if !running.run.is_finite() {
            self.return_to(before);
            return Err(Error::Nowhere { position });
        }
        running.range.forget();
        Ok(())
    }

    /// Sets the temperature in °C that the next steps have.
    pub fn set_temperature(&mut self, temperature: Option<f64>) {
        self.running.run.temperature = temperature;
    }

    /// Sets the effort that the gear transmits in the next steps, where it is known.
    pub fn set_transmitted(&mut self, transmitted: Option<f64>) {
        self.running.run.transmitted = transmitted;
    }

    /// Switches the drive on or off for the next steps.
    pub fn set_enabled(&mut self, enabled: bool) {
        self.running.run.enabled = enabled;
    }

    /// Sets the session clock and the path travelled so far.
    pub fn set_clock(&mut self, time: f64, path: f64) {
        self.running.run.time = time;
        self.running.run.path = path;
        self.running.range.meet(&[Entry::Number(time), Entry::Number(path)]);
    }

    /// Replaces the friction state by that of a contact that brings these values along, in the
    /// order of the law's start quantities.
    pub fn prime(&mut self, start: &[f64]) {
        self.running.state = self.running.law.primed(start);
        self.meet();
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
        self.meet();
    }

    /// Takes note of a friction state that was put in.
    fn meet(&mut self) {
        let entries = self.friction_entries();
        self.running.range.meet(entries.iter().map(|(_, entry)| entry));
    }

    /// Where it stands.
    pub fn standing(&self) -> Standing {
        self.running.standing()
    }

    /// Back to where it stood.
    pub fn return_to(&mut self, before: Standing) {
        self.running.return_to(before);
    }

    /// Whether all of its state is made of numbers, where it was so before.
    pub fn is_sound(&self, before: &Standing) -> bool {
        self.running.is_sound(before)
    }
}
