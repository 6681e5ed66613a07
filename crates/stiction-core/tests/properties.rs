//! Properties over random parameters and inputs.
#![allow(missing_docs)]

mod common;

use common::{Stream, all_laws, drawn, law, model, motor, positions, run};
use proptest::prelude::*;
use stiction_core::friction::{AnyState, Channels, Entry};
use stiction_core::model::FrictionModel;
use stiction_core::motor::{Column, Motor, MotorSpec, PerSample, Running, Surroundings};
use stiction_core::scalar::{Dual, Scalar};

/// Equal loops must come back to this share of the range of the force.
const RECOVERED: f64 = 1e-12;

fn entry(model: &FrictionModel, name: &str) -> f64 {
    match model.entries().into_iter().find(|(n, _)| *n == name) {
        Some((_, Entry::Number(x))) => x,
        other => panic!("{name} is {other:?}"),
    }
}

/// ∫₀ˣ of the virgin curve: what the spring can give back at most from elongation x.
fn energy(k_0: f64, k_inf: f64, d_0: f64, x: f64) -> f64 {
    let d = 2.0 * x.abs();
    0.25 * (0.5 * k_inf * d * d + (k_0 - k_inf) * d_0 * (d - d_0 * (1.0 - (-d / d_0).exp())))
}

#[test]
fn a_million_random_steps_never_give_back_more_than_was_stored() {
    for seed in 0..4 {
        let mut stream = Stream::new(seed);
        let (k_0, d_0) = (stream.log(1e3, 1e4), stream.log(1e-4, 1e-3));
        let k_inf = k_0 * stream.between(0.1, 0.6);
        let (breakaway, damping) = (stream.log(0.2, 1.0), stream.between(0.0, 0.5));
        let viscous = stream.between(0.0, 0.1);
        let mut model = model(
            "hsieh_pan",
            &[
                ("initial_stiffness", k_0),
                ("final_stiffness", k_inf),
                ("decay_distance", d_0),
                ("breakaway", breakaway),
                ("damping", damping),
                ("viscous", viscous),
            ],
        );
        let dt = 1e-4;
        // The work is counted from rest: nothing is stored there.
        let (mut work, mut least, mut before) = (0.0_f64, 0.0_f64, 0.0);
        let mut velocity = 0.0;
        for _ in 0..1_000_000 {
            velocity = 0.98 * velocity + 0.03 * (stream.next() - 0.5);
            let force = model.step(velocity, dt, &Channels::default()).unwrap();
            let series = entry(&model, "series_force");
            // Spring by trapezoid, what depends on velocity at the end of the step.
            let spring = 0.5 * (before + series) * velocity * dt;
            work += spring + (force - series) * velocity * dt;
            before = series;
            least = least.min(work);
        }
        assert!(work > 0.0);
        // A step crosses reversals, break-away and stops inside: the trapezoid is off by up to
        // one step's work there.
        let slack = 2.0 * breakaway * 0.15 * dt;
        assert!(least > -slack, "seed {seed}: {least} below {slack}");
        assert!(energy(k_0, k_inf, d_0, 1e-4) > 0.0);
    }
}

#[test]
fn coulomb_friction_never_gives_anything_back() {
    let mut stream = Stream::new(9);
    let mut model = model("coulomb", &[("coulomb", 0.3), ("breakaway", 0.5), ("viscous", 0.05)]);
    for _ in 0..1_000_000 {
        let velocity = stream.between(-1.0, 1.0);
        assert!(model.step(velocity, 1e-4, &Channels::default()).unwrap() * velocity >= 0.0);
    }
}

#[test]
fn memory_stays_bounded_under_equal_cycles() {
    let mut model = model("hsieh_pan", &[("hardening_coefficient", 0.0)]);
    let mut velocity = vec![0.01; 3];
    for _ in 0..100_000 {
        velocity.extend([-0.01, -0.01, 0.01, 0.01]);
    }
    run(&mut model, &velocity, 1e-3);
    let statistics = model.statistics();
    assert!(statistics.memory_peak <= 4, "{statistics:?}");
    assert_eq!(statistics.memory_growths, 0);
    assert!(statistics.closings >= 99_999);
}

