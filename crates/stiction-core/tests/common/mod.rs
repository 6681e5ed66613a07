//! What the tests of the core share.
#![allow(dead_code, missing_docs)]

use stiction_core::friction::{Channels, LAWS, LawRecord};
use stiction_core::model::{FrictionModel, LawSpec};
use stiction_core::motor::{Column, Motor, MotorSpec, PerSample, Surroundings};

/// A deterministic stream of numbers in 0 … 1: tests need spread, not quality.
pub struct Stream(u64);

impl Stream {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x1234_5678_9ABC_DEF1)
    }
    /// One for each law, so that a new law leaves the draws of the others as they are.
    pub fn of(law: &LawRecord, seed: u64) -> Self {
        let letters = law.name.bytes().map(u64::from);
        Self::new(letters.fold(seed, |sum, letter| sum.wrapping_mul(31).wrapping_add(letter)))
    }
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    /// Between two positive numbers, evenly in the logarithm.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        (low.ln() + (high / low).ln() * self.next()).exp()
    }
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

pub fn law(name: &str, parameters: &[(&str, f64)], options: &[(&str, &str)]) -> LawSpec {
    let numbers: Vec<_> = parameters.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect();
    let words: Vec<_> = options.iter().map(|(n, w)| ((*n).to_owned(), (*w).to_owned())).collect();
    LawSpec::new(name, &numbers, &words).unwrap()
}

pub fn model(name: &str, parameters: &[(&str, f64)]) -> FrictionModel {
    FrictionModel::new(law(name, parameters, &[]))
}

pub fn run(model: &mut FrictionModel, velocity: &[f64], dt: f64) -> Vec<f64> {
    let mut friction = vec![0.0; velocity.len()];
    model.simulate(velocity, dt, |_| Channels::default(), &mut friction).unwrap();
    friction
}

pub fn motor(inertia: f64, law: LawSpec) -> Motor {
    Motor::new(MotorSpec::new(inertia, 1.0, law)).unwrap()
}

pub fn positions(motor: &mut Motor, inputs: &[f64], dt: f64) -> Vec<f64> {
    column(motor, Column::Position, inputs, dt)
}

pub fn column(motor: &mut Motor, column: Column, inputs: &[f64], dt: f64) -> Vec<f64> {
    column_amid(Surroundings::NONE, motor, column, inputs, dt)
}

pub fn column_amid(
    around: Surroundings<'_>,
    motor: &mut Motor,
    column: Column,
    inputs: &[f64],
    dt: f64,
) -> Vec<f64> {
    let mut values = vec![0.0; inputs.len()];
    motor.simulate(inputs, around, PerSample::Same(dt), &mut [(column, &mut values)]).unwrap();
    values
}

/// Some load and some warmth: there are effects that come with them alone.
pub const AROUND: Surroundings<'_> = Surroundings {
    load: PerSample::Same(0.05),
    transmitted: None,
    temperature: Some(PerSample::Same(40.0)),
    enabled: None,
};

/// Parameters drawn within about a factor 3 of the typical ones, inside the bounds and in order.
pub fn drawn(record: &'static LawRecord, stream: &mut Stream) -> LawSpec {
    for _ in 0..100 {
        let parameters: Vec<(String, f64)> = record
            .parameters
            .iter()
            .map(|spec| {
                let (low, high) = spec.bounds;
                let value = spec.typical * stream.log(0.4, 2.5);
                (spec.name.to_owned(), value.clamp(low, high))
            })
            .collect();
        let options: Vec<(String, String)> = record
            .options
            .iter()
            .map(|option| {
                let pick = (stream.next() * option.choices.len() as f64) as usize;
                (option.name.to_owned(), option.choices[pick].0.to_owned())
            })
            .collect();
        if let Ok(spec) = LawSpec::new(record.name, &parameters, &options) {
            return spec;
        }
    }
    panic!("no ordered parameters found for {}", record.name);
}

pub fn all_laws() -> &'static [LawRecord] {
    LAWS
}
