//! The running state of a body.

use super::budget::Budget;
use super::effects::Situation;
use crate::math::scalar::Scalar;

/// What effects ask of where a run was before a sample.
#[derive(Debug, Clone, Copy)]
pub struct Before<S> {
    /// Position.
    pub position: S,
    /// Friction.
    pub friction: S,
    /// Time on the session clock.
    pub time: S,
}

impl<S: Scalar> Before<S> {
    /// Of where a run is.
    #[inline]
    pub fn of(run: &Run<S>) -> Self {
        Self { position: run.position, friction: run.friction, time: run.time }
    }
}

/// Position, velocity and what else of the body runs from step to step.
#[derive(Debug, Clone, Copy)]
pub struct Run<S> {
    /// Position.
    pub position: S,
    /// Velocity.
    pub velocity: S,
    /// Time on the session clock.
    pub time: S,
    /// Path travelled since the session began.
    pub path: S,
    /// Displacement since effects last took a sample into their memory.
    pub moved: S,
    /// What the gear transmits, where that is known and is not the load.
    pub transmitted: Option<f64>,
    /// Temperature in °C, where it is known.
    pub temperature: Option<f64>,
    /// What a servo's distance from its goal has summed up to.
    pub wound: S,
    /// Whether the drive is on.
    pub enabled: bool,
    /// Friction at the end of the last step.
    pub friction: S,
    /// Position of the second mass.
    pub second_position: S,
    /// Velocity of the second mass.
    pub second_velocity: S,
    /// Hardening of the relaxation module.
    pub relaxed: S,
    /// Gravity, added efforts and shaft at the end of the last step.
    pub(crate) ambient: S,
    /// What the contact may give back, beside effects.
    pub budget: Budget<S>,
}

impl<S: Scalar> Run<S> {
    /// Where the plant is.
    #[inline]
    pub fn situation(&self) -> Situation<S> {
        Situation {
            position: self.position,
            velocity: self.velocity,
            time: self.time,
            path: self.path,
            moved: self.moved,
            transmitted: self.transmitted,
            temperature: self.temperature,
            wound: self.wound,
            enabled: self.enabled,
            ..Situation::resting()
        }
    }

    /// Gravity, added efforts and shaft at the end of the last step.
    pub fn ambient(&self) -> S {
        self.ambient
    }

    /// The same, to be set to what it was.
    pub fn ambient_mut(&mut self) -> &mut S {
        &mut self.ambient
    }

    /// Whether all of it is made of finite numbers.
    pub fn is_finite(&self) -> bool {
        let motion = [self.position, self.velocity, self.time, self.path, self.moved];
        let rest = [self.wound, self.friction, self.relaxed, self.ambient];
        let second = [self.second_position, self.second_velocity];
        motion.iter().chain(&rest).chain(&second).all(|x| x.re().is_finite())
    }

    /// Whether the motion is no number any more: from there nothing leads back, and steps cost most.
    #[inline(always)]
    pub fn is_lost(&self) -> bool {
        !(self.position + self.velocity).re().is_finite()
    }

    /// The same state over another number type, with no parameter dependence.
    pub fn lift<T: Scalar>(&self) -> Run<T> {
        let lift = |x: S| T::constant(x.re());
        Run {
            position: lift(self.position),
            velocity: lift(self.velocity),
            time: lift(self.time),
            path: lift(self.path),
            moved: lift(self.moved),
            transmitted: self.transmitted,
            temperature: self.temperature,
            wound: lift(self.wound),
            enabled: self.enabled,
            friction: lift(self.friction),
            second_position: lift(self.second_position),
            second_velocity: lift(self.second_velocity),
            relaxed: lift(self.relaxed),
            ambient: lift(self.ambient),
            budget: self.budget.lift(),
        }
    }
}
