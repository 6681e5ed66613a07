//! No step allocates.
#![allow(missing_docs)]

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use common::{law, motor};
use stiction_core::friction::{Channels, LAWS};
use stiction_core::model::{FrictionModel, LawSpec};
use stiction_core::motor::{EffectSpec, Motor, MotorSpec};

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

struct Counting;

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
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

// One test, because tests of one file run side by side and would count each other's allocations.
#[test]
fn no_step_allocates() {
    for record in LAWS {
        let hooked = record.parameters.iter().any(|p| p.name == "breakaway");
        let level = [if hooked { ("breakaway", 0.5) } else { ("coulomb", 0.5) }];
        let spec: LawSpec = law(record.name, &level, &[]);
        let mut model = FrictionModel::new(spec.clone());
        let mut body = motor(0.0076, spec);
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        for k in 0..20_000 {
            let phase = f64::from(k) * 1e-3;
            model.step(0.05 * (7.0 * phase).sin(), 1e-4, &Channels::default());
            body.step(0.8 * (3.0 * phase).sin(), 0.0, 1e-4).unwrap();
        }
        let after = ALLOCATIONS.load(Ordering::Relaxed);
        let statistics = body.statistics();
        assert!(!hooked || statistics.breakaways > 0, "{}: {statistics:?}", record.name);
        assert_eq!(after - before, 0, "{} allocates", record.name);
    }
    let delay = EffectSpec::new("input_delay", &[("delay".to_owned(), 0.0123)]).unwrap();
    let law = law("coulomb", &[("coulomb", 0.5)], &[]);
    let spec = MotorSpec { effects: vec![delay], ..MotorSpec::new(0.0076, 1.0, law) };
    let mut late = Motor::new(spec).unwrap();
    let mut run = |samples: i32| {
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        for k in 0..samples {
            late.step(0.8 * (3e-3 * f64::from(k)).sin(), 0.0, 1e-4).unwrap();
        }
        ALLOCATIONS.load(Ordering::Relaxed) - before
    };
    // Room for the inputs on their way is found while the delay fills up, then no more.
    run(200);
    assert_eq!(run(20_000), 0, "a delay allocates");
}
