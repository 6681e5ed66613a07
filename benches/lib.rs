//! The workloads of the benches; that they do what the benches claim is tested in
//! `crates/stiction-core/tests/bench_workloads.rs`.

use stiction_core::effects::EffectSpec;
use stiction_core::friction::{LawRecord, law_record};
use stiction_core::integrate::Integrator;
use stiction_core::model::{FrictionModel, LawSpec};
use stiction_core::motor::{Motor, MotorSpec};

/// Samples of one pass.
pub const SAMPLES: usize = 20_000;
/// Duration of a sample in s.
pub const DT: f64 = 1e-4;

/// Of a typical gain: the motor still breaks away and sticks again.
const TYPICAL_SHARE: f64 = 0.5;

/// The law with break-away enabled and reachable where it has one, else with its defaults.
pub fn law(record: &'static LawRecord) -> LawSpec {
    LawSpec::new(record.name, &[("breakaway".to_owned(), 0.5)], &[])
        .or_else(|_| LawSpec::new(record.name, &[], &[]))
        .expect("defaults are allowed")
}

/// Velocities that ring, reverse and now and then slide.
pub fn velocities() -> Vec<f64> {
    (0..SAMPLES)
        .map(|k| {
            let t = k as f64 * DT;
            0.004 * (50.0 * t).sin() + 0.003 * (311.0 * t).sin() + 0.02 * (6.5 * t).sin().powi(9)
        })
        .collect()
}

/// Efforts that ring, creep and now and then break away.
pub fn efforts() -> Vec<f64> {
    (0..SAMPLES)
        .map(|k| {
            let t = k as f64 * DT;
            0.45 * (6.0 * t).sin() + if (t % 0.3) < 0.02 { 0.3 } else { 0.0 }
        })
        .collect()
}

/// A friction model of this law.
pub fn model(record: &'static LawRecord) -> FrictionModel {
    FrictionModel::new(law(record))
}

/// A motor with this law.
pub fn motor(record: &'static LawRecord, integrator: Integrator) -> Motor {
    let spec = MotorSpec { integrator, ..MotorSpec::new(0.0076, 1.0, law(record)) };
    Motor::new(spec).expect("a sane motor")
}

/// A motor with this law and these effects, joined by `+`, whose gains are typical; nothing where one of
/// them needs a servo.
pub fn motor_with(law_name: &str, effects: &str) -> Option<Motor> {
    let record = law_record(law_name).expect("a law");
    let typical = |name: &str| {
        let gains = EffectSpec::new(name, &[]).expect("an effect").record.parameters.iter();
        let gains = gains.filter(|parameter| parameter.neutral.is_some());
        let stated: Vec<_> =
            gains.map(|gain| (gain.name.to_owned(), TYPICAL_SHARE * gain.typical)).collect();
        EffectSpec::new(name, &stated).expect("typical values are allowed")
    };
    let effects = effects.split('+').filter(|name| !name.is_empty()).map(typical).collect();
    Motor::new(MotorSpec { effects, ..MotorSpec::new(0.0076, 1.0, law(record)) }).ok()
}
