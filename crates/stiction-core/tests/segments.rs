//! Long runs: inputs that are held, steps as long as an error allows, rests in one evaluation.
#![allow(missing_docs)]

mod common;

use common::{law, motor};
use stiction_core::integrate::{Account, Integrator};
use stiction_core::model::LawSpec;
use stiction_core::motor::{Column, EffectSpec, Motor, MotorSpec, PerSample, Surroundings};
use stiction_core::segments::{Segments, TENTH_OF_AN_ARC_SECOND};

const INERTIA: f64 = 0.0076;
const TOLERANCE: f64 = TENTH_OF_AN_ARC_SECOND;
/// Steps of the reference: it is then good to a thousandth of the tolerance.
const FINE: f64 = 2e-5;
/// Evaluations that a rest may cost, of whatever length.
const REST: u64 = 500;

fn segments<'a>(durations: &'a [f64], inputs: &'a [f64], times: &'a [f64]) -> Segments<'a> {
    let around = Surroundings::NONE;
    Segments { durations, inputs, around, tolerance: TOLERANCE, times }
}

fn positions(motor: &mut Motor, segments: &Segments<'_>) -> (Vec<f64>, Account) {
    let mut positions = vec![0.0; segments.rows().len()];
    let (account, sound) =
        motor.simulate_segments(segments, &mut [(Column::Position, &mut positions)]).unwrap();
    assert!(sound);
    (positions, account)
}

/// Greatest distance of rows from those of the reference integrator in fixed steps.
fn worst(spec: &MotorSpec, segments: &Segments<'_>) -> f64 {
    let (rows, _) = positions(&mut Motor::new(spec.clone()).unwrap(), segments);
    let reference = MotorSpec { integrator: Integrator::Reference, ..spec.clone() };
    let mut inputs = Vec::new();
    for (duration, input) in segments.durations.iter().zip(segments.inputs) {
        inputs.extend(vec![*input; (duration / FINE).round() as usize]);
    }
    let mut fine = vec![0.0; inputs.len()];
    let mut columns = [(Column::Position, &mut fine[..])];
    let mut reference = Motor::new(reference).unwrap();
    reference.simulate(&inputs, Surroundings::NONE, PerSample::Same(FINE), &mut columns).unwrap();
    let at = |time: f64| fine[(time / FINE).round() as usize - 1];
    let off = segments.rows().into_iter().zip(rows).map(|(time, row)| (row - at(time)).abs());
    off.fold(0.0, f64::max)
}

/// Pulses of both ways with their rings, and two holds.
fn pulses_and_holds() -> (Vec<f64>, Vec<f64>) {
    let (mut durations, mut inputs) = (Vec::new(), Vec::new());
    for pulse in [0.15, 0.2, 0.3, -0.15, 0.25] {
        durations.extend([0.02, 0.28]);
        inputs.extend([pulse, 0.0]);
    }
    durations.extend([0.5, 0.5]);
    inputs.extend([0.13, 0.02]);
    (durations, inputs)
}

fn pulses(number: usize, rest: f64) -> (Vec<f64>, Vec<f64>) {
    let sizes = [0.15, 0.2, -0.15, -0.2];
    let durations = (0..2 * number).map(|k| if k % 2 == 0 { 0.02 } else { rest }).collect();
    let inputs = (0..2 * number).map(|k| if k % 2 == 0 { sizes[k / 2 % 4] } else { 0.0 });
    (durations, inputs.collect())
}

fn rig() -> LawSpec {
    law("hsieh_pan", &[], &[])
}

#[test]
fn rows_are_those_of_the_reference_within_the_tolerance() {
    let breaking = [("breakaway", 0.25), ("viscous", 0.05)];
    let rated = [("breakaway", 0.4), ("viscous", 0.05), ("loading_rate", 5.0)];
    let dry = [("coulomb", 0.1), ("breakaway", 0.15), ("viscous", 0.01)];
    let (durations, inputs) = pulses_and_holds();
    let often: Vec<f64> = (1..250).map(|k| f64::from(k) * 0.01).collect();
    for (spec, allowed) in [
        (rig(), 1.0),
        (law("hsieh_pan", &[], &[("damper", "spring")]), 1.0),
        (law("hsieh_pan", &rated, &[("virgin_curve", "same")]), 1.0),
        // Slides of 6 mrad: the fast integrator at 0.1 ms is 5 tolerances off.
        (law("hsieh_pan", &breaking, &[]), 2.0),
        (law("coulomb", &dry, &[]), 1.0),
        (law("maxwell_slip", &[("viscous", 0.3)], &[]), 1.0),
        // It rings on friction's own hysteresis alone, for seconds.
        (law("maxwell_slip", &[], &[]), 2.0),
        (law("elastic_perfectly_plastic", &[("viscous", 0.3)], &[]), 1.0),
        (law("rate_and_state", &[], &[]), 1.0),
        // Slides, and its error is estimated by a method of second order.
        (law("rate_and_state", &[("coulomb", 0.22)], &[]), 2.0),
        (law("lugre", &[], &[]), 1.0),
        // Its loops drift: a turn that is missed by little counts with every swing.
        (law("dahl", &[("viscous", 0.3)], &[]), 2.0),
    ] {
        for times in [&[][..], &often[..]] {
            let spec = MotorSpec::new(INERTIA, 1.0, spec.clone());
            let off = worst(&spec, &segments(&durations, &inputs, times));
            assert!(off <= allowed * TOLERANCE, "{:?}: {}", spec.friction, off / TOLERANCE);
        }
    }
}

