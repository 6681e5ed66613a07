//! Exact derivatives of whole trajectories and along a motion are the same to the bit on every
//! processor. Alone in this file: the width is one of the whole process.
#![allow(missing_docs)]

use stiction_core::effects::EFFECTS;
use stiction_core::friction::LAWS;
use stiction_core::lanes::Width;
use stiction_core::model::LawSpec;
use stiction_core::motor::{Column, EffectSpec, Motor, MotorSpec, PerSample, Surroundings};
use stiction_core::sensitivity::{MeasuredMotion, follow_sensitivity, sensitivity};

const SAMPLES: usize = 4000;

/// A ring, a ramp that breaks away, pulses and rests.
fn inputs() -> Vec<f64> {
    (0..SAMPLES)
        .map(|k| {
            let t = k as f64 * 2e-4;
            let pulse = if t % 0.2 < 0.02 { 0.3 } else { 0.0 };
            0.45 * (9.0 * t).sin() * t.min(1.0) + 0.1 * (120.0 * t).sin() + pulse
        })
        .collect()
}

/// Every law without effects, and every effect that such motors may have beside a law.
fn motors() -> Vec<MotorSpec> {
    let law = |name: &str| {
        let stated = [("breakaway".to_owned(), 0.4)];
        LawSpec::new(name, &stated, &[]).or_else(|_| LawSpec::new(name, &[], &[])).unwrap()
    };
    let bare = |name: &str| MotorSpec { weight: 0.02, ..MotorSpec::new(0.0076, 1.5, law(name)) };
    let mut motors: Vec<_> = LAWS.iter().map(|record| bare(record.name)).collect();
    for record in EFFECTS {
        let gains = record.parameters.iter().filter(|p| record.facts.gains.contains(&p.name));
        let stated: Vec<_> = gains.map(|p| (p.name.to_owned(), 0.05 * p.typical)).collect();
        for law in ["hsieh_pan", "coulomb"] {
            let effects = vec![EffectSpec::new(record.name, &stated).unwrap()];
            motors.push(MotorSpec { effects, ..bare(law) });
        }
    }
    motors
}

#[test]
fn derivatives_are_the_same_at_every_width() {
    let inputs = inputs();
    for spec in motors() {
        let name = format!("{} {:?}", spec.friction.record.name, spec.effects);
        let known = spec.parameters();
        let finite = known.iter().filter(|(_, value)| value.is_finite());
        let paths: Vec<String> = finite.map(|(path, _)| path.clone()).collect();
        let motor = Motor::new(spec.clone()).unwrap();
        let warm = Some(PerSample::Same(31.0));
        let around =
            Surroundings { temperature: warm, ..Surroundings::from(PerSample::Same(0.01)) };
        let dt = PerSample::Same(2e-4);
        let mut positions = vec![0.0; SAMPLES + 1];
        let mut columns = [(Column::Position, &mut positions[1..])];
        motor.clone().simulate(&inputs, around, dt, &mut columns).unwrap();
        let each = PerSample::Each(&inputs);
        let motion =
            MeasuredMotion { positions: &positions, inputs: each, around, dt, averaged: true };
        let at = |width: Width| {
            width.limit();
            assert!(Width::widest() <= width);
            let start = motor.running();
            let found = sensitivity(&spec, start, &inputs, around, dt, &paths).unwrap();
            let along = follow_sensitivity(&spec, start.into(), &motion, &paths).unwrap();
            let found = found.position.into_iter().chain(found.velocity);
            let along = along.needed.into_iter().chain(along.driven);
            found.chain(along).map(f64::to_bits).collect::<Vec<_>>()
        };
        let plain = at(Width::Baseline);
        assert!(plain.iter().any(|bits| *bits << 1 != 0), "{name}");
        for width in [Width::Four, Width::Eight] {
            assert!(at(width) == plain, "{name} {width:?}");
        }
    }
}
