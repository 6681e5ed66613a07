//! A position servo: what makes an effort of a goal.

use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::resolve;

parameters! {
    /// Numbers of a [`Servo`].
    pub struct ServoNumbers {
        proportional: PerPosition, "duty per distance from the goal, P",
            default Value(1.0), neutral None, typical 1.0, bounds -1e12, 1e12;
        integral: PerPositionTime, "duty per distance from the goal and time, I",
            default Value(0.0), neutral Some(0.0), typical 1.0, bounds -1e12, 1e12;
        derivative: PerVelocity, "duty per velocity, D",
            default Value(0.0), neutral Some(0.0), typical 0.01, bounds -1e12, 1e12;
        duty_limit: One, "greatest duty",
            default Value(1.0), neutral None, typical 1.0, bounds 0.0, 1.0;
        supply: Voltage, "voltage at duty 1",
            default Value(1.0), neutral None, typical 7.4, bounds 0.0, 1e12;
        resistance: Resistance, "resistance of the winding, R",
            default Value(1.0), neutral None, typical 3.0, bounds 1e-9, 1e12;
        current_limit: Current, "greatest current",
            default Value(f64::INFINITY), neutral Some(f64::INFINITY), typical 1.5, bounds 0.0, f64::INFINITY;
    }
}

/// A position servo: goal, proportional-integral-derivative law, duty, voltage, motor.
///
/// duty = P·(goal − x) + I·∫(goal − x)·dt − D·v within ± its limit; V = supply·duty;
/// i = (V − k·v)/R within ± its limit; effort = k·i.
///
/// Source: Duclusaud et al. (2025), the electrical model of their servo actuators; Leonhard, Control of
/// Electrical Drives (2001), ch. 5, for the motor.
pub type Servo = ServoNumbers<f64>;

impl PartialEq for Servo {
    fn eq(&self, other: &Self) -> bool {
        self.values() == other.values()
    }
}

impl Servo {
    /// A servo with these numbers; what is not stated takes its default.
    pub fn new(stated: &[(String, f64)]) -> Result<Self> {
        Ok(Self::from_values(&resolve("servo", Self::SPECS, stated)?))
    }

    /// Its numbers in the order of [`Self::SPECS`].
    pub fn values(&self) -> [f64; 7] {
        [
            self.proportional,
            self.integral,
            self.derivative,
            self.duty_limit,
            self.supply,
            self.resistance,
            self.current_limit,
        ]
    }

    /// Voltage on the motor, from the distance to the goal and what that has summed up to.
    #[inline]
    pub fn voltage<S: Scalar>(&self, error: S, velocity: S, wound: S) -> S {
        let duty = error * self.proportional + wound * self.integral - velocity * self.derivative;
        within(duty, self.duty_limit) * self.supply
    }

    /// Current for a voltage, with this torque constant.
    #[inline]
    pub fn current<S: Scalar>(&self, constant: S, voltage: S, velocity: S) -> S {
        within((voltage - constant * velocity) / self.resistance, self.current_limit)
    }

    /// What the distance from the goal has summed up to after a sample; it stands while the duty is
    /// at its limit.
    #[inline]
    pub fn wind<S: Scalar>(&self, error: S, velocity: S, wound: S, span: S) -> S {
        if self.integral == 0.0 {
            return wound;
        }
        let full = self.duty_limit * self.supply;
        let free = self.voltage(error, velocity, wound).re().abs() < full;
        if free { wound + error * span } else { wound }
    }

    /// Effort per distance and per velocity on a motor with this torque constant.
    pub fn stiffness_and_damping(&self, constant: f64) -> (f64, f64) {
        let gain = constant.abs() * self.supply / self.resistance;
        let own = constant * constant / self.resistance;
        (gain * self.proportional.abs(), gain * self.derivative.abs() + own)
    }
}

/// A number held within ± a limit.
#[inline]
pub fn within<S: Scalar>(value: S, limit: f64) -> S {
    // The lesser and the greater of two, for which processors have instructions.
    let held = if limit < value.re() { S::constant(limit) } else { value };
    if held.re() < -limit { S::constant(-limit) } else { held }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONSTANT: f64 = 0.4;

    fn servo() -> Servo {
        let numbers = [("proportional", 2.0), ("supply", 7.4), ("resistance", 3.0)];
        Servo::new(&numbers.map(|(name, value)| (name.to_owned(), value))).unwrap()
    }

    #[test]
    fn the_error_makes_a_voltage_up_to_the_supply() {
        let servo = servo();
        assert_eq!(servo.voltage(0.25, 1.0, 5.0), 0.5 * 7.4);
        assert_eq!(servo.voltage(-3.0, 0.0, 0.0), -7.4);
    }

    #[test]
    fn a_motor_runs_without_current_at_the_speed_that_its_own_voltage_allows() {
        let servo = servo();
        assert_eq!(servo.current(CONSTANT, 4.0, 10.0), 0.0);
        assert!((servo.current(CONSTANT, 0.0, 3.0) + CONSTANT).abs() < 1e-15);
        let limited = Servo { current_limit: 0.1, ..servo };
        assert_eq!(limited.current(CONSTANT, 7.4, 0.0), 0.1);
    }

    #[test]
    fn the_integral_stands_while_the_duty_is_at_its_limit() {
        let servo = Servo { integral: 1.0, ..servo() };
        assert_eq!(servo.wind(0.1, 0.0, 0.0, 0.01), 0.1 * 0.01);
        assert_eq!(servo.wind(0.9, 0.0, 0.2, 0.01), 0.2);
    }
}