/// Tolerances that laws may be off which ring on hysteresis alone, and whose loops drift (dahl: 3.4).
const UNDAMPED: f64 = 5.0;

#[test]
fn every_law_keeps_near_the_reference() {
    let (durations, inputs) = pulses_and_holds();
    for record in common::all_laws() {
        let spec = MotorSpec::new(INERTIA, 1.0, law(record.name, &[], &[]));
        let off = worst(&spec, &segments(&durations, &inputs, &[]));
        assert!(off <= UNDAMPED * TOLERANCE, "{}: {}", record.name, off / TOLERANCE);
    }
}

#[test]
fn a_pendulum_that_creeps_is_followed_too() {
    let (durations, inputs) = pulses_and_holds();
    let spec = MotorSpec {
        gravity_amplitude: 20.0,
        gravity_zero: 3e-3,
        ..MotorSpec::new(INERTIA, 1.0, rig())
    };
    let off = worst(&spec, &segments(&durations, &inputs, &[]));
    assert!(off <= TOLERANCE, "{}", off / TOLERANCE);
}

#[test]
fn a_rest_of_any_length_costs_the_same() {
    for spec in [
        rig(),
        law("hsieh_pan", &[("breakaway", 0.5)], &[]),
        law("maxwell_slip", &[("viscous", 0.3)], &[]),
        law("coulomb", &[], &[]),
        law("lugre", &[], &[]),
    ] {
        let cost = |rest: f64| {
            let mut body = motor(INERTIA, spec.clone());
            positions(&mut body, &segments(&[0.02], &[0.2], &[]));
            positions(&mut body, &segments(&[rest], &[0.0], &[])).1.evaluations
        };
        let short = cost(5.0);
        assert!(short <= REST, "{:?}: {short}", spec);
        for rest in [86.0, 1e4, 1e9] {
            assert_eq!(cost(rest), short, "{:?}", spec);
        }
    }
}

#[test]
fn a_pulse_and_its_rest_cost_no_more_than_a_rest_may() {
    let (durations, inputs) = pulses(20, 85.98);
    for spec in [
        law("hsieh_pan", &[("breakaway", 0.5)], &[]),
        law("maxwell_slip", &[("viscous", 0.3)], &[]),
    ] {
        let run = segments(&durations, &inputs, &[]);
        let cost = positions(&mut motor(INERTIA, spec.clone()), &run).1.evaluations;
        assert!(cost <= 20 * REST, "{:?}: {cost}", spec);
    }
}

