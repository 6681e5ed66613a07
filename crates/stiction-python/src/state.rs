//! States as dicts of floats and arrays.

use numpy::{PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyList};
use stiction_core::friction::Entry;

use crate::arguments::Text;
use crate::arrays::samples;
use crate::error::input_error;
use crate::real::real;

/// A state as a dict.
pub fn to_dict<'py>(
    py: Python<'py>,
    entries: Vec<(impl AsRef<str>, Entry)>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, entry) in entries {
        match entry {
            Entry::Number(x) => dict.set_item(name.as_ref(), x)?,
            Entry::Pairs(rows) => {
                let array = PyArray2::zeros(py, [rows.len(), 2], false);
                {
                    let mut filled = array.readwrite();
                    let flat = filled.as_slice_mut()?;
                    for (target, row) in flat.chunks_exact_mut(2).zip(rows) {
                        target.copy_from_slice(&row);
                    }
                }
                dict.set_item(name.as_ref(), array)?;
            }
        }
    }
    Ok(dict)
}

/// The entries of a state given as a dict; arrays may be lists of rows, as JSON has them.
pub fn from_dict(state: &Bound<'_, PyDict>) -> PyResult<Vec<(String, Entry)>> {
    state
        .iter()
        .map(|(name, value)| {
            let py = name.py();
            let Text(name) = name
                .extract()
                .map_err(|_: PyErr| input_error(py, format!("state key {name} is not a word")))?;
            if let Ok(number) = real(&value) {
                return Ok((name, Entry::Number(number)));
            }
            let wrong = |shape: &[usize]| {
                input_error(
                    py,
                    format!("state entry '{name}' has shape {shape:?}; allowed is (n, 2)"),
                )
            };
            let mut shape = [0, 2].to_vec();
            if let Ok(rows) = value.cast::<PyList>() {
                shape[0] = rows.len();
            } else {
                shape = value.getattr("shape").and_then(|shape| shape.extract()).map_err(|_| {
                    input_error(py, format!("state entry '{name}' is neither number nor array"))
                })?;
            }
            if shape.len() != 2 || shape[1] != 2 {
                return Err(wrong(&shape));
            }
            if shape[0] == 0 {
                return Ok((name, Entry::Pairs(Vec::new())));
            }
            let rows = samples(&name, &value)?;
            if rows.shape() != shape {
                return Err(wrong(rows.shape()));
            }
            let pairs = rows.as_slice()?.chunks_exact(2).map(|row| [row[0], row[1]]).collect();
            Ok((name, Entry::Pairs(pairs)))
        })
        .collect()
}

/// Parameters (numbers) and options (words) given as keywords.
#[allow(clippy::type_complexity)] // two lists, taken apart where they are asked for
pub fn keywords(
    owner: &str,
    given: Option<&Bound<'_, PyDict>>,
) -> PyResult<(Vec<(String, f64)>, Vec<(String, String)>)> {
    let (mut numbers, mut words) = (Vec::new(), Vec::new());
    for (name, value) in given.into_iter().flatten() {
        let py = name.py();
        let Text(name) = name.extract().map_err(|_: PyErr| {
            input_error(py, format!("keyword {name} of {owner} is not a word"))
        })?;
        if let Ok(Text(word)) = value.extract() {
            words.push((name, word));
        } else if !value.is_instance_of::<PyBool>()
            && let Ok(number) = real(&value)
        {
            numbers.push((name, number));
        } else {
            let kind = value.get_type().name()?;
            return Err(input_error(
                py,
                format!(
                    "{name} of {owner} is a {kind}; allowed is a number for a parameter, a word \
                     for an option"
                ),
            ));
        }
    }
    Ok((numbers, words))
}
