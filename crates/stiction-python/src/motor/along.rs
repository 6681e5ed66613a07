//! What a motor needs along a measured motion: efforts, signatures, and their derivatives.

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use stiction_core::gradient::{Acting, Weighted, gradient};
use stiction_core::motor::Motor as Core;
use stiction_core::sensitivity::{
    EffortSensitivity, follow_columns, follow_sensitivity, sensitivity_into,
};
use stiction_core::signatures::{signature_columns, signatures};

use super::Motor;
use crate::arguments::{Names, Text, candidates_of, gains_of, threads_of};
use crate::arrays::{Around, Each, one_row, rising, target};
use crate::error::{IntoPython, input_error, is_finite, outcome};
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

/// Derivatives as arrays of this shape.
fn arrays(
    py: Python<'_>,
    rows: EffortSensitivity,
    shape: [usize; 2],
    strict: bool,
) -> PyResult<Derivatives<'_>> {
    outcome(
        py,
        strict,
        "derivatives",
        [&rows.needed, &rows.driven, &rows.ahead].map(|row| &**row),
    )?;
    let array = |values| PyArray1::from_vec(py, values).reshape(shape);
    Ok((array(rows.needed)?, array(rows.driven)?, array(rows.ahead)?))
}

#[pymethods]
impl Motor {
    /// Efforts along a measured motion; the motor is left at its end.
    ///
    /// Parameters
    /// ----------
    /// motion : Motion
    ///     Of n samples.
    /// start : dict of str to float, optional
    ///     Start values of the law (``LawRecord.start``, see ``stiction.laws()``), those left out
    ///     0: the contact begins with these, not as it is.
    /// strict : bool
    ///     Whether results that are no finite numbers are refused; a fit, whose trials may run away,
    ///     takes them as they are. The motor then stays where it is.
    ///
    /// Returns
    /// -------
    /// drive, ambient, friction : numpy.ndarray, shape (n,)
    ///     Effort of the drive for its inputs, of gravity and added efforts, and friction, N·m or
    ///     N, at the end of each sample.
    /// ahead : numpy.ndarray, shape (n,)
    ///     How far the centre of mass is ahead of the reading (a second mass, a sensor that errs),
    ///     rad or m.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A start that is no dict, a start value that the law has not, that is not finite or out of
    ///     its bounds; with ``strict`` efforts that are no finite numbers.
    #[pyo3(signature = (motion, *, start=None, strict=true))]
    fn follow<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        start: Option<&Bound<'py, PyAny>>,
        strict: bool,
    ) -> PyResult<Followed<'py>> {
        let motion = motion.get();
        let n = motion.samples();
        let follow = |core: &mut Core| {
            let mut efforts = [vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]];
            core.follow(&motion.measured(), efforts.each_mut().map(Vec::as_mut_slice))?;
            Ok(efforts)
        };
        let finite = |efforts: &[Vec<f64>; 4]| efforts.iter().all(|each| is_finite(each));
        let efforts = self.along(py, start, strict, follow, finite)?;
        outcome(py, strict, "efforts", efforts.iter().map(Vec::as_slice))?;
        let [driven, ambient, friction, ahead] =
            efforts.map(|values| PyArray1::from_vec(py, values));
        Ok((driven, ambient, friction, ahead))
    }

    /// Measured minus needed effort along a measured motion, seen through a kernel.
    ///
    /// The load and the inertia term of what the sensor shows are the caller's. The motor is left
    /// at the end of the motion.
    ///
    /// Parameters
    /// ----------
    /// motion : Motion
    ///     Of n samples.
    /// kernel : RowKernel
    ///     Of m weights, a stamp ``every`` so many samples.
    /// start : dict of str to float, optional
    ///     As for ``follow``.
    /// strict : bool
    ///     As for ``follow``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (rows,)
    ///     N·m or N; rows is (n − m − 1)/``every`` rounded up, 0 where the motion is too short.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``follow``.
    #[pyo3(signature = (motion, kernel, *, start=None, strict=true))]
    fn follow_rows<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        kernel: &Bound<'py, RowKernel>,
        start: Option<&Bound<'py, PyAny>>,
        strict: bool,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let motion = motion.get().measured();
        let kernel = kernel.get().core();
        let follow = |core: &mut Core| core.follow_rows(&motion, &kernel);
        let rows = self.along(py, start, strict, follow, |rows| is_finite(rows))?;
        outcome(py, strict, "efforts", [rows.as_slice()])?;
        Ok(PyArray1::from_vec(py, rows))
    }

    /// Exact derivatives of efforts along a measured motion by parameters; the motor is left as it
    /// was.
    ///
    /// Parameters
    /// ----------
    /// motion : Motion
    ///     Of n samples.
    /// parameters : sequence of str
    ///     Whole paths, as ``parameters`` of the motor has them; where a start is given its values
    ///     too: ``start.force`` and so on.
    /// start : dict of str to float, optional
    ///     As for ``follow``.
    /// strict : bool
    ///     As for ``follow``.
    ///
    /// Returns
    /// -------
    /// needed, driven, ahead : numpy.ndarray, shape (parameters, n)
    ///     Of friction less gravity and added efforts, of the effort of the drive, and of how far
    ///     the centre of mass is ahead of the reading; SI, per unit of the parameter.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``follow``; a path that is unknown, or one of a start that is not given.
    #[pyo3(signature = (motion, parameters, *, start=None, strict=true))]
    fn follow_sensitivity<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        parameters: Names,
        start: Option<&Bound<'py, PyAny>>,
        strict: bool,
    ) -> PyResult<Derivatives<'py>> {
        let Names(parameters) = parameters;
        let motion = motion.get();
        let measured = motion.measured();
        let rows = self.beside(py, start, |spec, start| {
            follow_sensitivity(spec, start, &measured, &parameters)
        })?;
        arrays(py, rows.or_input_error(py)?, [parameters.len(), motion.samples()], strict)
    }

    /// Exact derivatives of what ``follow_rows`` returns by parameters; the motor is left as it
    /// was.
    ///
    /// Parameters
    /// ----------
    /// motion, kernel
    ///     As for ``follow_rows``.
    /// parameters, start, strict
    ///     As for ``follow_sensitivity``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (parameters, rows)
    ///     SI, per unit of the parameter.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``follow_sensitivity``.
    #[pyo3(signature = (motion, parameters, kernel, *, start=None, strict=true))]
    fn follow_columns<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        parameters: Names,
        kernel: &Bound<'py, RowKernel>,
        start: Option<&Bound<'py, PyAny>>,
        strict: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let Names(parameters) = parameters;
        let motion = motion.get();
        let measured = motion.measured();
        let kernel = kernel.get().core();
        let values = self.beside(py, start, |spec, start| {
            follow_columns(spec, start, &measured, &parameters, &kernel)
        })?;
        let (rows, values) = (kernel.rows(motion.samples()), values.or_input_error(py)?);
        outcome(py, strict, "derivatives", [values.as_slice()])?;
        PyArray1::from_vec(py, values).reshape([parameters.len(), rows])
    }

    /// Exact derivatives of efforts along a measured motion by the gains of effects beside the
    /// motor's own, each at the gain 0; the motor is left as it was.
    ///
    /// Parameters
    /// ----------
    /// motion : Motion
    ///     Of n samples.
    /// candidates : iterable of (str, dict of str to float)
    ///     Effects by name, each with its parameters that are no gains, see ``stiction.effects()``.
    /// start : dict of str to float, optional
    ///     As for ``follow``.
    /// threads : int
    ///     1 to 256; results do not depend on it.
    /// strict : bool
    ///     As for ``follow``.
    ///
    /// Returns
    /// -------
    /// needed, driven, ahead : numpy.ndarray, shape (gains, n)
    ///     As for ``follow_sensitivity``, in the order of the candidates and of their gains.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``follow``; candidates that are no such pairs, an unknown effect or parameter, a
    ///     value out of bounds, a gain among them, threads out of bounds.
    #[pyo3(signature = (motion, candidates, *, start=None, threads=1, strict=true))]
    fn signatures<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        candidates: &Bound<'py, PyAny>,
        start: Option<&Bound<'py, PyAny>>,
        threads: i64,
        strict: bool,
    ) -> PyResult<Derivatives<'py>> {
        let motion = motion.get();
        let measured = motion.measured();
        let threads = threads_of(py, threads)?;
        let list = candidates_of(candidates)?;
        let rows = self
            .beside(py, start, |spec, start| signatures(spec, start, &measured, &list, threads))?;
        arrays(py, rows, [gains_of(&list), motion.samples()], strict)
    }

    /// Exact derivatives of what ``follow_rows`` returns by the gains of effects beside the motor's
    /// own; the motor is left as it was.
    ///
    /// Parameters
    /// ----------
    /// motion, kernel
    ///     As for ``follow_rows``.
    /// candidates, start, threads, strict
    ///     As for ``signatures``.
    /// kept : sequence of int, optional
    ///     Rows that are wanted, rising from 0; all of them without it.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (gains, rows)
    ///     SI, per unit of the gain.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``signatures``; rows that do not rise, or that are not there.
    #[pyo3(signature = (motion, candidates, kernel, *, start=None, threads=1, strict=true, kept=None))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn signature_columns<'py>(
        &self,
        py: Python<'py>,
        motion: &Bound<'py, Motion>,
        candidates: &Bound<'py, PyAny>,
        kernel: &Bound<'py, RowKernel>,
        start: Option<&Bound<'py, PyAny>>,
        threads: i64,
        strict: bool,
        kept: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let motion = motion.get();
        let measured = motion.measured();
        let threads = threads_of(py, threads)?;
        let list = candidates_of(candidates)?;
        let kernel = kernel.get().core();
        let rows = kernel.rows(motion.samples());
        let kept = kept.map(|kept| rising("kept", kept, rows)).transpose()?;
        let values = self.beside(py, start, |spec, start| {
            let kernel = (&kernel, kept.as_deref());
            signature_columns(spec, start, &measured, &list, kernel, threads)
        })?;
        outcome(py, strict, "derivatives", [values.as_slice()])?;
        let rows = kept.map_or(rows, |kept| kept.len());
        PyArray1::from_vec(py, values).reshape([gains_of(&list), rows])
    }

    /// Exact derivatives of position and velocity by parameters and by the state at the start, which
    /// is the present one; the motor is left as it was.
    ///
    /// Parameters
    /// ----------
    /// current, dt, load, temperature, enabled, transmitted
    ///     As for ``simulate``.
    /// parameters : sequence of str
    ///     Whole paths, as ``parameters`` of the motor has them; ``start.position`` and
    ///     ``start.velocity`` are those of the motor, with its second mass; where a start is given its
    ///     values too: ``start.force`` and so on.
    /// start : dict of str to float, optional
    ///     As for ``follow``: what the contact brings along in place of its own state.
    /// out : numpy.ndarray, shape (2, parameters, n), optional
    ///     Array to fill, C-contiguous float64.
    /// strict : bool
    ///     As for ``follow``.
    ///
    /// Returns
    /// -------
    /// position, velocity : numpy.ndarray, shape (parameters, n)
    ///     After each sample, rad and rad/s (m and m/s) per unit of the parameter; views of ``out``
    ///     where that is given.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``simulate``; an unknown path, an ``out`` that is no such array.
    #[pyo3(signature = (current, dt, parameters, *, load=None, temperature=None, enabled=None, transmitted=None, start=None, out=None, strict=true))]
    #[allow(clippy::type_complexity)] // a pair of arrays, as Python gets it
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn sensitivity<'py>(
        &self,
        py: Python<'py>,
        current: &Bound<'py, PyAny>,
        dt: &Bound<'py, PyAny>,
        parameters: Names,
        load: Option<&Bound<'py, PyAny>>,
        temperature: Option<&Bound<'py, PyAny>>,
        enabled: Option<&Bound<'py, PyAny>>,
        transmitted: Option<&Bound<'py, PyAny>>,
        start: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
        strict: bool,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let Names(parameters) = parameters;
        let current = one_row("current", current)?;
        let shape = current.shape().to_vec();
        let dt = Each::steps("dt", dt, &shape)?;
        let around = Around::read([load, temperature, enabled, transmitted], &shape)?;
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
        let result = self.beside(py, start, |spec, start| {
            let rows = [position, velocity];
            sensitivity_into(spec, start, current, around, dt, &parameters, rows)
        })?;
        result.or_input_error(py)?;
        outcome(py, strict, "derivatives", [&*both])?;
        drop(rows);
        Ok((array.get_item(0)?, array.get_item(1)?))
    }

    /// Exact derivatives of Σ position·x + velocity·v over the samples of a simulation by its inputs
    /// and by its loads, from the present state; the motor is left as it was.
    ///
    /// Parameters
    /// ----------
    /// current, dt, load, temperature, enabled, transmitted
    ///     As for ``simulate``.
    /// position, velocity : array_like, shape (n,)
    ///     Weights of what ``simulate`` gives after each sample.
    /// by : {"input", "load"}
    ///     By the input of each sample, of a servo its goal, or by its load.
    /// strict : bool
    ///     As for ``follow``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (n,)
    ///     Per unit of the input, or per N·m or N. Its cost grows with the square of n.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``simulate``; weights that are not as many as the samples.
    #[pyo3(
        signature = (current, dt, position, velocity, *, by=Text("input".to_owned()), load=None, temperature=None, enabled=None, transmitted=None, strict=true),
        text_signature = "($self, current, dt, position, velocity, *, by='input', load=None, temperature=None, enabled=None, transmitted=None, strict=True)"
    )]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        current: &Bound<'py, PyAny>,
        dt: &Bound<'py, PyAny>,
        position: &Bound<'py, PyAny>,
        velocity: &Bound<'py, PyAny>,
        by: Text,
        load: Option<&Bound<'py, PyAny>>,
        temperature: Option<&Bound<'py, PyAny>>,
        enabled: Option<&Bound<'py, PyAny>>,
        transmitted: Option<&Bound<'py, PyAny>>,
        strict: bool,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let by = match by.0.as_str() {
            "input" => Acting::Input,
            "load" => Acting::Load,
            other => {
                return Err(input_error(py, format!("by = '{other}'; give 'input' or 'load'")));
            }
        };
        let current = one_row("current", current)?;
        let shape = current.shape().to_vec();
        let dt = Each::steps("dt", dt, &shape)?;
        let around = Around::read([load, temperature, enabled, transmitted], &shape)?;
        let (position, velocity) = (one_row("position", position)?, one_row("velocity", velocity)?);
        let current = current.as_slice()?;
        let weights = Weighted { position: position.as_slice()?, velocity: velocity.as_slice()? };
        let (dt, around) = (dt.per_sample()?, around.surroundings()?);
        let found = self.beside(py, None, |spec, start| {
            gradient(spec, start.running, current, around, dt, weights, by)
        })?;
        let found = found.or_input_error(py)?;
        outcome(py, strict, "derivatives", [found.as_slice()])?;
        Ok(PyArray1::from_vec(py, found))
    }
}
