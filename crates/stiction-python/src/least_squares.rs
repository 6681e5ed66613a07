//! Least squares whose residual and slopes are callables of Python.

use nalgebra::DMatrix;
use numpy::{PyArray1, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use stiction_core::least_squares::{
    Block, Bounds, Parts, Problem, Pull, Settings, Slopes, minimise,
};

use crate::arrays::numbers;
use crate::error::input_error;
use crate::interrupt::detached;
use crate::real::real;

/// Rows of each part, as they came.
struct Rows<'py>(Vec<PyReadonlyArrayDyn<'py, f64>>);

impl Parts for Rows<'_> {
    fn parts(&self) -> Vec<&[f64]> {
        self.0.iter().map(slice).collect()
    }
}

/// Slopes of each part, as they came.
struct Columns<'py> {
    blocks: Vec<(Vec<usize>, PyReadonlyArrayDyn<'py, f64>)>,
    chain: Option<DMatrix<f64>>,
}

impl Slopes for Columns<'_> {
    fn blocks(&self) -> Vec<Block<'_>> {
        let own = self.blocks.iter();
        own.map(|(columns, slopes)| Block { columns, slopes: slice(slopes) }).collect()
    }

    fn chain(&self) -> Option<&DMatrix<f64>> {
        self.chain.as_ref()
    }
}

/// What [`numbers`] has read is contiguous.
fn slice<'a>(array: &'a PyReadonlyArrayDyn<'_, f64>) -> &'a [f64] {
    array.as_slice().unwrap_or_default()
}

/// Two callables, and how many rows each part has.
struct Callables<'a, 'py> {
    py: Python<'py>,
    residual: &'a Bound<'py, PyAny>,
    slopes: &'a Bound<'py, PyAny>,
    rows: Option<Vec<usize>>,
}

impl<'py> Problem for Callables<'_, 'py> {
    type Error = PyErr;
    type Residual = Rows<'py>;
    type Slopes = Columns<'py>;

    fn residual(&mut self, at: &[f64]) -> PyResult<Rows<'py>> {
        let given: Vec<Bound<'py, PyAny>> =
            self.residual.call1((PyArray1::from_slice(self.py, at),))?.extract()?;
        let parts: Vec<_> =
            given.iter().map(|part| numbers("residual", part)).collect::<PyResult<_>>()?;
        let rows: Vec<usize> = parts.iter().map(|part| part.len()).collect();
        if *self.rows.get_or_insert_with(|| rows.clone()) != rows {
            let told = "residual has other rows than before; give as many each time".to_owned();
            return Err(input_error(self.py, told));
        }
        Ok(Rows(parts))
    }

    fn slopes(&mut self, at: &[f64]) -> PyResult<Columns<'py>> {
        type Given<'py> = (Vec<(Vec<usize>, Bound<'py, PyAny>)>, Option<Bound<'py, PyAny>>);
        let (blocks, chain): Given<'py> =
            self.slopes.call1((PyArray1::from_slice(self.py, at),))?.extract()?;
        let blocks: Vec<_> = blocks
            .into_iter()
            .map(|(columns, slopes)| Ok((columns, numbers("slopes", &slopes)?)))
            .collect::<PyResult<_>>()?;
        let fits = |rows: usize, columns: &[usize], shape: &[usize]| {
            let rising = columns.is_sorted_by(|one, next| one < next);
            rising
                && columns.last().is_some_and(|k| *k < at.len())
                && shape == [columns.len(), rows]
        };
        let rows = self.rows.as_deref().unwrap_or_default();
        let mut both = rows.iter().zip(&blocks);
        let whole = rows.len() == blocks.len();
        if !whole || !both.all(|(rows, (columns, own))| fits(*rows, columns, own.shape())) {
            let wanted = "give rising columns and an array of shape (columns, rows) for each part";
            return Err(input_error(self.py, format!("slopes do not fit the residual; {wanted}")));
        }
        Ok(Columns { blocks, chain: chain.map(|own| square(&own, at.len())).transpose()? })
    }

    fn over_rows<R: Send>(&self, work: impl FnOnce() -> R + Send) -> PyResult<R> {
        detached(self.py, work)
    }
}

