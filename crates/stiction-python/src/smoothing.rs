//! Smoothing of a measured motion.

use numpy::PyArray1;
use pyo3::prelude::*;
use stiction_core::smoothing;

use crate::arrays::one_row;
use crate::error::{checked, finite, input_error};
use crate::interrupt::detached;
use crate::real::real;

/// Positions behind readings, each from the widest window that noise does not refute.
///
/// Parameters
/// ----------
/// readings : array_like, shape (n,)
///     rad or m.
/// noise : float
///     Standard deviation of the readings, steps included; rad or m.
/// halves : sequence of int
///     Samples on each side of the middle of each window, rising from 0.
///
/// Returns
/// -------
/// numpy.ndarray, shape (n,)
///
/// Raises
/// ------
/// InputError
///     Readings that are no row of finite numbers, halves that do not rise from 0.
#[pyfunction]
pub fn adaptively_smoothed<'py>(
    py: Python<'py>,
    readings: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = real)] noise: f64,
    halves: Vec<usize>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let readings = one_row("readings", readings)?;
    let noise = finite(py, "noise", noise)?;
    let given = readings.as_slice()?;
    let rising = halves.first() == Some(&0) && halves.is_sorted_by(|one, next| one < next);
    // Wider than all readings together, the ends alone would go on.
    if !rising || halves.last().is_some_and(|widest| *widest > given.len()) {
        let wanted = "give whole numbers that rise from 0 to at most that of the readings";
        return Err(input_error(py, format!("halves = {halves:?} are no windows; {wanted}")));
    }
    let smoothed = detached(py, || smoothing::adaptively_smoothed(given, noise, &halves))?;
    checked(py, "smoothed readings", "", [smoothed.as_slice()])?;
    Ok(PyArray1::from_vec(py, smoothed))
}

/// Positions behind readings that flicker, none of whose turns is late.
///
/// Parameters
/// ----------
/// readings : array_like, shape (n,)
///     rad or m.
/// width : float
///     Of the backlash that keeps flicker out, at least 0; rad or m.
///
/// Returns
/// -------
/// numpy.ndarray, shape (n,)
///
/// Raises
/// ------
/// InputError
///     Readings that are no row of finite numbers, a width that is none.
#[pyfunction]
pub fn played<'py>(
    py: Python<'py>,
    readings: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = real)] width: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let readings = one_row("readings", readings)?;
    let width = finite(py, "width", width)?;
    if width < 0.0 {
        let wanted = "give the width of a backlash, 0 or more";
        return Err(input_error(py, format!("width = {width} is out of bounds: {wanted}")));
    }
    let given = readings.as_slice()?;
    let found = py.detach(|| smoothing::played(given, width));
    checked(py, "followed readings", "", [found.as_slice()])?;
    Ok(PyArray1::from_vec(py, found))
}
