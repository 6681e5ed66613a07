//! What a sample costs over the range of each parameter, against its default: `sweep [LAW ...]`.
//!
//! One parameter at a time, a thousandth to a thousand times its typical value within its bounds; the rest
//! as in the other benches. Two motions: efforts that ring, break away and rest, and efforts of ±0.2 that
//! only ring. A stiffer contact, or one that is damped more, has samples that are divided into more steps,
//! because its motion is faster: so the cost of a step is told beside that of a sample. Effects are swept on
//! `hsieh_pan`.

use std::hint::black_box;
use std::time::Instant;

use stiction_benches::{DT, SAMPLES, efforts, motor_stated};
use stiction_core::effects::EFFECTS;
use stiction_core::friction::LAWS;
use stiction_core::motor::{Column, Motor, PerSample, Surroundings};
use stiction_core::parameter::ParameterSpec;

const ROUNDS: usize = 5;
/// Values each way from the typical one, so many a decade.
const EACH_WAY: i32 = 9;
const PER_DECADE: f64 = 3.0;
/// Cost over that of the default from which on a value is printed.
const WORTH: f64 = 1.5;

/// Nanoseconds of a sample, the best of some runs, and its steps; nothing where it does not run.
fn cost(motor: &Motor, effort: &[f64]) -> Option<(f64, f64)> {
    let (mut x, mut v) = (vec![0.0; SAMPLES], vec![0.0; SAMPLES]);
    let around = Surroundings { temperature: Some(PerSample::Same(30.0)), ..Surroundings::NONE };
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let mut motor = motor.clone();
        let columns = &mut [(Column::Position, &mut x[..]), (Column::Velocity, &mut v[..])];
        let begun = Instant::now();
        motor.simulate(black_box(effort), around, PerSample::Same(DT), columns).ok()?;
        best = best.min(begun.elapsed().as_secs_f64() * 1e9 / SAMPLES as f64);
    }
    Some((best, motor.running().division(DT).steps))
}

/// Values of a parameter within its bounds.
fn values(spec: &ParameterSpec) -> impl Iterator<Item = f64> {
    let (typical, (lower, upper)) = (spec.typical, spec.bounds);
    (-EACH_WAY..=EACH_WAY)
        .map(move |k| typical * 10.0_f64.powf(f64::from(k) / PER_DECADE))
        .filter(move |value| *value >= lower && *value <= upper)
}

/// Sweeps the parameters of a law, or of an effect on it; the worst cost of a sample and of a step.
fn sweep(law: &str, effect: &str, specs: &[ParameterSpec], motions: &[Vec<f64>]) -> (f64, f64) {
    let name = if effect.is_empty() { law } else { effect };
    let mut worst = (1.0_f64, 1.0_f64);
    let Some(default) = motor_stated(law, effect, None) else { return worst };
    // A default that rests all along costs next to nothing: then what moves is held against it.
    let bases: Vec<_> = motions.iter().filter_map(|effort| cost(&default, effort)).collect();
    let Some((base, steps)) = bases.into_iter().max_by(|one, other| one.0.total_cmp(&other.0))
    else {
        return worst;
    };
    for effort in motions {
        for spec in specs {
            let mut told = (1.0, 1.0, 0.0, 0.0);
            for value in values(spec) {
                let motor = motor_stated(law, effect, Some((spec.name, value)));
                let Some((now, divided)) = motor.and_then(|motor| cost(&motor, effort)) else {
                    continue;
                };
                let (sample, step) = (now / base, now / divided / (base / steps));
                worst = (worst.0.max(sample), worst.1.max(step));
                if step > told.1 {
                    told = (sample, step, value, divided);
                }
            }
            if told.1 > WORTH {
                let (sample, step, value, divided) = told;
                println!(
                    "{name:28}{:28}{value:10.3e}{divided:7} steps{sample:9.2} a sample{step:7.2} a step",
                    spec.name
                );
            }
        }
    }
    worst
}

fn main() {
    let named: Vec<String> = std::env::args().skip(1).collect();
    let wanted = |name: &str| named.is_empty() || named.iter().any(|word| word == name);
    let rings = (0..SAMPLES).map(|k| 0.2 * (60.0 * DT * k as f64).sin()).collect();
    let motions = [efforts(), rings];
    let mut summary = Vec::new();
    for law in LAWS.iter().filter(|law| wanted(law.name)) {
        summary.push((law.name, sweep(law.name, "", law.parameters, &motions)));
    }
    for effect in EFFECTS.iter().filter(|effect| wanted(effect.name)) {
        let worst = sweep("hsieh_pan", effect.name, effect.parameters, &motions);
        summary.push((effect.name, worst));
    }
    println!("\n{:28}{:>10}{:>10}", "worst over default", "a sample", "a step");
    for (name, (sample, step)) in summary {
        println!("{name:28}{sample:10.2}{step:10.2}");
    }
}
