//! Where a motor gets to by itself along a measured motion, and its derivatives.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use stiction_core::shoot::{Pull, Windows, shoot_response, shoot_sensitivity};
use stiction_core::signatures::shoot_signatures;

use super::Motor;
use crate::arguments::{Names, Shots, candidates_of, gains_of, threads_of};
use crate::error::{IntoPython, finite, input_error, outcome};
use crate::motion::Motion;
use crate::real::real;

/// Two arrays: readings, efforts of the pull.
type Accompanied<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl Motor {
    /// What each of many short simulations along a measured motion comes to.
    ///
    /// A window starts at the measured position and velocity, with friction as ``follow`` leaves it
    /// there. The motor is left as it was.
    ///
    /// Parameters
    /// ----------
    /// motion : Motion
    /// weights : array_like, shape (samples of a window,)
    ///     Of what the sensor would read after each sample of a window.
    /// stride : int
    ///     Samples from the start of a window to that of the next.
    /// start : dict of str to float, optional
    ///     As for ``follow``.
    /// strict : bool
    ///     As for ``follow``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (windows,)
    ///     Sum, by the weights, of what the sensor would read less what it read at the start, rad
    ///     or m times their unit; empty where the motion is shorter than a window.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``follow``; weights that are no flat array of finite numbers, a stride below 1, a
    ///     ``dt`` too long for this machine.
    #[pyo3(signature = (motion, weights, stride, *, start=None, strict=true))]
    fn shoot<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        weights: &Bound<'py, PyAny>,
        stride: i64,
        start: Option<&Bound<'py, PyAny>>,
        strict: bool,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let motion = motion.get();
        let measured = motion.measured();
        let shots = Shots::read(weights, stride)?;
        let windows = shots.windows()?;
        let sums = self.primed(py, start, |core| core.shoot(&measured, &windows))?;
        let sums = sums.or_input_error(py)?;
        outcome(py, strict, "motions of the windows", [sums.as_slice()])?;
        Ok(PyArray1::from_vec(py, sums))
    }

    /// One simulation drawn to a measured motion by a spring and a damper; the motor is left as it
    /// was, and starts from there.
    ///
    /// Parameters
    /// ----------
    /// motion : Motion
    ///     Of n samples.
    /// stiffness : float
    ///     Of the spring, N·m/rad or N/m.
    /// damping : float
    ///     Of the damper, N·m·s/rad or N·s/m.
    /// start : dict of str to float, optional
    ///     As for ``follow``.
    /// strict : bool
    ///     As for ``follow``.
    ///
    /// Returns
    /// -------
    /// readings : numpy.ndarray, shape (n,)
    ///     What the sensor reads after each sample, without its rounding, rad or m.
    /// pull : numpy.ndarray, shape (n,)
    ///     Effort of spring and damper during it, N·m or N.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``follow``; a stiffness or damping that is not finite, a ``dt`` too long for this
    ///     machine.
    #[pyo3(signature = (motion, stiffness, damping, *, start=None, strict=true))]
    fn accompany<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        #[pyo3(from_py_with = real)] stiffness: f64,
        #[pyo3(from_py_with = real)] damping: f64,
        start: Option<&Bound<'py, PyAny>>,
        strict: bool,
    ) -> PyResult<Accompanied<'py>> {
        let motion = motion.get();
        let measured = motion.measured();
        let stiffness = finite(py, "stiffness", stiffness)?;
        let pull = Pull { stiffness, damping: finite(py, "damping", damping)? };
        let rows = self.primed(py, start, |core| core.accompany(&measured, pull))?;
        let (readings, efforts) = rows.or_input_error(py)?;
        outcome(py, strict, "readings and efforts", [readings.as_slice(), efforts.as_slice()])?;
        Ok((PyArray1::from_vec(py, readings), PyArray1::from_vec(py, efforts)))
    }

    /// Exact derivatives of what ``shoot`` returns by parameters; the motor is left as it was.
    ///
    /// Parameters
    /// ----------
    /// motion, weights, stride
    ///     As for ``shoot``.
    /// parameters, start, strict
    ///     As for ``follow_sensitivity``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (parameters, windows)
    ///     SI, per unit of the parameter.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``shoot`` and ``follow_sensitivity``.
    #[pyo3(signature = (motion, weights, stride, parameters, *, start=None, strict=true))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn shoot_sensitivity<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        weights: &Bound<'py, PyAny>,
        stride: i64,
        parameters: Names,
        start: Option<&Bound<'py, PyAny>>,
        strict: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let Names(parameters) = parameters;
        let motion = motion.get();
        let measured = motion.measured();
        let shots = Shots::read(weights, stride)?;
        let windows = shots.windows()?;
        let rows = self.beside(py, start, |spec, start| {
            shoot_sensitivity(spec, start, &measured, &windows, &parameters)
        })?;
        let shape = [parameters.len(), windows.number(motion.samples())];
        let rows = rows.or_input_error(py)?;
        outcome(py, strict, "derivatives", [rows.as_slice()])?;
        PyArray1::from_vec(py, rows).reshape(shape)
    }

    /// Exact derivatives of what ``shoot`` returns by an effort along +x that acts during one part
    /// of each window; the motor is left as it was.
    ///
    /// Parameters
    /// ----------
    /// motion, weights, stride, start, strict
    ///     As for ``shoot``.
    /// parts : int
    ///     How many equal ones a window has; the last takes the rest.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (parts, windows)
    ///     Per N·m or N.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``shoot``; parts below 1 or more than a window has samples.
    #[pyo3(signature = (motion, weights, stride, parts, *, start=None, strict=true))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn shoot_response<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        weights: &Bound<'py, PyAny>,
        stride: i64,
        parts: i64,
        start: Option<&Bound<'py, PyAny>>,
        strict: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let motion = motion.get();
        let measured = motion.measured();
        let shots = Shots::read(weights, stride)?;
        let windows = shots.windows()?;
        let parts = parts_of(py, parts, &windows)?;
        let rows = self.beside(py, start, |spec, start| {
            shoot_response(spec, start, &measured, &windows, parts)
        })?;
        let shape = [parts, windows.number(motion.samples())];
        let rows = rows.or_input_error(py)?;
        outcome(py, strict, "derivatives", [rows.as_slice()])?;
        PyArray1::from_vec(py, rows).reshape(shape)
    }

    /// Derivatives of what ``shoot`` returns by the gains of effects beside the motor's own, each at
    /// the gain 0; the motor is left as it was.
    ///
    /// Of first order in two places: what an effect adds is taken along the measured motion, and how
    /// the simulated motion answers to an effort (see ``shoot_response``) along its own.
    ///
    /// Parameters
    /// ----------
    /// motion, weights, stride, parts
    ///     As for ``shoot_response``.
    /// candidates, start, threads, strict
    ///     As for ``signatures``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (gains, windows)
    ///     SI, per unit of the gain.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``shoot_response`` and ``signatures``.
    #[pyo3(signature = (motion, weights, stride, candidates, parts, *, start=None, threads=1, strict=true))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn shoot_signatures<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        weights: &Bound<'py, PyAny>,
        stride: i64,
        candidates: &Bound<'py, PyAny>,
        parts: i64,
        start: Option<&Bound<'py, PyAny>>,
        threads: i64,
        strict: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let motion = motion.get();
        let measured = motion.measured();
        let shots = Shots::read(weights, stride)?;
        let windows = shots.windows()?;
        let parts = parts_of(py, parts, &windows)?;
        let threads = threads_of(py, threads)?;
        let list = candidates_of(candidates)?;
        let rows = self.beside(py, start, |spec, start| {
            shoot_signatures(spec, start, &measured, &windows, &list, parts, threads)
        })?;
        let shape = [gains_of(&list), windows.number(motion.samples())];
        let rows = rows.or_input_error(py)?;
        outcome(py, strict, "derivatives", [rows.as_slice()])?;
        PyArray1::from_vec(py, rows).reshape(shape)
    }
}

/// Into how many parts a window is divided.
fn parts_of(py: Python<'_>, parts: i64, windows: &Windows<'_>) -> PyResult<usize> {
    let most = windows.weights.len();
    usize::try_from(parts).ok().filter(|n| (1..=most).contains(n)).ok_or_else(|| {
        input_error(
            py,
            format!("parts = {parts} is out of bounds: allowed is 1 to {most}, one a sample"),
        )
    })
}
