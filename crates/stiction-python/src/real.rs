//! Real numbers from Python: what is of another kind is refused, though numpy would make floats of it.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyString};

/// Kinds of numpy's types that hold real numbers.
pub const KINDS: &str = "biuf";

/// A real number: of complex ones the half would be lost, and of dates the unit.
#[inline]
pub fn real(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    match value.cast::<PyFloat>() {
        Ok(number) => Ok(number.value()),
        Err(_) => converted(value),
    }
}

/// The same, or nothing.
pub fn real_or_none(value: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    if value.is_none() { Ok(None) } else { real(value).map(Some) }
}

#[inline(never)]
fn converted(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    if value.hasattr("mask")? {
        return Err(PyTypeError::new_err("must be real number, not masked"));
    }
    if !value.is_instance_of::<PyInt>()
        && let Ok(dtype) = value.getattr("dtype")
        && !kind_of(&dtype).is_ok_and(|kind| KINDS.contains(&kind))
    {
        return Err(PyTypeError::new_err(format!("must be real number, not {dtype}")));
    }
    value.extract()
}

/// The letter of a numpy type.
pub fn kind_of(dtype: &Bound<'_, PyAny>) -> PyResult<String> {
    let kind = dtype.getattr("kind")?;
    Ok(kind.cast::<PyString>()?.to_string_lossy().into_owned())
}
