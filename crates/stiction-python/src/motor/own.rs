//! What a motor is and where it is: parameters, settings, state, counters.

use std::borrow::Cow;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stiction_core::integrate::Integrator;
use stiction_core::motor::Column;
use stiction_core::servo::Servo;

use super::Motor;
use crate::error::{IntoPython, finite};
use crate::friction_model::{FrictionModel, effects_dict, fixed};
use crate::real::real;
use crate::state::{from_dict, to_dict};

fn servo_settings<'py>(py: Python<'py>, servo: &Servo) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (spec, value) in Servo::SPECS.iter().zip(servo.values()) {
        dict.set_item(spec.name, value)?;
    }
    Ok(dict)
}

#[pymethods]
impl Motor {
    /// Paths and values of all parameters, as a new dict that cannot be changed in place.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let dict = PyDict::new(py);
        for (path, value) in self.core(py)?.spec().parameters() {
            dict.set_item(path, value)?;
        }
        fixed(dict, "a motor has the parameters it was made with; make another Motor")
    }

    /// Keywords that rebuild the motor, but for friction.
    fn settings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let spec = self.core(py)?.spec().clone();
        let effects = effects_dict(py, &spec.effects)?;
        let dict = PyDict::new(py);
        dict.set_item("inertia", spec.inertia)?;
        dict.set_item("torque_constant", spec.gain)?;
        dict.set_item("effects", effects)?;
        dict.set_item("gravity_amplitude", spec.gravity_amplitude)?;
        dict.set_item("gravity_zero", spec.gravity_zero)?;
        dict.set_item("weight", spec.weight)?;
        dict.set_item("input_limit", spec.input_limit)?;
        dict.set_item("servo", spec.servo.map(|servo| servo_settings(py, &servo)).transpose()?)?;
        dict.set_item("count", spec.count)?;
        let integrator = match spec.integrator {
            Integrator::Fast => "fast",
            Integrator::Reference => "reference",
        };
        dict.set_item("integrator", integrator)?;
        Ok(dict)
    }

    /// Law, parameters and options of the friction: what ``FrictionModel`` takes.
    fn friction_settings<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(&'static str, Bound<'py, PyDict>)> {
        let spec = self.core(py)?.spec().friction.clone();
        let dict = PyDict::new(py);
        for (parameter, value) in spec.record.parameters.iter().zip(&spec.values) {
            dict.set_item(parameter.name, value)?;
        }
        for (name, word) in spec.options() {
            dict.set_item(name, word)?;
        }
        Ok((spec.record.name, dict))
    }

    /// Names of the columns that a trajectory can show.
    #[getter]
    fn output_names(&self, py: Python<'_>) -> PyResult<Vec<Cow<'static, str>>> {
        Ok(Column::names(&self.core(py)?.spec().friction))
    }

    /// Back to rest, or to motion, with friction never moved.
    ///
    /// Parameters
    /// ----------
    /// position : float
    ///     rad or m.
    /// velocity : float
    ///     rad/s or m/s.
    /// time, path : float
    ///     Time on the session clock, s, and path travelled so far, rad or m: what slow effects go
    ///     by.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A velocity beyond ±1e6 rad/s (m/s), numbers that are not finite, a position so far away
    ///     that the effort there is none.
    #[pyo3(signature = (position=0.0, velocity=0.0, *, time=0.0, path=0.0))]
    fn reset(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = real)] position: f64,
        #[pyo3(from_py_with = real)] velocity: f64,
        #[pyo3(from_py_with = real)] time: f64,
        #[pyo3(from_py_with = real)] path: f64,
    ) -> PyResult<()> {
        let position = finite(py, "position", position)?;
        let velocity = crate::error::velocity(py, velocity)?;
        let (time, path) = (finite(py, "time", time)?, finite(py, "path", path)?);
        let mut core = self.core(py)?;
        core.reset(position, velocity).or_input_error(py)?;
        core.set_clock(time, path);
        Ok(())
    }

    /// Time on the session clock in s: what the state calls ``time``.
    #[getter]
    fn clock(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.core(py)?.running().run.time)
    }

    /// State of body and friction as a dict of floats and arrays; assign one to continue from it.
    ///
    /// A state of the law that is called like one of the body's is ``friction.name`` here.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A state that no motor with this law returned.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let entries = self.core(py)?.entries();
        to_dict(py, entries)
    }

    #[setter]
    fn set_state(&self, state: &Bound<'_, PyDict>) -> PyResult<()> {
        let entries = from_dict(state)?;
        self.core(state.py())?.restore(&entries).or_input_error(state.py())
    }

    /// State of the friction alone, as a ``FrictionModel`` of this law has it.
    ///
    /// Returns
    /// -------
    /// dict of str to float or numpy.ndarray
    fn friction_state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let entries = self.core(py)?.friction_entries();
        to_dict(py, entries)
    }

    /// What resists at the contact, with its effects: what ``friction_model`` stands on.
    ///
    /// Returns
    /// -------
    /// model : FrictionModel
    ///     In the present state.
    /// left_out : list of str
    ///     Effects of this motor that no contact alone has.
    fn contact(&self, py: Python<'_>) -> PyResult<(FrictionModel, Vec<&'static str>)> {
        let (model, left_out) = self.core(py)?.friction_model().or_input_error(py)?;
        Ok((FrictionModel::of(model), left_out))
    }

    /// Takes over the state of another motor.
    ///
    /// Parameters
    /// ----------
    /// other : Motor
    ///     Of the same definition, which is not checked: what it is is taken over too.
    fn adopt(&self, other: &Bound<'_, Self>) -> PyResult<()> {
        let py = other.py();
        // Copied out first: two locks at once could wait for each other.
        let core = other.get().core(py)?.clone();
        *self.core(py)? = core;
        Ok(())
    }

    /// How often each branch was taken: reversals, closings, break-aways, sticks, memory.
    #[getter]
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let counted = self.core(py)?.statistics();
        super::statistics(py, &counted)
    }
}
