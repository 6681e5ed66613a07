//! Arrays from Python: C-contiguous float64 is borrowed, anything else is converted.

use std::fmt::Display;

use numpy::{
    PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyReadwriteArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use stiction_core::error::Shown;
use stiction_core::finite::check;
use stiction_core::motor::{PerSample, Surroundings};

use crate::error::{IntoPython, duration, input_error};
use crate::real::{KINDS, kind_of, real};

static ASARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
static IS_MASKED: PyOnceLock<Py<PyAny>> = PyOnceLock::new();

/// A C-contiguous float64 array of at least one dimension and one element, all of it finite.
pub fn samples<'py>(
    name: &str,
    values: &Bound<'py, PyAny>,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let array = numbers(name, values)?;
    check(name, array.as_slice()?).or_input_error(values.py())?;
    Ok(array)
}

/// The same where whoever goes through it looks whether it is finite.
pub fn numbers<'py>(
    name: &str,
    values: &Bound<'py, PyAny>,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let py = values.py();
    refuse_masked(name, values)?;
    let array = match values.cast::<PyArrayDyn<f64>>() {
        Ok(array) if array.is_c_contiguous() => array.clone(),
        _ => converted(name, values)?,
    };
    if array.ndim() == 0 {
        return Err(input_error(
            py,
            format!("{name} is a single number; give an array of shape (n,), or use step"),
        ));
    }
    if array.len() == 0 {
        return Err(input_error(py, format!("{name} is empty; give at least one sample")));
    }
    Ok(array.readonly())
}

/// What can be read as real numbers, as an array of them.
fn converted<'py>(name: &str, values: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = values.py();
    let wrong =
        |why: &dyn Display| input_error(py, format!("{name} is not an array of numbers: {why}"));
    let refused = |error: PyErr| wrong(error.value(py));
    let asarray = ASARRAY.import(py, "numpy", "asarray")?;
    let array = asarray.call1((values,)).map_err(refused)?;
    let dtype = array.getattr("dtype")?;
    let kind = kind_of(&dtype)?;
    // Python's own numbers, Fraction and Decimal among them, are objects.
    if kind != "O" && !KINDS.contains(&kind) {
        return Err(wrong(&format_args!("the type is {dtype}")));
    }
    // Of those numpy would take the real half of a complex one, and the number in a date.
    if kind == "O" {
        for item in array.getattr("flat")?.try_iter()? {
            let item = item?;
            if !item.is_none() {
                real(&item).map_err(refused)?;
            }
        }
    }
    let options = PyDict::new(py);
    options.set_item("dtype", "float64")?;
    options.set_item("order", "C")?;
    let array = asarray.call((array,), Some(&options)).map_err(refused)?;
    Ok(array.cast_into::<PyArrayDyn<f64>>()?)
}

/// Refuses an array that is masked somewhere: what lies under the mask is no reading.
fn refuse_masked(name: &str, values: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = values.py();
    if values.is_exact_instance_of::<PyArrayDyn<f64>>() || !values.hasattr("mask")? {
        return Ok(());
    }
    if IS_MASKED.import(py, "numpy.ma", "is_masked")?.call1((values,))?.extract()? {
        return Err(input_error(
            py,
            format!("{name} is masked in places; fill these, or leave them out"),
        ));
    }
    Ok(())
}

/// Places that rise, each below an end.
pub fn rising(name: &str, places: &Bound<'_, PyAny>, end: usize) -> PyResult<Vec<usize>> {
    let found: Vec<usize> = places.extract().unwrap_or_else(|_| vec![end]);
    let rise = found.is_sorted_by(|one, next| one < next);
    if rise && found.last().is_none_or(|last| *last < end) {
        return Ok(found);
    }
    let told = format!(
        "{name} is no sequence of whole numbers that rise; give some from 0 to below {end}"
    );
    Err(input_error(places.py(), told))
}

/// A one-dimensional [`samples`].
pub fn one_row<'py>(
    name: &str,
    values: &Bound<'py, PyAny>,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let array = samples(name, values)?;
    if array.ndim() != 1 {
        return Err(input_error(
            values.py(),
            format!("{name} has {} dimensions; give an array of shape (n,)", array.ndim()),
        ));
    }
    Ok(array)
}

/// One number for all samples or one for each.
pub enum Each<'py> {
    /// The same for all.
    Same(f64),
    /// One for each.
    Array(PyReadonlyArrayDyn<'py, f64>),
}

