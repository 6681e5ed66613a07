//! What is shown of a trajectory changes no bit of it.
#![allow(missing_docs)]

mod common;

use common::{Stream, all_laws, drawn, motor};
use stiction_core::motor::{Column, Motor, PerSample, Surroundings};

const SAMPLES: usize = 1500;
const DT: f64 = 2e-4;

/// Efforts that rest, ring and now and then break away.
fn efforts(stream: &mut Stream) -> Vec<f64> {
    let (size, turns) = (stream.between(0.3, 0.9), stream.between(20.0, 90.0));
    let one = |k: usize| match k % 500 {
        0..150 => 0.05,
        150..170 => 0.9,
        _ => size * (turns * k as f64 * DT).sin(),
    };
    (0..SAMPLES).map(one).collect()
}

fn after(start: &Motor, inputs: &[f64], mut columns: Vec<(Column, &mut [f64])>) -> Motor {
    let mut motor = start.clone();
    motor.simulate(inputs, Surroundings::NONE, PerSample::Same(DT), &mut columns).unwrap();
    motor
}

#[test]
fn every_set_of_columns_and_every_step_give_the_same_bits() {
    for record in all_laws() {
        let mut stream = Stream::of(record, 5);
        for _ in 0..3 {
            let start = motor(stream.log(2e-3, 2e-2), drawn(record, &mut stream));
            let inputs = efforts(&mut stream);
            let row = || vec![0.0; SAMPLES];
            let (mut x, mut v, mut y, mut w, mut f) = (row(), row(), row(), row(), row());
            let two = vec![(Column::Velocity, &mut v[..]), (Column::Position, &mut x[..])];
            let two = after(&start, &inputs, two);
            let more = vec![
                (Column::Friction, &mut f[..]),
                (Column::Position, &mut y[..]),
                (Column::Velocity, &mut w[..]),
            ];
            let more = after(&start, &inputs, more);
            let none = after(&start, &inputs, vec![]);
            let mut steps = start.clone();
            for (k, input) in inputs.iter().enumerate() {
                assert_eq!(steps.step(*input, 0.0, DT).unwrap(), (x[k], v[k]), "{}", record.name);
            }
            assert_eq!((&x, &v), (&y, &w), "{}", record.name);
            assert!(f.iter().any(|force| *force != 0.0));
            for other in [&more, &none, &steps] {
                let entries = |motor: &Motor| format!("{:?}", motor.entries());
                assert_eq!(entries(&two), entries(other), "{}", record.name);
            }
        }
    }
}
