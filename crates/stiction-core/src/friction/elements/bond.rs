//! A spring that holds up to a stretch and is dragged along beyond: stick and slip by position.

use crate::friction::{Channels, Entry, EntryReader, Event, LawState, Motion, Outcome, Statistics};
use crate::math::scalar::{Scalar, sign};
use crate::support::error::Result;

/// Stretch of the spring, and whether it is dragged.
#[derive(Debug, Clone, Copy)]
pub struct Bond<S> {
    /// Stretch, at most the limit in size.
    pub stretch: S,
    /// 0 holds, ±1 is dragged in that direction.
    pub mode: f64,
    /// Break-aways and sticks.
    pub statistics: Statistics,
}

impl<S: Scalar> Bond<S> {
    /// Holding, with nothing stretched.
    pub fn relaxed() -> Self {
        Self { stretch: S::constant(0.0), mode: 0.0, statistics: Statistics::default() }
    }

    /// The same bond over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> Bond<T> {
        Bond { stretch: convert(self.stretch), mode: self.mode, statistics: self.statistics }
    }

    /// Takes the bond from the entries of a state.
    pub fn restore(read: &mut EntryReader<'_>) -> Result<Self> {
        Ok(Self {
            stretch: S::constant(read.number("stretch", false)?),
            mode: read.choice("mode", &[-1.0, 0.0, 1.0])?,
            statistics: Statistics {
                breakaways: read.count("breakaways")?,
                sticks: read.count("sticks")?,
                ..Statistics::default()
            },
        })
    }

    /// Stretch after a displacement in the present mode, also past the limit: a step that would end
    /// in the other mode where the event is found would leave its force to round-off.
    #[inline]
    fn moved(&self, limit: S, displacement: S) -> S {
        if self.mode == 0.0 { self.stretch + displacement } else { limit * self.mode }
    }

    /// The event that is due before any motion: it is dragged one way, the velocity points the other.
    #[inline]
    pub fn pending(&self, velocity: S) -> Option<Event> {
        (self.mode * velocity.re() < 0.0).then_some(Event::Reversal)
    }

    /// The event that a step runs past which would end at this stretch.
    #[inline]
    pub fn event(&self, limit: S, stretch: S, motion: &Motion<S>) -> Option<Event> {
        if self.mode == 0.0 {
            return (stretch.re().abs() > limit.re()).then_some(Event::BreakAway);
        }
        (self.mode * motion.velocity.re() <= 0.0).then_some(Event::Reversal)
    }

    /// Positive before the event, zero at it.
    #[inline]
    pub fn margin(&self, limit: S, motion: &Motion<S>, event: Event) -> S {
        match event {
            Event::BreakAway => {
                let stretch = self.stretch + motion.displacement;
                // From one limit to the other: the one that lies ahead counts.
                let ahead = match sign(motion.displacement.re()) {
                    0.0 => sign(motion.velocity.re()),
                    side => side,
                };
                limit - if ahead == 0.0 { stretch.abs() } else { stretch * ahead }
            }
            Event::Reversal | Event::HookReturn => motion.velocity * self.mode,
        }
    }

    /// Changes mode.
    pub fn switch(&mut self, limit: S, event: Event) {
        match event {
            Event::BreakAway => {
                self.mode = sign(self.stretch.re());
                self.stretch = limit * self.mode;
                self.statistics.breakaways += 1;
            }
            Event::Reversal | Event::HookReturn => {
                self.stretch = limit * self.mode;
                self.mode = 0.0;
                self.statistics.sticks += 1;
            }
        }
    }
}

impl<S: Scalar> LawState<S> for Bond<S> {
    const OUTPUTS: &'static [&'static str] = &["stretch", "mode"];

    fn output(&self, index: usize) -> S {
        if index == 0 { self.stretch } else { S::constant(self.mode) }
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        vec![
            ("stretch", Entry::Number(self.stretch.re())),
            ("mode", Entry::Number(self.mode)),
            ("breakaways", Entry::Number(self.statistics.breakaways as f64)),
            ("sticks", Entry::Number(self.statistics.sticks as f64)),
        ]
    }

    fn statistics(&self) -> Statistics {
        self.statistics
    }
}

/// A step of a bond.
#[derive(Debug, Clone, Copy)]
pub struct BondTrial<S> {
    /// Stretch at its end.
    pub stretch: S,
    /// Friction at its end.
    pub outcome: Outcome<S>,
}

/// Friction of a bond that is damped while it holds.
#[derive(Debug, Clone)]
pub struct DampedBond<S> {
    /// Stiffness while it holds.
    pub stiffness: S,
    /// Stretch from which on it is dragged.
    pub limit: S,
    /// Force while it is dragged.
    pub dragged: S,
    /// Damping while it holds.
    pub damping: S,
    /// Friction per speed at all times.
    pub viscous: S,
}

impl<S: Scalar> DampedBond<S> {
    /// Force at a stretch, and its damping.
    #[inline]
    pub fn at(&self, mode: f64, stretch: S, velocity: S, channels: &Channels<S>) -> (S, S) {
        let viscous = self.viscous * channels.viscous_level;
        if mode != 0.0 {
            return (self.dragged * channels.level * mode + viscous * velocity, viscous);
        }
        let damping = self.damping + viscous;
        (self.stiffness * stretch * channels.level + damping * velocity, damping)
    }

    /// A step in the present mode.
    #[inline]
    pub fn advance(
        &self,
        bond: &Bond<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> BondTrial<S> {
        let stretch = bond.moved(self.limit, motion.displacement);
        let (force, damping) = self.at(bond.mode, stretch, motion.velocity, channels);
        let stiffness = if bond.mode == 0.0 { self.stiffness } else { S::constant(0.0) };
        let slope = stiffness * channels.level * motion.duration + damping;
        BondTrial { stretch, outcome: Outcome { force, slope, damping } }
    }
}
