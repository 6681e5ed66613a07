//! What a motor carries from sample to sample can be taken out and put into another one.
#![allow(missing_docs)]

mod common;

use std::collections::BTreeSet;

use common::{Stream, drawn};
use stiction_core::effects::{EFFECTS, EffectRecord};
use stiction_core::friction::{Entry, LAWS};
use stiction_core::integrate::Integrator;
use stiction_core::model::{FrictionModel, LawSpec};
use stiction_core::motor::{Column, EffectSpec, Motor, MotorSpec, PerSample, Surroundings};
use stiction_core::servo::Servo;

const DT: f64 = 1e-3;
const SAMPLES: usize = 80;

/// A disk with a pendulum, a carriage with a weight and a limited drive, a servo, the other integrator.
fn machines(law: &LawSpec) -> [MotorSpec; 4] {
    let plain = MotorSpec::new(0.0076, 1.0, law.clone());
    let numbers = [("proportional", 20.0), ("integral", 3.0), ("supply", 12.0)];
    let servo = Servo::new(&numbers.map(|(name, value)| (name.to_owned(), value))).unwrap();
    [
        MotorSpec { gravity_amplitude: 0.1, gravity_zero: 0.2, ..plain.clone() },
        MotorSpec { weight: 0.3, input_limit: 1.5, ..MotorSpec::new(2.0, 3.0, law.clone()) },
        MotorSpec { servo: Some(servo), count: 1e-4, ..plain.clone() },
        MotorSpec { integrator: Integrator::Reference, ..plain },
    ]
}

/// An effect at its typical values.
fn typical(record: &'static EffectRecord) -> EffectSpec {
    let values = record.parameters.iter().map(|spec| spec.typical).collect();
    EffectSpec { record, values }
}

/// Positions of some samples, all of which differ: input, load and temperature.
fn positions(motor: &mut Motor, from: usize) -> Vec<f64> {
    let at = |rate: f64, size: f64| -> Vec<f64> {
        (from..from + SAMPLES).map(|k| size * (rate * k as f64).sin()).collect()
    };
    let (inputs, load, warmth) = (at(0.11, 0.9), at(0.31, 0.05), at(0.02, 40.0));
    let around = Surroundings {
        temperature: Some(PerSample::Each(&warmth)),
        ..Surroundings::from(PerSample::Each(&load))
    };
    let mut values = vec![0.0; SAMPLES];
    let columns = &mut [(Column::Position, values.as_mut_slice())];
    assert!(motor.simulate(&inputs, around, PerSample::Same(DT), columns).unwrap());
    values
}

fn entries(motor: &Motor) -> Vec<(String, Entry)> {
    motor.entries().into_iter().map(|(name, entry)| (name.into_owned(), entry)).collect()
}

/// Every law with every effect, and with all of them, on every machine.
fn every_motor(mut with: impl FnMut(&MotorSpec)) {
    for record in LAWS {
        let law = drawn(record, &mut Stream::of(record, 11));
        for machine in machines(&law) {
            let mut lists: Vec<Vec<EffectSpec>> =
                EFFECTS.iter().map(|e| vec![typical(e)]).collect();
            lists.push(EFFECTS.iter().map(typical).collect());
            lists.push(Vec::new());
            for effects in lists {
                with(&MotorSpec { effects, ..machine.clone() });
            }
        }
    }
}

#[test]
fn another_motor_goes_on_from_a_state_to_the_bit() {
    every_motor(|spec| {
        let mut motor = Motor::new(spec.clone()).unwrap();
        motor.reset(0.3, 0.1).unwrap();
        motor.set_clock(2.0, 1.0);
        positions(&mut motor, 0);
        let kept = entries(&motor);
        let mut other = Motor::new(spec.clone()).unwrap();
        other.restore(&kept).unwrap_or_else(|problem| panic!("{problem}: {spec:?}"));
        assert_eq!(entries(&other), kept, "{spec:?}");
        let (went, goes) = (positions(&mut motor, SAMPLES), positions(&mut other, SAMPLES));
        assert_eq!(went.map_bits(), goes.map_bits(), "{spec:?}");
        assert_eq!(entries(&other), entries(&motor), "{spec:?}");
    });
}

trait Bits {
    fn map_bits(&self) -> Vec<u64>;
}

impl Bits for Vec<f64> {
    fn map_bits(&self) -> Vec<u64> {
        self.iter().map(|x| x.to_bits()).collect()
    }
}

#[test]
fn no_two_states_or_columns_of_a_motor_have_one_name() {
    every_motor(|spec| {
        let motor = Motor::new(spec.clone()).unwrap();
        let names: Vec<String> = entries(&motor).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "{names:?}");
        let columns = Column::names(&spec.friction);
        assert_eq!(columns.iter().collect::<BTreeSet<_>>().len(), columns.len(), "{columns:?}");
        for (k, name) in columns.iter().enumerate() {
            let column = Column::named(&spec.friction, name).unwrap();
            assert_eq!(column, Column::named(&spec.friction, &columns[k]).unwrap());
            assert_eq!(matches!(column, Column::Law(_)), k >= 4, "{name}");
        }
    });
}

#[test]
fn names_of_laws_leave_the_dot_to_motors() {
    for record in LAWS {
        let model = FrictionModel::new(drawn(record, &mut Stream::of(record, 11)));
        let states = model.entries().into_iter().map(|(name, _)| name);
        for name in states.chain(record.outputs.iter().map(|name| (*name).into())) {
            assert!(!name.contains('.') && !name.is_empty(), "{}: {name}", record.name);
        }
    }
}

#[test]
fn a_state_that_is_called_like_one_of_the_body_stands_beside_it() {
    let law = LawSpec::new("bristle", &[], &[]).unwrap();
    let mut motor = Motor::new(MotorSpec::new(0.0076, 1.0, law)).unwrap();
    motor.reset(5.0, 0.0).unwrap();
    positions(&mut motor, 0);
    let number = |wanted: &str| {
        let mut all = entries(&motor).into_iter();
        match all.find(|(name, _)| name == wanted) {
            Some((_, Entry::Number(x))) => x,
            other => panic!("{wanted}: {other:?}"),
        }
    };
    assert_eq!(number("position"), motor.running().run.position);
    assert_eq!(number("velocity"), motor.running().run.velocity);
    assert!((number("position") - number("friction.position") - 5.0).abs() < 1e-9);
    let mut missing = entries(&motor);
    missing.retain(|(name, _)| name != "friction.position");
    let problem = motor.restore(&missing).unwrap_err().to_string();
    assert!(problem.contains("'friction.position' is missing"), "{problem}");
}
