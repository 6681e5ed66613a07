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

/// A motor with this law and this effect, or with none, of one of which a parameter is stated; nothing where
/// that is not allowed, or the effect needs a servo.
pub fn motor_stated(law_name: &str, effect: &str, stated: Option<(&str, f64)>) -> Option<Motor> {
    let record = law_record(law_name).expect("a law");
    let stated = stated.map(|(name, value)| (name.to_owned(), value));
    if !effect.is_empty() {
        let kind = EffectSpec::new(effect, &[]).expect("an effect").record;
        let others = kind.parameters.iter().filter(|parameter| parameter.neutral.is_some());
        let mut values: Vec<_> = others
            .map(|gain| (gain.name.to_owned(), TYPICAL_SHARE * gain.typical))
            .filter(|(name, _)| stated.as_ref().is_none_or(|(other, _)| other != name))
            .collect();
        values.extend(stated);
        let effects = vec![EffectSpec::new(effect, &values).ok()?];
        return Motor::new(MotorSpec { effects, ..MotorSpec::new(0.0076, 1.0, law(record)) }).ok();
    }
    let own = record.parameters.iter().any(|parameter| parameter.name == "breakaway");
    let other = stated.as_ref().is_none_or(|(name, _)| name != "breakaway");
    let reachable = (own && other).then(|| ("breakaway".to_owned(), 0.5));
    let values: Vec<_> = reachable.into_iter().chain(stated).collect();
    Motor::new(MotorSpec::new(0.0076, 1.0, LawSpec::new(law_name, &values, &[]).ok()?)).ok()
}

/// A motor with this law and these effects, joined by `+`, whose gains are typical; nothing where one of
/// them needs a servo. A value of the law may stand behind its name: `hsieh_pan:breakaway=100`.
pub fn motor_with(law_name: &str, effects: &str) -> Option<Motor> {
    let (law_name, stated) = law_name.split_once(':').unwrap_or((law_name, ""));
    let record = law_record(law_name).expect("a law");
    let friction = match stated.split_once('=') {
        None => law(record),
        Some((name, value)) => {
            let value = value.parse().expect("a number");
            motor_stated(law_name, "", Some((name, value)))?.spec().friction.clone()
        }
    };
    let typical = |name: &str| {
        let gains = EffectSpec::new(name, &[]).expect("an effect").record.parameters.iter();
        let gains = gains.filter(|parameter| parameter.neutral.is_some());
        let stated: Vec<_> =
            gains.map(|gain| (gain.name.to_owned(), TYPICAL_SHARE * gain.typical)).collect();
        EffectSpec::new(name, &stated).expect("typical values are allowed")
    };
    let effects = effects.split('+').filter(|name| !name.is_empty()).map(typical).collect();
    Motor::new(MotorSpec { effects, ..MotorSpec::new(0.0076, 1.0, friction) }).ok()
}
