//! `Motion`: what was measured, read once and followed by any number of motors.

use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use stiction_core::motor::{PerSample, Surroundings};
use stiction_core::sensitivity::MeasuredMotion;

use crate::arrays::{Each, one_row};
use crate::error::input_error;

/// One number for all samples or one for each, kept.
enum Numbers {
    Same(f64),
    Each(Vec<f64>),
}

impl Numbers {
    fn of(each: &Each<'_>) -> PyResult<Self> {
        Ok(match each.per_sample()? {
            PerSample::Same(value) => Self::Same(value),
            PerSample::Each(values) => Self::Each(values.to_vec()),
        })
    }

    fn per_sample(&self) -> PerSample<'_> {
        match self {
            Self::Same(value) => PerSample::Same(*value),
            Self::Each(values) => PerSample::Each(values),
        }
    }
}

/// A measured motion, and what acted in each sample.
///
/// Parameters
/// ----------
/// position : array_like, shape (n + 1,)
///     Positions, the first before the first sample.
/// current : float or array_like, shape (n,)
///     Inputs of the drive, held over the samples between them.
/// dt : float or array_like, shape (n,)
///     Sample time, s.
/// load : float or array_like, shape (n,), optional
///     External effort, positive along +x.
/// temperature : float or array_like, shape (n,), optional
///     In °C.
/// enabled : array_like, shape (n,), optional
///     Whether the drive is on, 0 where it is off.
/// transmitted : float or array_like, shape (n,), optional
///     Effort that the gear transmits, as a load that acts on the machine: friction that grows with the
///     load sees it in place of the load.
/// averaged : bool
///     Whether the friction of a rigid contact, which jumps inside samples, is its mean over the sample
///     before each stamp and the one after, to be compared with inputs that are held, and a contact
///     that yields goes through where the motion turns between two stamps; otherwise friction is what
///     it is at the stamp, of a motion that is straight in between.
///
/// Raises
/// ------
/// InputError
///     Arrays of other lengths, numbers that are not finite, a sample time that is not positive.
#[pyclass(frozen, module = "stiction")]
pub struct Motion {
    positions: Vec<f64>,
    inputs: Numbers,
    dt: Numbers,
    load: Numbers,
    transmitted: Option<Numbers>,
    temperature: Option<Numbers>,
    enabled: Option<Numbers>,
    averaged: bool,
}

impl Motion {
    /// Samples between the positions.
    pub fn samples(&self) -> usize {
        self.positions.len() - 1
    }

    /// The form that the core takes.
    pub fn measured(&self) -> MeasuredMotion<'_> {
        MeasuredMotion {
            positions: &self.positions,
            inputs: self.inputs.per_sample(),
            around: Surroundings {
                load: self.load.per_sample(),
                transmitted: self.transmitted.as_ref().map(Numbers::per_sample),
                temperature: self.temperature.as_ref().map(Numbers::per_sample),
                enabled: self.enabled.as_ref().map(Numbers::per_sample),
            },
            dt: self.dt.per_sample(),
            averaged: self.averaged,
        }
    }
}

#[pymethods]
impl Motion {
    #[new]
    #[pyo3(signature = (position, current, dt, *, load=None, temperature=None, enabled=None, transmitted=None, averaged=false))]
    #[allow(clippy::too_many_arguments)] // keywords of the Python class
    fn new(
        position: &Bound<'_, PyAny>,
        current: &Bound<'_, PyAny>,
        dt: &Bound<'_, PyAny>,
        load: Option<&Bound<'_, PyAny>>,
        temperature: Option<&Bound<'_, PyAny>>,
        enabled: Option<&Bound<'_, PyAny>>,
        transmitted: Option<&Bound<'_, PyAny>>,
        averaged: bool,
    ) -> PyResult<Self> {
        let py = position.py();
        let position = one_row("position", position)?;
        let n = position.len() - 1;
        if n == 0 {
            return Err(input_error(py, "position has 1 value; give at least two"));
        }
        let each = |name: &str, given: &Bound<'_, PyAny>| {
            Numbers::of(&Each::read(name, Some(given), 0.0, &[n])?)
        };
        Ok(Self {
            positions: position.as_slice()?.to_vec(),
            inputs: each("current", current)?,
            dt: Numbers::of(&Each::steps("dt", dt, &[n])?)?,
            load: load.map_or(Ok(Numbers::Same(0.0)), |given| each("load", given))?,
            transmitted: transmitted.map(|given| each("transmitted", given)).transpose()?,
            temperature: temperature.map(|given| each("temperature", given)).transpose()?,
            enabled: enabled.map(|given| each("enabled", given)).transpose()?,
            averaged,
        })
    }

    fn __len__(&self) -> usize {
        self.samples()
    }
}
