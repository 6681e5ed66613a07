//! Steps in a row are the same as one by one, whatever effects a motor has: to the bit, derivatives too.
#![allow(missing_docs)]

mod common;

use common::Stream;
use stiction_core::effects::{EFFECTS, EffectSpec};
use stiction_core::friction::{LAWS, LawRecord};
use stiction_core::model::LawSpec;
use stiction_core::motor::{Column, Motor, MotorSpec, PerSample, Running, Surroundings};
use stiction_core::parameter::ParameterSpec;
use stiction_core::scalar::{Dual, Scalar};

const SAMPLES: usize = 700;
const MOTORS: u64 = 60;

/// A typical value, larger or smaller, on either side where that is allowed.
fn near(parameter: &ParameterSpec, stream: &mut Stream) -> f64 {
    let side = if parameter.bounds.0 < 0.0 && stream.next() < 0.5 { -1.0 } else { 1.0 };
    let value = side * parameter.typical * stream.log(0.3, 3.0);
    value.clamp(parameter.bounds.0, parameter.bounds.1)
}

fn law(record: &LawRecord, stream: &mut Stream) -> LawSpec {
    let breakaway = if stream.next() < 0.8 { stream.between(0.2, 0.6) } else { 5.0 };
    let mut stated = vec![("breakaway".to_owned(), breakaway)];
    if stream.next() < 0.5 {
        stated.push(("coulomb".to_owned(), breakaway * stream.between(0.4, 1.0)));
    }
    if stream.next() < 0.5 {
        stated.push(("viscous".to_owned(), stream.log(1e-3, 0.3)));
    }
    let plainly = || LawSpec::new(record.name, &[], &[]).unwrap();
    LawSpec::new(record.name, &stated, &[]).unwrap_or_else(|_| plainly())
}

/// A motor with a few effects, in most cases of those that go in rows.
fn drawn(record: &LawRecord, stream: &mut Stream) -> MotorSpec {
    let number = 1 + (3.0 * stream.next()) as usize;
    let mut effects: Vec<EffectSpec> = Vec::new();
    while effects.len() < number {
        let effect = &EFFECTS[(stream.next() * EFFECTS.len() as f64) as usize];
        let direct = effect.hooks.iter().all(|hook| hook.at_contact());
        if effects.iter().any(|other| other.record.name == effect.name)
            || (!direct && stream.next() < 0.7)
        {
            continue;
        }
        let values = effect.parameters.iter().map(|p| near(p, stream)).collect();
        effects.push(EffectSpec { record: effect, values });
    }
    let level = stream.next() < 0.7;
    MotorSpec {
        effects,
        gravity_amplitude: if level { 0.0 } else { stream.log(1e-3, 0.3) },
        weight: if stream.next() < 0.7 { 0.0 } else { stream.between(-0.1, 0.1) },
        ..MotorSpec::new(stream.log(1e-3, 2e-2), 1.0, law(record, stream))
    }
}

/// Efforts that ring, let go and rest.
fn efforts(stream: &mut Stream, dt: f64) -> Vec<f64> {
    let (size, pace) = (stream.between(0.3, 1.2), stream.log(2.0, 40.0));
    let effort = |t: f64| match t * pace % 3.0 {
        still if still > 2.4 => 0.05,
        _ => 0.7 * (pace * t).sin() + 0.5 * (2.7 * pace * t).sin(),
    };
    (0..SAMPLES).map(|k| size * effort(k as f64 * dt)).collect()
}

struct Drawn {
    spec: MotorSpec,
    inputs: Vec<f64>,
    loads: Vec<f64>,
    temperature: Option<f64>,
    dt: f64,
}

impl Drawn {
    fn new(record: &LawRecord, seed: u64) -> Self {
        let mut stream = Stream::of(record, seed);
        let spec = drawn(record, &mut stream);
        let dt = stream.log(1e-4, 3e-3);
        let inputs = efforts(&mut stream, dt);
        let (weight, drift) = (stream.between(-0.1, 0.1), stream.between(-0.1, 0.1));
        let load = |k: usize| weight + drift * (k / 50) as f64 / 14.0;
        let loads = (0..SAMPLES).map(load).collect();
        let temperature = (stream.next() < 0.5).then(|| stream.between(0.0, 60.0));
        Self { spec, inputs, loads, temperature, dt }
    }

