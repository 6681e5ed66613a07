//! `FrictionModel`: a law, its parameters and its state.

use std::fmt::Write;
use std::sync::MutexGuard;

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::pyclass::CompareOp;
use pyo3::types::{PyBool, PyDict, PyTuple};
use stiction_core::friction::{Channels, Entry};
use stiction_core::model::{FrictionModel as Core, LawSpec};

use crate::arguments::Text;
use crate::arrays::{Each, samples};
use crate::error::{FASTEST, IntoPython, duration, finite, input_error, velocity};
use crate::real::{real, real_or_none};
use crate::shared::Shared;
use crate::state::{from_dict, keywords, to_dict};

/// A friction law with its parameters and its state.
///
/// Parameters
/// ----------
/// law : str
///     A name of the catalogue, see ``stiction.laws()``.
/// **keywords : float or str
///     Parameters (numbers, SI) and options (words) of the law; what is not given takes its
///     documented default.
///
/// Raises
/// ------
/// InputError
///     Unknown law, parameter or option; value out of bounds or not a number.
#[pyclass(frozen, module = "stiction._native")]
pub struct FrictionModel {
    core: Shared<Core>,
}

impl FrictionModel {
    /// What it is a binding of.
    #[inline]
    pub fn core(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Core>> {
        self.core.lock(py)
    }

    /// Law, parameters, options and state: all that two equal models share.
    fn definition(&self, py: Python<'_>) -> PyResult<(LawSpec, Vec<(&'static str, Entry)>)> {
        let core = self.core(py)?;
        Ok((core.spec().clone(), core.entries()))
    }
}

#[inline]
fn channels(
    py: Python<'_>,
    load: f64,
    effort: f64,
    temperature: Option<f64>,
) -> PyResult<Channels<f64>> {
    // One comparison for the usual case: the sum is finite only where both are.
    if !(load + effort).is_finite() {
        finite(py, "load", load)?;
        finite(py, "effort", effort)?;
    }
    if let Some(temperature) = temperature {
        finite(py, "temperature", temperature)?;
    }
    Ok(Channels { load, effort, temperature, ..Channels::default() })
}

#[pymethods]
impl FrictionModel {
    #[new]
    #[pyo3(signature = (law, /, **keywords))]
    fn new(py: Python<'_>, law: Text, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let Text(law) = law;
        let (numbers, words) = self::keywords(&law, keywords)?;
        let spec = LawSpec::new(&law, &numbers, &words).or_input_error(py)?;
        Ok(Self { core: Shared::new(Core::new(spec)) })
    }

