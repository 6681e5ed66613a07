//! An effect as a plant states it.

use crate::math::scalar::Scalar;
use crate::plant::effects::{AnyEffect, EffectRecord, effect_record};
use crate::support::error::{Error, Result};
use crate::support::parameter::resolve;

/// An effect with every parameter decided.
#[derive(Debug, Clone)]
pub struct EffectSpec {
    /// Catalogue entry.
    pub record: &'static EffectRecord,
    /// Values in the order of the record's parameters.
    pub values: Vec<f64>,
}

impl PartialEq for EffectSpec {
    fn eq(&self, other: &Self) -> bool {
        self.record.name == other.record.name && self.values == other.values
    }
}

impl EffectSpec {
    /// The effect called `name`; what is not stated takes its default, gains 0.
    pub fn new(name: &str, stated: &[(String, f64)]) -> Result<Self> {
        let record = effect_record(name)?;
        Ok(Self { record, values: resolve(name, record.parameters, stated)? })
    }

    /// The effect called `name` at its neutral point, in the shape stated.
    pub fn candidate(name: &str, shape: &[(String, f64)]) -> Result<Self> {
        let effect = Self::new(name, shape)?;
        let gains = effect.record.facts.gains;
        if let Some((gain, value)) = shape.iter().find(|(word, _)| gains.contains(&word.as_str())) {
            let shapes = effect.record.parameters.iter().map(|p| p.name);
            let shapes: Vec<&str> = shapes.filter(|word| !gains.contains(word)).collect();
            return Err(Error::Gain {
                effect: name.to_owned(),
                gain: gain.clone(),
                given: *value,
                shapes: if shapes.is_empty() { "nothing".to_owned() } else { shapes.join(", ") },
            });
        }
        Ok(effect)
    }

    /// Refuses effects of which one is stated twice: no path of a parameter would tell which.
    pub fn refuse_twice(effects: &[Self]) -> Result<()> {
        for (place, Self { record, .. }) in effects.iter().enumerate() {
            if effects[..place].iter().any(|other| other.record.name == record.name) {
                return Err(Error::Twice { effect: record.name });
            }
        }
        Ok(())
    }

    /// The effect over some number type, from values of that type.
    pub fn built<S: Scalar>(&self, values: &[S]) -> AnyEffect<S> {
        AnyEffect::build(self.record.name, values).expect("the record's own name is in the list")
    }
}