/// A sequence that looks like chance, from 0 to 1.
fn chance(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[test]
fn rings_behind_slides_are_those_of_a_fine_tolerance() {
    // A long slide is as straight as a ring that has nearly died out, and must not pass for one.
    let slides = law("maxwell_slip", &[("viscous", 0.3)], &[]);
    for seed in 0..40 {
        let mut next = chance(seed);
        let (mut durations, mut inputs) = (Vec::new(), Vec::new());
        for _ in 0..12 {
            durations.extend([0.005 + 0.03 * next(), 0.02 + 0.4 * next()]);
            inputs.extend([0.9 * next() - 0.45, 0.0]);
        }
        let run = segments(&durations, &inputs, &[]);
        let fine = Segments { tolerance: 1e-4 * TOLERANCE, ..run };
        let [rows, exact] =
            [&run, &fine].map(|run| positions(&mut motor(INERTIA, slides.clone()), run).0);
        let off = rows.iter().zip(&exact).map(|(row, exact)| (row - exact).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off <= 2.0 * TOLERANCE, "{seed}: {}", off / TOLERANCE);
    }
}

#[test]
fn cost_grows_with_pulses_and_not_with_the_time_between() {
    let cost = |number: usize, rest: f64| {
        let (durations, inputs) = pulses(number, rest);
        let run = segments(&durations, &inputs, &[]);
        positions(&mut motor(INERTIA, rig()), &run).1.evaluations as f64
    };
    let few = cost(100, 86.0);
    assert!(cost(1000, 86.0) <= 10.5 * few);
    assert!(cost(100, 8600.0) <= 1.01 * few);
    // A fixed step that needs no division would take 8e8.
    assert!(few <= 100.0 * 700.0);
}

#[test]
fn creep_of_a_rest_is_its_exponential() {
    // h → f(σ) = c·σ² at the rate α, and the body creeps as it hardens.
    let effort = 0.13;
    let inputs = [0.0, effort];
    let limit = 1.6e-3 * effort * effort;
    let times = [2.0, 2.5, 3.5, 10.0];
    let run = segments(&[0.1, 60.0], &inputs, &times);
    let (rows, _) = positions(&mut motor(INERTIA, rig()), &run);
    // Rows: end of the first segment, those asked for, the end.
    let (end, left) = (rows[5], |k: usize| rows[5] - rows[k]);
    assert!(left(1) > 3e-7 && left(1) < limit);
    for (k, time) in times.iter().enumerate() {
        let exact = left(1) * (-2.0 * (time - times[0])).exp();
        // The damper takes C_s·v off the spring, and a hundredth of the silence may be missing.
        assert!((left(k + 1) - exact).abs() < 0.01 * TOLERANCE, "{time}: {}", left(k + 1) - exact);
    }
    let sprung = end - limit;
    let spring = law("hsieh_pan", &[("hardening_coefficient", 0.0)], &[]);
    let run = segments(&[60.0], &inputs[1..], &[]);
    let (without, _) = positions(&mut motor(INERTIA, spring), &run);
    // The overshoot has hardened a little more than the held effort would.
    assert!((without[0] - sprung).abs() < limit);
}

#[test]
fn what_sticks_does_not_move_at_all() {
    let mut body = motor(INERTIA, law("coulomb", &[("coulomb", 0.3)], &[]));
    let (rows, _) = positions(&mut body, &segments(&[0.05, 1.0, 1e6], &[0.5, 0.0, 0.29], &[]));
    assert!(rows[0] > 0.0 && rows[1] > rows[0]);
    assert_eq!(rows[2], rows[1]);
    assert_eq!(body.running().run.velocity, 0.0);
}

#[test]
fn a_level_that_falls_lets_go_when_it_reaches_the_effort() {
    // Friction 0.5·(1 − 0.4·(1 − e^(−t/100))) falls to 0.4 at t = 100·ln 2.
    let stated = |name: &str, value: f64| (name.to_owned(), value);
    let warm =
        EffectSpec::new("warm_up", &[stated("coulomb", 0.4), stated("time", 100.0)]).unwrap();
    let spec = MotorSpec {
        effects: vec![warm],
        ..MotorSpec::new(INERTIA, 1.0, law("coulomb", &[("coulomb", 0.5)], &[]))
    };
    let free = 100.0 * 2.0_f64.ln();
    let times = [free - 1e-6, free + 0.1];
    let mut body = Motor::new(spec).unwrap();
    let (rows, account) = positions(&mut body, &segments(&[200.0], &[0.4], &times));
    assert_eq!(rows[0], 0.0);
    assert!(rows[1] > 0.0 && rows[1] < 1e-5 / INERTIA, "{}", rows[1]);
    assert_eq!(account.rests, 2);
}

#[test]
fn a_machine_that_has_to_be_sampled_is_sampled() {
    let delay = EffectSpec::new("input_delay", &[("delay".to_owned(), 0.005)]).unwrap();
    let spec = MotorSpec { effects: vec![delay], ..MotorSpec::new(INERTIA, 1.0, rig()) };
    let (rows, account) = positions(
        &mut Motor::new(spec.clone()).unwrap(),
        &segments(&[0.004, 0.1], &[0.2, 0.0], &[]),
    );
    assert_eq!(rows[0], 0.0);
    assert!(rows[1] > 0.0 && account.rests == 0);
    let inputs: Vec<f64> = (0..104).map(|k| if k < 4 { 0.2 } else { 0.0 }).collect();
    let sampled = common::positions(&mut Motor::new(spec).unwrap(), &inputs, 1e-3);
    assert!((rows[1] - sampled[103]).abs() < 1e-12);
}

#[test]
fn what_cannot_be_run_is_refused() {
    let mut body = motor(INERTIA, rig());
    let wrong = [
        segments(&[1.0], &[0.0, 1.0], &[]),
        segments(&[0.0], &[0.0], &[]),
        segments(&[f64::NAN], &[0.0], &[]),
        segments(&[1.0], &[0.0], &[2.0]),
        segments(&[1.0], &[0.0], &[0.5, 0.5]),
        Segments { tolerance: 0.0, ..segments(&[1.0], &[0.0], &[]) },
    ];
    for run in wrong {
        assert!(body.simulate_segments(&run, &mut []).is_err());
    }
    assert_eq!(body.running().run.time, 0.0);
}
