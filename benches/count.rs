//! One run of a motor loop for `instructions.py` to count: `count LAW[:NAME=VALUE][+EFFECT...] PASSES`.

use stiction_benches::{DT, SAMPLES, efforts, motor_with};
use stiction_core::motor::{Column, PerSample, Surroundings};

fn main() {
    let mut words = std::env::args().skip(1);
    let (plant, passes) = (words.next().expect("a law"), words.next().expect("a number"));
    let passes: usize = passes.parse().expect("a number");
    let (law, effects) = plant.split_once('+').unwrap_or((&plant, ""));
    let start = motor_with(law, effects).expect("a motor");
    let effort = efforts();
    let (mut x, mut v) = (vec![0.0; SAMPLES], vec![0.0; SAMPLES]);
    for _ in 0..passes {
        let columns =
            &mut [(Column::Position, x.as_mut_slice()), (Column::Velocity, v.as_mut_slice())];
        let same = PerSample::Same(DT);
        start.clone().simulate(&effort, Surroundings::NONE, same, columns).expect("a sane motor");
    }
    println!("{}", x[SAMPLES - 1]);
}