#[test]
fn a_deep_nest_is_kept_whole_and_grows_between_chunks() {
    let mut model = model("hsieh_pan", &[("hardening_coefficient", 0.0), ("damping", 0.0)]);
    let steps = 3000;
    let velocity: Vec<f64> = (0..steps)
        .map(|k| {
            let size = 1.0 - f64::from(k) / f64::from(steps + 1);
            if k % 2 == 0 { size } else { -size }
        })
        .collect();
    let inward = run(&mut model, &velocity, 1e-4);
    assert_eq!(model.statistics().memory_peak, u64::try_from(steps).unwrap() - 1);
    assert!(model.statistics().memory_growths > 0);
    // Back out along the same path every reverse point is met again.
    let outward: Vec<f64> = velocity.iter().rev().map(|v| -v).collect();
    let back = run(&mut model, &outward[..steps as usize - 1], 1e-4);
    let last = *back.last().unwrap();
    assert!((last - inward[0]).abs() < 1e-9, "{last} against {}", inward[0]);
}

#[test]
fn a_stuck_shaft_does_not_creep() {
    let samples = 3_600_000;
    // Half of break-away with a ripple, for an hour at 1 kHz.
    let inputs: Vec<f64> =
        (0..samples).map(|k| 0.25 + 0.15 * (f64::from(k) * 0.031).sin()).collect();
    let mut rigid = motor(0.0076, law("coulomb", &[("coulomb", 0.35), ("breakaway", 0.5)], &[]));
    let position = positions(&mut rigid, &inputs, 1e-3);
    assert!(position.iter().all(|x| x.to_bits() == 0), "coulomb moved");

    let steady = vec![0.25; samples as usize];
    let mut elastic =
        motor(0.0076, law("hsieh_pan", &[("hardening_coefficient", 0.0), ("breakaway", 0.5)], &[]));
    positions(&mut elastic, &steady[..20_000], 1e-3);
    let position = positions(&mut elastic, &steady, 1e-3);
    let rest = position[position.len() - 1];
    let off = position.iter().fold(0.0_f64, |worst, x| worst.max((x - rest).abs()));
    assert!(off < 1e-12, "moved by {off}");
    let third = position.len() / 3;
    let mean = |part: &[f64]| part.iter().map(|x| x - rest).sum::<f64>() / part.len() as f64;
    let trend = mean(&position[2 * third..]) - mean(&position[..third]);
    assert!(trend.abs() < 1e-13, "trend {trend}");
}

#[test]
fn steps_do_not_depend_on_how_they_are_chunked() {
    for record in all_laws() {
        let mut stream = Stream::of(record, 21);
        let spec = drawn(record, &mut stream);
        let velocity: Vec<f64> = (0..2000).map(|_| stream.between(-0.3, 0.3)).collect();
        let whole = run(&mut FrictionModel::new(spec.clone()), &velocity, 1e-4);
        let mut model = FrictionModel::new(spec.clone());
        let mut parts = Vec::new();
        let mut at = 0;
        while at < velocity.len() {
            let end = (at + 1 + (stream.next() * 300.0) as usize).min(velocity.len());
            parts.extend(run(&mut model, &velocity[at..end], 1e-4));
            at = end;
        }
        assert_eq!(whole, parts);
        let mut model = FrictionModel::new(spec);
        let single: Vec<f64> = velocity
            .iter()
            .map(|v| {
                let (force, _) = model.clone().trial(*v, 1e-4, &Channels::default()).unwrap();
                assert!(force.is_finite());
                let proposed = model.trial(*v, 1e-4, &Channels::default()).unwrap().0;
                assert_eq!(force, proposed);
                assert!(model.commit());
                proposed
            })
            .collect();
        assert_eq!(whole, single);
    }
}

/// Samples of a slow pull through break-away, at the end of which the body slides.
fn pull(samples: usize, dt: f64) -> Vec<f64> {
    (0..samples).map(|k| 2.0 * (k as f64 + 1.0) * dt).collect()
}

