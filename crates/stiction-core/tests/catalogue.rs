//! The one-place rule: whatever is in the lists behaves as everything in them must.
#![allow(missing_docs)]

mod common;

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use common::{AROUND, Stream, column_amid, drawn, motor, positions, run};
use stiction_core::effects::{EFFECTS, Scale, neutral_values};
use stiction_core::friction::{Channels, LAWS, LawRecord, Statistics};
use stiction_core::model::{FrictionModel, LawSpec};
use stiction_core::motor::{Column, EffectSpec, Motor, MotorSpec, PerSample, Running};
use stiction_core::scalar::{Dual, Scalar};
use stiction_core::sensitivity::sensitivity;

/// What beside the parameters of a law an effect may be part of.
const BESIDE: [&str; 2] = ["body.gravity_amplitude", "law.remembers"];

/// Names of the modules in a folder, of one file each or of a folder; `elements` are shared pieces.
fn modules(folder: &str) -> BTreeSet<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(folder);
    std::fs::read_dir(path)
        .unwrap()
        .filter_map(|entry| {
            let path = entry.unwrap().path();
            let is_module = path.is_dir() || path.extension().is_some_and(|own| own == "rs");
            let name = path.file_stem()?.to_str()?;
            (is_module && !["mod", "elements"].contains(&name)).then(|| name.to_owned())
        })
        .collect()
}

#[test]
fn every_file_in_the_folders_is_in_its_list() {
    assert_eq!(modules("friction"), LAWS.iter().map(|law| law.name.to_owned()).collect());
    assert_eq!(modules("plant/effects"), EFFECTS.iter().map(|e| e.name.to_owned()).collect());
}

#[test]
fn parameters_are_documented_and_their_defaults_are_allowed() {
    let laws = LAWS.iter().map(|law| (law.name, law.parameters));
    for (name, parameters) in laws.chain(EFFECTS.iter().map(|e| (e.name, e.parameters))) {
        for spec in parameters {
            assert!(spec.meaning.len() > 3, "{name}.{} has no meaning", spec.name);
            assert!(spec.check(spec.typical).is_ok(), "{name}.{}", spec.name);
            if let Some(neutral) = spec.neutral {
                assert!(spec.check(neutral).is_ok(), "{name}.{}", spec.name);
            }
        }
    }
    for law in LAWS {
        assert!(LawSpec::new(law.name, &[], &[]).is_ok(), "{} lacks defaults", law.name);
        for start in law.start {
            assert!(start.meaning.len() > 3, "start.{} of {}", start.name, law.name);
            assert_eq!(start.neutral, Some(0.0), "start.{} of {}", start.name, law.name);
            assert!(start.check(start.typical).is_ok(), "start.{} of {}", start.name, law.name);
        }
        for name in law.optional {
            assert!(law.parameters.iter().any(|p| p.name == *name), "{}.{name}", law.name);
        }
    }
    for effect in EFFECTS {
        assert!(EffectSpec::new(effect.name, &[]).is_ok(), "{} lacks defaults", effect.name);
        for gain in effect.facts.gains {
            let spec = effect.parameters.iter().find(|p| p.name == *gain);
            assert_eq!(spec.and_then(|p| p.neutral), Some(0.0), "{}.{gain}", effect.name);
        }
        for other in effect.facts.look_alikes {
            assert_ne!(other, &effect.name);
        }
        let shapes: Vec<&str> = effect.facts.shapes.iter().map(|shape| shape.parameter).collect();
        for spec in effect.parameters {
            let (gain, shape) =
                (effect.facts.gains.contains(&spec.name), shapes.contains(&spec.name));
            let second = effect.facts.second.contains(&spec.name);
            let places = [gain, shape, second].iter().filter(|own| **own).count();
            assert_eq!(places, 1, "{}.{} is a gain or has a grid", effect.name, spec.name);
        }
        for shape in effect.facts.shapes {
            assert!(effect.parameters.iter().any(|p| p.name == shape.parameter));
            assert_eq!(shape.grid.is_empty(), shape.scale == Scale::Order, "{}", effect.name);
        }
        for term in effect.facts.law_terms {
            let law = LAWS.iter().any(|law| law.parameters.iter().any(|p| p.name == *term));
            assert!(law || BESIDE.contains(term), "{}: nothing has {term}", effect.name);
        }
        assert!(!effect.facts.means.is_empty() && !effect.facts.remedy.is_empty());
    }
}

