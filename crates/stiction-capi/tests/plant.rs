//! Motors of plant files, against motors that are made by hand.
#![allow(missing_docs)]

use std::ffi::{CStr, CString};
use std::ptr::null_mut;

use stiction_capi::{
    Machine, Status, stiction_message, stiction_motor_free, stiction_motor_from_plant,
    stiction_motor_load_plant, stiction_motor_measured, stiction_motor_set_enabled,
    stiction_motor_step,
};
use stiction_core::effects::EffectSpec;
use stiction_core::model::LawSpec;
use stiction_core::motor::{Motor, MotorSpec};
use stiction_core::servo::Servo;

fn said() -> String {
    // SAFETY: the message ends in a zero byte and lives until the next refused call.
    unsafe { CStr::from_ptr(stiction_message()) }.to_str().unwrap().to_owned()
}

fn made(text: &str) -> Result<*mut Machine, (Status, String)> {
    let (mut motor, text) = (null_mut(), CString::new(text).unwrap());
    // SAFETY: the text ends in a zero byte, the target is a local.
    let status = unsafe { stiction_motor_from_plant(text.as_ptr(), &raw mut motor) };
    if status == Status::Ok { Ok(motor) } else { Err((status, said())) }
}

fn pairs(stated: &[(&str, f64)]) -> Vec<(String, f64)> {
    stated.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
}

fn law(name: &str, stated: &[(&str, f64)]) -> LawSpec {
    LawSpec::new(name, &pairs(stated), &[]).unwrap()
}

/// Both go the same way to the bit.
fn same(text: &str, spec: MotorSpec) {
    let motor = made(text).unwrap();
    let mut own = Motor::new(spec).unwrap();
    for k in 0..500 {
        let input = 0.6 * (f64::from(k) * 0.03).sin();
        let (mut x, mut v, mut seen) = (0.0, 0.0, 0.0);
        // SAFETY: the handle is live until it is freed, all targets are locals.
        unsafe {
            let went = stiction_motor_step(motor, input, 0.05, 1e-3, &raw mut x, &raw mut v);
            assert_eq!(went, Status::Ok, "{}", said());
            assert_eq!(stiction_motor_measured(motor, &raw mut seen), Status::Ok);
        }
        assert_eq!((x, v), own.step(input, 0.05, 1e-3).unwrap(), "{text}: {k}");
        assert_eq!(seen, own.running().machine.measured(x));
    }
    assert!(own.running().run.path > 0.0);
    // SAFETY: nobody uses it from now on.
    unsafe { stiction_motor_free(motor) };
}

#[test]
fn a_driven_machine_has_its_gravity_limit_effects_and_counts() {
    let text = r#"
[motion]
kind = "rotary"
[drive]
input = "current_a"
gain = { value = 0.8, min = 0.1, max = 2.0, fixed = true }
limit = 0.5
[body]
inertia = 0.01
gravity_amplitude = 0.1
gravity_zero_rad = 0.3
payload_kg = 0.2
payload_m = 0.1
[friction]
law = "lugre"
coulomb = 0.1
breakaway = { value = 0.2, min = 0.0 }
[[effects]]
name = "cogging"
cosine = 0.02
order = 7
[[effects]]
name = "input_delay"
delay = 0.004
[sensor]
counts_per_rev = 4096
[controller]
kind = "pd"
kp = 3.0
"#;
    let friction = law("lugre", &[("coulomb", 0.1), ("breakaway", 0.2)]);
    let mut spec = MotorSpec::new(0.01 + 0.2 * 0.1 * 0.1, 0.8, friction);
    spec.input_limit = 0.5;
    spec.gravity_amplitude = 0.1 + 0.2 * 0.1 * 9.80665;
    spec.gravity_zero = 0.3;
    spec.count = 2.0 * std::f64::consts::PI / 4096.0;
    spec.effects = vec![
        EffectSpec::new("cogging", &pairs(&[("cosine", 0.02), ("order", 7.0)])).unwrap(),
        EffectSpec::new("input_delay", &pairs(&[("delay", 0.004)])).unwrap(),
    ];
    same(text, spec);
}

#[test]
fn a_servo_goes_to_its_goal() {
    let text = r#"
[drive]
kind = "servo"
torque_constant = 0.5
proportional = 5.0
integral = 2
supply_v = 7.4
resistance_ohm = 3.0
[body]
inertia = 0.01
[friction]
law = "coulomb"
coulomb = 0.1
[[effects]]
name = "goal_rate_limit"
slowness = 0.5
"#;
    let mut spec = MotorSpec::new(0.01, 0.5, law("coulomb", &[("coulomb", 0.1)]));
    let numbers = [("proportional", 5.0), ("integral", 2.0), ("supply", 7.4), ("resistance", 3.0)];
    spec.servo = Some(Servo::new(&pairs(&numbers)).unwrap());
    spec.effects = vec![EffectSpec::new("goal_rate_limit", &pairs(&[("slowness", 0.5)])).unwrap()];
    same(text, spec);
}

