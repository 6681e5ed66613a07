//! One run of a motor loop for `instructions.py` to count: `count LAW PASSES`.

use stiction_benches::{DT, SAMPLES, efforts, motor};
use stiction_core::friction::law_record;
use stiction_core::integrate::Integrator;
use stiction_core::motor::{Column, PerSample, Surroundings};

fn main() {
    let mut words = std::env::args().skip(1);
    let (law, passes) = (words.next().expect("a law"), words.next().expect("a number"));
    let passes: usize = passes.parse().expect("a number");
    let start = motor(law_record(&law).expect("a law"), Integrator::Fast);
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