#[test]
fn laws_stay_finite_over_their_bounds() {
    for law in LAWS {
        let mut stream = Stream::of(law, 3);
        for trial in 0..60 {
            let parameters: Vec<(String, f64)> = law
                .parameters
                .iter()
                .map(|spec| {
                    let (low, high) = spec.bounds;
                    let (low, high) = (low.max(spec.typical * 1e-5), high.min(spec.typical * 1e5));
                    (spec.name.to_owned(), stream.log(low, high))
                })
                .collect();
            let Ok(spec) = LawSpec::new(law.name, &parameters, &[]) else { continue };
            let mut model = FrictionModel::new(spec.clone());
            let dt = stream.log(1e-6, 1e-1);
            let velocity: Vec<f64> = (0..200)
                .map(|k| {
                    let size = stream.log(1e-6, 1e1);
                    if k % 7 == 0 { 0.0 } else { size * (stream.next() - 0.5) }
                })
                .collect();
            let friction = run(&mut model, &velocity, dt);
            assert!(friction.iter().all(|f| f.is_finite()), "{trial}: {spec:?}");
        }
    }
}

#[test]
fn laws_oppose_motion() {
    for law in LAWS {
        let mut stream = Stream::of(law, 5);
        for _ in 0..20 {
            let spec = drawn(law, &mut stream);
            let speed = stream.log(0.01, 1.0);
            for direction in [1.0, -1.0] {
                let mut model = FrictionModel::new(spec.clone());
                let friction = run(&mut model, &[direction * speed; 400], 1e-3);
                assert!(friction[399] * direction > 0.0, "{spec:?}");
            }
            let mut model = FrictionModel::new(spec.clone());
            let velocity: Vec<f64> =
                (0..4000).map(|k| speed * (f64::from(k) * 0.01).sin()).collect();
            let friction = run(&mut model, &velocity, 1e-3);
            let power: f64 = friction.iter().zip(&velocity).map(|(f, v)| f * v).sum();
            assert!(power > 0.0, "{spec:?}");
        }
    }
}

#[test]
fn slope_is_the_derivative_of_the_force_by_the_velocity() {
    for law in LAWS {
        let mut stream = Stream::of(law, 7);
        for case in 0..60 {
            let spec = drawn(law, &mut stream);
            let mut model = FrictionModel::new(spec.clone());
            let warm: Vec<f64> = (0..200).map(|k| 0.05 * (f64::from(k) * 0.02).sin()).collect();
            run(&mut model, &warm, 1e-3);
            let velocity = stream.between(-0.2, 0.2);
            let dt = stream.log(1e-5, 1e-2);
            let channels = Channels::default();
            let at = |v: f64| model.clone().trial(v, dt, &channels).unwrap().0;
            let step = 1e-6 * velocity.abs().max(1e-3);
            let chord = (at(velocity + step) - at(velocity - step)) / (2.0 * step);
            let slope = model.trial(velocity, dt, &channels).unwrap().1;
            let tolerance = 2e-5 * (chord.abs() + slope.abs()) + 1e-7;
            assert!(
                (slope - chord).abs() < tolerance,
                "{case} {velocity} {dt}: {slope} {chord} {spec:?}"
            );
        }
    }
}

/// A run that rings, reverses, creeps and, where the law can, slides.
fn excitation(samples: usize) -> Vec<f64> {
    (0..samples)
        .map(|k| {
            let t = k as f64 * 1e-3;
            0.5 * (7.0 * t).sin() + 0.4 * (23.0 * t).sin() + if t % 0.2 < 0.02 { 0.3 } else { 0.0 }
        })
        .collect()
}

