//! `RowKernel`: what rows of an effort residual are seen through.

use pyo3::prelude::*;
use stiction_core::kernel::RowKernel as Core;

use crate::arrays::one_row;
use crate::error::{IntoPython, finite};
use crate::real::real;

/// What rows of an effort residual are seen through: means about stamps.
///
/// Parameters
/// ----------
/// weights : array_like, shape (m,)
///     Of the mean of an effort, in the order of the samples; m is odd.
/// second : array_like, shape (m + 2,)
///     Of the mean of the second derivative of a position, 1/s².
/// every : int
///     Samples from one stamp to the next.
/// inertia : float
///     kg·m² or kg; makes an effort of that derivative.
/// held : bool
///     Whether the drive holds its effort from sample to sample: it counts half a sample later.
/// smooth : bool
///     Whether what is needed goes on between samples without jumps: it counts as a second difference
///     of positions weighs it.
///
/// Raises
/// ------
/// InputError
///     Numbers of weights that do not fit, a spacing below 1, numbers that are not finite.
#[pyclass(frozen, module = "stiction._native")]
pub struct RowKernel {
    mean: Vec<f64>,
    second: Vec<f64>,
    every: usize,
    inertia: f64,
    held: bool,
    smooth: bool,
}

impl RowKernel {
    pub fn core(&self) -> Core<'_> {
        Core {
            mean: &self.mean,
            second: &self.second,
            every: self.every,
            inertia: self.inertia,
            held: self.held,
            smooth: self.smooth,
        }
    }
}

#[pymethods]
impl RowKernel {
    #[new]
    #[pyo3(signature = (weights, second, every, inertia=0.0, *, held=false, smooth=false))]
    fn new(
        py: Python<'_>,
        weights: &Bound<'_, PyAny>,
        second: &Bound<'_, PyAny>,
        every: i64,
        #[pyo3(from_py_with = real)] inertia: f64,
        held: bool,
        smooth: bool,
    ) -> PyResult<Self> {
        let numbers =
            |name, value| -> PyResult<Vec<f64>> { Ok(one_row(name, value)?.as_slice()?.to_vec()) };
        let kernel = Self {
            mean: numbers("weights", weights)?,
            second: numbers("second", second)?,
            every: usize::try_from(every).unwrap_or(0),
            inertia: finite(py, "inertia", inertia)?,
            held,
            smooth,
        };
        kernel.core().check().or_input_error(py)?;
        Ok(kernel)
    }
}
