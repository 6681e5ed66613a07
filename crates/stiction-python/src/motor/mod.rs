//! `Motor`: a machine with friction, advanced sample by sample or over arrays.

mod along;
mod own;
mod shots;

use std::borrow::Cow;
use std::sync::MutexGuard;

use numpy::{PyArray1, PyReadwriteArrayDyn, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use stiction_core::error::{Error, Result};
use stiction_core::friction::Statistics;
use stiction_core::interrupt::due;
use stiction_core::motor::{Column, Motor as Core, MotorSpec};
use stiction_core::segments::Segments;
use stiction_core::sensitivity::Start;

use crate::arguments::{Names, Text, Words, effects_of, integrator_of, numbers_of, servo_of};
use crate::arrays::{Around, Each, one_row, target};
use crate::error::{IntoPython, duration, finite, input_error};
use crate::friction_model::FrictionModel;
use crate::interrupt::detached;
use crate::real::{real, real_or_none};
use crate::shared::Shared;

/// Base of ``stiction.Motor``: everything that needs no Python.
#[pyclass(frozen, subclass, module = "stiction._native")]
pub struct Motor {
    core: Shared<Core>,
}

impl Motor {
    /// What it is a binding of.
    #[inline]
    pub fn core(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Core>> {
        self.core.lock(py)
    }

    /// Start values of the law, where any are given.
    fn start(
        &self,
        py: Python<'_>,
        given: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Option<Vec<f64>>> {
        let Some(given) = given else { return Ok(None) };
        let numbers = numbers_of("start", given)?;
        self.core(py)?.spec().friction.start(&numbers).or_input_error(py).map(Some)
    }

    /// Work on a copy, primed where start values are given, without the interpreter.
    fn primed<R: Send>(
        &self,
        py: Python<'_>,
        start: Option<&Bound<'_, PyAny>>,
        work: impl FnOnce(&mut Core) -> R + Send,
    ) -> PyResult<R> {
        let primed = self.start(py, start)?;
        let mut core = self.core(py)?.clone();
        detached(py, || {
            if let Some(start) = &primed {
                core.prime(start);
            }
            work(&mut core)
        })
    }

    /// Goes along a motion, or stays where it is where that leads to no number; results are refused
    /// then, unless they are wanted as they are.
    fn along<R: Send>(
        &self,
        py: Python<'_>,
        start: Option<&Bound<'_, PyAny>>,
        strict: bool,
        work: impl FnOnce(&mut Core) -> Result<R> + Send,
        finite: impl Fn(&R) -> bool + Sync,
    ) -> PyResult<R> {
        let primed = self.start(py, start)?;
        let done = self.core.apart(py, |core| {
            let before = core.standing();
            if let Some(start) = &primed {
                core.prime(start);
            }
            let done = work(core);
            let refused = done.as_ref().is_ok_and(|done| strict && !finite(done));
            if done.is_err() || refused || due() || !core.is_sound(&before) {
                core.return_to(before);
            }
            done
        })?;
        done.or_input_error(py)
    }

    /// Work that starts where the motor is and leaves it as it was, without the interpreter.
    fn beside<R: Send>(
        &self,
        py: Python<'_>,
        start: Option<&Bound<'_, PyAny>>,
        work: impl FnOnce(&MotorSpec, Start<'_>) -> R + Send,
    ) -> PyResult<R> {
        let primed = self.start(py, start)?;
        let core = self.core(py)?.clone();
        detached(py, || {
            let primed = primed.as_deref();
            work(core.spec(), Start { running: core.running(), primed, free: false })
        })
    }
}

/// A word out of a dict of arrays to fill.
fn word<'a, 'py>(key: &'a Bound<'py, PyAny>) -> PyResult<&'a Bound<'py, PyString>> {
    let wrong = |_| input_error(key.py(), format!("key {key} of out is not a word"));
    key.cast::<PyString>().map_err(wrong)
}

/// Branch counters by name.
fn statistics<'py>(py: Python<'py>, counted: &Statistics) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item(intern!(py, "reversals"), counted.reversals)?;
    dict.set_item(intern!(py, "closings"), counted.closings)?;
    dict.set_item(intern!(py, "breakaways"), counted.breakaways)?;
    dict.set_item(intern!(py, "sticks"), counted.sticks)?;
    dict.set_item(intern!(py, "memory_peak"), counted.memory_peak)?;
    dict.set_item(intern!(py, "memory_growths"), counted.memory_growths)?;
    dict.set_item(intern!(py, "memory_merged"), counted.memory_merged)?;
    Ok(dict)
}

/// Whether columns show that the motion ran away, and the trajectory will say so.
fn shown(columns: &[(Column, &mut [f64])]) -> bool {
    columns.iter().any(|(column, values)| {
        let number = |x: &f64| match column {
            // A level may be infinite by definition.
            Column::Law(_) => !x.is_nan(),
            _ => x.is_finite(),
        };
        !values.iter().all(number)
    })
}

/// Arrays by name, samples, time at the start, branch counters.
type Ran<'py> = (Bound<'py, PyDict>, usize, f64, Bound<'py, PyDict>);

/// Times of the rows, arrays by name, what it cost.
type Held<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyDict>, Bound<'py, PyDict>);

#[pymethods]
impl Motor {
    #[new]
    #[pyo3(
        signature = (
            inertia, torque_constant=1.0, friction=None, *, effects=None, gravity_amplitude=0.0,
            gravity_zero=0.0, weight=0.0, input_limit=f64::INFINITY, servo=None, count=0.0,
            integrator=Text::fast(),
        ),
        text_signature = "(inertia, torque_constant=1.0, friction=None, *, effects=None, \
            gravity_amplitude=0.0, gravity_zero=0.0, weight=0.0, input_limit=1e999, servo=None, \
            count=0.0, integrator='fast')",
    )]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn new(
        py: Python<'_>,
        #[pyo3(from_py_with = real)] inertia: f64,
        #[pyo3(from_py_with = real)] torque_constant: f64,
        friction: Option<&Bound<'_, PyAny>>,
        effects: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = real)] gravity_amplitude: f64,
        #[pyo3(from_py_with = real)] gravity_zero: f64,
        #[pyo3(from_py_with = real)] weight: f64,
        #[pyo3(from_py_with = real)] input_limit: f64,
        servo: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = real)] count: f64,
        integrator: Text,
    ) -> PyResult<Self> {
        let wanted = "give a FrictionModel, for instance FrictionModel('coulomb', coulomb=0.35)";
        let Some(friction) = friction else {
            return Err(input_error(py, format!("friction is missing; {wanted}")));
        };
        let friction = friction.cast::<FrictionModel>().map_err(|_| {
            input_error(py, format!("friction is {friction}, no FrictionModel; {wanted}"))
        })?;
        let model = friction.get().core(py)?.clone();
        let spec = MotorSpec {
            input_limit,
            gravity_amplitude,
            gravity_zero,
            weight,
            count,
            servo: servo.map(servo_of).transpose()?,
            effects: effects.map(effects_of).transpose()?.unwrap_or_default(),
            integrator: integrator_of(py, &integrator)?,
            ..MotorSpec::new(inertia, torque_constant, model.spec().clone())
        };
        let core = Core::with_contact(spec, &model).or_input_error(py)?;
        Ok(Self { core: Shared::new(core) })
    }

    /// One sample with held current.
    ///
    /// Parameters
    /// ----------
    /// current : float
    ///     Input of the drive: A, V, N·m or N, of a servo its goal, rad or m.
    /// dt : float
    ///     Duration in s.
    /// load : float
    ///     External effort, N·m or N, positive along +x.
    /// temperature : float, optional
    ///     In °C, for what depends on it; without it nobody knows it.
    /// enabled : bool
    ///     Whether the drive is on.
    ///
    /// Returns
    /// -------
    /// position, velocity : float
    ///     At its end; rad and rad/s, or m and m/s.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     Numbers that are not finite, a ``dt`` that is not above 0 and at most 1e6 s or too long
    ///     for this machine, a motion that runs away: then the motor stays where it is.
    #[pyo3(signature = (current, dt, *, load=0.0, temperature=None, enabled=true))]
    fn step(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = real)] current: f64,
        #[pyo3(from_py_with = real)] dt: f64,
        #[pyo3(from_py_with = real)] load: f64,
        #[pyo3(from_py_with = real_or_none)] temperature: Option<f64>,
        enabled: bool,
    ) -> PyResult<(f64, f64)> {
        let current = finite(py, "current", current)?;
        let dt = duration(py, "dt", dt)?;
        let load = finite(py, "load", load)?;
        let temperature = temperature.map(|t| finite(py, "temperature", t)).transpose()?;
        let mut core = self.core(py)?;
        core.set_transmitted(None);
        core.set_temperature(temperature);
        core.set_enabled(enabled);
        core.step(current, load, dt).or_input_error(py)
    }

    /// Samples with held inputs: what ``simulate`` stands on.
    ///
    /// Parameters
    /// ----------
    /// current, dt, load, temperature, enabled, outputs, out, transmitted
    ///     As for ``simulate``.
    ///
    /// Returns
    /// -------
    /// columns : dict of str to numpy.ndarray, shape (n,)
    ///     By name.
    /// length : int
    ///     How many samples there were.
    /// start : float
    ///     Time on the session clock before the first, s.
    /// statistics : dict of str to int
    ///     How often each branch was taken since the last reset.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``simulate``.
    #[pyo3(signature = (current, dt, load=None, temperature=None, enabled=None, outputs=None, out=None, transmitted=None))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn run<'py>(
        &self,
        py: Python<'py>,
        current: &Bound<'py, PyAny>,
        dt: &Bound<'py, PyAny>,
        load: Option<&Bound<'py, PyAny>>,
        temperature: Option<&Bound<'py, PyAny>>,
        enabled: Option<&Bound<'py, PyAny>>,
        outputs: Option<Words<'py>>,
        out: Option<&Bound<'py, PyDict>>,
        transmitted: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Ran<'py>> {
        let current = one_row("current", current)?;
        let n = current.len();
        let dt = Each::steps("dt", dt, &[n])?;
        let around = Around::read([load, temperature, enabled, transmitted], &[n])?;
        // Name and array of each column, where there is one to fill.
        let wanted: Vec<(Bound<'py, PyString>, Option<Bound<'py, PyAny>>)> = match (outputs, out) {
            (Some(Words(names)), out) => {
                let given = out.map_or_else(|| PyDict::new(py), Clone::clone);
                for key in given.keys() {
                    let key = Text::of(word(&key)?);
                    if !names.iter().any(|name| Text::of(name) == key) {
                        return Err(input_error(
                            py,
                            format!("out['{key}'] is not among outputs; add it there or drop it"),
                        ));
                    }
                }
                let array = |name: Bound<'py, PyString>| Ok((name.clone(), given.get_item(name)?));
                names.into_iter().map(array).collect::<PyResult<_>>()?
            }
            (None, Some(out)) if !out.is_empty() => {
                let own = |(key, array)| Ok((word(&key)?.clone(), Some(array)));
                out.iter().map(own).collect::<PyResult<_>>()?
            }
            _ => {
                let names = Column::names(&self.core(py)?.spec().friction);
                names.into_iter().map(|name| (PyString::new(py, &name), None)).collect()
            }
        };
        let kinds = {
            let core = self.core(py)?;
            let law = &core.spec().friction;
            let kind = |name: &Bound<'py, PyString>| {
                Column::named(law, &name.to_string_lossy()).or_input_error(py)
            };
            wanted.iter().map(|(name, _)| kind(name)).collect::<PyResult<Vec<Column>>>()?
        };
        let result = PyDict::new(py);
        let mut arrays: Vec<(Column, PyReadwriteArrayDyn<'py, f64>)> =
            Vec::with_capacity(wanted.len());
        for ((name, array), column) in wanted.iter().zip(kinds) {
            let fresh;
            let array = match array {
                Some(array) => array,
                None => {
                    fresh = PyArray1::<f64>::zeros(py, n, false).into_any();
                    &fresh
                }
            };
            if arrays.iter().any(|(other, _)| *other == column) {
                return Err(input_error(py, format!("output '{name}' is asked for twice")));
            }
            result.set_item(name, array)?;
            arrays.push((column, target(format_args!("out['{name}']"), array, &[n])?));
        }
        let current = current.as_slice()?;
        let (dt, around) = (dt.per_sample()?, around.surroundings()?);
        let mut columns = Vec::with_capacity(arrays.len());
        for (column, array) in &mut arrays {
            columns.push((*column, array.as_slice_mut()?));
        }
        let ran = self.core.apart(py, |core| {
            let start = core.running().run.time;
            if !core.simulate(current, around, dt, &mut columns)? && !shown(&columns) {
                return Err(Error::RanUnseen);
            }
            Ok((start, core.statistics()))
        });
        let (start, counted) = ran?.or_input_error(py)?;
        Ok((result, n, start, statistics(py, &counted)?))
    }

    /// Inputs held for long: what ``simulate_segments`` stands on.
    ///
    /// Parameters
    /// ----------
    /// durations, current, times, load, temperature, enabled, outputs
    ///     As for ``simulate_segments``.
    /// tolerance : float
    ///     Error of the position that is aimed at, rad (m).
    ///
    /// Returns
    /// -------
    /// times : numpy.ndarray, shape (rows,)
    ///     Of the rows, s from the start.
    /// columns : dict of str to numpy.ndarray, shape (rows,)
    ///     By name.
    /// cost : dict of str to int
    ///     ``evaluations`` of the law, ``steps``, ``refused`` steps and ``rests``.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``simulate_segments``.
    #[pyo3(signature = (
        durations, current, *, tolerance, times=None, load=None, temperature=None, enabled=None, outputs=None
    ))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn run_segments<'py>(
        &self,
        py: Python<'py>,
        durations: &Bound<'py, PyAny>,
        current: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = real)] tolerance: f64,
        times: Option<&Bound<'py, PyAny>>,
        load: Option<&Bound<'py, PyAny>>,
        temperature: Option<&Bound<'py, PyAny>>,
        enabled: Option<&Bound<'py, PyAny>>,
        outputs: Option<Names>,
    ) -> PyResult<Held<'py>> {
        let durations = one_row("durations", durations)?;
        let current = one_row("current", current)?;
        let around = Around::read([load, temperature, enabled, None], durations.shape())?;
        let times = times.map(|times| one_row("times", times)).transpose()?;
        let segments = Segments {
            durations: durations.as_slice()?,
            inputs: current.as_slice()?,
            around: around.surroundings()?,
            tolerance,
            times: times.as_ref().map_or(Ok(&[][..]), |times| times.as_slice())?,
        };
        segments.check().or_input_error(py)?;
        let rows = segments.rows();
        let law = self.core(py)?.spec().friction.clone();
        let all = || Column::names(&law).into_iter().map(Cow::into_owned).collect();
        let names: Vec<String> = outputs.map_or_else(all, |names| names.0);
        let kinds = names.iter().map(|name| Column::named(&law, name).or_input_error(py));
        let kinds = kinds.collect::<PyResult<Vec<Column>>>()?;
        if let Some(k) = (0..kinds.len()).find(|k| kinds[..*k].contains(&kinds[*k])) {
            return Err(input_error(py, format!("output '{}' is asked for twice", names[k])));
        }
        let mut arrays = vec![vec![0.0; rows.len()]; kinds.len()];
        let mut columns: Vec<(Column, &mut [f64])> =
            kinds.into_iter().zip(arrays.iter_mut().map(Vec::as_mut_slice)).collect();
        let ran = self.core.apart(py, |core| {
            let (account, sound) = core.simulate_segments(&segments, &mut columns)?;
            if sound || shown(&columns) { Ok(account) } else { Err(Error::RanUnseen) }
        });
        let account = ran?.or_input_error(py)?;
        let result = PyDict::new(py);
        for (name, values) in names.iter().zip(arrays) {
            result.set_item(name, PyArray1::from_vec(py, values))?;
        }
        let cost = PyDict::new(py);
        cost.set_item("evaluations", account.evaluations)?;
        cost.set_item("steps", account.steps)?;
        cost.set_item("refused", account.refused)?;
        cost.set_item("rests", account.rests)?;
        Ok((PyArray1::from_vec(py, rows), result, cost))
    }
}
