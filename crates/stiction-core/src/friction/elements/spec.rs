//! Which friction law, with every parameter and option decided.

use crate::friction::{Law, LawRecord, law_record};
use crate::math::scalar::Scalar;
use crate::support::error::{Error, Result, Shown};
use crate::support::parameter::resolve;

/// Which law, with every parameter and option decided.
#[derive(Clone)]
pub struct LawSpec {
    /// Catalogue entry.
    pub record: &'static LawRecord,
    /// Values in the order of the record's parameters.
    pub values: Vec<f64>,
    /// Index of the choice for each of the record's options.
    pub choices: Vec<usize>,
}

impl std::fmt::Debug for LawSpec {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut shown = formatter.debug_struct(self.record.name);
        for (parameter, value) in self.record.parameters.iter().zip(&self.values) {
            shown.field(parameter.name, value);
        }
        for (name, word) in self.options() {
            shown.field(name, &word);
        }
        shown.finish()
    }
}

impl PartialEq for LawSpec {
    fn eq(&self, other: &Self) -> bool {
        self.record.name == other.record.name
            && self.values == other.values
            && self.choices == other.choices
    }
}

impl LawSpec {
    /// The law called `name`; what is not stated takes its default.
    pub fn new(name: &str, stated: &[(String, f64)], options: &[(String, String)]) -> Result<Self> {
        let record = law_record(name)?;
        for (option, word) in options {
            if record.parameters.iter().any(|known| known.name == option) {
                let allowed = "a number".to_owned();
                let given = format!("the word '{word}'");
                return Err(Error::WrongKind {
                    name: format!("{option} of {name}"),
                    given,
                    allowed,
                });
            }
            if !record.options.iter().any(|known| known.name == option) {
                let words = record.parameters.iter().map(|p| p.name);
                let words: Vec<&str> = words.chain(record.options.iter().map(|o| o.name)).collect();
                return Err(Error::unknown(format!("option of {name}"), option, words));
            }
        }
        let choices = record
            .options
            .iter()
            .map(|option| match options.iter().find(|(given, _)| given == option.name) {
                None => Ok(0),
                Some((_, word)) => {
                    option.choices.iter().position(|(known, _)| known == word).ok_or_else(|| {
                        Error::unknown(
                            format!("value of option {} of {name}", option.name),
                            word,
                            option.choices.iter().map(|(known, _)| *known),
                        )
                    })
                }
            })
            .collect::<Result<Vec<usize>>>()?;
        for (number, value) in stated {
            if let Some(option) = record.options.iter().find(|known| known.name == number) {
                let words: Vec<&str> = option.choices.iter().map(|(word, _)| *word).collect();
                return Err(Error::WrongKind {
                    name: format!("{number} of {name}"),
                    given: format!("the number {}", Shown(*value)),
                    allowed: words.join(" or "),
                });
            }
        }
        for (given, _) in stated {
            if record.parameters.iter().all(|known| known.name != given)
                && let Some(meant) = record.called(given)
            {
                return Err(Error::UnknownName {
                    kind: format!("parameter of {name}"),
                    given: given.clone(),
                    near: format!("; it is called '{}' here", meant.name),
                    known: record.parameters.iter().map(|p| p.name).collect::<Vec<_>>().join(", "),
                });
            }
        }
        let values = resolve(name, record.parameters, stated)?;
        Law::<f64>::check(name, &values)?;
        Ok(Self { record, values, choices })
    }

    /// Whether a contact of this law never gives back more than it took, at constant levels.
    pub fn passive(&self) -> bool {
        Law::passive(self.record.name, &self.values).unwrap_or(false)
    }

    /// Start values of a contact in the order of the record; what is not stated is 0.
    pub fn start(&self, stated: &[(String, f64)]) -> Result<Vec<f64>> {
        resolve(&format!("the start of {}", self.record.name), self.record.start, stated)
    }

    /// The law over some number type, from values of that type.
    pub fn law<S: Scalar>(&self, values: &[S]) -> Law<S> {
        Law::build(self.record.name, values, &self.choices)
            .expect("the record's own name is in the list")
    }

    /// The law with plain values.
    pub fn plain(&self) -> Law<f64> {
        self.law(&self.values)
    }

    /// Names and words of the options.
    pub fn options(&self) -> impl Iterator<Item = (&'static str, &'static str)> + '_ {
        self.record
            .options
            .iter()
            .zip(&self.choices)
            .map(|(option, choice)| (option.name, option.choices[*choice].0))
    }
}
