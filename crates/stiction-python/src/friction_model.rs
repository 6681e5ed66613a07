//! `FrictionModel`: a law, its parameters and its state.

use std::borrow::Cow;
use std::fmt::Write;
use std::sync::MutexGuard;

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::pyclass::CompareOp;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBool, PyDict, PyString, PyTuple, PyType};
use stiction_core::effects::EffectSpec;
use stiction_core::friction::{Channels, Entry};
use stiction_core::model::{FrictionModel as Core, LawSpec};

use crate::arguments::{Text, effects_of};
use crate::arrays::{Each, samples};
use crate::error::{FASTEST, IntoPython, call_error, duration, finite, input_error, velocity};
use crate::real::{real, real_or_none};
use crate::shared::Shared;
use crate::state::{from_dict, keywords, to_dict};

/// A friction law with its parameters and its state, and the effects that act at the contact.
///
/// Parameters
/// ----------
/// law : str or LawRecord
///     A name of the catalogue, see ``stiction.laws()``, or an entry of it.
/// effects : dict of str to dict of str to float, optional
///     Effects by name with their parameters, as ``Motor`` takes them: those that act on the friction
///     level, add an effort or let the contact relax (``EffectRecord.at_contact`` of
///     ``stiction.effects()``). What they go by is kept beside the state of the law: the position that
///     the velocities add up to, the path, the clock, and what they remember.
/// **keywords : float or str
///     Parameters (numbers, SI) and options (words) of the law; what is not given takes its
///     documented default.
///
/// Raises
/// ------
/// InputError
///     Unknown law, parameter, option or effect; value out of bounds or not a number; an effect of the
///     drive, the sensor or a second mass, which no contact has.
///
/// Notes
/// -----
/// With effects the friction is all that resists motion at the contact: F with
/// J·x'' = u + load − F, so that an effort which effects add (cogging, an offset) is in it with its sign
/// turned round. ``effort`` of a step is all effort beside that.
#[pyclass(frozen, module = "stiction._native")]
pub struct FrictionModel {
    core: Shared<Core>,
}

impl FrictionModel {
    /// What it is a binding of.
    #[inline]
    pub fn core(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Core>> {
        self.core.lock(py)
    }

    /// A binding of this model.
    pub fn of(core: Core) -> Self {
        Self { core: Shared::new(core) }
    }

    /// Law, effects, parameters, options and state: all that two equal models share.
    fn definition(&self, py: Python<'_>) -> PyResult<Definition> {
        let core = self.core(py)?;
        Ok((core.spec().clone(), core.effects().to_vec(), core.entries()))
    }

    /// Keywords that rebuild the model, but for its law.
    fn settings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let core = self.core(py)?;
        let spec = core.spec();
        for (parameter, value) in spec.record.parameters.iter().zip(&spec.values) {
            dict.set_item(parameter.name, value)?;
        }
        for (name, word) in spec.options() {
            dict.set_item(name, word)?;
        }
        if !core.effects().is_empty() {
            dict.set_item("effects", effects_dict(py, core.effects())?)?;
        }
        Ok(dict)
    }
}

/// All that two equal models share.
type Definition = (LawSpec, Vec<EffectSpec>, Vec<(Cow<'static, str>, Entry)>);

/// Effects by name with their parameters, as they are given.
pub fn effects_dict<'py>(py: Python<'py>, effects: &[EffectSpec]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for effect in effects {
        let values = PyDict::new(py);
        for (parameter, value) in effect.record.parameters.iter().zip(&effect.values) {
            values.set_item(parameter.name, value)?;
        }
        dict.set_item(effect.record.name, values)?;
    }
    Ok(dict)
}

/// How a parameter of a model is changed, in words.
pub const PARAMETERS: &str = "a model has the parameters and options that it was made with; make \
     another one, as in FrictionModel(f.law, **{**f.parameters, 'coulomb': 3.0})";

/// A dict that refuses to be changed in place, and says how it is done.
pub fn fixed<'py>(dict: Bound<'py, PyDict>, remedy: &str) -> PyResult<Bound<'py, PyAny>> {
    static FIXED: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    FIXED.import(dict.py(), "stiction.fixed", "Fixed")?.call1((dict, remedy))
}

