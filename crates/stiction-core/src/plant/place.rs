//! What goes by where a body is and by nothing else, as a row of plain steps asks for it.

use super::body::Body;
use super::effects::{Effects, never_driving};
use crate::math::scalar::Scalar;
use crate::math::wave::{Follower, Wave};

/// Terms of a sum that are followed at most.
const MOST: usize = 4;

/// What an effect adds.
#[derive(Debug, Clone, Copy)]
pub enum Followed {
    /// The same everywhere.
    Even(f64),
    /// One harmonic.
    Harmonic(Follower),
    /// Two of them.
    Both(Follower, Follower),
}

impl Followed {
    /// A wave.
    pub fn wave<S: Scalar>(wave: &Wave<S>) -> Self {
        let first = Follower::new(wave.first.plain(), 0.0);
        match wave.second {
            None => Self::Harmonic(first),
            Some(second) => Self::Both(first, Follower::new(second.plain(), 0.0)),
        }
    }

    #[inline(always)]
    fn at(&mut self, position: f64) -> f64 {
        match self {
            Self::Even(value) => *value,
            Self::Harmonic(harmonic) => harmonic.at(position),
            Self::Both(first, second) => first.at(position) + second.at(position),
        }
    }

    /// The same without going there.
    #[inline(always)]
    fn seen(&self, position: f64) -> f64 {
        match self {
            Self::Even(value) => *value,
            Self::Harmonic(harmonic) => harmonic.seen(position),
            Self::Both(first, second) => first.seen(position) + second.seen(position),
        }
    }
}

/// Some of it, in the order of their sum.
#[derive(Debug, Clone, Copy)]
struct Sum {
    terms: [Followed; MOST],
    number: usize,
}

impl Sum {
    fn of(given: impl Iterator<Item = Option<Followed>>) -> Option<Self> {
        let (mut terms, mut number) = ([Followed::Even(0.0); MOST], 0);
        for term in given {
            *terms.get_mut(number)? = term?;
            number += 1;
        }
        Some(Self { terms, number })
    }

    #[inline(always)]
    fn onto(&mut self, mut sum: f64, position: f64) -> f64 {
        for term in &mut self.terms[..self.number] {
            sum += term.at(position);
        }
        sum
    }
}

/// Gravity, added efforts and the level of dry friction, step by step.
#[derive(Debug, Clone, Copy)]
pub struct ByPlace {
    weight: f64,
    pendulum: Option<Follower>,
    efforts: Sum,
    levels: Sum,
    /// The share of the input that is added to it.
    ripple: Option<Followed>,
}

impl ByPlace {
    /// Of a body and effects whose efforts and levels go by the place alone.
    pub fn of<S: Scalar>(body: &Body<S>, effects: &Effects<S>) -> Option<Self> {
        let pendulum = (!body.is_level())
            .then(|| Follower::new(body.pendulum().plain(), body.gravity_zero.re()));
        let efforts = Sum::of(effects.followed_efforts())?;
        let levels = Sum::of(effects.followed_levels())?;
        let ripple = effects.followed_input();
        Some(Self { weight: body.level_gravity().re(), pendulum, efforts, levels, ripple })
    }

    /// Whether there are efforts alone: no level but 1, and a drive that is the same everywhere.
    pub fn is_effort_alone(&self) -> bool {
        self.levels.number == 0 && self.ripple.is_none()
    }

    /// Whether the drive goes by the place.
    #[inline(always)]
    pub fn has_ripple(&self) -> bool {
        self.ripple.is_some()
    }

    /// What an input becomes.
    #[inline(always)]
    pub fn input(&self, input: f64, position: f64) -> f64 {
        match &self.ripple {
            None => input,
            Some(ripple) => input + input * ripple.seen(position),
        }
    }

    /// Follows to where the input will be asked for.
    #[inline(always)]
    pub fn follow_ripple(&mut self, position: f64) {
        if let Some(ripple) = &mut self.ripple {
            ripple.at(position);
        }
    }

    /// Gravity and added efforts, summed in the order in which [`super::Machine`] has them.
    #[inline(always)]
    pub fn effort(&mut self, position: f64) -> f64 {
        let gravity = match &mut self.pendulum {
            None => self.weight,
            Some(pendulum) => self.weight + pendulum.at(position),
        };
        gravity + self.efforts.onto(0.0, position)
    }

    /// The level of dry friction, likewise.
    #[inline(always)]
    pub fn level(&mut self, position: f64) -> f64 {
        never_driving(self.levels.onto(1.0, position))
    }
}
