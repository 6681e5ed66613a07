//! Slides and reversals of contacts that have no rigid stick: counted, without any say in the force.

use crate::friction::{Entry, EntryReader, Statistics};
use crate::math::row::{Row, pick};
use crate::math::scalar::sign;
use crate::support::error::Result;

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

    /// All of it as numbers.
    fn numbers(&self) -> [f64; 5] {
        let counts = [self.reversals, self.breakaways, self.sticks].map(|count| count as f64);
        let [reversals, breakaways, sticks] = counts;
        [self.mode, self.direction, reversals, breakaways, sticks]
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

/// [`Slides`] of several contacts, one in each lane.
#[derive(Debug, Clone, Default)]
pub struct SlidesAbreast {
    mode: Row,
    direction: Row,
    reversals: Row,
    breakaways: Row,
    sticks: Row,
}

impl SlidesAbreast {
    /// Takes those of a contact.
    pub fn load(&mut self, lane: usize, slides: &Slides) {
        let [mode, direction, reversals, breakaways, sticks] = slides.numbers();
        self.mode.0[lane] = mode;
        self.direction.0[lane] = direction;
        self.reversals.0[lane] = reversals;
        self.breakaways.0[lane] = breakaways;
        self.sticks.0[lane] = sticks;
    }

    /// Puts them back.
    pub fn store(&self, lane: usize, slides: &mut Slides) {
        let count = |row: &Row| row.0[lane] as u64;
        *slides = Slides {
            mode: self.mode.0[lane],
            direction: self.direction.0[lane],
            reversals: count(&self.reversals),
            breakaways: count(&self.breakaways),
            sticks: count(&self.sticks),
        };
    }

    /// [`Slides::after`] of a lane, where `taken`.
    #[inline(always)]
    pub fn step(&mut self, lane: usize, taken: bool, velocity: f64, force: f64, coulomb: f64) {
        let (mode, direction) = (self.mode.0[lane], self.direction.0[lane]);
        let moving = sign(velocity);
        self.reversals.add(lane, taken & (moving * direction < 0.0), 1.0);
        self.direction.take(lane, taken & (moving != 0.0), moving);
        let sticks = (mode != 0.0) & (force * mode < STICKS * coulomb);
        let mode = pick(sticks, 0.0, mode);
        let slides = (mode == 0.0) & (force.abs() >= SLIDES * coulomb);
        self.mode.take(lane, taken, pick(slides, sign(force), mode));
        self.sticks.add(lane, taken & sticks, 1.0);
        self.breakaways.add(lane, taken & slides, 1.0);
    }
}