#[test]
fn a_linear_machine_has_a_weight_and_the_law_its_options() {
    let text = r#"
[motion]
kind = "linear"
[body]
inertia = 1.5
weight_n = 0.2
payload_kg = 0.01
[friction]
law = "hsieh_pan"
breakaway = 0.5
virgin_curve = "same"
[sensor]
count_m = 1e-6
"#;
    let options = [("virgin_curve".to_owned(), "same".to_owned())];
    let friction = LawSpec::new("hsieh_pan", &pairs(&[("breakaway", 0.5)]), &options).unwrap();
    let mut spec = MotorSpec::new(1.5 + 0.01, 1.0, friction);
    spec.weight = 0.2 + 0.01 * 9.80665;
    spec.count = 1e-6;
    same(text, spec);
}

#[test]
fn a_drive_that_is_off_does_nothing() {
    let motor = made("[body]\ninertia = 0.01\n[friction]\nlaw = \"dahl\"\n").unwrap();
    let (mut x, mut v) = (0.5, 0.5);
    // SAFETY: the handle is live until it is freed, all targets are locals.
    unsafe {
        assert_eq!(stiction_motor_set_enabled(motor, 0), Status::Ok);
        stiction_motor_step(motor, 0.3, 0.0, 1e-3, &raw mut x, &raw mut v);
        assert_eq!((x, v), (0.0, 0.0));
        stiction_motor_set_enabled(motor, 1);
        stiction_motor_step(motor, 0.3, 0.0, 1e-3, &raw mut x, &raw mut v);
        assert!(x > 0.0);
        stiction_motor_free(motor);
    }
}

#[test]
fn what_is_no_plant_is_a_sentence() {
    const BODY: &str = "[body]\ninertia = 0.01\n";
    const LAW: &str = "[friction]\nlaw = \"coulomb\"\n";
    for (text, words) in [
        ("law = [", "plant: line 1 is no TOML"),
        ("\n[body\n", "plant: line 2 is no TOML"),
        (LAW, "[body] inertia is missing"),
        (BODY, "[friction] law is missing"),
        (&format!("{BODY}[friction]\nlaw = \"colomb\""), "did you mean 'coulomb'"),
        (&format!("{BODY}{LAW}viscos = 0.1"), "did you mean 'viscous'"),
        (&format!("{BODY}{LAW}viscous = \"much\""), "[friction] viscous = \"much\" is no number"),
        (&format!("{BODY}{LAW}viscous = {{ min = 0 }}"), "[friction] viscous has no value"),
        (&format!("{BODY}{LAW}[drve]"), "did you mean 'drive'"),
        (&format!("{BODY}{LAW}[drive]\nkind = \"prescribed_motion\""), "has no motor"),
        (&format!("{BODY}{LAW}[drive]\nkind = \"servo\""), "[drive] proportional is missing"),
        (&format!("{BODY}{LAW}[drive]\ngain = 0"), "moves nothing"),
        (&format!("{BODY}weight_n = 1\n{LAW}"), "[body] weight_n is for linear plants"),
        (&format!("{BODY}{LAW}[[effects]]\nname = \"coging\""), "did you mean 'cogging'"),
        (&format!("{BODY}{LAW}[[effects]]\nname = \"goal_rate_limit\""), "only a servo"),
        (&format!("{BODY}{LAW}[sensor]\ncounts_per_rev = 0"), "is no number above 0"),
        (&format!("[body]\ninertia = -1\n{LAW}"), "inertia"),
    ] {
        let (status, told) = made(text).unwrap_err();
        assert_eq!(status, Status::Refused);
        assert!(told.contains(words), "{text}: {told}");
        assert_eq!(told.lines().count(), 1, "{told}");
    }
    let mut motor = null_mut();
    // SAFETY: the path ends in a zero byte, the target is a local; NULL is checked for.
    unsafe {
        let status = stiction_motor_load_plant(c"nowhere.toml".as_ptr(), &raw mut motor);
        assert_eq!(status, Status::Refused);
        assert!(said().starts_with("nowhere.toml: cannot be read"), "{}", said());
        let none = std::ptr::null();
        assert_eq!(stiction_motor_load_plant(none, &raw mut motor), Status::Null);
        assert_eq!(stiction_motor_from_plant(c"".as_ptr(), null_mut()), Status::Null);
    }
}
