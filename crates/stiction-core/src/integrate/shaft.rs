//! A second mass on a shaft: as part of a simulated machine, and seen from a measured motion.

use crate::effects::SecondMass;
use crate::scalar::Scalar;

/// The shaft of a machine that is simulated.
#[derive(Debug, Clone, Copy)]
pub struct Shaft<S> {
    /// Inertia beyond the shaft.
    pub inertia: S,
    /// Stiffness.
    pub stiffness: S,
    /// Damping.
    pub damping: S,
}

impl<S: Scalar> Shaft<S> {
    /// The shaft of a body of this inertia; a rigid one is none.
    pub fn new(mass: &SecondMass<S>, inertia: S) -> Option<Self> {
        if mass.compliance.re() == 0.0 {
            return None;
        }
        let far = inertia * mass.share;
        let stiffness = S::constant(1.0) / mass.compliance;
        let reduced = far * -(mass.share - 1.0);
        let damping = mass.damping_ratio * 2.0 * (stiffness * reduced).sqrt();
        Some(Self { inertia: far, stiffness, damping })
    }
}

/// How far a second mass is ahead of a motor whose motion is given.
///
/// e'' + 2·ζ·ω·e' + ω²·e = −x'' with ω² = 1/μ, μ = c·s·J, solved exactly for an acceleration that
/// changes linearly over a sample. As μ → 0 that goes over into e = −μ·x'' without a seam, which is
/// what its derivative at a rigid shaft is taken from.
#[derive(Debug, Clone, Copy)]
pub struct Twist<S> {
    share: S,
    /// Compliance times the inertia beyond the shaft, 1/ω².
    square: S,
    /// ζ of the far mass on a shaft that is held.
    ratio: S,
    ahead: S,
    rate: S,
    before: S,
}

impl<S: Scalar> Twist<S> {
    /// A shaft at rest.
    pub fn new(mass: &SecondMass<S>, inertia: S) -> Self {
        let zero = S::constant(0.0);
        Self {
            share: mass.share,
            square: mass.compliance * mass.share * inertia,
            ratio: mass.damping_ratio * (-(mass.share - 1.0)).sqrt(),
            ahead: zero,
            rate: zero,
            before: zero,
        }
    }

    /// Goes through a sample at whose end the motor has this acceleration; gives how far the centre
    /// of mass is then ahead of the motor.
    pub fn advance(&mut self, acceleration: S, span: f64) -> S {
        let (from, to) = (self.before, acceleration);
        self.before = to;
        if self.square.re() <= 0.0 {
            self.ahead = -(self.square * to);
            return self.share * self.ahead;
        }
        let omega = S::constant(1.0) / self.square.sqrt();
        let slope = (to - from) / span;
        let lag = self.ratio * 2.0 * slope / omega;
        let following = |acceleration: S| -(self.square * (acceleration - lag));
        let drift = -(self.square * slope);
        let (distance, speed) = (self.ahead - following(from), self.rate - drift);
        let decay = self.ratio * omega;
        let swing = omega * (-(self.ratio * self.ratio - 1.0)).sqrt();
        let left = (-(decay * span)).exp();
        let (sine, cosine) = ((swing * span).sin(), (swing * span).cos());
        let sine = sine / swing;
        self.ahead = following(to) + left * (distance * cosine + (speed + decay * distance) * sine);
        self.rate =
            drift + left * (speed * cosine - (decay * speed + omega * omega * distance) * sine);
        self.share * self.ahead
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    const SHARE: f64 = 0.4;
    const INERTIA: f64 = 0.01;

    fn mass<S: Scalar>(compliance: S) -> SecondMass<S> {
        let constant = S::constant;
        SecondMass { compliance, share: constant(SHARE), damping_ratio: constant(0.05) }
    }

    #[test]
    fn a_steady_wave_twists_the_shaft_as_its_response_says() {
        // y/x = (1 + 2ζi·r)/(1 − r² + 2ζi·r), r = w/ω; e = y − x.
        let (dt, w) = (1e-4, 90.0_f64);
        for frequency in [30.0, 80.0, 4000.0] {
            let omega = 2.0 * std::f64::consts::PI * frequency;
            let compliance = 1.0 / (omega * omega * SHARE * INERTIA);
            let mut twist = Twist::new(&mass(compliance), INERTIA);
            let (r, z) = (w / omega, 0.05 * (1.0 - SHARE).sqrt());
            // e = r²/(1 − r² + 2ζr·i)·x
            let (a, b) = (1.0 - r * r, 2.0 * z * r);
            let size = r * r / (a * a + b * b);
            let mut worst: f64 = 0.0;
            for k in 1..60_000 {
                let t = f64::from(k) * dt;
                let ahead = twist.advance(-w * w * (w * t).sin(), dt);
                let exact = SHARE * size * (a * (w * t).sin() - b * (w * t).cos());
                if t > 5.0 {
                    worst = worst.max((ahead - exact).abs() / (SHARE * size * a.hypot(b)));
                }
            }
            assert!(worst < 2e-3, "{frequency} Hz: {worst}");
        }
    }

    #[test]
    fn a_rigid_shaft_shows_the_derivative_by_its_compliance() {
        let mut rigid = Twist::new(&mass(Dual::variable(0.0, 0)), Dual::constant(INERTIA));
        let small = 1e-9;
        let mut soft = Twist::new(&mass(small), INERTIA);
        for k in 1..2000 {
            let acceleration = (f64::from(k) * 0.02).sin();
            let exact = rigid.advance(Dual::constant(acceleration), 1e-3);
            let chord = soft.advance(acceleration, 1e-3) / small;
            assert_eq!(exact.re(), 0.0);
            let gone = -SHARE * SHARE * INERTIA;
            assert!((Scalar::partial(exact, 0) - gone * acceleration).abs() < 1e-15);
            assert!((chord - gone * acceleration).abs() < 2e-2 * gone.abs(), "{k}");
        }
    }
}
