//! Steps per second of each law and of the motor loop.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use stiction_benches::{DT, SAMPLES, efforts, model, motor, velocities};
use stiction_core::friction::{Channels, LAWS};
use stiction_core::integrate::Integrator;
use stiction_core::motor::{Column, PerSample, Surroundings};

fn laws(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("law");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    let velocity = velocities();
    for record in LAWS {
        let mut friction = vec![0.0; SAMPLES];
        let start = model(record);
        group.bench_function(record.name, |bench| {
            bench.iter(|| {
                let mut model = start.clone();
                let channels = |_| Channels::default();
                model.simulate(black_box(&velocity), DT, channels, &mut friction).unwrap();
                black_box(friction[SAMPLES - 1])
            });
        });
    }
    group.finish();
}

fn motors(criterion: &mut Criterion) {
    for (name, integrator) in
        [("motor", Integrator::Fast), ("motor, reference", Integrator::Reference)]
    {
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(SAMPLES as u64));
        let effort = efforts();
        for record in LAWS {
            let (mut x, mut v) = (vec![0.0; SAMPLES], vec![0.0; SAMPLES]);
            let start = motor(record, integrator);
            group.bench_function(record.name, |bench| {
                bench.iter(|| {
                    let mut motor = start.clone();
                    let columns = &mut [
                        (Column::Position, x.as_mut_slice()),
                        (Column::Velocity, v.as_mut_slice()),
                    ];
                    let same = PerSample::Same;
                    motor
                        .simulate(black_box(&effort), Surroundings::NONE, same(DT), columns)
                        .unwrap();
                    black_box(x[SAMPLES - 1])
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, laws, motors);
criterion_main!(benches);
