//! What defines a motor, in plain numbers.

use crate::friction::{Law, LawSpec};
use crate::integrate::Integrator;
use crate::math::scalar::Scalar;
use crate::plant::Machine;
use crate::plant::body::Body;
use crate::plant::drive::Drive;
use crate::plant::effects::{EffectSpec, Effects};
use crate::plant::sensor::Sensor;
use crate::plant::servo::Servo;
use crate::support::error::{Error, Result};

/// Everything that defines a motor, in plain numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct MotorSpec {
    /// Inertia (mass).
    pub inertia: f64,
    /// Effort per unit of input.
    pub gain: f64,
    /// Greatest magnitude of the input that gets through.
    pub input_limit: f64,
    /// What makes an effort of a goal position, where the input is one.
    pub servo: Option<Servo>,
    /// Amplitude of the pendulum torque.
    pub gravity_amplitude: f64,
    /// Position at which the pendulum hangs.
    pub gravity_zero: f64,
    /// Constant weight against positive motion.
    pub weight: f64,
    /// Size of a sensor count, 0 for none.
    pub count: f64,
    /// Friction law.
    pub friction: LawSpec,
    /// Effects.
    pub effects: Vec<EffectSpec>,
    /// Which integrator runs it.
    pub integrator: Integrator,
}

impl MotorSpec {
    /// A motor with inertia, gain and friction alone.
    pub fn new(inertia: f64, gain: f64, friction: LawSpec) -> Self {
        Self {
            inertia,
            gain,
            input_limit: f64::INFINITY,
            servo: None,
            gravity_amplitude: 0.0,
            gravity_zero: 0.0,
            weight: 0.0,
            count: 0.0,
            friction,
            effects: Vec::new(),
            integrator: Integrator::Fast,
        }
    }

    /// Refuses values that no motor has.
    pub fn check(&self) -> Result<()> {
        let bounded = [
            ("inertia", self.inertia, 1e-15, 1e15),
            ("gain", self.gain, -1e12, 1e12),
            ("input_limit", self.input_limit, 0.0, f64::INFINITY),
            ("gravity_amplitude", self.gravity_amplitude, -1e12, 1e12),
            ("gravity_zero", self.gravity_zero, -1e12, 1e12),
            ("weight", self.weight, -1e12, 1e12),
            ("count", self.count, 0.0, 1e6),
        ];
        for (name, given, lower, upper) in bounded {
            if given.is_nan() {
                return Err(Error::NotFinite { name: name.to_owned(), given });
            }
            if given < lower || given > upper {
                let unit = String::new();
                return Err(Error::OutOfBounds {
                    name: name.to_owned(),
                    given,
                    lower,
                    upper,
                    unit,
                });
            }
        }
        Ok(())
    }

    /// Path of the effort per unit: of input, or of a servo's current.
    fn gain_path(&self) -> &'static str {
        if self.servo.is_some() { "drive.torque_constant" } else { "drive.gain" }
    }

    /// Paths and values of all parameters: `body.inertia`, `friction.coulomb`,
    /// `effects.cogging.cosine` … in a fixed order.
    pub fn parameters(&self) -> Vec<(String, f64)> {
        let mut list = vec![
            ("body.inertia".to_owned(), self.inertia),
            (self.gain_path().to_owned(), self.gain),
            ("body.gravity_amplitude".to_owned(), self.gravity_amplitude),
            ("body.gravity_zero_rad".to_owned(), self.gravity_zero),
            ("body.weight_n".to_owned(), self.weight),
        ];
        let friction = self.friction.record.parameters.iter().zip(&self.friction.values);
        list.extend(friction.map(|(spec, v)| (format!("friction.{}", spec.name), *v)));
        for effect in &self.effects {
            let name = effect.record.name;
            let values = effect.record.parameters.iter().zip(&effect.values);
            list.extend(values.map(|(spec, v)| (format!("effects.{name}.{}", spec.name), *v)));
        }
        list
    }

    /// Refuses values, in the order of [`MotorSpec::parameters`], that this motor cannot have.
    pub fn allows(&self, values: &[f64]) -> Result<()> {
        let (body, rest) = values.split_at(5);
        let (friction, mut rest) = rest.split_at(self.friction.values.len());
        let stated: Vec<(String, f64)> = self
            .friction
            .record
            .parameters
            .iter()
            .zip(friction)
            .map(|(spec, value)| (spec.name.to_owned(), *value))
            .collect();
        LawSpec::new(self.friction.record.name, &stated, &[])?;
        for effect in &self.effects {
            let (own, left) = rest.split_at(effect.values.len());
            rest = left;
            let named = effect.record.parameters.iter().zip(own);
            let stated: Vec<(String, f64)> =
                named.map(|(spec, value)| (spec.name.to_owned(), *value)).collect();
            EffectSpec::new(effect.record.name, &stated)?;
        }
        Self {
            inertia: body[0],
            gain: body[1],
            gravity_amplitude: body[2],
            gravity_zero: body[3],
            weight: body[4],
            ..self.clone()
        }
        .check()
    }

    /// Machine and law over some number type; `values` in the order of [`Self::parameters`].
    pub fn build<S: Scalar>(&self, values: &[S]) -> (Machine<S>, Law<S>) {
        let (first, rest) = values.split_at(5);
        let (friction, mut rest) = rest.split_at(self.friction.values.len());
        let effects = self.effects.iter().map(|effect| {
            let own;
            (own, rest) = rest.split_at(effect.values.len());
            effect.built(own)
        });
        let effects = Effects::new(effects);
        let law = self.friction.law(friction);
        let machine = Machine::new(
            Drive { gain: first[1], limit: self.input_limit, servo: self.servo },
            Body::new(first[0], first[2], first[3], first[4]),
            effects,
            Sensor { count: self.count },
            law.sliding_force(),
        );
        (machine, law)
    }
}