#[test]
fn neutral_effects_change_no_bit() {
    let inputs = excitation(1500);
    for law in LAWS {
        let spec = LawSpec::new(law.name, &[("breakaway".to_owned(), 0.5)], &[])
            .or_else(|_| LawSpec::new(law.name, &[], &[]))
            .unwrap();
        // A weight loads the contact, whatever else there is.
        let alone = MotorSpec { weight: 0.05, ..MotorSpec::new(0.0076, 1.0, spec) };
        let plain = positions(&mut Motor::new(alone.clone()).unwrap(), &inputs, 1e-3);
        for effect in EFFECTS {
            let with = MotorSpec {
                effects: vec![EffectSpec { record: effect, values: neutral_values(effect) }],
                ..alone.clone()
            };
            let with = positions(&mut Motor::new(with).unwrap(), &inputs, 1e-3);
            assert!(plain == with, "{} on {}", effect.name, law.name);
        }
    }
}

#[test]
fn active_effects_change_the_motion() {
    let inputs = excitation(1500);
    for law in LAWS {
        // A contact that slides: what a slide renews has no meaning without one.
        let spec = LawSpec::new(law.name, &[("breakaway".to_owned(), 0.5)], &[])
            .or_else(|_| LawSpec::new(law.name, &[], &[]))
            .unwrap();
        let read = Column::Measured;
        let plain = column_amid(AROUND, &mut motor(0.0076, spec.clone()), read, &inputs, 1e-3);
        for effect in EFFECTS {
            let values = effect.parameters.iter().map(|p| p.typical).collect();
            let with = MotorSpec {
                effects: vec![EffectSpec { record: effect, values }],
                ..MotorSpec::new(0.0076, 1.0, spec.clone())
            };
            // A sensor that errs shows in its readings alone.
            let with = column_amid(AROUND, &mut Motor::new(with).unwrap(), read, &inputs, 1e-3);
            assert!(plain != with, "{} on {}", effect.name, law.name);
            assert!(with.iter().all(|x| x.is_finite()), "{} on {}", effect.name, law.name);
        }
    }
}

/// Final position, the branches taken by the end of every sample, for a reversal that moves into
/// the neighbouring step leaves the final counts as they were, and the greatest position on the way.
fn end_state(spec: &MotorSpec, inputs: &[f64], dt: f64) -> (f64, Vec<Statistics>, f64) {
    let mut motor = Motor::new(spec.clone()).unwrap();
    motor.set_temperature(Some(40.0));
    let mut position = 0.0;
    let mut farthest = 0.0_f64;
    let branches = inputs
        .iter()
        .map(|input| {
            position = motor.step(*input, 0.05, dt).unwrap().0;
            farthest = farthest.max(position.abs());
            motor.statistics()
        })
        .collect();
    (position, branches, farthest)
}

#[test]
fn gradients_equal_central_differences_on_the_same_branches() {
    // The longest test by far: its laws go over the processor's cores.
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut compared = 0;
        while let Some(law) = LAWS.get(next.fetch_add(1, Ordering::Relaxed)) {
            compared += compare_gradients(law);
        }
        compared
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let compared: usize = std::thread::scope(|scope| {
        let started: Vec<_> = (0..cores).map(|_| scope.spawn(worker)).collect();
        started.into_iter().map(|one| one.join().unwrap()).sum()
    });
    assert!(compared > 100, "only {compared} comparisons ran on equal branches");
}