/// ∂(final position)/∂(break-away) averaged over a step's worth of break-away times, and the chord
/// between the ends of that range.
fn across_breakaway(dt: f64) -> (f64, f64) {
    let duration = 0.32;
    let samples = (duration / dt) as usize;
    let inputs = pull(samples, dt);
    let spec = |breakaway: f64| {
        MotorSpec::new(
            0.0076,
            1.0,
            law(
                "hsieh_pan",
                &[
                    ("final_stiffness", 800.0),
                    ("breakaway", breakaway),
                    ("coulomb", 0.35),
                    ("viscous", 0.05),
                ],
                &[],
            ),
        )
    };
    let end = |breakaway: f64| {
        let mut motor = Motor::new(spec(breakaway)).unwrap();
        let x = positions(&mut motor, &inputs, dt);
        assert!(motor.statistics().breakaways >= 1);
        x[samples - 1]
    };
    let (low, high) = (0.5 * 0.999, 0.5 * 1.001);
    let chord = (end(high) - end(low)) / (high - low);
    let points = 40;
    let mean = (0..points)
        .map(|k| {
            let breakaway = low + (high - low) * (f64::from(k) + 0.5) / f64::from(points);
            let spec = spec(breakaway);
            let fresh = Motor::new(spec.clone()).unwrap();
            let path = ["friction.breakaway".to_owned()];
            stiction_core::sensitivity::sensitivity(
                &spec,
                fresh.running(),
                &inputs,
                Surroundings::NONE,
                PerSample::Same(dt),
                &path,
            )
            .unwrap()
            .position[samples - 1]
        })
        .sum::<f64>()
        / f64::from(points);
    (mean, chord)
}

#[test]
fn the_gradient_across_breakaway_equals_the_chord() {
    for dt in [1e-4, 2e-5] {
        let (gradient, chord) = across_breakaway(dt);
        let error = (gradient / chord - 1.0).abs();
        assert!(error < 0.01, "dt {dt}: {gradient} against {chord}, off by {error}");
    }
}

/// The farthest that two runs are from each other.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).fold(0.0_f64, |w, (a, b)| w.max((a - b).abs()))
}

#[test]
fn integrators_agree_on_a_slide() {
    let inputs: Vec<f64> = (0..4000).map(|k| 0.8 * (f64::from(k) * 2e-3).sin()).collect();
    for record in all_laws() {
        let hooked = record.parameters.iter().any(|p| p.name == "breakaway");
        let level = if hooked { ("breakaway", 0.5) } else { ("coulomb", 0.5) };
        let mut parameters = vec![level];
        if record.sensitive {
            // Where a law says that little becomes much it has to be so, and viscous friction is
            // what makes two runs comparable.
            let end = |inertia| {
                let mut motor = motor(inertia, law(record.name, &[level], &[]));
                positions(&mut motor, &inputs, 1e-4)
            };
            let apart = apart(&end(0.0076), &end(0.0076 * (1.0 + 1e-9)));
            assert!(apart > 1e-6, "{} makes {apart} of one part in 10⁹", record.name);
            parameters.push(("viscous", 0.5));
        }
        let spec = MotorSpec::new(0.0076, 1.0, law(record.name, &parameters, &[]));
        let reference = MotorSpec {
            integrator: stiction_core::integrate::Integrator::Reference,
            ..spec.clone()
        };
        let fast = positions(&mut Motor::new(spec).unwrap(), &inputs, 1e-4);
        let slow = positions(&mut Motor::new(reference).unwrap(), &inputs, 1e-4);
        let range = fast.iter().fold(0.0_f64, |r, x| r.max(x.abs()));
        let worst = apart(&fast, &slow);
        assert!(worst < 1e-3 * range, "{}: {worst} of {range}", record.name);
    }
}

