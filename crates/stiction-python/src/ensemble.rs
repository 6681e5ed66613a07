//! `Ensemble`: many machines of one kind, advanced in one call.

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stiction_core::ensemble::{Changes, Ensemble as Core, Inputs, Keep, Plan, Rows};
use stiction_core::lanes::Width;
use stiction_core::motor::Column;

use crate::arguments::{Names, Text, threads_of};
use crate::arrays::{Each, numbers, samples};
use crate::error::{IntoPython, duration, finite, input_error};
use crate::motor::Motor;
use crate::real::real;
use crate::shared::Shared;

/// Base of ``stiction.Ensemble``: everything that needs no Python.
#[pyclass(frozen, subclass, module = "stiction._native")]
pub struct Ensemble {
    core: Shared<Core>,
}

/// Numbers for each sample, for all members or for each.
enum Table<'py> {
    Same(f64),
    Array(PyReadonlyArrayDyn<'py, f64>),
}

impl<'py> Table<'py> {
    /// Reads a number, an array of shape (n,) or one of shape (members, n).
    fn read(
        name: &str,
        given: Option<&Bound<'py, PyAny>>,
        members: usize,
        n: Option<usize>,
    ) -> PyResult<Self> {
        let Some(given) = given else { return Ok(Self::Same(0.0)) };
        let py = given.py();
        if n.is_some()
            && let Ok(number) = real(given)
        {
            return finite(py, name, number).map(Self::Same);
        }
        // The run itself looks whether they are finite.
        let array = numbers(name, given)?;
        let shape = array.shape();
        let fits = match *shape {
            [length] => n.is_none_or(|n| length == n),
            [rows, length] => rows == members && n.is_none_or(|n| length == n),
            _ => false,
        };
        if fits {
            return Ok(Self::Array(array));
        }
        let wanted = n.map_or_else(|| "n".to_owned(), |n| n.to_string());
        Err(input_error(
            py,
            format!("{name} has shape {shape:?}; give ({wanted},) or ({members}, {wanted})"),
        ))
    }

    fn rows(&self) -> PyResult<Rows<'_>> {
        Ok(match self {
            Self::Same(value) => Rows::Same(*value),
            Self::Array(array) if array.ndim() == 1 => Rows::Shared(array.as_slice()?),
            Self::Array(array) => Rows::Each(array.as_slice()?),
        })
    }
}

