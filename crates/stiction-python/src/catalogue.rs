//! The catalogue of laws and effects as plain dicts; `stiction.catalogue` makes records of them.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use stiction_core::effects::EFFECTS;
use stiction_core::friction::{LAWS, law_record};
use stiction_core::parameter::{Default, MotionKind, ParameterSpec};

use crate::arguments::Text;

fn parameters<'py>(
    py: Python<'py>,
    specs: &[ParameterSpec],
    optional: &[&str],
) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for spec in specs {
        let dict = PyDict::new(py);
        dict.set_item("name", spec.name)?;
        dict.set_item("symbol", spec.symbol())?;
        dict.set_item("meaning", spec.meaning)?;
        dict.set_item("unit", spec.quantity.unit(MotionKind::Rotary))?;
        dict.set_item("linear_unit", spec.quantity.unit(MotionKind::Linear))?;
        let (default, follows) = match spec.default {
            Default::Value(value) => (value, None),
            Default::Ratio { of, factor, otherwise } => (otherwise, Some((of, factor))),
        };
        dict.set_item("default", default)?;
        dict.set_item("follows", follows)?;
        dict.set_item("neutral", spec.neutral)?;
        dict.set_item("typical", spec.typical)?;
        dict.set_item("bounds", spec.bounds)?;
        dict.set_item("optional", optional.contains(&spec.name))?;
        list.append(dict)?;
    }
    Ok(list)
}

/// Every law of the catalogue.
#[pyfunction]
pub fn laws(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let list = PyList::empty(py);
    for law in LAWS {
        let dict = PyDict::new(py);
        dict.set_item("name", law.name)?;
        dict.set_item("summary", law.summary)?;
        dict.set_item("source", law.source)?;
        dict.set_item("parameters", parameters(py, law.parameters, law.optional)?)?;
        dict.set_item("start", parameters(py, law.start, &[])?)?;
        dict.set_item("remembers", law.remembers)?;
        let options = PyList::empty(py);
        for option in law.options {
            let entry = PyDict::new(py);
            entry.set_item("name", option.name)?;
            entry.set_item("meaning", option.meaning)?;
            entry.set_item("choices", option.choices.to_vec())?;
            options.append(entry)?;
        }
        dict.set_item("options", options)?;
        dict.set_item("outputs", law.outputs.to_vec())?;
        list.append(dict)?;
    }
    Ok(list)
}

/// The parameter of a law that somebody means by a symbol of the literature, or None.
#[pyfunction]
pub fn called(law: Text, given: Text) -> Option<&'static str> {
    let (Text(law), Text(given)) = (law, given);
    law_record(&law).ok()?.called(&given).map(|spec| spec.name)
}

/// The laws with what each is, for whoever asks for help.
pub fn list_of_laws() -> String {
    let wide = LAWS.iter().map(|law| law.name.len()).max().unwrap_or(0);
    LAWS.iter().map(|law| format!("{:<wide$}  {}\n", law.name, law.summary)).collect()
}

/// Every effect of the catalogue.
#[pyfunction]
pub fn effects(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let list = PyList::empty(py);
    for effect in EFFECTS {
        let dict = PyDict::new(py);
        dict.set_item("name", effect.name)?;
        dict.set_item("summary", effect.facts.summary)?;
        dict.set_item("family", effect.facts.class)?;
        dict.set_item("coordinate", effect.facts.coordinate)?;
        dict.set_item("channels", effect.facts.channels.to_vec())?;
        dict.set_item("look_alikes", effect.facts.look_alikes.to_vec())?;
        dict.set_item("experiment", effect.facts.experiment)?;
        dict.set_item("plan", effect.facts.plan)?;
        dict.set_item("means", effect.facts.means)?;
        dict.set_item("remedy", effect.facts.remedy)?;
        dict.set_item("gains", effect.facts.gains.to_vec())?;
        dict.set_item("second", effect.facts.second.to_vec())?;
        dict.set_item("law_terms", effect.facts.law_terms.to_vec())?;
        dict.set_item("rotary_only", effect.facts.rotary_only)?;
        let shapes = PyList::empty(py);
        for shape in effect.facts.shapes {
            let entry = PyDict::new(py);
            entry.set_item("parameter", shape.parameter)?;
            entry.set_item("scale", shape.scale.word())?;
            entry.set_item("grid", shape.grid.to_vec())?;
            entry.set_item("fitted", shape.fitted)?;
            shapes.append(entry)?;
        }
        dict.set_item("shapes", shapes)?;
        let hooks: Vec<&str> = effect.hooks.iter().map(|hook| hook.word()).collect();
        dict.set_item("hooks", hooks)?;
        dict.set_item("parameters", parameters(py, effect.parameters, &[])?)?;
        list.append(dict)?;
    }
    Ok(list)
}