/// A change of the inertia by 45 units in the last place, as a measure of what round-off becomes.
const NUDGE: f64 = 1e-14;
/// So many times that may lie between two orders of summing.
const AS_GROWN: f64 = 10.0;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn reverse_points_are_recovered_and_loops_wiped_out(
        k_0 in 1e2..1e5_f64,
        share in 0.05..0.9_f64,
        d_0 in 1e-5..1e-2_f64,
        sizes in proptest::collection::vec(0.05..0.95_f64, 2..12),
    ) {
        let parameters = [
            ("initial_stiffness", k_0),
            ("final_stiffness", share * k_0),
            ("decay_distance", d_0),
            ("hardening_coefficient", 0.0),
            ("damping", 0.0),
        ];
        // Nested turning points: each inside the two before it.
        let mut turns = vec![3.0 * d_0, -2.0 * d_0];
        for size in sizes {
            let (a, b) = (turns[turns.len() - 2], turns[turns.len() - 1]);
            turns.push(b + (a - b) * size);
        }
        let mut nested = model("hsieh_pan", &parameters);
        let mut at = 0.0;
        let mut visit = |model: &mut FrictionModel, x: f64| {
            let force = model.step((x - at) / 1e-3, 1e-3, &Channels::default()).unwrap();
            at = x;
            force
        };
        let inward: Vec<f64> = turns.iter().map(|x| visit(&mut nested, *x)).collect();
        let range = inward[0] - inward[1];
        // Out again: every reverse point still open is met at its old force.
        for k in (0..turns.len() - 1).rev() {
            let force = visit(&mut nested, turns[k]);
            prop_assert!((force - inward[k]).abs() <= RECOVERED * range);
        }
        // Past the first turning point nothing of the loops is left.
        let beyond = visit(&mut nested, 3.5 * d_0);
        let mut straight = model("hsieh_pan", &parameters);
        let direct = straight.step(3.5 * d_0 / 1e-3, 1e-3, &Channels::default()).unwrap();
        prop_assert!((beyond - direct).abs() <= RECOVERED * range);
        prop_assert_eq!(nested.entries().into_iter().find(|(n, _)| *n == "reverse_points").unwrap().1, Entry::Pairs(vec![]));
    }

    #[test]
    fn dual_and_plain_paths_agree(seed in 0_u64..10_000) {
        let mut stream = Stream::new(seed);
        for record in all_laws() {
            let spec = MotorSpec::new(stream.log(0.003, 0.02), 1.0, drawn(record, &mut stream));
            let inputs: Vec<f64> = (0..400).map(|k| stream.between(0.6, 1.0) * (f64::from(k) * 0.03).sin()).collect();
            let alone = |inertia: f64| {
                let mut plain = Motor::new(MotorSpec { inertia, ..spec.clone() }).unwrap();
                let mut x = vec![0.0; inputs.len()];
                plain.simulate(&inputs, Surroundings::NONE, PerSample::Same(5e-4), &mut [(Column::Position, &mut x)]).unwrap();
                x
            };
            let x = alone(spec.inertia);
            // What a machine makes of round-off: of another one by a few units in the last place.
            let nudged = alone(spec.inertia * (1.0 + NUDGE));
            let grown = x.iter().zip(&nudged).fold(0.0_f64, |r, (a, b)| r.max((a - b).abs()));
            let values: Vec<Dual> = spec.parameters().iter().enumerate()
                .map(|(k, (_, v))| if k < 8 && v.is_finite() { Dual::variable(*v, k) } else { Dual::constant(*v) })
                .collect();
            let mut dual = Running::new(&spec, &values);
            let mut y = vec![0.0; inputs.len()];
            dual.simulate(&inputs, Surroundings::NONE, PerSample::Same(5e-4), |k, run, _, _| y[k] = run.position.re()).unwrap();
            let range = x.iter().fold(1e-12_f64, |r, x| r.max(x.abs()));
            let allowed = 1e-9 * range + AS_GROWN * grown;
            for (x, y) in x.iter().zip(&y) {
                prop_assert!((x - y).abs() <= allowed, "{} {x} {y} {grown}", record.name);
            }
        }
    }

    #[test]
    fn a_state_round_trip_continues_to_the_bit(seed in 0_u64..10_000) {
        let mut stream = Stream::new(seed);
        for record in all_laws() {
            let spec = drawn(record, &mut stream);
            let velocity: Vec<f64> = (0..600).map(|_| stream.between(-0.4, 0.4)).collect();
            let mut model = FrictionModel::new(spec.clone());
            run(&mut model, &velocity[..300], 1e-4);
            let entries: Vec<(String, Entry)> =
                model.entries().into_iter().map(|(n, e)| (n.into_owned(), e)).collect();
            let mut other = FrictionModel::new(spec);
            other.restore(&entries).unwrap();
            let lifted: AnyState<f64> = model.state().lift();
            let mut copy = model.clone();
            prop_assert_eq!(format!("{lifted:?}"), format!("{:?}", copy.state()));
            let rest = run(&mut model, &velocity[300..], 1e-4);
            prop_assert_eq!(&rest, &run(&mut other, &velocity[300..], 1e-4));
            prop_assert_eq!(&rest, &run(&mut copy, &velocity[300..], 1e-4));
        }
    }
}