    fn around(&self) -> Surroundings<'_> {
        let temperature = self.temperature.map(PerSample::Same);
        Surroundings { load: PerSample::Each(&self.loads), temperature, ..Surroundings::NONE }
    }
}

/// Bits of a number. A friction that effects take away whole is a zero, of either sign.
fn bits_of(value: f64) -> u64 {
    (value + 0.0).to_bits()
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| bits_of(*value)).collect()
}

#[test]
fn a_run_with_effects_is_its_steps() {
    for record in LAWS {
        for seed in 0..MOTORS {
            let drawn = Drawn::new(record, seed);
            let Ok(start) = Motor::new(drawn.spec.clone()) else { continue };
            let case = || format!("{} {seed} {:?}", record.name, drawn.spec);
            let (mut at_once, mut stepped) = (start.clone(), start);
            let mut columns = [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![0.0; SAMPLES]);
            let [x, v, f] = &mut columns;
            let wanted =
                &mut [(Column::Position, &mut x[..]), (Column::Velocity, v), (Column::Friction, f)];
            let done =
                at_once.simulate(&drawn.inputs, drawn.around(), PerSample::Same(drawn.dt), wanted);
            stepped.set_temperature(drawn.temperature);
            let steps: Result<Vec<_>, _> = (0..SAMPLES)
                .map(|k| {
                    let moved = stepped.step(drawn.inputs[k], drawn.loads[k], drawn.dt);
                    moved.map(|(x, v)| [x, v, stepped.running().run.friction])
                })
                .collect();
            let Ok(steps) = steps else {
                assert!(done.is_err(), "{}", case());
                continue;
            };
            done.unwrap();
            for (place, column) in columns.iter().enumerate() {
                let own: Vec<f64> = steps.iter().map(|step| step[place]).collect();
                assert_eq!(bits(column), bits(&own), "{}", case());
            }
            assert_eq!(at_once.entries(), stepped.entries(), "{}", case());
        }
    }
}

#[test]
fn derivatives_of_a_run_with_effects_are_those_of_its_steps() {
    for record in LAWS {
        for seed in 0..MOTORS / 2 {
            let drawn = Drawn::new(record, 1000 + seed);
            let values: Vec<f64> = drawn.spec.parameters().into_iter().map(|(_, x)| x).collect();
            if Motor::new(drawn.spec.clone()).is_err() {
                continue;
            }
            let first = values.len().saturating_sub(8);
            let seeded: Vec<Dual> = values
                .iter()
                .enumerate()
                .map(|(k, value)| match k.checked_sub(first) {
                    Some(column) => Dual::variable(*value, column),
                    None => Dual::constant(*value),
                })
                .collect();
            let mut at_once = Running::new(&drawn.spec, &seeded);
            let mut stepped = at_once.clone();
            let mut rows = Vec::new();
            let same = PerSample::Same(drawn.dt);
            let done = at_once.simulate(&drawn.inputs, drawn.around(), same, |_, run, _, _| {
                rows.push([run.position, run.velocity, run.friction]);
            });
            if done.is_err() {
                continue;
            }
            for (k, row) in rows.iter().enumerate() {
                stepped.run.temperature = drawn.temperature;
                stepped.step(drawn.inputs[k], drawn.loads[k], drawn.dt).unwrap();
                let run = [stepped.run.position, stepped.run.velocity, stepped.run.friction];
                for (one, other) in row.iter().zip(&run) {
                    let parts = |x: Dual| (0..8).map(move |column| bits_of(x.partial(column)));
                    let case = || format!("{} {seed} {k} {:?}", record.name, drawn.spec);
                    assert_eq!(bits_of(one.re()), bits_of(other.re()), "{}", case());
                    assert!(parts(*one).eq(parts(*other)), "{} {one:?} {other:?}", case());
                }
            }
        }
    }
}
