//! Motors that go side by side do what each of them does alone, to the bit and at every width.
#![allow(missing_docs)]

use stiction_core::effects::EffectSpec;
use stiction_core::ensemble::{Changes, Ensemble, Inputs, Keep, Plan, Rows};
use stiction_core::friction::{LAWS, Statistics, law_record};
use stiction_core::lanes::Width;
use stiction_core::model::LawSpec;
use stiction_core::motor::{Column, Motor, MotorSpec, PerSample, Running, Surroundings};

const MEMBERS: usize = 21;
const SAMPLES: usize = 3000;

/// A motor with this law that breaks away, and with these values instead of the usual ones.
fn motor(law: &str, stated: &[(&str, f64)]) -> Motor {
    let record = law_record(law).unwrap();
    let own = |name: &str| record.parameters.iter().any(|p| p.name == name);
    let mut stated: Vec<(String, f64)> =
        stated.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    if own("breakaway") {
        stated.push(("breakaway".to_owned(), 0.4));
    }
    let law = LawSpec::new(record.name, &stated, &[]).unwrap();
    let spec = MotorSpec { weight: 0.02, ..MotorSpec::new(0.0076, 1.5, law) };
    Motor::new(spec).unwrap()
}

/// Ramps, rings, pulses, rests and noise, another size for each member.
fn inputs() -> Vec<f64> {
    let mut inputs = Vec::new();
    let mut noise = 12_345_u64;
    for member in 0..MEMBERS {
        let size = 0.1 + 0.03 * member as f64;
        for k in 0..SAMPLES {
            let t = k as f64 * 2e-4;
            noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let shaken = (noise >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
            let wave = size * (40.0 * t).sin() + if t % 0.2 < 0.02 { 0.25 } else { 0.0 };
            inputs.push(match k / 700 {
                0 => 0.0,
                1 => 0.15,
                2 => wave,
                3 => wave + 0.05 * shaken,
                _ => -size,
            });
        }
    }
    inputs
}

const KINDS: [Column; 4] = [Column::Position, Column::Velocity, Column::Friction, Column::Measured];

/// What is kept of an ensemble whose members differ in inertia.
fn together(
    motor: &Motor,
    masses: &[f64],
    inputs: &[f64],
    (dt, keep): (f64, Keep<'_>),
    (threads, width): (usize, Width),
) -> Vec<Vec<f64>> {
    let paths = ["body.inertia".to_owned()];
    let changes = Changes { paths: &paths, values: masses };
    let mut ensemble = Ensemble::new(motor, MEMBERS, changes).unwrap();
    let plan = Plan {
        samples: SAMPLES,
        inputs: Inputs::Each(inputs),
        loads: Rows::Same(0.01),
        dt: PerSample::Same(dt),
        keep,
        threads,
        width,
    };
    let mut kept = vec![vec![0.0; MEMBERS * keep.width(SAMPLES)]; KINDS.len()];
    let mut columns: Vec<_> =
        KINDS.into_iter().zip(kept.iter_mut().map(Vec::as_mut_slice)).collect();
    // Again from where they got to: what is kept is of the second run.
    ensemble.run(&plan, &mut columns).unwrap();
    ensemble.run(&plan, &mut columns).unwrap();
    kept
}

/// The columns of each member alone.
fn apart(motor: &Motor, masses: &[f64], inputs: &[f64], dt: f64) -> Vec<Vec<f64>> {
    let mut all = vec![Vec::new(); KINDS.len()];
    for (member, mass) in masses.iter().enumerate() {
        let spec = MotorSpec { inertia: *mass, ..motor.spec().clone() };
        let mut alone = Motor::new(spec).unwrap();
        let mut own = vec![vec![0.0; SAMPLES]; KINDS.len()];
        let mut columns: Vec<_> =
            KINDS.into_iter().zip(own.iter_mut().map(Vec::as_mut_slice)).collect();
        let around = Surroundings::from(PerSample::Same(0.01));
        let given = &inputs[member * SAMPLES..(member + 1) * SAMPLES];
        alone.simulate(given, around, PerSample::Same(dt), &mut columns).unwrap();
        alone.simulate(given, around, PerSample::Same(dt), &mut columns).unwrap();
        for (all, own) in all.iter_mut().zip(own) {
            all.extend(own);
        }
    }
    all
}

fn masses() -> Vec<f64> {
    (0..MEMBERS).map(|k| 0.006 + 0.000_2 * k as f64).collect()
}

fn agrees(motor: &Motor, dt: f64) {
    let (masses, inputs) = (masses(), inputs());
    let alone = apart(motor, &masses, &inputs, dt);
    for width in [Width::Baseline, Width::Four, Width::Eight] {
        for threads in [1, 2] {
            let how = (dt, Keep::Every(1));
            let whole = together(motor, &masses, &inputs, how, (threads, width));
            assert_eq!(whole, alone, "{width:?} {threads}");
        }
    }
}

#[test]
fn every_law_does_the_same_side_by_side_as_alone() {
    for record in LAWS {
        agrees(&motor(record.name, &[]), 2e-4);
    }
}

#[test]
fn inputs_that_are_late_or_mapped_are_the_same_side_by_side() {
    let effect = |name: &str, values: &[(&str, f64)]| {
        let values: Vec<_> = values.iter().map(|(name, x)| ((*name).to_owned(), *x)).collect();
        EffectSpec::new(name, &values).unwrap()
    };
    let of_drive = [
        vec![effect("drive_deadband", &[("deadband", 0.02)])],
        vec![effect("input_delay", &[("delay", 7.3e-4)])],
        vec![
            effect("torque_constant_saturation", &[("loss", 0.2), ("input", 0.6)]),
            effect("current_loop_lag", &[("time", 2e-3)]),
            effect("torque_bias", &[("bias", 0.01)]),
        ],
        vec![
            effect("goal_rate_limit", &[("slowness", 0.02)]),
            effect("drive_saturation", &[("share", 1.0), ("limit", 0.35)]),
        ],
    ];
    for law in ["coulomb", "dahl", "hsieh_pan", "lugre", "maxwell_slip"] {
        for effects in &of_drive {
            let spec = MotorSpec { effects: effects.clone(), ..motor(law, &[]).spec().clone() };
            agrees(&Motor::new(spec).unwrap(), 2e-4);
        }
    }
}

#[test]
fn options_and_divided_samples_change_no_bit() {
    agrees(&motor("hsieh_pan", &[("viscous", 0.05)]), 5e-4);
    agrees(&motor("hsieh_pan", &[("hardening_coefficient", 0.0), ("coulomb", 0.4)]), 2e-4);
    agrees(&motor("hsieh_pan", &[("creep_rate", 300.0), ("slip_distance", 1e-7)]), 2e-4);
    agrees(&motor("hsieh_pan", &[("hardening_exponent", 1.7)]), 2e-4);
    agrees(&motor("hsieh_pan", &[("stribeck_exponent", 1.0)]), 2e-4);
    // No creep, creep too fast for its short way, slides beyond all fall of the level.
    agrees(&motor("hsieh_pan", &[("creep_rate", 0.0)]), 2e-4);
    agrees(&motor("hsieh_pan", &[("creep_rate", 40.0), ("hardening_coefficient", 3e-2)]), 2e-4);
    agrees(&motor("hsieh_pan", &[("stribeck_velocity", 1e-3), ("coulomb", 0.3)]), 1e-4);
}

#[test]
fn hooks_of_many_kinds_do_the_same_side_by_side_as_alone() {
    let mut seed = 88_172_645_463_325_252_u64;
    let mut share = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    for round in 0..24 {
        let stiffness = 3000.0 * 10_f64.powf(share() - 0.5);
        let any = [
            ("final_stiffness", stiffness * (0.05 + 0.8 * share())),
            ("viscous", 0.1 * share()),
            ("slip_distance", 10_f64.powf(-7.0 + 4.0 * share())),
            ("stribeck_velocity", 10_f64.powf(-3.0 + 3.0 * share())),
            ("creep_rate", 10_f64.powf(3.0 * share())),
            ("hardening_coefficient", 1.6e-3 * 10_f64.powf(2.0 * share() - 1.0)),
            ("damping", share()),
        ];
        let mut stated: Vec<_> = any.into_iter().filter(|_| share() < 0.5).collect();
        stated.push(("initial_stiffness", stiffness));
        stated.push(("decay_distance", 2.9e-4 * 10_f64.powf(share() - 0.5)));
        stated.push(("coulomb", 0.05 + 0.34 * share()));
        println!("round {round}: {stated:?}");
        agrees(&motor("hsieh_pan", &stated), if share() < 0.5 { 1e-4 } else { 3e-4 });
    }
}

#[test]
fn what_is_kept_is_made_of_the_same_samples() {
    let motor = motor("hsieh_pan", &[("viscous", 0.02)]);
    let (masses, inputs, dt) = (masses(), inputs(), 2e-4);
    let alone = apart(&motor, &masses, &inputs, dt);
    let rows = |column: usize| alone[column].chunks(SAMPLES);
    for every in [7, 32, 100] {
        let how = (dt, Keep::Every(every));
        let kept = together(&motor, &masses, &inputs, how, (1, Width::widest()));
        for (column, kept) in kept.iter().enumerate() {
            let thinned: Vec<f64> = rows(column)
                .flat_map(|row| row.iter().skip(every - 1).step_by(every).copied())
                .collect();
            assert_eq!(*kept, thinned);
        }
    }
    let last = together(&motor, &masses, &inputs, (dt, Keep::Last), (1, Width::widest()));
    let ends = together(&motor, &masses, &inputs, (dt, Keep::Extremes), (1, Width::widest()));
    let target = Rows::Same(1e-4);
    let rms = together(&motor, &masses, &inputs, (dt, Keep::Rms(target)), (1, Width::widest()));
    for column in 0..KINDS.len() {
        for (member, row) in rows(column).enumerate() {
            assert_eq!(last[column][member], row[SAMPLES - 1]);
            let least = row.iter().copied().fold(f64::INFINITY, f64::min);
            let most = row.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(ends[column][2 * member..2 * member + 2], [least, most]);
            let sum = row.iter().fold(0.0, |sum, x| sum + (x - 1e-4) * (x - 1e-4));
            assert_eq!(rms[column][member], (sum / SAMPLES as f64).sqrt());
        }
    }
}

#[test]
fn lighter_laws_do_the_same_side_by_side_with_other_values() {
    agrees(&motor("dahl", &[("viscous", 0.05), ("coulomb", 0.2)]), 5e-4);
    agrees(&motor("dahl", &[("exponent", 1.0)]), 2e-4);
    agrees(&motor("coulomb", &[("coulomb", 0.4), ("viscous", 0.05)]), 5e-4);
    agrees(&motor("coulomb", &[("coulomb", 0.1), ("stribeck_velocity", 0.02)]), 2e-4);
    agrees(&motor("coulomb", &[("stribeck_exponent", 1.0)]), 2e-4);
    agrees(&motor("lugre", &[("coulomb", 0.4), ("viscous", 0.05)]), 5e-4);
    agrees(&motor("lugre", &[("damping", 0.0), ("stribeck_velocity", 0.02)]), 2e-4);
    agrees(&motor("lugre", &[("damping_velocity", 0.1)]), 2e-4);
}

#[test]
fn states_and_counters_end_the_same_side_by_side() {
    for law in ["coulomb", "dahl", "hsieh_pan", "lugre"] {
        let motor = motor(law, &[]);
        let (masses, inputs) = (masses(), inputs());
        let paths = ["body.inertia".to_owned()];
        let changes = Changes { paths: &paths, values: &masses };
        let ends = |wide: bool| {
            // Columns of the law's own states, of every sample, are a matter of each motor alone.
            let names = law_record(law).unwrap().outputs;
            let mut ensemble = Ensemble::new(&motor, MEMBERS, changes).unwrap();
            let plan = Plan {
                samples: SAMPLES,
                inputs: Inputs::Each(&inputs),
                loads: Rows::Same(0.01),
                dt: PerSample::Same(2e-4),
                keep: if wide { Keep::Last } else { Keep::Every(SAMPLES) },
                threads: 1,
                width: Width::widest(),
            };
            let mut kept = vec![vec![0.0; MEMBERS]; names.len()];
            let mut columns: Vec<_> = kept
                .iter_mut()
                .enumerate()
                .map(|(k, values)| (Column::Law(k), values.as_mut_slice()))
                .collect();
            ensemble.run(&plan, &mut columns).unwrap();
            // How often memory made room depends on how many steps were asked for at a time.
            let alike = |counted| Statistics { memory_growths: 0, ..counted };
            (kept, ensemble.statistics().map(alike).collect::<Vec<_>>())
        };
        assert_eq!(ends(true), ends(false), "{law}");
    }
}

#[test]
fn motors_without_effects_go_side_by_side() {
    for law in ["coulomb", "dahl", "hsieh_pan", "lugre"] {
        assert!(motor(law, &[]).running().law.goes_abreast(), "{law}");
    }
    assert!(!motor("hsieh_pan", &[("hardening_exponent", 1.7)]).running().law.goes_abreast());
}

#[test]
fn bodies_end_the_same_side_by_side() {
    let (masses, inputs) = (masses(), inputs());
    for law in ["coulomb", "hsieh_pan"] {
        let motor = motor(law, &[]);
        let paths = ["body.inertia".to_owned()];
        let changes = Changes { paths: &paths, values: &masses };
        let mut ensemble = Ensemble::new(&motor, MEMBERS, changes).unwrap();
        let plan = Plan {
            samples: SAMPLES,
            inputs: Inputs::Each(&inputs),
            loads: Rows::Same(0.01),
            dt: PerSample::Same(3e-4),
            keep: Keep::Last,
            threads: 1,
            width: Width::widest(),
        };
        for _ in 0..2 {
            ensemble.run(&plan, &mut []).unwrap();
        }
        for (member, mass) in masses.iter().enumerate() {
            let spec = MotorSpec { inertia: *mass, ..motor.spec().clone() };
            let mut alone = Motor::new(spec).unwrap();
            let given = &inputs[member * SAMPLES..(member + 1) * SAMPLES];
            for _ in 0..2 {
                let around = Surroundings::from(PerSample::Same(0.01));
                alone.simulate(given, around, PerSample::Same(3e-4), &mut []).unwrap();
            }
            let numbers = |motor: &Running<f64>| {
                let run = &motor.run;
                [run.position, run.velocity, run.friction, run.path, run.time].map(f64::to_bits)
            };
            let ended = ensemble.running(member).unwrap();
            assert_eq!(numbers(ended), numbers(alone.running()), "{law} {member}");
        }
    }
}

#[test]
fn a_number_that_is_not_finite_leaves_all_where_they_are() {
    let inputs = inputs();
    let targets = vec![0.0; MEMBERS * SAMPLES];
    for law in ["hsieh_pan", "maxwell_slip"] {
        let motor = motor(law, &[]);
        let none = Changes { paths: &[], values: &[] };
        let mut ensemble = Ensemble::new(&motor, MEMBERS, none).unwrap();
        let mut out = vec![0.0; MEMBERS];
        for (samples, threads) in [(SAMPLES, 1), (SAMPLES, 2), (300, 1)] {
            let n = MEMBERS * samples;
            // Of two the first; at the very end; among what a tile leaves over.
            for (table, places) in [
                ("current", vec![n - 1]),
                ("load", vec![5 * samples + 17, 40]),
                ("target", vec![n / 2]),
            ] {
                let bad = |name: &str, of: &[f64]| {
                    let mut of = of[..n].to_vec();
                    for (k, place) in places.iter().enumerate().filter(|_| name == table) {
                        of[*place] = [f64::NAN, f64::INFINITY][k % 2];
                    }
                    of
                };
                let (current, load) = (bad("current", &inputs), bad("load", &targets));
                let target = bad("target", &targets);
                let plan = Plan {
                    samples,
                    inputs: Inputs::Each(&current),
                    loads: Rows::Each(&load),
                    dt: PerSample::Same(2e-4),
                    keep: Keep::Rms(Rows::Each(&target)),
                    threads,
                    width: Width::widest(),
                };
                let refused = ensemble.run(&plan, &mut [(Column::Position, &mut out)]);
                let place = places.iter().min().unwrap();
                let given = if places.len() == 1 { "NaN" } else { "inf" };
                let said = format!(
                    "{table}[{place}] = {given} is not a finite number; repair or drop the sample"
                );
                assert_eq!(refused.unwrap_err().to_string(), said, "{law} {samples} {threads}");
                for member in 0..MEMBERS {
                    let run = &ensemble.running(member).unwrap().run;
                    assert_eq!((run.time, run.path), (0.0, 0.0), "{law} {samples} {threads}");
                }
            }
        }
    }
}
