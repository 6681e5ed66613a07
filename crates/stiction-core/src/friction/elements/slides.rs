//! Slides and reversals of contacts that have no rigid stick: counted, without any say in the force.

use crate::error::Result;
use crate::friction::{Entry, EntryReader, Statistics};
use crate::scalar::sign;

/// Share of F_c from which a contact counts as sliding.
const SLIDES: f64 = 0.95;
/// Share of F_c below which it counts as sticking again; apart, so that a ripple counts nothing.
const STICKS: f64 = 0.5;

/// Whether a contact slides, and how often it began and ended to.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Slides {
    /// 0 sticks, ±1 slides in that direction.
    pub mode: f64,
    /// Direction of the last motion.
    direction: f64,
    reversals: u64,
    breakaways: u64,
    sticks: u64,
}

impl Slides {
    /// The count once the velocity and the dry force at level 1 are these.
    #[inline(always)]
    pub fn after(self, velocity: f64, force: f64, coulomb: f64) -> Self {
        let mut next = self;
        let moving = sign(velocity);
        next.reversals += u64::from(moving * next.direction < 0.0);
        if moving != 0.0 {
            next.direction = moving;
        }
        if next.mode != 0.0 && force * next.mode < STICKS * coulomb {
            next.mode = 0.0;
            next.sticks += 1;
        }
        if next.mode == 0.0 && force.abs() >= SLIDES * coulomb {
            next.mode = sign(force);
            next.breakaways += 1;
        }
        next
    }

    /// As branch counters.
    pub fn statistics(&self) -> Statistics {
        Statistics {
            reversals: self.reversals,
            breakaways: self.breakaways,
            sticks: self.sticks,
            ..Statistics::default()
        }
    }

    /// As entries of a state.
    pub fn entries(&self) -> Vec<(&'static str, Entry)> {
        vec![
            ("mode", Entry::Number(self.mode)),
            ("direction", Entry::Number(self.direction)),
            ("reversals", Entry::Number(self.reversals as f64)),
            ("breakaways", Entry::Number(self.breakaways as f64)),
            ("sticks", Entry::Number(self.sticks as f64)),
        ]
    }

    /// From the entries of a state.
    pub fn restore(read: &mut EntryReader<'_>) -> Result<Self> {
        Ok(Self {
            mode: read.choice("mode", &[-1.0, 0.0, 1.0])?,
            direction: read.choice("direction", &[-1.0, 0.0, 1.0])?,
            reversals: read.count("reversals")?,
            breakaways: read.count("breakaways")?,
            sticks: read.count("sticks")?,
        })
    }
}
