//! `Motor`: a machine with friction, advanced sample by sample or over arrays.

use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadwriteArrayDyn, PyUntypedArrayMethods,
};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use stiction_core::friction::Statistics;
use stiction_core::integrate::Integrator;
use stiction_core::motor::{Column, Motor as Core, MotorSpec};
use stiction_core::segments::Segments;
use stiction_core::sensitivity::{
    EffortSensitivity, Start, follow_columns, follow_sensitivity, sensitivity_into,
};
use stiction_core::servo::Servo;
use stiction_core::shoot::{Pull, shoot_response, shoot_sensitivity};
use stiction_core::signatures::{signature_columns, signatures};

use crate::arguments::{
    Shots, candidates_of, effects_of, gains_of, integrator_of, numbers_of, servo_of, threads_of,
};
use crate::arrays::{Around, Each, one_row, target};
use crate::error::{IntoPython, duration, finite, input_error, velocity};
use crate::friction_model::FrictionModel;
use crate::kernel::RowKernel;
use crate::motion::Motion;
use crate::state::{from_dict, to_dict};

/// Base of ``stiction.Motor``: everything that needs no Python.
#[pyclass(frozen, subclass, module = "stiction._native")]
pub struct Motor {
    core: Mutex<Core>,
}

impl Motor {
    #[inline]
    fn lock(&self) -> MutexGuard<'_, Core> {
        self.core.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What it is a binding of.
    pub fn core(&self) -> MutexGuard<'_, Core> {
        self.lock()
    }

    /// Start values of the law, where any are given.
    fn start(
        &self,
        py: Python<'_>,
        given: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Option<Vec<f64>>> {
        let Some(given) = given else { return Ok(None) };
        let numbers = numbers_of("start", given)?;
        self.lock().spec().friction.start(&numbers).or_input_error(py).map(Some)
    }

    /// A copy, primed where start values are given.
    fn primed(&self, start: Option<&[f64]>) -> Core {
        let mut core = self.lock().clone();
        if let Some(start) = start {
            core.prime(start);
        }
        core
    }

    /// Work that starts where the motor is and leaves it as it was, without the interpreter.
    fn beside<R: Send>(
        &self,
        py: Python<'_>,
        start: Option<&Bound<'_, PyAny>>,
        work: impl FnOnce(&MotorSpec, Start<'_>) -> R + Send,
    ) -> PyResult<R> {
        let primed = self.start(py, start)?;
        Ok(py.detach(|| {
            let core = self.lock().clone();
            work(core.spec(), Start { running: core.running(), primed: primed.as_deref() })
        }))
    }
}

fn servo_settings<'py>(py: Python<'py>, servo: &Servo) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (spec, value) in Servo::SPECS.iter().zip(servo.values()) {
        dict.set_item(spec.name, value)?;
    }
    Ok(dict)
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
    Ok(dict)
}

/// Arrays by name, samples, time at the start, branch counters.
type Ran<'py> = (Bound<'py, PyDict>, usize, f64, Bound<'py, PyDict>);

/// Three arrays: needed, driven, ahead.
type Derivatives<'py> =
    (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);
/// Four arrays: drive, ambient, friction, ahead.
type Followed<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// Times of the rows, arrays by name, what it cost.
type Held<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyDict>, Bound<'py, PyDict>);

