//! What the methods of `Motor` are given, as the core takes it.

use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use stiction_core::integrate::Integrator;
use stiction_core::motor::EffectSpec;
use stiction_core::servo::Servo;
use stiction_core::shoot::{Windows, check};

use crate::arrays::one_row;
use crate::error::{IntoPython, input_error};
use crate::state::keywords;

/// Words, of outputs or of parameters.
pub struct Words<'py>(pub Vec<Bound<'py, PyString>>);

impl<'a, 'py> FromPyObject<'a, 'py> for Words<'py> {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let wrong = |given: &Bound<'py, PyAny>, what: &str| {
            let shown = given.repr().map_or_else(|_| "?".to_owned(), |shown| shown.to_string());
            input_error(given.py(), format!("{shown} is {what}; give a sequence of names"))
        };
        if given.is_instance_of::<PyString>() {
            return Err(wrong(&given, "a single word"));
        }
        let each = given.try_iter().map_err(|_| wrong(&given, "no sequence"))?;
        let words = each.map(|word| {
            let word = word?;
            word.cast::<PyString>().cloned().map_err(|_| wrong(&word, "no word"))
        });
        words.collect::<PyResult<_>>().map(Self)
    }
}

/// A word; what no encoding has (a lone half of a surrogate pair) stands in it as �, so that a complaint
/// can show it.
pub struct Text(pub String);

impl Text {
    pub fn of(word: &Bound<'_, PyString>) -> String {
        word.to_string_lossy().into_owned()
    }

    /// The integrator where none is named.
    pub fn fast() -> Self {
        Self("fast".to_owned())
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Text {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match given.cast::<PyString>() {
            Ok(word) => Ok(Self(Self::of(&word))),
            Err(_) => given.extract().map(Self),
        }
    }
}

/// The same, each as a string of the core.
pub struct Names(pub Vec<String>);

impl<'a, 'py> FromPyObject<'a, 'py> for Names {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let Words(words) = given.extract()?;
        Ok(Self(words.iter().map(Text::of).collect()))
    }
}

/// An integrator by its name.
pub fn integrator_of(py: Python<'_>, Text(name): &Text) -> PyResult<Integrator> {
    match name.as_str() {
        "fast" => Ok(Integrator::Fast),
        "reference" => Ok(Integrator::Reference),
        other => {
            Err(input_error(py, format!("integrator '{other}' is unknown; known: fast, reference")))
        }
    }
}

/// Effects from a dict of names and their parameters.
pub fn effects_of(effects: &Bound<'_, PyAny>) -> PyResult<Vec<EffectSpec>> {
    let py = effects.py();
    let effects = effects.cast::<PyDict>().map_err(|_| {
        let wanted =
            "give a dict of names and their parameters, as in {'cogging': {'order': 12.0}}";
        input_error(py, format!("effects is {effects}; {wanted}"))
    })?;
    let mut list = Vec::new();
    for (name, values) in effects {
        let Text(name) = name
            .extract()
            .map_err(|_: PyErr| input_error(py, format!("effect name {name} is not a word")))?;
        let numbers = numbers_of(&format!("effect {name}"), &values)?;
        list.push(EffectSpec::new(&name, &numbers).or_input_error(py)?);
    }
    Ok(list)
}

/// A servo from a dict of its numbers.
pub fn servo_of(given: &Bound<'_, PyAny>) -> PyResult<Servo> {
    Servo::new(&numbers_of("servo", given)?).or_input_error(given.py())
}

/// Passes are few: more threads than this have nothing to do.
const MOST_THREADS: i64 = 256;

/// The numbers given for an effect or for a start.
pub fn numbers_of(owner: &str, values: &Bound<'_, PyAny>) -> PyResult<Vec<(String, f64)>> {
    let py = values.py();
    let values = values
        .cast::<PyDict>()
        .map_err(|_| input_error(py, format!("parameters of {owner} are not a dict")))?;
    let (numbers, words) = keywords(owner, Some(values))?;
    match words.first() {
        None => Ok(numbers),
        Some((option, _)) => {
            Err(input_error(py, format!("{option} of {owner} is a word; allowed is a number")))
        }
    }
}

/// Effects that may be missing, from pairs of a name and a dict of shape parameters.
pub fn candidates_of(candidates: &Bound<'_, PyAny>) -> PyResult<Vec<EffectSpec>> {
    let py = candidates.py();
    let wanted = "give pairs of an effect's name and a dict of its shape, for instance \
                  [('cogging', {'order': 12.0})]";
    let each = candidates
        .try_iter()
        .map_err(|_| input_error(py, format!("candidates is {candidates}; {wanted}")))?;
    let mut list = Vec::new();
    for (k, candidate) in each.enumerate() {
        let candidate = candidate?;
        let (Text(name), shape): (Text, Bound<'_, PyAny>) = candidate
            .extract()
            .map_err(|_| input_error(py, format!("candidates[{k}] is {candidate}; {wanted}")))?;
        let numbers = numbers_of(&format!("effect {name}"), &shape)?;
        list.push(EffectSpec::candidate(&name, &numbers).or_input_error(py)?);
    }
    Ok(list)
}

/// Gains of all candidates.
pub fn gains_of(candidates: &[EffectSpec]) -> usize {
    candidates.iter().map(|effect| effect.record.facts.gains.len()).sum()
}

pub fn threads_of(py: Python<'_>, threads: i64) -> PyResult<usize> {
    if (1..=MOST_THREADS).contains(&threads) {
        return Ok(threads as usize);
    }
    Err(input_error(
        py,
        format!("threads = {threads} is out of bounds: allowed is 1 to {MOST_THREADS}"),
    ))
}

/// Weights of the samples of a window, and from how many samples to how many the windows start.
pub struct Shots<'py> {
    weights: PyReadonlyArrayDyn<'py, f64>,
    stride: usize,
}

impl<'py> Shots<'py> {
    pub fn read(weights: &Bound<'py, PyAny>, stride: i64) -> PyResult<Self> {
        let py = weights.py();
        let weights = one_row("weights", weights)?;
        let shots = Self { weights, stride: usize::try_from(stride).unwrap_or(0) };
        check(&shots.windows()?).or_input_error(py)?;
        Ok(shots)
    }

    pub fn windows(&self) -> PyResult<Windows<'_>> {
        Ok(Windows { stride: self.stride, weights: self.weights.as_slice()? })
    }
}
