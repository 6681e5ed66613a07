//! Time a sample of motors with effects, beside the bare one: `effects [LAW ...]`.
//!
//! All of a law take their turn in every round; of each the best round counts.

use std::hint::black_box;
use std::time::Instant;

use stiction_benches::{DT, SAMPLES, efforts, motor_with};
use stiction_core::effects::EFFECTS;
use stiction_core::motor::{Column, Motor, PerSample, Surroundings};

const ROUNDS: usize = 15;
/// What a diagnosis likes to hand back together.
const THREE: &str = "cogging+position_dependent_friction+torque_bias";

/// Nanoseconds a sample of a run through all of them.
fn run(motor: &Motor, effort: &[f64], x: &mut [f64], v: &mut [f64]) -> f64 {
    let mut motor = motor.clone();
    let columns = &mut [(Column::Position, &mut *x), (Column::Velocity, &mut *v)];
    let around = Surroundings { temperature: Some(PerSample::Same(30.0)), ..Surroundings::NONE };
    let begun = Instant::now();
    motor.simulate(black_box(effort), around, PerSample::Same(DT), columns).expect("a sane motor");
    begun.elapsed().as_secs_f64() * 1e9 / SAMPLES as f64
}

fn main() {
    let mut laws: Vec<String> = std::env::args().skip(1).collect();
    if laws.is_empty() {
        laws = ["coulomb", "hsieh_pan", "lugre"].map(str::to_owned).to_vec();
    }
    let effort = efforts();
    let (mut x, mut v) = (vec![0.0; SAMPLES], vec![0.0; SAMPLES]);
    let mut plants = vec![String::new()];
    plants.extend(EFFECTS.iter().map(|effect| effect.name.to_owned()));
    plants.push(THREE.to_owned());
    let mut table = vec![Vec::new(); plants.len()];
    for law in &laws {
        let motors: Vec<Option<Motor>> =
            plants.iter().map(|effects| motor_with(law, effects)).collect();
        let mut best = vec![f64::INFINITY; plants.len()];
        for _ in 0..ROUNDS {
            for (motor, best) in motors.iter().zip(&mut best) {
                if let Some(motor) = motor {
                    *best = best.min(run(motor, &effort, &mut x, &mut v));
                }
            }
        }
        for (row, time) in table.iter_mut().zip(&best) {
            row.push((*time, *time / best[0]));
        }
    }
    println!("{:48}{}", "ns, against bare", laws.join("  "));
    for (name, row) in plants.iter().zip(&table) {
        let cells: Vec<String> =
            row.iter().map(|(time, ratio)| format!("{time:8.1} {ratio:5.2}")).collect();
        println!("{:48}{}", if name.is_empty() { "bare" } else { name }, cells.join("  "));
    }
}