/// Two arrays: readings, efforts of the pull.
type Accompanied<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Derivatives as arrays of this shape.
fn arrays(py: Python<'_>, rows: EffortSensitivity, shape: [usize; 2]) -> PyResult<Derivatives<'_>> {
    let array = |values| PyArray1::from_vec(py, values).reshape(shape);
    Ok((array(rows.needed)?, array(rows.driven)?, array(rows.ahead)?))
}

#[pymethods]
impl Motor {
    #[new]
    #[pyo3(signature = (
        inertia, torque_constant=1.0, friction=None, *, effects=None, gravity_amplitude=0.0,
        gravity_zero=0.0, weight=0.0, input_limit=f64::INFINITY, servo=None, count=0.0,
        integrator="fast",
    ))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn new(
        py: Python<'_>,
        inertia: f64,
        torque_constant: f64,
        friction: Option<&Bound<'_, FrictionModel>>,
        effects: Option<&Bound<'_, PyDict>>,
        gravity_amplitude: f64,
        gravity_zero: f64,
        weight: f64,
        input_limit: f64,
        servo: Option<&Bound<'_, PyAny>>,
        count: f64,
        integrator: &str,
    ) -> PyResult<Self> {
        let Some(friction) = friction else {
            return Err(input_error(
                py,
                "friction is missing; give a FrictionModel, for instance \
                 FrictionModel('coulomb', coulomb=0.35)",
            ));
        };
        let (law, state) = {
            let core = friction.get().lock();
            (core.spec().clone(), core.state().clone())
        };
        let spec = MotorSpec {
            input_limit,
            gravity_amplitude,
            gravity_zero,
            weight,
            count,
            servo: servo.map(servo_of).transpose()?,
            effects: effects_of(effects)?,
            integrator: integrator_of(py, integrator)?,
            ..MotorSpec::new(inertia, torque_constant, law)
        };
        let mut core = Core::new(spec).or_input_error(py)?;
        core.set_friction_state(state);
        Ok(Self { core: Mutex::new(core) })
    }

    /// One sample with held current; position and velocity at its end.
    #[pyo3(signature = (current, dt, *, load=0.0, temperature=None, enabled=true))]
    fn step(
        &self,
        py: Python<'_>,
        current: f64,
        dt: f64,
        load: f64,
        temperature: Option<f64>,
        enabled: bool,
    ) -> PyResult<(f64, f64)> {
        let current = finite(py, "current", current)?;
        let dt = duration(py, "dt", dt)?;
        let load = finite(py, "load", load)?;
        let temperature = temperature.map(|t| finite(py, "temperature", t)).transpose()?;
        let mut core = self.lock();
        core.set_temperature(temperature);
        core.set_enabled(enabled);
        core.step(current, load, dt).or_input_error(py)
    }

    /// Samples with held inputs: the arrays asked for, by name, how many samples there were, the time
    /// on the session clock before the first, and how often each branch was taken.
    #[pyo3(signature = (current, dt, *, load=None, temperature=None, enabled=None, outputs=None, out=None))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn run<'py>(
        &self,
        py: Python<'py>,
        current: &Bound<'py, PyAny>,
        dt: &Bound<'py, PyAny>,
        load: Option<&Bound<'py, PyAny>>,
        temperature: Option<&Bound<'py, PyAny>>,
        enabled: Option<&Bound<'py, PyAny>>,
        outputs: Option<Vec<Bound<'py, PyString>>>,
        out: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Ran<'py>> {
        let current = one_row("current", current)?;
        let n = current.len();
        let dt = Each::steps("dt", dt, &[n])?;
        let around = Around::read([load, temperature, enabled], &[n])?;
        let names = match (outputs, out) {
            (Some(names), out) => {
                let given = out.map_or_else(|| PyDict::new(py), Clone::clone);
                for key in given.keys() {
                    let key = word(&key)?.to_str()?;
                    if !names.iter().any(|name| *name == *key) {
                        return Err(input_error(
                            py,
                            format!("out['{key}'] is not among outputs; add it there or drop it"),
                        ));
                    }
                }
                names
            }
            (None, Some(out)) if !out.is_empty() => {
                out.keys().iter().map(|key| word(&key).cloned()).collect::<PyResult<_>>()?
            }
            _ => {
                let names = Column::names(&self.lock().spec().friction);
                names.into_iter().map(|name| PyString::new(py, name)).collect()
            }
        };
        let result = PyDict::new(py);
        let mut arrays: Vec<(Column, PyReadwriteArrayDyn<'py, f64>)> =
            Vec::with_capacity(names.len());
        for name in &names {
            let word = name.to_str()?;
            let column = Column::named(&self.lock().spec().friction, word);
            let column = column.or_input_error(py)?;
            let array = match out.map(|out| out.get_item(name)).transpose()?.flatten() {
                Some(array) => array,
                None => PyArray1::<f64>::zeros(py, n, false).into_any(),
            };
            if arrays.iter().any(|(other, _)| *other == column) {
                return Err(input_error(py, format!("output '{word}' is asked for twice")));
            }
            result.set_item(name, &array)?;
            arrays.push((column, target(format_args!("out['{word}']"), &array, &[n])?));
        }
        let current = current.as_slice()?;
        let (dt, around) = (dt.per_sample()?, around.surroundings()?);
        let mut columns = Vec::with_capacity(arrays.len());
        for (column, array) in &mut arrays {
            columns.push((*column, array.as_slice_mut()?));
        }
        let (start, counted) = py
            .detach(|| {
                let mut core = self.lock();
                let start = core.running().run.time;
                core.simulate(current, around, dt, &mut columns)?;
                Ok((start, core.statistics()))
            })
            .or_input_error(py)?;
        Ok((result, n, start, statistics(py, &counted)?))
    }

    /// Inputs held for durations (shape (n,) each): times of the rows, the arrays asked for, by name,
    /// and what it cost.
    #[pyo3(signature = (
        durations, current, *, tolerance, times=None, load=None, temperature=None, enabled=None, outputs=None
    ))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn run_segments<'py>(
        &self,
        py: Python<'py>,
        durations: &Bound<'py, PyAny>,
        current: &Bound<'py, PyAny>,
        tolerance: f64,
        times: Option<&Bound<'py, PyAny>>,
        load: Option<&Bound<'py, PyAny>>,
        temperature: Option<&Bound<'py, PyAny>>,
        enabled: Option<&Bound<'py, PyAny>>,
        outputs: Option<Vec<String>>,
    ) -> PyResult<Held<'py>> {
        let durations = one_row("durations", durations)?;
        let current = one_row("current", current)?;
        let around = Around::read([load, temperature, enabled], durations.shape())?;
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
        let law = self.lock().spec().friction.clone();
        let all = || Column::names(&law).iter().map(|name| (*name).to_owned()).collect();
        let names: Vec<String> = outputs.unwrap_or_else(all);
        let kinds = names.iter().map(|name| Column::named(&law, name).or_input_error(py));
        let kinds = kinds.collect::<PyResult<Vec<Column>>>()?;
        let mut arrays = vec![vec![0.0; rows.len()]; kinds.len()];
        let mut columns: Vec<(Column, &mut [f64])> =
            kinds.into_iter().zip(arrays.iter_mut().map(Vec::as_mut_slice)).collect();
        let account = py
            .detach(|| self.lock().simulate_segments(&segments, &mut columns))
            .or_input_error(py)?;
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

    /// Efforts along a measured motion: of the drive for its inputs, of gravity and added efforts,
    /// friction, and how far the centre of mass is ahead of the reading (a second mass, a sensor
    /// that errs); each of shape (n,), at the end of each sample.
    /// With start values of the law (`laws()`) the contact begins with these, not as it is.
    #[pyo3(signature = (motion, *, start=None))]
    fn follow<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Followed<'py>> {
        let motion = motion.get();
        let start = self.start(py, start)?;
        let n = motion.samples();
        let mut efforts = [vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        {
            let motion = motion.measured();
            let arrays = efforts.each_mut().map(Vec::as_mut_slice);
            py.detach(|| {
                let mut core = self.lock();
                if let Some(start) = &start {
                    core.prime(start);
                }
                core.follow(&motion, arrays)
            })
            .or_input_error(py)?;
        }
        let [driven, ambient, friction, ahead] =
            efforts.map(|values| PyArray1::from_vec(py, values));
        Ok((driven, ambient, friction, ahead))
    }

    /// Measured minus needed effort along a measured motion, seen through a kernel; shape (rows,).
    /// The load and the inertia term of what the sensor shows are the caller's. Starts as in
    /// ``follow``.
    #[pyo3(signature = (motion, kernel, *, start=None))]
    fn follow_rows<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        kernel: &Bound<'py, RowKernel>,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let motion = motion.get().measured();
        let kernel = kernel.get().core();
        let start = self.start(py, start)?;
        let rows = py.detach(|| {
            let mut core = self.lock();
            if let Some(start) = &start {
                core.prime(start);
            }
            core.follow_rows(&motion, &kernel)
        });
        Ok(PyArray1::from_vec(py, rows.or_input_error(py)?))
    }

    /// Exact derivatives by parameters along a measured motion: of friction less gravity and added
    /// efforts, of the effort of the drive, and of how far the centre of mass is ahead of the
    /// reading; each of shape (parameters, n).
    /// Where a start is given its values are parameters too: `start.force` and so on. The motor is
    /// left as it was.
    #[pyo3(signature = (motion, parameters, *, start=None))]
    fn follow_sensitivity<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        parameters: Vec<String>,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Derivatives<'py>> {
        let motion = motion.get();
        let measured = motion.measured();
        let rows = self.beside(py, start, |spec, start| {
            follow_sensitivity(spec, start, &measured, &parameters)
        })?;
        arrays(py, rows.or_input_error(py)?, [parameters.len(), motion.samples()])
    }

    /// Exact derivatives, by the parameters at these paths, of measured minus needed effort along
    /// a measured motion, seen through a kernel; shape (parameters, rows). Starts as in
    /// ``follow_sensitivity``. The motor is left as it was.
    #[pyo3(signature = (motion, parameters, kernel, *, start=None))]
    fn follow_columns<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        parameters: Vec<String>,
        kernel: &Bound<'py, RowKernel>,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let motion = motion.get();
        let measured = motion.measured();
        let kernel = kernel.get().core();
        let values = self.beside(py, start, |spec, start| {
            follow_columns(spec, start, &measured, &parameters, &kernel)
        })?;
        let rows = kernel.rows(motion.samples());
        PyArray1::from_vec(py, values.or_input_error(py)?).reshape([parameters.len(), rows])
    }

    /// Exact derivatives along a measured motion by the gains of effects beside the motor's own,
    /// each at the gain 0 and in the shape given as (name, parameters): of friction less gravity and
    /// added efforts, of the effort of the drive, and of how far the centre of mass is ahead of the
    /// reading; each of shape (gains, n), in the order of the candidates and of their gains. The
    /// motor is left as it was.
    #[pyo3(signature = (motion, candidates, *, start=None, threads=1))]
    fn signatures<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        candidates: &Bound<'py, PyAny>,
        start: Option<&Bound<'py, PyAny>>,
        threads: i64,
    ) -> PyResult<Derivatives<'py>> {
        let motion = motion.get();
        let measured = motion.measured();
        let threads = threads_of(py, threads)?;
        let list = candidates_of(candidates)?;
        let rows = self
            .beside(py, start, |spec, start| signatures(spec, start, &measured, &list, threads))?;
        arrays(py, rows, [gains_of(&list), motion.samples()])
    }

    /// The same of measured minus needed effort, seen through a kernel; shape (gains, rows).
    #[pyo3(signature = (motion, candidates, kernel, *, start=None, threads=1))]
    fn signature_columns<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        candidates: &Bound<'py, PyAny>,
        kernel: &Bound<'py, RowKernel>,
        start: Option<&Bound<'py, PyAny>>,
        threads: i64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let motion = motion.get();
        let measured = motion.measured();
        let threads = threads_of(py, threads)?;
        let list = candidates_of(candidates)?;
        let kernel = kernel.get().core();
        let values = self.beside(py, start, |spec, start| {
            signature_columns(spec, start, &measured, &list, &kernel, threads)
        })?;
        PyArray1::from_vec(py, values).reshape([gains_of(&list), kernel.rows(motion.samples())])
    }

    /// What each of many short simulations along a measured motion comes to: the sum, by `weights`
    /// (shape (samples of a window,)), of what the sensor would read after each sample less what it
    /// read at the start; shape (windows,). Windows start every `stride` samples at the measured
    /// position and velocity, with friction as `follow` leaves it there.
    #[pyo3(signature = (motion, weights, stride, *, start=None))]
    fn shoot<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        weights: &Bound<'py, PyAny>,
        stride: i64,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let motion = motion.get();
        let measured = motion.measured();
        let shots = Shots::read(weights, stride)?;
        let windows = shots.windows()?;
        let start = self.start(py, start)?;
        let sums = py.detach(|| self.primed(start.as_deref()).shoot(&measured, &windows));
        Ok(PyArray1::from_vec(py, sums.or_input_error(py)?))
    }

    /// One simulation drawn to a measured motion by a spring and a damper: what the sensor reads
    /// after each sample, and the effort of the pull during it; shape (n,) each. The motor is left
    /// as it was.
    #[pyo3(signature = (motion, stiffness, damping, *, start=None))]
    fn accompany<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        stiffness: f64,
        damping: f64,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Accompanied<'py>> {
        let motion = motion.get();
        let measured = motion.measured();
        let stiffness = finite(py, "stiffness", stiffness)?;
        let pull = Pull { stiffness, damping: finite(py, "damping", damping)? };
        let start = self.start(py, start)?;
        let rows = py.detach(|| self.primed(start.as_deref()).accompany(&measured, pull));
        let (readings, efforts) = rows.or_input_error(py)?;
        Ok((PyArray1::from_vec(py, readings), PyArray1::from_vec(py, efforts)))
    }

    /// Exact derivatives of what `shoot` returns by parameters and start values; shape
    /// (parameters, windows). The motor is left as it was.
    #[pyo3(signature = (motion, weights, stride, parameters, *, start=None))]
    fn shoot_sensitivity<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        weights: &Bound<'py, PyAny>,
        stride: i64,
        parameters: Vec<String>,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let motion = motion.get();
        let measured = motion.measured();
        let shots = Shots::read(weights, stride)?;
        let windows = shots.windows()?;
        let rows = self.beside(py, start, |spec, start| {
            shoot_sensitivity(spec, start, &measured, &windows, &parameters)
        })?;
        let shape = [parameters.len(), windows.number(motion.samples())];
        PyArray1::from_vec(py, rows.or_input_error(py)?).reshape(shape)
    }

    /// Exact derivatives of what `shoot` returns by an effort along +x that acts during one part of
    /// each window, for every of so many equal parts; shape (parts, windows). The motor is left as
    /// it was.
    #[pyo3(signature = (motion, weights, stride, parts, *, start=None))]
    fn shoot_response<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        weights: &Bound<'py, PyAny>,
        stride: i64,
        parts: i64,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let motion = motion.get();
        let measured = motion.measured();
        let shots = Shots::read(weights, stride)?;
        let windows = shots.windows()?;
        let most = windows.weights.len();
        let Some(parts) = usize::try_from(parts).ok().filter(|n| (1..=most).contains(n)) else {
            return Err(input_error(
                py,
                format!("parts = {parts} is out of bounds: allowed is 1 to {most}, one a sample"),
            ));
        };
        let rows = self.beside(py, start, |spec, start| {
            shoot_response(spec, start, &measured, &windows, parts)
        })?;
        let shape = [parts, windows.number(motion.samples())];
        PyArray1::from_vec(py, rows.or_input_error(py)?).reshape(shape)
    }

    /// Exact derivatives of position and velocity by parameters, from the present state.
    ///
    /// Returns two arrays of shape (parameters, n), parts of one of shape (2, parameters, n) that
    /// may be given as ``out``; the motor is left as it was.
    #[pyo3(signature = (current, dt, parameters, *, load=None, temperature=None, enabled=None, out=None))]
    #[allow(clippy::type_complexity)] // a pair of arrays, as Python gets it
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn sensitivity<'py>(
        &self,
        py: Python<'py>,
        current: &Bound<'py, PyAny>,
        dt: &Bound<'py, PyAny>,
        parameters: Vec<String>,
        load: Option<&Bound<'py, PyAny>>,
        temperature: Option<&Bound<'py, PyAny>>,
        enabled: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let current = one_row("current", current)?;
        let shape = current.shape().to_vec();
        let dt = Each::steps("dt", dt, &shape)?;
        let around = Around::read([load, temperature, enabled], &shape)?;
        let current = current.as_slice()?;
        let (dt, around) = (dt.per_sample()?, around.surroundings()?);
        let shape = [2, parameters.len(), current.len()];
        // One array, for the system gives large ones larger pages.
        let array = match out {
            Some(array) => array.clone(),
            None => PyArray3::<f64>::zeros(py, shape, false).into_any(),
        };
        let mut rows = target("out", &array, &shape)?;
        let both = rows.as_slice_mut()?;
        let (position, velocity) = both.split_at_mut(both.len() / 2);
        let result = py.detach(|| {
            let core = self.lock().clone();
            let rows = [position, velocity];
            sensitivity_into(core.spec(), core.running(), current, around, dt, &parameters, rows)
        });
        drop(rows);
        result.or_input_error(py)?;
        Ok((array.get_item(0)?, array.get_item(1)?))
    }

    /// Paths and values of all parameters.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (path, value) in self.lock().spec().parameters() {
            dict.set_item(path, value)?;
        }
        Ok(dict)
    }

    /// Keywords that rebuild the motor, but for friction.
    fn settings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let spec = self.lock().spec().clone();
        let effects = PyDict::new(py);
        for effect in &spec.effects {
            let values = PyDict::new(py);
            for (parameter, value) in effect.record.parameters.iter().zip(&effect.values) {
                values.set_item(parameter.name, value)?;
            }
            effects.set_item(effect.record.name, values)?;
        }
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
        let spec = self.lock().spec().friction.clone();
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
    fn output_names(&self) -> Vec<&'static str> {
        Column::names(&self.lock().spec().friction)
    }

    /// Back to rest at this position (or in motion at this velocity), friction never moved; the
    /// session clock in s and the path travelled so far are what slow effects go by.
    #[pyo3(signature = (position=0.0, velocity=0.0, *, time=0.0, path=0.0))]
    fn reset(
        &self,
        py: Python<'_>,
        position: f64,
        velocity: f64,
        time: f64,
        path: f64,
    ) -> PyResult<()> {
        let position = finite(py, "position", position)?;
        let velocity = self::velocity(py, velocity)?;
        let (time, path) = (finite(py, "time", time)?, finite(py, "path", path)?);
        let mut core = self.lock();
        core.reset(position, velocity);
        core.set_clock(time, path);
        Ok(())
    }

    /// Time on the session clock in s: what the state calls ``time``.
    #[getter]
    fn clock(&self) -> f64 {
        self.lock().running().run.time
    }

    /// State of body and friction as a dict of floats and arrays; assign one to continue from it.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let entries = self.lock().entries();
        to_dict(py, entries)
    }

    #[setter]
    fn set_state(&self, state: &Bound<'_, PyDict>) -> PyResult<()> {
        let entries = from_dict(state)?;
        self.lock().restore(&entries).or_input_error(state.py())
    }

    /// Takes over the state of another motor of the same definition, whatever it is.
    fn adopt(&self, other: &Bound<'_, Self>) {
        // Copied out first: two locks at once could wait for each other.
        let core = other.get().lock().clone();
        *self.lock() = core;
    }

    /// How often each branch was taken: reversals, closings, break-aways, sticks, memory.
    #[getter]
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let counted = self.lock().statistics();
        self::statistics(py, &counted)
    }
}
