//! Everything of a plant but its friction law, and the running state of its body.

use super::shaft::Shaft;
use crate::body::Body;
use crate::drive::Drive;
use crate::effects::{Effects, Passage, Situation};
use crate::friction::Channels;
use crate::friction::elements::plastic::Plastic;
use crate::scalar::Scalar;
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
    pub(super) relaxation: Option<Plastic<S>>,
    pub(super) shaft: Option<Shaft<S>>,
    /// Friction of slow sliding, which renews the relaxing junctions.
    sliding: f64,
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
    /// Time on the session clock.
    pub time: S,
    /// Path travelled since the session began.
    pub path: S,
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
    /// Puts the parts together; `sliding` is the law's friction of slow sliding.
    pub fn new(
        drive: Drive<S>,
        body: Body<S>,
        effects: Effects<S>,
        sensor: Sensor,
        sliding: S,
    ) -> Self {
        let relaxation = effects.relaxation().and_then(|r| {
            let there = r.creep.re() != 0.0 || r.creep.derivative_is_nonzero();
            (there && sliding.re().is_finite() && sliding.re() > 0.0).then(|| Plastic {
                coefficient: r.creep / sliding.power_of_magnitude(r.exponent),
                exponent: r.exponent,
                rate: r.rate,
            })
        });
        let shaft = effects.second_mass().and_then(|m| Shaft::new(&m, body.inertia));
        let inertia = shaft.map_or(body.inertia, |shaft| body.inertia - shaft.inertia);
        Self { drive, body, effects, sensor, relaxation, shaft, sliding: sliding.re(), inertia }
    }

    /// A body at this position and velocity.
    pub fn start(&self, position: S, velocity: S) -> Run<S> {
        let zero = S::constant(0.0);
        let mut run = Run {
            position,
            velocity,
            time: zero,
            path: zero,
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
        self.inertia.re().min(self.shaft.map_or(f64::INFINITY, |shaft| shaft.inertia.re()))
    }

    /// Stiffness beside that of the friction.
    pub(super) fn greatest_stiffness(&self) -> f64 {
        let shaft = self.shaft.map_or(0.0, |shaft| shaft.stiffness.re());
        shaft + self.body.gravity_amplitude.re().abs()
    }

    /// Shaft effort on the motor's side.
    #[inline]
    pub(super) fn shaft(&self, at: &Situation<S>, position: S, velocity: S) -> S {
        self.shaft.map_or(S::constant(0.0), |shaft| {
            shaft.stiffness * (position - at.position) + shaft.damping * (velocity - at.velocity)
        })
    }

    /// Moves the second mass on while the motor goes from one situation to another.
    #[inline]
    pub(super) fn swing(
        &self,
        start: &Situation<S>,
        end: &Situation<S>,
        span: S,
        run: &mut Run<S>,
    ) {
        let Some(shaft) = self.shaft else { return };
        let half = span * 0.5;
        let pull = self.shaft(start, run.second_position, run.second_velocity);
        let slowing = -(pull / shaft.inertia);
        run.second_position += span * (run.second_velocity + half * slowing);
        let arriving = run.second_velocity + span * slowing;
        let pull_then = self.shaft(end, run.second_position, arriving);
        run.second_velocity -= half * (pull + pull_then) / shaft.inertia;
    }

    /// Effort that does not come from input and load.
    #[inline]
    pub(super) fn ambient(&self, at: &Situation<S>, second: S, second_velocity: S) -> S {
        let effort = self.body.gravity(at.position) + self.effects.effort(at);
        if self.shaft.is_some() { effort + self.shaft(at, second, second_velocity) } else { effort }
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

    /// Whether a friction of this size slides, which renews relaxing junctions.
    #[inline]
    pub(super) fn slides(&self, friction: S) -> bool {
        friction.re().abs() >= SLIDING_SHARE * self.sliding
    }

    /// Hardening of the relaxation module after a step under this friction, and how far it crept.
    #[inline]
    pub fn relax(&self, hardened: S, friction: S, span: S) -> (S, S) {
        let zero = S::constant(0.0);
        let Some(module) = self.relaxation else { return (zero, zero) };
        if self.slides(friction) {
            return (zero, zero);
        }
        let creep = module.creep(hardened, friction, |_| zero, zero, span);
        (hardened + creep.hardening, creep.displacement)
    }

    /// Whether the contact creeps of itself.
    #[inline]
    pub fn relaxes(&self) -> bool {
        self.relaxation.is_some()
    }

    /// Lets effects remember the sample that a run went through, from where it stood before.
    #[inline]
    pub fn remember(&mut self, before: &Run<S>, run: &Run<S>) {
        if self.effects.remembers() {
            let passage = Passage {
                displacement: run.position - before.position,
                friction: before.friction,
                span: run.time - before.time,
            };
            self.effects.remember(&passage);
        }
    }
}

/// Share of the friction of slow sliding from which on a contact counts as sliding.
const SLIDING_SHARE: f64 = 0.98;

impl<S: Scalar> Run<S> {
    /// Where the plant is.
    #[inline]
    pub fn situation(&self) -> Situation<S> {
        Situation {
            position: self.position,
            velocity: self.velocity,
            time: self.time,
            path: self.path,
        }
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
            path: lift(self.path),
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
    if !law.holds(state, &machine.channels(&at, effort, load)) {
        return false;
    }
    run.friction = effort;
    run.time += span;
    // A second mass goes on swinging on the shaft of a motor that is held.
    machine.swing(&at, &at, span, run);
    if machine.relaxation.is_some() {
        let (hardened, crept) = machine.relax(run.relaxed, effort, span);
        run.relaxed = hardened;
        run.position += crept;
        run.path += crept.abs();
    }
    machine.refresh(run);
    true
}