impl<'py> Each<'py> {
    /// Reads a scalar, an array of this shape, or nothing.
    pub fn read(
        name: &str,
        value: Option<&Bound<'py, PyAny>>,
        neutral: f64,
        shape: &[usize],
    ) -> PyResult<Self> {
        let Some(value) = value else { return Ok(Self::Same(neutral)) };
        let py = value.py();
        if let Ok(number) = real(value) {
            return crate::error::finite(py, name, number).map(Self::Same);
        }
        let array = samples(name, value)?;
        if array.shape() != shape {
            return Err(input_error(
                py,
                format!(
                    "{name} has shape {:?} where {shape:?} is needed; give one value a sample or \
                     one number",
                    array.shape()
                ),
            ));
        }
        Ok(Self::Array(array))
    }

    /// Reads steps: a positive number, or one positive number a sample.
    pub fn steps(name: &str, value: &Bound<'py, PyAny>, shape: &[usize]) -> PyResult<Self> {
        let each = Self::read(name, Some(value), f64::NAN, shape)?;
        match &each {
            Self::Same(step) => {
                duration(value.py(), name, *step)?;
            }
            Self::Array(steps) => {
                let steps = steps.as_slice()?;
                // Stamps begin anywhere, durations above 0: what rises from 0 or below is a clock.
                if steps[0] <= 0.0 && steps.is_sorted_by(|one, next| one < next) && steps.len() > 1
                {
                    let told = format!(
                        "{name} rises from {} to {}, so these are stamps: give durations, as \
                         numpy.diff does, or one for all samples",
                        Shown(steps[0]),
                        Shown(steps[steps.len() - 1])
                    );
                    return Err(input_error(value.py(), told));
                }
                for step in steps {
                    duration(value.py(), name, *step)?;
                }
            }
        }
        Ok(each)
    }

    /// The form that the core takes, usable without the interpreter.
    pub fn per_sample(&self) -> PyResult<PerSample<'_>> {
        Ok(match self {
            Self::Same(value) => PerSample::Same(*value),
            Self::Array(array) => PerSample::Each(array.as_slice()?),
        })
    }
}

/// What acts beside the input: external effort, temperature, whether the drive is on, and what the gear
/// transmits.
pub struct Around<'py> {
    load: Each<'py>,
    temperature: Option<Each<'py>>,
    enabled: Option<Each<'py>>,
    transmitted: Option<Each<'py>>,
}

impl<'py> Around<'py> {
    /// Reads load, temperature, whether the drive is on, and what the gear transmits; without a load there
    /// is none, without a temperature nobody knows it, a drive is on unless it is said to be off, and a
    /// gear transmits the load.
    pub fn read(given: [Option<&Bound<'py, PyAny>>; 4], shape: &[usize]) -> PyResult<Self> {
        let [load, temperature, enabled, transmitted] = given;
        let read = |name: &str, given: Option<&Bound<'py, PyAny>>| {
            given.map(|given| Each::read(name, Some(given), 0.0, shape)).transpose()
        };
        Ok(Self {
            load: Each::read("load", load, 0.0, shape)?,
            temperature: read("temperature", temperature)?,
            enabled: read("enabled", enabled)?,
            transmitted: read("transmitted", transmitted)?,
        })
    }

    /// The form that the core takes, usable without the interpreter.
    pub fn surroundings(&self) -> PyResult<Surroundings<'_>> {
        Ok(Surroundings {
            load: self.load.per_sample()?,
            transmitted: self.transmitted.as_ref().map(Each::per_sample).transpose()?,
            temperature: self.temperature.as_ref().map(Each::per_sample).transpose()?,
            enabled: self.enabled.as_ref().map(Each::per_sample).transpose()?,
        })
    }
}

/// A writable C-contiguous float64 array of this shape to fill, called `name` in a complaint.
pub fn target<'py>(
    name: impl Display,
    value: &Bound<'py, PyAny>,
    shape: &[usize],
) -> PyResult<PyReadwriteArrayDyn<'py, f64>> {
    let py = value.py();
    let wrong = |what: String| {
        let comma = if shape.len() == 1 { "," } else { "" };
        let numbers: Vec<String> = shape.iter().map(usize::to_string).collect();
        let wanted = numbers.join(", ");
        input_error(
            py,
            format!(
                "{name} {what}; give a writable C-contiguous float64 array of shape \
                 ({wanted}{comma})"
            ),
        )
    };
    let array =
        value.cast::<PyArrayDyn<f64>>().map_err(|_| wrong("is not a float64 array".to_owned()))?;
    if array.shape() != shape {
        return Err(wrong(format!("has shape {:?}", array.shape())));
    }
    if !array.is_c_contiguous() {
        return Err(wrong("is not C-contiguous".to_owned()));
    }
    array.try_readwrite().map_err(|_| wrong("is read-only or given twice".to_owned()))
}