/// The name of a law, by itself or of its record in the catalogue.
fn name_of(law: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(Text(name)) = law.extract() {
        return Ok(name);
    }
    match law.getattr("name").and_then(|name| name.extract()) {
        Ok(Text(name)) => Ok(name),
        Err(_) => Err(input_error(
            law.py(),
            format!(
                "FrictionModel: {} is no law; give a name of stiction.laws(), such as 'lugre'",
                law.repr()?
            ),
        )),
    }
}

/// Refuses values without a name after the law.
fn refuse_nameless(law: &str, values: &Bound<'_, PyTuple>) -> PyResult<()> {
    if values.is_empty() {
        return Ok(());
    }
    let py = values.py();
    let value = values.get_item(0)?.repr()?;
    let record = LawSpec::new(law, &[], &[]).or_input_error(py)?.record;
    let names: Vec<&str> = record.parameters.iter().map(|parameter| parameter.name).collect();
    let example = names.first().map_or_else(String::new, |name| format!(", {name}={value}"));
    let told = format!(
        "FrictionModel: {value} comes without a name; give parameters by name, as in \
         FrictionModel('{law}'{example}) (those of {law}: {})",
        names.join(", ")
    );
    Err(call_error(py, told))
}

/// A velocity of one contact: many at once are told where they belong.
#[inline]
fn one(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    real(value).map_err(|error| {
        if value.is_none() || value.is_instance_of::<PyString>() || value.len().is_err() {
            return error;
        }
        input_error(
            value.py(),
            format!(
                "velocity holds {} numbers, and a step takes one: simulate(velocity, dt) takes the \
                 samples of one contact, and Ensemble(motor, n).step_many those of many machines",
                value.len().unwrap_or(0)
            ),
        )
    })
}

/// A number as Python reads it.
fn literal(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { format!("float('{value}')") }
}

#[inline]
fn channels(
    py: Python<'_>,
    load: f64,
    effort: f64,
    temperature: Option<f64>,
) -> PyResult<Channels<f64>> {
    // One comparison for the usual case: the sum is finite only where both are.
    if !(load + effort).is_finite() {
        finite(py, "load", load)?;
        finite(py, "effort", effort)?;
    }
    if let Some(temperature) = temperature {
        finite(py, "temperature", temperature)?;
    }
    Ok(Channels { load, effort, temperature, ..Channels::default() })
}

