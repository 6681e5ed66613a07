//! What an effect is told of the plant, and what it answers.

use crate::math::scalar::Scalar;

/// Where the plant is when an effect is asked.
#[derive(Debug, Clone, Copy)]
pub struct Situation<S> {
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
    /// Effort from the machine's load, external and gravity, positive along +x; what the gear transmits
    /// where that is known.
    pub load: S,
    /// Effort on the body, positive along +x, but friction and the load: that of the motor first of all.
    pub motor: S,
    /// Friction of slow sliding of the law, at level 1.
    pub sliding: S,
    /// Effort that the gear transmits, positive along +x, where that is known and is more than the
    /// external load and gravity.
    pub transmitted: Option<f64>,
    /// Temperature in °C, where it is known.
    pub temperature: Option<f64>,
    /// What a servo's distance from its goal has summed up to.
    pub wound: S,
    /// Whether the drive is on.
    pub enabled: bool,
}

impl<S: Scalar> Situation<S> {
    /// At rest at 0, with nothing around it.
    pub fn resting() -> Self {
        let zero = S::constant(0.0);
        Self {
            position: zero,
            velocity: zero,
            time: zero,
            path: zero,
            moved: zero,
            load: zero,
            motor: zero,
            sliding: zero,
            transmitted: None,
            temperature: None,
            wound: zero,
            enabled: true,
        }
    }

    /// What friction that grows with the load sees of it: what the gear transmits where that is known,
    /// which holds effort that accelerates what it carries.
    #[inline(always)]
    pub fn carried(&self, load: S) -> S {
        match self.transmitted {
            None => load,
            Some(effort) => S::constant(effort),
        }
    }

    /// The situation a little later.
    #[inline]
    pub fn after(&self, displacement: S, velocity: S, span: S) -> Self {
        Self {
            position: self.position + displacement,
            velocity,
            time: self.time + span,
            path: self.path + displacement.abs(),
            moved: self.moved + displacement,
            ..*self
        }
    }
}

/// Numbers that an effect carries from sample to sample.
pub const MEMORY: usize = 4;
/// What an effect remembers; which number means what is its own affair.
pub type Memory<S> = [S; MEMORY];

/// A sample that a contact went through, as an effect remembers it.
#[derive(Debug, Clone, Copy)]
pub struct Passage<S> {
    /// Displacement of the body.
    pub displacement: S,
    /// Friction before, at the end of the sample before.
    pub friction: S,
    /// Duration.
    pub span: S,
}

/// Change of the friction level: multipliers are 1 plus the sum of these.
#[derive(Debug, Clone, Copy)]
pub struct LevelChange<S> {
    /// Share added to the friction level.
    pub friction: S,
    /// Share added to viscous friction.
    pub viscous: S,
}

/// What gives way in series with the friction law, under force and with time.
#[derive(Debug, Clone, Copy)]
pub enum Relaxation<S> {
    /// A plastic module: it creeps until it has hardened, and a slide renews it. See
    /// [`crate::friction::elements::plastic::Plastic`].
    Hardening {
        /// Creep under the force of slow sliding once it has ended; 0 is neutral.
        creep: S,
        /// Exponent by which it falls at lower forces.
        exponent: S,
        /// Rate.
        rate: S,
    },
    /// Creep that goes on as long as the force does.
    Steady {
        /// Speed of creep under the force of slow sliding; 0 is neutral.
        speed: S,
        /// Exponent by which it falls at lower forces.
        exponent: S,
    },
}

/// A second mass: it carries `share` of the inertia.
#[derive(Debug, Clone, Copy)]
pub struct SecondMass<S> {
    /// Share of the inertia of the second mass.
    pub share: S,
    /// What leads to it.
    pub coupling: Coupling<S>,
}

/// What stands between the motor and a second mass.
#[derive(Debug, Clone, Copy)]
pub enum Coupling<S> {
    /// A shaft that twists.
    Shaft {
        /// Compliance; 0 is rigid and neutral.
        compliance: S,
        /// Damping of the two masses swinging against each other, as a share of the critical one.
        damping_ratio: S,
    },
    /// A gap in which the second mass flies free.
    Gap {
        /// Width.
        width: S,
        /// 1/ω of the second mass on an end of the gap, with the motor held; 0 is rigid: such ends stop
        /// it without rebound.
        contact_time: S,
        /// Damping of the two masses against each other at an end that yields, as a share of the
        /// critical one.
        damping_ratio: S,
        /// Viscous friction of the second mass over its inertia, 1/s.
        load_damping: S,
    },
}

/// A reading of the position sensor and its slope by the position, less 1.
#[derive(Debug, Clone, Copy)]
pub struct Reading<S> {
    /// What the sensor reads beyond the position.
    pub error: S,
    /// Slope of that by the position.
    pub slope: S,
}
