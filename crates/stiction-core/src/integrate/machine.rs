//! Everything of a plant but its friction law, and the running state of its body.

use crate::body::Body;
use crate::drive::Drive;
use crate::effects::{Effects, Relaxation, SecondMass, Situation};
use crate::friction::Channels;
use crate::scalar::{Scalar, sign};
use crate::sensor::Sensor;

/// Drive, body, effects and sensor.
#[derive(Debug, Clone)]
pub struct Machine<S: Scalar> {
    /// From input to effort.
    pub drive: Drive<S>,
    /// Inertia and gravity.
    pub body: Body<S>,
    /// Effects beside the law.
    pub effects: Effects<S>,
    /// Position sensor.
    pub sensor: Sensor,
    pub(super) relaxation: Option<Relaxation<S>>,
    pub(super) second_mass: Option<SecondMass<S>>,
    /// Inertia on the motor's side of the shaft.
    pub(super) inertia: S,
}

/// Position, velocity and what else of the body runs from step to step.
#[derive(Debug, Clone, Copy)]
pub struct Run<S> {
    /// Position.
    pub position: S,
    /// Velocity.
    pub velocity: S,
    /// Time since the start or the last reset.
    pub time: S,
    /// Friction at the end of the last step.
    pub friction: S,
    /// Position of the second mass.
    pub second_position: S,
    /// Velocity of the second mass.
    pub second_velocity: S,
    /// Hardening of the relaxation module.
    pub relaxed: S,
    /// Gravity, added efforts and shaft at the end of the last step.
    pub(super) ambient: S,
}

impl<S: Scalar> Machine<S> {
    /// Puts the parts together.
    pub fn new(drive: Drive<S>, body: Body<S>, effects: Effects<S>, sensor: Sensor) -> Self {
        let relaxation = effects.relaxation().filter(|r| r.coefficient.re() != 0.0);
        let second_mass = effects.second_mass().filter(|m| m.share.re() != 0.0);
        let inertia = second_mass.map_or(body.inertia, |m| body.inertia * (-(m.share - 1.0)));
        Self { drive, body, effects, sensor, relaxation, second_mass, inertia }
    }

    /// A body at this position and velocity.
    pub fn start(&self, position: S, velocity: S) -> Run<S> {
        let zero = S::constant(0.0);
        let mut run = Run {
            position,
            velocity,
            time: zero,
            friction: zero,
            second_position: position,
            second_velocity: velocity,
            relaxed: zero,
            ambient: zero,
        };
        self.refresh(&mut run);
        run
    }

    /// Recomputes what is derived from the other fields, after these were set from outside.
    pub fn refresh(&self, run: &mut Run<S>) {
        run.ambient = self.ambient(&run.situation(), run.second_position, run.second_velocity);
    }

    /// Least inertia that a spring acts on.
    pub(super) fn lightest_inertia(&self) -> f64 {
        let other = self.second_mass.map_or(f64::INFINITY, |m| (self.body.inertia * m.share).re());
        self.inertia.re().min(other)
    }

    /// Stiffness beside that of the friction.
    pub(super) fn greatest_stiffness(&self) -> f64 {
        let shaft = self.second_mass.map_or(0.0, |m| m.stiffness.re());
        shaft + self.body.gravity_amplitude.re().abs()
    }

    /// Shaft effort on the motor's side.
    #[inline]
    pub(super) fn shaft(&self, at: &Situation<S>, position: S, velocity: S) -> S {
        self.second_mass.map_or(S::constant(0.0), |m| {
            m.stiffness * (position - at.position) + m.damping * (velocity - at.velocity)
        })
    }

    /// Effort that does not come from input and load.
    #[inline]
    pub(super) fn ambient(&self, at: &Situation<S>, second: S, second_velocity: S) -> S {
        let effort = self.body.gravity(at.position) + self.effects.effort(at);
        if self.second_mass.is_some() {
            effort + self.shaft(at, second, second_velocity)
        } else {
            effort
        }
    }

    /// Effort of the drive.
    #[inline]
    pub(super) fn driven(&self, input: S, at: &Situation<S>) -> S {
        self.drive.effort(self.effects.input(input, at))
    }

    /// All effort but friction and shaft, then the drive's share and the rest of it.
    #[inline]
    pub fn efforts(&self, at: &Situation<S>, input: S, load: S) -> (S, S, S) {
        let driven = self.driven(input, at);
        let ambient = self.body.gravity(at.position) + self.effects.effort(at);
        (driven + load + ambient, driven, ambient)
    }

    /// What reaches the contact.
    #[inline]
    pub fn channels(&self, at: &Situation<S>, effort: S, load: S) -> Channels<S> {
        let (level, viscous_level) = self.effects.levels(at);
        Channels { effort, load, level, viscous_level, temperature: None }
    }

    /// Hardening that the relaxation module gains over a step under this friction.
    #[inline]
    pub(super) fn relax(&self, run: &Run<S>, friction: S, span: S) -> S {
        let zero = S::constant(0.0);
        self.relaxation.map_or(zero, |module| {
            module.creep(run.relaxed, friction, |_| zero, zero, span).hardening
        })
    }

    /// Signed displacement that goes with a gain of hardening.
    #[inline]
    pub(super) fn crept(&self, gained: S, friction: S) -> S {
        gained * sign(friction.re())
    }
}

impl<S: Scalar> Run<S> {
    /// Where the plant is.
    #[inline]
    pub fn situation(&self) -> Situation<S> {
        Situation { position: self.position, velocity: self.velocity, time: self.time }
    }

    /// Gravity, added efforts and shaft at the end of the last step.
    pub fn ambient(&self) -> S {
        self.ambient
    }

    /// Sets what [`Self::ambient`] returned.
    pub fn set_ambient(&mut self, ambient: S) {
        self.ambient = ambient;
    }

    /// The same state over another number type, with no parameter dependence.
    pub fn lift<T: Scalar>(&self) -> Run<T> {
        let lift = |x: S| T::constant(x.re());
        Run {
            position: lift(self.position),
            velocity: lift(self.velocity),
            time: lift(self.time),
            friction: lift(self.friction),
            second_position: lift(self.second_position),
            second_velocity: lift(self.second_velocity),
            relaxed: lift(self.relaxed),
            ambient: lift(self.ambient),
        }
    }
}

/// Holds a resting body for `span` where the contact can: nothing moves but slow creep.
#[inline]
pub(super) fn hold<S: Scalar, L: crate::friction::FrictionLaw<S>>(
    machine: &Machine<S>,
    run: &mut Run<S>,
    (input, load): (S, S),
    law: &L,
    state: &mut L::State,
    span: S,
) -> bool {
    let at = run.situation();
    let effort = machine.driven(input, &at) + load + run.ambient;
    // A shaft still swings on a held motor: only a machine of one mass stands still as a whole.
    if machine.second_mass.is_some() || !law.holds(state, &machine.channels(&at, effort, load)) {
        return false;
    }
    run.friction = effort;
    run.time += span;
    if machine.relaxation.is_some() {
        let gained = machine.relax(run, effort, span);
        run.relaxed += gained;
        run.position += machine.crept(gained, effort);
    }
    machine.refresh(run);
    true
}