#[pymethods]
impl FrictionModel {
    #[new]
    #[pyo3(
        signature = (law=None, *nameless, effects=None, **keywords),
        text_signature = "(law, *, effects=None, **keywords)"
    )]
    fn new(
        py: Python<'_>,
        law: Option<&Bound<'_, PyAny>>,
        nameless: &Bound<'_, PyTuple>,
        effects: Option<&Bound<'_, PyAny>>,
        keywords: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let Some(law) = law else {
            let told = "FrictionModel: the law is missing; give its name first, as in \
                        FrictionModel('coulomb', coulomb=0.3) (stiction.laws() has all)";
            return Err(call_error(py, told));
        };
        let law = name_of(law)?;
        refuse_nameless(&law, nameless)?;
        let (numbers, words) = self::keywords(&law, keywords)?;
        let spec = LawSpec::new(&law, &numbers, &words).or_input_error(py)?;
        let effects = effects.map(effects_of).transpose()?.unwrap_or_default();
        Ok(Self::of(Core::with_effects(spec, effects).or_input_error(py)?))
    }

    /// One sample at a held velocity.
    ///
    /// Parameters
    /// ----------
    /// velocity : float
    ///     Held over ``dt``, rad/s or m/s.
    /// dt : float
    ///     Duration in s, positive.
    /// load, effort, temperature : float, optional
    ///     Load on the contact and all other effort on the body (what a stuck contact holds), N·m
    ///     or N; temperature in °C, without which nobody knows it.
    ///
    /// Returns
    /// -------
    /// float
    ///     Friction at the end, N·m or N, positive when it resists positive motion. A contact with true
    ///     stick that rests returns the effort, up to the level that it holds.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A velocity beyond ±1e6 rad/s (m/s), a ``dt`` that is not above 0 and at most 1e6 s, a
    ///     number that is not finite; friction that leaves the range of floats.
    #[pyo3(signature = (velocity, dt, *, load=0.0, effort=0.0, temperature=None))]
    fn step(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = one)] velocity: f64,
        #[pyo3(from_py_with = real)] dt: f64,
        #[pyo3(from_py_with = real)] load: f64,
        #[pyo3(from_py_with = real)] effort: f64,
        #[pyo3(from_py_with = real_or_none)] temperature: Option<f64>,
    ) -> PyResult<f64> {
        let velocity = self::velocity(py, velocity)?;
        let dt = duration(py, "dt", dt)?;
        let channels = channels(py, load, effort, temperature)?;
        self.core(py)?.step(velocity, dt, &channels).or_input_error(py)
    }

    /// Samples at held velocities.
    ///
    /// Parameters
    /// ----------
    /// velocity : array_like, shape (n,) or (batch, n)
    ///     Each value is held over ``dt``, rad/s or m/s.
    /// dt : float
    ///     Duration of a sample in s.
    /// load, effort, temperature : float or array_like shaped like velocity, optional
    ///     As for ``step``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shaped like velocity
    ///     Friction at the end of each sample, N·m or N. With shape (n,) the model is left at its
    ///     end state; with shape (batch, n) every row starts at the present state and the model is
    ///     left as it was.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``step``; other shapes, no samples, a masked one.
    #[pyo3(signature = (velocity, dt, *, load=None, effort=None, temperature=None))]
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        velocity: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = real)] dt: f64,
        load: Option<&Bound<'py, PyAny>>,
        effort: Option<&Bound<'py, PyAny>>,
        temperature: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let dt = duration(py, "dt", dt)?;
        let velocity = samples("velocity", velocity)?;
        if let Some(fastest) = velocity.as_slice()?.iter().find(|v| v.abs() > FASTEST) {
            self::velocity(py, *fastest)?;
        }
        let shape = velocity.shape().to_vec();
        if shape.len() > 2 {
            return Err(input_error(
                py,
                format!("velocity has shape {shape:?}; allowed are (n,) and (batch, n)"),
            ));
        }
        let load = Each::read("load", load, 0.0, &shape)?;
        let effort = Each::read("effort", effort, 0.0, &shape)?;
        let known = temperature.is_some();
        let temperature = Each::read("temperature", temperature, 0.0, &shape)?;
        let result = PyArrayDyn::<f64>::zeros(py, shape.clone(), false);
        {
            let mut filled = result.readwrite();
            let friction = filled.as_slice_mut()?;
            let velocity = velocity.as_slice()?;
            let (load, effort, temperature) =
                (load.per_sample()?, effort.per_sample()?, temperature.per_sample()?);
            let at = |k: usize| Channels {
                load: load.at(k),
                effort: effort.at(k),
                temperature: known.then(|| temperature.at(k)),
                ..Channels::default()
            };
            let ran = self.core.apart(py, |core| {
                if shape.len() == 1 {
                    return core.simulate(velocity, dt, at, friction);
                }
                let n = shape[1];
                let mut rows = velocity.chunks(n).zip(friction.chunks_mut(n)).enumerate();
                rows.try_for_each(|(row, (velocity, friction))| {
                    core.clone().simulate(velocity, dt, |k| at(row * n + k), friction)
                })
            })?;
            ran.or_input_error(py)?;
        }
        Ok(result)
    }

    /// Friction and its slope at a held velocity, changing nothing until ``commit``.
    ///
    /// Parameters
    /// ----------
    /// velocity, dt, load, effort, temperature
    ///     As for ``step``.
    ///
    /// Returns
    /// -------
    /// friction : float
    ///     At the end, N·m or N.
    /// slope : float
    ///     ∂friction/∂velocity at fixed ``dt``, N·m·s/rad or N·s/m.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``step``.
    #[pyo3(signature = (velocity, dt, *, load=0.0, effort=0.0, temperature=None))]
    fn trial(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = real)] velocity: f64,
        #[pyo3(from_py_with = real)] dt: f64,
        #[pyo3(from_py_with = real)] load: f64,
        #[pyo3(from_py_with = real)] effort: f64,
        #[pyo3(from_py_with = real_or_none)] temperature: Option<f64>,
    ) -> PyResult<(f64, f64)> {
        let velocity = self::velocity(py, velocity)?;
        let dt = duration(py, "dt", dt)?;
        let channels = channels(py, load, effort, temperature)?;
        self.core(py)?.trial(velocity, dt, &channels).or_input_error(py)
    }

    /// Friction of a step and its derivatives, changing nothing.
    ///
    /// Parameters
    /// ----------
    /// velocity, dt, load, effort, temperature
    ///     As for ``step``.
    ///
    /// Returns
    /// -------
    /// friction : float
    ///     At the end, N·m or N.
    /// inputs : dict of str to float
    ///     Derivatives by ``velocity`` at fixed ``dt``, as ``trial`` tells it, by ``effort`` and by
    ///     ``load`` at that effort.
    /// parameters : dict of str to float
    ///     Derivatives by all parameters, called as in ``parameters``, exact for a state that depends on
    ///     none of them; by one that is infinite 0.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     As for ``step``.
    #[pyo3(signature = (velocity, dt, *, load=0.0, effort=0.0, temperature=None))]
    fn derivatives<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = real)] velocity: f64,
        #[pyo3(from_py_with = real)] dt: f64,
        #[pyo3(from_py_with = real)] load: f64,
        #[pyo3(from_py_with = real)] effort: f64,
        #[pyo3(from_py_with = real_or_none)] temperature: Option<f64>,
    ) -> PyResult<(f64, Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let velocity = self::velocity(py, velocity)?;
        let dt = duration(py, "dt", dt)?;
        let channels = channels(py, load, effort, temperature)?;
        let core = self.core(py)?;
        let found = core.derivatives(velocity, dt, &channels).or_input_error(py)?;
        let (inputs, parameters) = (PyDict::new(py), PyDict::new(py));
        for (name, derivative) in ["velocity", "effort", "load"].iter().zip(found.inputs) {
            inputs.set_item(name, derivative)?;
        }
        for ((name, _), derivative) in core.parameters().into_iter().zip(found.parameters) {
            parameters.set_item(name, derivative)?;
        }
        Ok((found.friction, inputs, parameters))
    }

    /// Accepts the last trial.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     There is none, or something else came after it.
    fn commit(&self, py: Python<'_>) -> PyResult<()> {
        if self.core(py)?.commit() {
            Ok(())
        } else {
            Err(input_error(py, "there is no trial to commit; call trial first"))
        }
    }

    /// Back to a contact that was never moved.
    ///
    /// Parameters
    /// ----------
    /// position, time, path : float
    ///     What effects go by: where the contact is, rad or m, time on the session clock, s, and path
    ///     travelled so far, rad or m. A law alone goes by none of them.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     Numbers that are not finite.
    #[pyo3(signature = (position=0.0, *, time=0.0, path=0.0))]
    fn reset(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = real)] position: f64,
        #[pyo3(from_py_with = real)] time: f64,
        #[pyo3(from_py_with = real)] path: f64,
    ) -> PyResult<()> {
        let position = finite(py, "position", position)?;
        let (time, path) = (finite(py, "time", time)?, finite(py, "path", path)?);
        self.core(py)?.reset_at(position, time, path);
        Ok(())
    }

    /// An independent copy, state included.
    fn copy(&self, py: Python<'_>) -> PyResult<Self> {
        Ok(Self::of(self.core(py)?.clone()))
    }

    fn __copy__(&self, py: Python<'_>) -> PyResult<Self> {
        self.copy(py)
    }

    fn __deepcopy__(&self, memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.copy(memo.py())
    }

    /// Name of the law.
    #[getter]
    fn law(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(self.core(py)?.spec().record.name)
    }

    /// Every parameter as a new dict: those of the law by name, those of effects by path, as
    /// ``effects.cogging.cosine``.
    ///
    /// It cannot be changed in place: a model has the parameters it was made with.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let dict = PyDict::new(py);
        for (path, value) in self.core(py)?.parameters() {
            dict.set_item(path, value)?;
        }
        fixed(dict, PARAMETERS)
    }

    /// Effects by name with their parameters, as they are given, as a new dict.
    #[getter]
    fn effects<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let effects = self.core(py)?.effects().to_vec();
        effects_dict(py, &effects)
    }

    /// Every option by name, as a new dict that cannot be changed in place.
    #[getter]
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let dict = PyDict::new(py);
        for (name, word) in self.core(py)?.spec().options() {
            dict.set_item(name, word)?;
        }
        fixed(dict, PARAMETERS)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("stiction.notebook")?.call_method1("friction_model", (slf,))
    }

    /// Whether the contact never gives back more work than it took; some laws do under a condition. With
    /// effects nothing promises that.
    #[getter]
    fn passive(&self, py: Python<'_>) -> PyResult<bool> {
        let core = self.core(py)?;
        Ok(core.effects().is_empty() && core.spec().passive())
    }

    /// The state as a dict of floats and arrays; assign one to continue from it.
    ///
    /// With effects it holds what they go by as well, called as a motor calls it: ``position``,
    /// ``time``, ``path``, ``friction`` of the law, ``relaxed`` and ``effect_memory``.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A state that this law, with these effects, did not return.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let entries = self.core(py)?.entries();
        to_dict(py, entries)
    }

    #[setter]
    fn set_state(&self, state: &Bound<'_, PyDict>) -> PyResult<()> {
        let entries = from_dict(state)?;
        self.core(state.py())?.restore(&entries).or_input_error(state.py())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let core = self.core(py)?;
        let spec = core.spec();
        let mut text = format!("FrictionModel('{}'", spec.record.name);
        for (parameter, value) in spec.record.parameters.iter().zip(&spec.values) {
            let _ = write!(text, ", {}={}", parameter.name, literal(*value));
        }
        for (name, word) in spec.options() {
            let _ = write!(text, ", {name}='{word}'");
        }
        let shown = |effect: &EffectSpec| {
            let values = effect.record.parameters.iter().zip(&effect.values);
            let values = values.map(|(spec, v)| format!("'{}': {}", spec.name, literal(*v)));
            let values: Vec<String> = values.collect();
            format!("'{}': {{{}}}", effect.record.name, values.join(", "))
        };
        if !core.effects().is_empty() {
            let effects: Vec<String> = core.effects().iter().map(shown).collect();
            let _ = write!(text, ", effects={{{}}}", effects.join(", "));
        }
        text.push(')');
        Ok(text)
    }

    fn __richcmp__(&self, other: &Bound<'_, PyAny>, op: CompareOp) -> PyResult<Py<PyAny>> {
        let py = other.py();
        let (Ok(other), CompareOp::Eq | CompareOp::Ne) = (other.cast::<Self>(), op) else {
            return Ok(py.NotImplemented());
        };
        // Each copied out under its own lock: two locks at once could wait for each other.
        let equal = self.definition(py)? == other.get().definition(py)?;
        let answer = equal == matches!(op, CompareOp::Eq);
        Ok(PyBool::new(py, answer).to_owned().into_any().unbind())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let py = slf.py();
        let me = slf.get();
        let keywords = me.settings(py)?;
        let rebuild = py.import("stiction._rebuild")?.getattr("friction_model")?;
        PyTuple::new(
            py,
            [
                rebuild,
                PyTuple::new(
                    py,
                    [
                        me.law(py)?.into_pyobject(py)?.into_any(),
                        keywords.into_any(),
                        me.state(py)?.into_any(),
                    ],
                )?
                .into_any(),
            ],
        )
    }
}