/// Holds the exact gradients of random motors with a law against chords; how many could be.
fn compare_gradients(law: &'static LawRecord) -> usize {
    let mut compared = 0;
    let mut stream = Stream::of(law, 11);
    for _ in 0..3 {
        let spec = MotorSpec {
            effects: EFFECTS
                .iter()
                .map(|e| EffectSpec {
                    record: e,
                    values: e.parameters.iter().map(|p| p.typical * 0.5).collect(),
                })
                .collect(),
            gravity_amplitude: 0.1,
            gravity_zero: 0.05,
            ..MotorSpec::new(0.0076 * stream.log(0.5, 2.0), 1.0, drawn(law, &mut stream))
        };
        let inputs = excitation(150);
        // No delay is a whole number of these: there its derivative is that to one side.
        let dt = 4.7e-4;
        if amplifies_round_off(&spec, &inputs, dt) {
            continue;
        }
        let parameters = spec.parameters();
        let paths: Vec<String> = parameters.iter().map(|(path, _)| path.clone()).collect();
        let fresh = Motor::new(spec.clone()).unwrap();
        let exact =
            sensitivity(&spec, fresh.running(), &inputs, AROUND, PerSample::Same(dt), &paths)
                .unwrap();
        let (position, _, farthest) = end_state(&spec, &inputs, dt);
        for (index, (path, value)) in parameters.iter().enumerate() {
            let perturbed = |factor: f64| {
                let mut values: Vec<f64> = parameters.iter().map(|(_, v)| *v).collect();
                values[index] = value + factor;
                respec(&spec, &values)
            };
            if !value.is_finite() {
                continue;
            }
            // Three sizes: where they disagree the difference itself is not to be trusted.
            let chord = |size: f64| {
                let up = end_state(&perturbed(size), &inputs, dt);
                let down = end_state(&perturbed(-size), &inputs, dt);
                let bend = (up.0 - 2.0 * position + down.0) / (2.0 * size);
                (up.1 == down.1).then_some(((up.0 - down.0) / (2.0 * size), bend))
            };
            let scale = value.abs().max(1e-3);
            let (Some((wide, _)), Some((middle, wide_bend)), Some((narrow, narrow_bend))) =
                (chord(8e-6 * scale), chord(4e-6 * scale), chord(2e-6 * scale))
            else {
                continue;
            };
            // Chords to either side that differ as much over half the width: a kink lies in it,
            // where some branch that no statistics count changes inside a sample.
            let (bent, wider) = (narrow_bend.abs(), wide_bend.abs());
            if bent > 1e-6 * narrow.abs() && bent > 0.7 * wider {
                continue;
            }
            let gradient = exact.position[(index + 1) * inputs.len() - 1];
            // A difference of positions that were of this size has no more digits than that, and
            // two chords put together have 5/3 of the round-off of the narrow one.
            let digits = 5.0 / 3.0 * 16.0 * f64::EPSILON * farthest / (2e-6 * scale);
            // Beside a curve, whose bend falls with the width, a smaller kink stands out.
            let kink = (2.0 * narrow_bend - wide_bend).abs();
            if kink > 0.5 * (1e-6 * narrow.abs() + digits) {
                continue;
            }
            // A smooth chord comes four times closer with half the width; one with a kink away
            // from its middle, J/2 (1 - distance / width) off, changes the more the narrower.
            let (wider, noise) = ((wide - middle).abs(), (middle - narrow).abs());
            if noise > 0.5 * wider + 1e-7 * narrow.abs() + digits {
                continue;
            }
            // Richardson: the error of the chord falls with the square of its size.
            let chord = narrow + (narrow - middle) / 3.0;
            if noise > 1e-6 * chord.abs() || digits > 1e-5 * chord.abs() {
                continue;
            }
            assert!(
                (gradient - chord).abs() <= 1e-6 * chord.abs() + digits,
                "{path}: {gradient} against {chord} ± {noise} ± {digits} of {:?}",
                spec.friction
            );
            compared += 1;
        }
    }
    compared
}

/// Whether a machine that sticks and slips on a swinging shaft makes of round-off, which differs
/// between number types, a motion of its own: no derivative tells anything there.
fn amplifies_round_off(spec: &MotorSpec, inputs: &[f64], dt: f64) -> bool {
    fn end<S: Scalar>(spec: &MotorSpec, inputs: &[f64], dt: f64) -> f64 {
        let values: Vec<S> = spec.parameters().iter().map(|p| S::constant(p.1)).collect();
        let mut running = Running::<S>::new(spec, &values);
        running.simulate(inputs, AROUND, PerSample::Same(dt), |_, _, _, _| {}).unwrap();
        running.run.position.re()
    }
    (end::<f64>(spec, inputs, dt) - end::<Dual>(spec, inputs, dt)).abs() > 1e-12
}

/// The same motor with other parameter values.
fn respec(spec: &MotorSpec, values: &[f64]) -> MotorSpec {
    let mut other = spec.clone();
    other.inertia = values[0];
    other.gain = values[1];
    other.gravity_amplitude = values[2];
    other.gravity_zero = values[3];
    other.weight = values[4];
    let mut rest = values[5..].iter().copied();
    for value in &mut other.friction.values {
        *value = rest.next().unwrap();
    }
    for effect in &mut other.effects {
        for value in &mut effect.values {
            *value = rest.next().unwrap();
        }
    }
    other
}