fn square(given: &Bound<'_, PyAny>, size: usize) -> PyResult<DMatrix<f64>> {
    let array = numbers("chain", given)?;
    if array.shape() != [size, size] {
        let told = format!("chain has shape {:?}; give ({size}, {size})", array.shape());
        return Err(input_error(given.py(), told));
    }
    Ok(DMatrix::from_row_slice(size, size, slice(&array)))
}

/// One number for each of so many variables.
fn each<'py>(
    name: &str,
    given: &Bound<'py, PyAny>,
    size: usize,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let array = numbers(name, given)?;
    if array.shape() != [size] {
        let told = format!("{name} has shape {:?}; give ({size},)", array.shape());
        return Err(input_error(given.py(), told));
    }
    Ok(array)
}

/// Minimises Σr² within bounds.
///
/// Parameters
/// ----------
/// residual : callable
///     Of x: the rows of each part, a sequence of arrays.
/// slopes : callable
///     Of x: for each part the columns that it has and an array of shape (columns, rows), then the
///     derivative of what has these columns by x, shape (p, p), None where that is x itself.
/// begin, low, high, scale : array_like, shape (p,)
/// pulls : sequence of (int, float, float)
///     Variables that rows hold near a centre: place, centre, weight.
/// most : int
///     Evaluations of the residual at most.
/// tolerance, nothing, damping : float
/// straight : bool
/// threads : int
///     Over which sums over rows are divided; they change no bit.
///
/// Returns
/// -------
/// tuple
///     x, the sum of squares, whether it has converged, whether the last slopes belong to x.
///
/// Raises
/// ------
/// InputError
///     Arrays of other shapes.
#[pyfunction]
#[pyo3(signature = (
    residual, slopes, begin, low, high, scale, *, pulls, most, tolerance, nothing, straight, damping,
    threads
))]
#[allow(clippy::too_many_arguments)] // by name from Python
pub fn least_squares<'py>(
    py: Python<'py>,
    residual: &Bound<'py, PyAny>,
    slopes: &Bound<'py, PyAny>,
    begin: &Bound<'py, PyAny>,
    low: &Bound<'py, PyAny>,
    high: &Bound<'py, PyAny>,
    scale: &Bound<'py, PyAny>,
    pulls: Vec<(usize, f64, f64)>,
    most: usize,
    #[pyo3(from_py_with = real)] tolerance: f64,
    #[pyo3(from_py_with = real)] nothing: f64,
    straight: bool,
    #[pyo3(from_py_with = real)] damping: f64,
    threads: usize,
) -> PyResult<(Bound<'py, PyArray1<f64>>, f64, bool, bool)> {
    let begin = numbers("begin", begin)?;
    let size = begin.len();
    let [begin, low, high, scale] = [
        each("begin", begin.as_any(), size)?,
        each("low", low, size)?,
        each("high", high, size)?,
        each("scale", scale, size)?,
    ];
    if let Some((place, ..)) = pulls.iter().find(|(place, ..)| *place >= size) {
        let told = format!("pulls name variable {place}; there are {size}, from 0");
        return Err(input_error(py, told));
    }
    let pulls: Vec<Pull> =
        pulls.into_iter().map(|(place, centre, weight)| Pull { place, centre, weight }).collect();
    let found = minimise(
        &mut Callables { py, residual, slopes, rows: None },
        slice(&begin),
        Bounds { low: slice(&low), high: slice(&high) },
        slice(&scale),
        &pulls,
        Settings { most, tolerance, nothing, straight, damping, threads },
    )?;
    let x = PyArray1::from_vec(py, found.x);
    Ok((x, found.cost, found.converged, found.fresh))
}
