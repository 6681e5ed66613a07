//! The benches time what they claim: paths on which every law slides and sticks again, or turns round.
#![allow(missing_docs)]

// The bench crate itself is not built by `cargo test`, because criterion would be.
#[path = "../../../benches/lib.rs"]
#[allow(dead_code)] // motors with effects
mod workload;

use stiction_core::friction::{Channels, LAWS, Statistics};
use stiction_core::integrate::Integrator;
use stiction_core::motor::{PerSample, Surroundings};
use workload::{DT, SAMPLES, efforts, model, motor, velocities};

#[test]
fn the_timed_paths_break_away_and_stick_again() {
    for record in LAWS {
        let mut model = model(record);
        let mut friction = vec![0.0; SAMPLES];
        model.simulate(&velocities(), DT, |_| Channels::default(), &mut friction).unwrap();
        // What a law counts it keeps in its state.
        let counts = |name: &str| model.entries().iter().any(|(entry, _)| *entry == name);
        let (hooked, closes) = (counts("breakaways"), counts("closings"));
        let looped =
            |counted: Statistics| if closes { counted.closings } else { counted.reversals };
        let counted = model.statistics();
        let slid = counted.breakaways;
        let events = if hooked { slid } else { slid.max(looped(counted)) };
        assert!(events > 1, "{}: {counted:?}", record.name);
        let mut motor = motor(record, Integrator::Fast);
        let same = PerSample::Same;
        motor.simulate(&efforts(), Surroundings::NONE, same(DT), &mut []).unwrap();
        let counted = motor.statistics();
        let slid = counted.breakaways.min(counted.sticks);
        let events = if hooked { slid } else { slid.max(looped(counted)) };
        assert!(events > 1, "{}: {counted:?}", record.name);
    }
}
