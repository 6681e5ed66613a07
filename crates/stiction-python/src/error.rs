//! Errors of the core as `stiction.errors.InputError`.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;
use stiction_core::error::{Error, Shown};
use stiction_core::finite::check;

static INPUT_ERROR: PyOnceLock<Py<PyType>> = PyOnceLock::new();
static CALL_ERROR: PyOnceLock<Py<PyType>> = PyOnceLock::new();

/// An `InputError` with this sentence.
pub fn input_error(py: Python<'_>, sentence: impl Into<String>) -> PyErr {
    match INPUT_ERROR.import(py, "stiction.errors", "InputError") {
        Ok(class) => PyErr::from_type(class.clone(), (sentence.into(),)),
        Err(error) => error,
    }
}

/// A `CallError` with this sentence: an `InputError` that is a `TypeError` too.
pub fn call_error(py: Python<'_>, sentence: impl Into<String>) -> PyErr {
    match CALL_ERROR.import(py, "stiction.errors", "CallError") {
        Ok(class) => PyErr::from_type(class.clone(), (sentence.into(),)),
        Err(error) => error,
    }
}

/// The Python form of the core's results.
pub trait IntoPython<T> {
    /// Turns a core error into an `InputError`.
    fn or_input_error(self, py: Python<'_>) -> PyResult<T>;
}

impl<T> IntoPython<T> for stiction_core::error::Result<T> {
    fn or_input_error(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| input_error(py, error.to_string()))
    }
}

/// Refuses a number that is not finite.
#[inline]
pub fn finite(py: Python<'_>, name: &str, value: f64) -> PyResult<f64> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(input_error(py, format!("{name} = {value} is not a finite number; give a finite one")))
    }
}

/// Beyond these, forces of allowed parameters leave the range of floats.
pub const FASTEST: f64 = 1e6;
const LONGEST: f64 = 1e6;

/// Refuses a velocity that is not finite or faster than anything.
#[inline]
pub fn velocity(py: Python<'_>, value: f64) -> PyResult<f64> {
    if value.abs() <= FASTEST {
        Ok(value)
    } else if !value.is_finite() {
        finite(py, "velocity", value)
    } else {
        Err(input_error(
            py,
            format!(
                "velocity = {} is out of bounds: allowed is -1e6 to 1e6 in rad/s or m/s",
                Shown(value)
            ),
        ))
    }
}

/// Refuses a step that is not a positive time.
#[inline]
pub fn duration(py: Python<'_>, name: &str, value: f64) -> PyResult<f64> {
    if value > 0.0 && value <= LONGEST {
        Ok(value)
    } else {
        Err(input_error(
            py,
            format!(
                "{name} = {} is not a step: allowed is a positive number of seconds, at most 1e6",
                Shown(value)
            ),
        ))
    }
}

/// Whether all numbers are finite.
pub fn is_finite(values: &[f64]) -> bool {
    check("", values).is_ok()
}

/// Refuses results of which one is no finite number, unless they are wanted as they are.
pub fn outcome<'a>(
    py: Python<'_>,
    strict: bool,
    what: &str,
    results: impl IntoIterator<Item = &'a [f64]>,
) -> PyResult<()> {
    if strict {
        checked(py, what, ", or strict=False to have them as they are", results)
    } else {
        Ok(())
    }
}

/// The same where there is no way to have them.
pub fn checked<'a>(
    py: Python<'_>,
    what: &str,
    way: &str,
    results: impl IntoIterator<Item = &'a [f64]>,
) -> PyResult<()> {
    for values in results {
        if let Err(Error::BadSample { place, given, .. }) = check(what, values) {
            return Err(input_error(
                py,
                format!(
                    "the {what} left the range of floats: number {place} is {given}, though all that \
                     was given is finite; give numbers nearer to those of a machine{way}"
                ),
            ));
        }
    }
    Ok(())
}