#[test]
fn a_slide_that_is_pulled_above_break_away_gives_nothing_back() {
    // Viscous friction lifts the sliding level far above break-away; the spring must not store
    // more than the body gave.
    for (viscous, distance, speed) in [(10.0, 1e-8, 0.3), (1.0, 1e-6, 3.0), (0.1, 2e-5, 5.0)] {
        let mut model = model(
            "hsieh_pan",
            &[
                ("breakaway", 0.5),
                ("damping", 0.0),
                ("hardening_coefficient", 0.0),
                ("viscous", viscous),
                ("slip_distance", distance),
            ],
        );
        let dt = 1e-6;
        let (mut work, mut least, mut before) = (0.0_f64, 0.0_f64, 0.0);
        let path = [(0.01, 20_000), (speed, 200), (0.0, 10), (-0.01, 20_000)];
        for (velocity, steps) in path {
            for _ in 0..steps {
                let force = model.step(velocity, dt, &Channels::default()).unwrap();
                work += 0.5 * (before + force) * velocity * dt;
                before = force;
                least = least.min(work);
            }
        }
        assert!(least > -1e-9, "{viscous} {distance} {speed}: {least}");
    }
}

#[test]
fn a_jump_of_velocity_breaks_a_series_damper_away_once_and_gives_nothing_back() {
    let parameters = [("breakaway", 0.5), ("coulomb", 0.35), ("hardening_coefficient", 0.0)];
    let spec = law("hsieh_pan", &parameters, &[("damper", "spring")]);
    let mut model = FrictionModel::new(spec);
    let channels = Channels::default();
    model.step(1.2, 1e-9, &channels).unwrap();
    assert_eq!(model.statistics().breakaways, 1);
    assert_eq!(entry(&model, "mode"), 1.0);
    model.reset();
    let dt = 1e-6;
    let (mut work, mut before, mut ends) = (0.0, 0.0, Vec::new());
    for _ in 0..20 {
        let path = [
            (0.004, 10_000, dt),
            (0.8, 1, 1e-9),
            (1.2, 1, 1e-9),
            (0.0, 1, 1e-9),
            (-0.004, 10_000, dt),
        ];
        for (velocity, steps, dt) in path {
            for _ in 0..steps {
                let force = model.step(velocity, dt, &channels).unwrap();
                work += 0.5 * (before + force) * velocity * dt;
                before = force;
            }
        }
        ends.push(work);
    }
    assert!(ends.windows(2).all(|pair| pair[1] >= pair[0] - 1e-9), "{ends:?}");
}

#[test]
fn drawn_laws_with_any_option_give_nothing_back() {
    // Steps far below the distances in which the force changes, so that the trapezoid is exact
    // enough to tell.
    let mut slides = 0;
    for record in all_laws() {
        let mut stream = Stream::of(record, 77);
        let mut claimed = 0;
        for _ in 0..12 {
            let spec = drawn(record, &mut stream);
            // Some laws are passive under a condition alone, and say whether it holds.
            if !spec.passive() {
                continue;
            }
            claimed += 1;
            let value = |name: &str| {
                let at = record.parameters.iter().position(|p| p.name == name);
                at.map(|k| spec.values[k])
            };
            let level = value("breakaway").or(value("coulomb")).unwrap_or(1.0);
            let reach = value("initial_stiffness").map_or(1e-4, |k| level / k);
            let slip = value("slip_distance").unwrap_or(reach).min(reach);
            let elastic = value("initial_stiffness").is_some();
            let dt = 1e-5;
            let speed = 0.02 * slip / dt;
            let mut model = FrictionModel::new(spec.clone());
            let (mut work, mut least, mut before, mut velocity) = (0.0_f64, 0.0_f64, 0.0, 0.0);
            for _ in 0..100_000 {
                velocity = 0.999 * velocity + 0.045 * speed * (stream.next() - 0.5);
                let force = model.step(velocity, dt, &Channels::default()).unwrap();
                // A force of the path by trapezoid, one without memory at the end of the step.
                work += if elastic { 0.5 * (before + force) } else { force } * velocity * dt;
                before = force;
                least = least.min(work);
            }
            slides += model.statistics().breakaways;
            let slack = 1e-3 * level * slip;
            assert!(least > -slack, "{least} of {work}, slack {slack}: {spec:?}");
        }
        assert!(claimed > 0, "no drawn {} claims to be passive", record.name);
    }
    assert!(slides > 100, "only {slides} slides");
}
