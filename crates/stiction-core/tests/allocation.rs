//! No step allocates.
#![allow(missing_docs)]

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use common::{law, motor};
use stiction_core::effects::EFFECTS;
use stiction_core::friction::{Channels, LAWS};
use stiction_core::model::{FrictionModel, LawSpec};
use stiction_core::motor::{EffectSpec, Motor, MotorSpec};

thread_local! {
    // A thread counts its own: the test harness allocates on others whenever it likes.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

fn allocations() -> u64 {
    ALLOCATIONS.with(Cell::get)
}

struct Counting;

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // A thread that ends has no counter left, and nothing to count.
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn no_step_allocates() {
    for record in LAWS {
        let hooked = record.parameters.iter().any(|p| p.name == "breakaway");
        let level = [if hooked { ("breakaway", 0.5) } else { ("coulomb", 0.5) }];
        let spec: LawSpec = law(record.name, &level, &[]);
        let mut model = FrictionModel::new(spec.clone());
        let mut body = motor(0.0076, spec);
        let before = allocations();
        for k in 0..20_000 {
            let phase = f64::from(k) * 1e-3;
            model.step(0.05 * (7.0 * phase).sin(), 1e-4, &Channels::default()).unwrap();
            body.step(0.8 * (3.0 * phase).sin(), 0.0, 1e-4).unwrap();
        }
        let after = allocations();
        let statistics = body.statistics();
        assert!(!hooked || statistics.breakaways > 0, "{}: {statistics:?}", record.name);
        assert_eq!(after - before, 0, "{} allocates", record.name);
    }
    let contact: Vec<EffectSpec> = EFFECTS
        .iter()
        .filter(|record| record.at_contact())
        .map(|record| {
            let typical = record.parameters.iter().map(|p| (p.name.to_owned(), p.typical));
            EffectSpec::new(record.name, &typical.collect::<Vec<_>>()).unwrap()
        })
        .collect();
    for record in LAWS {
        let law = law(record.name, &[], &[]);
        let mut model = FrictionModel::with_effects(law, contact.clone()).unwrap();
        let before = allocations();
        for k in 0..5_000 {
            let velocity = 0.05 * (7e-3 * f64::from(k)).sin();
            model.step(velocity, 1e-4, &Channels::default()).unwrap();
        }
        assert_eq!(allocations() - before, 0, "{} allocates with effects", record.name);
    }
    let delay = EffectSpec::new("input_delay", &[("delay".to_owned(), 0.0123)]).unwrap();
    let law = law("coulomb", &[("coulomb", 0.5)], &[]);
    let spec = MotorSpec { effects: vec![delay], ..MotorSpec::new(0.0076, 1.0, law) };
    let mut late = Motor::new(spec).unwrap();
    let mut run = |samples: i32| {
        let before = allocations();
        for k in 0..samples {
            late.step(0.8 * (3e-3 * f64::from(k)).sin(), 0.0, 1e-4).unwrap();
        }
        allocations() - before
    };
    // Room for the inputs on their way is found while the delay fills up, then no more.
    run(200);
    assert_eq!(run(20_000), 0, "a delay allocates");
}
