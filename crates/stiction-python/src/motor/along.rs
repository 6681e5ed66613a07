//! What a motor does along a measured motion: efforts, signatures, shots, and their derivatives.

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use stiction_core::sensitivity::{
    EffortSensitivity, follow_columns, follow_sensitivity, sensitivity_into,
};
use stiction_core::shoot::{Pull, shoot_response, shoot_sensitivity};
use stiction_core::signatures::{signature_columns, signatures};

use super::Motor;
use crate::arguments::{Shots, candidates_of, gains_of, threads_of};
use crate::arrays::{Around, Each, one_row, target};
use crate::error::{IntoPython, finite, input_error};
use crate::kernel::RowKernel;
use crate::motion::Motion;

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

/// Two arrays: readings, efforts of the pull.
type Accompanied<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Derivatives as arrays of this shape.
fn arrays(py: Python<'_>, rows: EffortSensitivity, shape: [usize; 2]) -> PyResult<Derivatives<'_>> {
    let array = |values| PyArray1::from_vec(py, values).reshape(shape);
    Ok((array(rows.needed)?, array(rows.driven)?, array(rows.ahead)?))
}

#[pymethods]
impl Motor {
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
}