    /// One sample at a held velocity.
    ///
    /// Parameters
    /// ----------
    /// velocity : float
    ///     Held over ``dt``, rad/s or m/s.
    /// dt : float
    ///     Duration in s, positive.
    /// load, effort, temperature : float, optional
    ///     Load on the contact and all other effort on the body (what a stuck contact holds), N·m
    ///     or N; temperature in °C, without which nobody knows it.
    ///
    /// Returns
    /// -------
    /// float
    ///     Friction at the end, N·m or N, positive when it resists positive motion.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A velocity beyond ±1e6 rad/s (m/s), a ``dt`` that is not above 0 and at most 1e6 s, a
    ///     number that is not finite; friction that leaves the range of floats.
    #[pyo3(signature = (velocity, dt, *, load=0.0, effort=0.0, temperature=None))]
    fn step(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = real)] velocity: f64,
        #[pyo3(from_py_with = real)] dt: f64,
        #[pyo3(from_py_with = real)] load: f64,
        #[pyo3(from_py_with = real)] effort: f64,
        #[pyo3(from_py_with = real_or_none)] temperature: Option<f64>,
    ) -> PyResult<f64> {
        let velocity = self::velocity(py, velocity)?;
        let dt = duration(py, "dt", dt)?;
        let channels = channels(py, load, effort, temperature)?;
        self.core(py)?.step(velocity, dt, &channels).or_input_error(py)
    }

    /// Samples at held velocities.
    ///
    /// Parameters
    /// ----------
    /// velocity : array_like, shape (n,) or (batch, n)
    ///     Each value is held over ``dt``, rad/s or m/s.
    /// dt : float
    ///     Duration of a sample in s.
    /// load, effort, temperature : float or array_like shaped like velocity, optional
    ///     As for ``step``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shaped like velocity
    ///     Friction at the end of each sample, N·m or N. With shape (n,) the model is left at its
    ///     end state; with shape (batch, n) every row starts at the present state and the model is
    ///     left as it was.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``step``; other shapes, no samples, a masked one.
    #[pyo3(signature = (velocity, dt, *, load=None, effort=None, temperature=None))]
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        velocity: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = real)] dt: f64,
        load: Option<&Bound<'py, PyAny>>,
        effort: Option<&Bound<'py, PyAny>>,
        temperature: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let dt = duration(py, "dt", dt)?;
        let velocity = samples("velocity", velocity)?;
        if let Some(fastest) = velocity.as_slice()?.iter().find(|v| v.abs() > FASTEST) {
            self::velocity(py, *fastest)?;
        }
        let shape = velocity.shape().to_vec();
        if shape.len() > 2 {
            return Err(input_error(
                py,
                format!("velocity has shape {shape:?}; allowed are (n,) and (batch, n)"),
            ));
        }
        let load = Each::read("load", load, 0.0, &shape)?;
        let effort = Each::read("effort", effort, 0.0, &shape)?;
        let known = temperature.is_some();
        let temperature = Each::read("temperature", temperature, 0.0, &shape)?;
        let result = PyArrayDyn::<f64>::zeros(py, shape.clone(), false);
        {
            let mut filled = result.readwrite();
            let friction = filled.as_slice_mut()?;
            let velocity = velocity.as_slice()?;
            let (load, effort, temperature) =
                (load.per_sample()?, effort.per_sample()?, temperature.per_sample()?);
            let at = |k: usize| Channels {
                load: load.at(k),
                effort: effort.at(k),
                temperature: known.then(|| temperature.at(k)),
                ..Channels::default()
            };
            let ran = self.core.apart(py, |core| {
                if shape.len() == 1 {
                    return core.simulate(velocity, dt, at, friction);
                }
                let n = shape[1];
                let mut rows = velocity.chunks(n).zip(friction.chunks_mut(n)).enumerate();
                rows.try_for_each(|(row, (velocity, friction))| {
                    core.clone().simulate(velocity, dt, |k| at(row * n + k), friction)
                })
            })?;
            ran.or_input_error(py)?;
        }
        Ok(result)
    }

    /// Friction and its slope at a held velocity, changing nothing until ``commit``.
    ///
    /// Parameters
    /// ----------
    /// velocity, dt, load, effort, temperature
    ///     As for ``step``.
    ///
    /// Returns
    /// -------
    /// friction : float
    ///     At the end, N·m or N.
    /// slope : float
    ///     ∂friction/∂velocity at fixed ``dt``, N·m·s/rad or N·s/m.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``step``.
    #[pyo3(signature = (velocity, dt, *, load=0.0, effort=0.0, temperature=None))]
    fn trial(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = real)] velocity: f64,
        #[pyo3(from_py_with = real)] dt: f64,
        #[pyo3(from_py_with = real)] load: f64,
        #[pyo3(from_py_with = real)] effort: f64,
        #[pyo3(from_py_with = real_or_none)] temperature: Option<f64>,
    ) -> PyResult<(f64, f64)> {
        let velocity = self::velocity(py, velocity)?;
        let dt = duration(py, "dt", dt)?;
        let channels = channels(py, load, effort, temperature)?;
        self.core(py)?.trial(velocity, dt, &channels).or_input_error(py)
    }

    /// Accepts the last trial.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     There is none, or something else came after it.
    fn commit(&self, py: Python<'_>) -> PyResult<()> {
        if self.core(py)?.commit() {
            Ok(())
        } else {
            Err(input_error(py, "there is no trial to commit; call trial first"))
        }
    }

    /// Back to a contact that was never moved.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.core(py)?.reset();
        Ok(())
    }

    /// An independent copy, state included.
    fn copy(&self, py: Python<'_>) -> PyResult<Self> {
        Ok(Self { core: Shared::new(self.core(py)?.clone()) })
    }

    fn __copy__(&self, py: Python<'_>) -> PyResult<Self> {
        self.copy(py)
    }

    fn __deepcopy__(&self, memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.copy(memo.py())
    }

    /// Name of the law.
    #[getter]
    fn law(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(self.core(py)?.spec().record.name)
    }

    /// Every parameter by name, as a new dict.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let core = self.core(py)?;
        let spec = core.spec();
        for (parameter, value) in spec.record.parameters.iter().zip(&spec.values) {
            dict.set_item(parameter.name, value)?;
        }
        Ok(dict)
    }

    /// Every option by name, as a new dict.
    #[getter]
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, word) in self.core(py)?.spec().options() {
            dict.set_item(name, word)?;
        }
        Ok(dict)
    }

    /// Whether the contact never gives back more work than it took; some laws do under a condition.
    #[getter]
    fn passive(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.core(py)?.spec().passive())
    }

    /// The state as a dict of floats and arrays; assign one to continue from it.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A state that this law did not return.
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

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let core = self.core(py)?;
        let spec = core.spec();
        let mut text = format!("FrictionModel('{}'", spec.record.name);
        for (parameter, value) in spec.record.parameters.iter().zip(&spec.values) {
            let _ = if value.is_finite() {
                write!(text, ", {}={value:?}", parameter.name)
            } else {
                write!(text, ", {}=float('{value}')", parameter.name)
            };
        }
        for (name, word) in spec.options() {
            let _ = write!(text, ", {name}='{word}'");
        }
        text.push(')');
        Ok(text)
    }

    fn __richcmp__(&self, other: &Bound<'_, PyAny>, op: CompareOp) -> PyResult<Py<PyAny>> {
        let py = other.py();
        let (Ok(other), CompareOp::Eq | CompareOp::Ne) = (other.cast::<Self>(), op) else {
            return Ok(py.NotImplemented());
        };
        // Each copied out under its own lock: two locks at once could wait for each other.
        let equal = self.definition(py)? == other.get().definition(py)?;
        let answer = equal == matches!(op, CompareOp::Eq);
        Ok(PyBool::new(py, answer).to_owned().into_any().unbind())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let py = slf.py();
        let me = slf.get();
        let keywords = me.parameters(py)?;
        keywords.update(me.options(py)?.as_mapping())?;
        let rebuild = py.import("stiction._rebuild")?.getattr("friction_model")?;
        PyTuple::new(
            py,
            [
                rebuild,
                PyTuple::new(
                    py,
                    [
                        me.law(py)?.into_pyobject(py)?.into_any(),
                        keywords.into_any(),
                        me.state(py)?.into_any(),
                    ],
                )?
                .into_any(),
            ],
        )
    }
}