/// Two arrays: positions, velocities.
type Reached<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl Ensemble {
    #[new]
    #[pyo3(signature = (motor, members, paths, values))]
    fn new(
        py: Python<'_>,
        motor: &Bound<'_, Motor>,
        members: usize,
        paths: Names,
        values: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let Names(paths) = paths;
        if members == 0 {
            return Err(input_error(py, "members = 0 is out of bounds: allowed is 1 or more"));
        }
        let values = values.map(|values| samples("parameters", values)).transpose()?;
        let values = values.as_ref().map_or(Ok(&[][..]), |values| values.as_slice())?;
        let motor = motor.get().core(py)?.clone();
        let core = Core::new(&motor, members, Changes { paths: &paths, values });
        Ok(Self { core: Shared::new(core.or_input_error(py)?) })
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.core.lock(py)?.len())
    }

    /// One sample of every machine.
    ///
    /// Parameters
    /// ----------
    /// current : float or array_like, shape (members,)
    ///     Input held over the sample, one for all or one for each machine.
    /// dt : float
    ///     Duration in s.
    /// load : float or array_like, shape (members,), optional
    ///     External effort, N·m or N, positive along +x; 0 without it.
    ///
    /// Returns
    /// -------
    /// position, velocity : numpy.ndarray, shape (members,)
    ///     At its end; rad and rad/s, or m and m/s.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     Other shapes, numbers that are not finite, a ``dt`` that is not above 0 and at most
    ///     1e6 s or too long for one of the machines, a machine that runs away: then all of them
    ///     stay where they are.
    #[pyo3(signature = (current, dt, *, load=None))]
    fn step_many<'py>(
        &self,
        py: Python<'py>,
        current: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = real)] dt: f64,
        load: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Reached<'py>> {
        let members = self.core.lock(py)?.len();
        let dt = duration(py, "dt", dt)?;
        let current = Each::read("current", Some(current), 0.0, &[members])?;
        let load = Each::read("load", load, 0.0, &[members])?;
        let position = PyArray1::<f64>::zeros(py, members, false);
        let velocity = PyArray1::<f64>::zeros(py, members, false);
        {
            let (mut x, mut v) = (position.readwrite(), velocity.readwrite());
            let (x, v) = (x.as_slice_mut()?, v.as_slice_mut()?);
            let (current, load) = (current.per_sample()?, load.per_sample()?);
            let done = self.core.apart(py, |core| core.step(current, load, dt, x, v))?;
            done.or_input_error(py)?;
        }
        Ok((position, velocity))
    }

    /// Runs every machine on: what ``simulate`` stands on.
    ///
    /// Parameters
    /// ----------
    /// current, dt, load, outputs, target
    ///     As for ``simulate``.
    /// keep : {"every", "last", "rms", "extremes"}
    ///     "every" for rows, or what ``simulate`` calls ``reduce``.
    /// every : int
    ///     Keeps every so many samples one row; unused without rows.
    /// threads : int
    ///     1 to 256.
    ///
    /// Returns
    /// -------
    /// dict of str to numpy.ndarray, shape (members · kept,)
    ///     What is kept of each output, one machine after the other.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``simulate``; ``keep``, ``every`` or ``threads`` that are none of these.
    #[pyo3(signature = (current, dt, *, load, outputs, keep, every, target, threads))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn run<'py>(
        &self,
        py: Python<'py>,
        current: &Bound<'py, PyAny>,
        dt: &Bound<'py, PyAny>,
        load: Option<&Bound<'py, PyAny>>,
        outputs: Names,
        keep: Text,
        every: usize,
        target: Option<&Bound<'py, PyAny>>,
        threads: i64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let Names(outputs) = outputs;
        let (members, law) = {
            let core = self.core.lock(py)?;
            (core.len(), core.spec().friction.clone())
        };
        let threads = threads_of(py, threads)?;
        let current = Table::read("current", Some(current), members, None)?;
        let Table::Array(array) = &current else {
            return Err(input_error(py, "current is a single number; give an array"));
        };
        let n = array.shape()[array.ndim() - 1];
        let inputs = match current.rows()? {
            Rows::Each(values) => Inputs::Each(values),
            Rows::Shared(values) => Inputs::Shared(values),
            Rows::Same(_) => Inputs::Shared(&[]),
        };
        let dt = Each::steps("dt", dt, &[n])?;
        let load = Table::read("load", load, members, Some(n))?;
        let target = Table::read("target", target, members, Some(n))?;
        let Text(keep) = keep;
        let keep = match keep.as_str() {
            "every" if every > 0 => Keep::Every(every),
            "last" => Keep::Last,
            "rms" => Keep::Rms(target.rows()?),
            "extremes" => Keep::Extremes,
            "every" => {
                return Err(input_error(py, "every = 0 is out of bounds: allowed is 1 or more"));
            }
            other => {
                let known = "every, last, rms, extremes";
                return Err(input_error(py, format!("keep '{other}' is unknown; known: {known}")));
            }
        };
        let width = keep.width(n);
        let result = PyDict::new(py);
        let mut arrays = Vec::with_capacity(outputs.len());
        for name in &outputs {
            let column = Column::named(&law, name).or_input_error(py)?;
            if result.contains(name)? {
                return Err(input_error(py, format!("output '{name}' is asked for twice")));
            }
            let array = PyArray1::<f64>::zeros(py, members * width, false);
            result.set_item(name, &array)?;
            arrays.push((column, array.readwrite()));
        }
        let mut columns = Vec::with_capacity(arrays.len());
        for (column, array) in &mut arrays {
            columns.push((*column, array.as_slice_mut()?));
        }
        let plan = Plan {
            samples: n,
            inputs,
            loads: load.rows()?,
            dt: dt.per_sample()?,
            keep,
            threads,
            width: Width::widest(),
        };
        self.core.apart(py, |core| core.run(&plan, &mut columns))?.or_input_error(py)?;
        Ok(result)
    }
}
