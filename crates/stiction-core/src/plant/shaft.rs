//! A second mass on a shaft: as part of a simulated machine, and seen from a measured motion.

use super::effects::{Coupling, SecondMass, Situation};
use super::gap::{Bounce, Flight};
use crate::math::scalar::{Scalar, sign};

/// The shaft of a machine that is simulated, or the gap in its place.
#[derive(Debug, Clone, Copy)]
pub struct Shaft<S> {
    /// Inertia beyond the shaft.
    pub inertia: S,
    /// Stiffness.
    pub stiffness: S,
    /// Damping.
    pub damping: S,
    /// How far the second mass is from either end of the gap when it is in the middle.
    pub play: Option<S>,
    /// Viscous friction of the second mass over its inertia.
    pub load_damping: S,
}

/// What stops a mass at the rigid end of a gap swings that fast against both masses, 1/s: fast beside any
/// motion of a machine and slow enough to be simulated.
const STOP: f64 = 2.0 * std::f64::consts::PI * 300.0;

impl<S: Scalar> Shaft<S> {
    /// The shaft of a body of this inertia; a rigid one is none, nor is one with nothing behind it.
    pub fn new(mass: &SecondMass<S>, inertia: S) -> Option<Self> {
        let far = inertia * mass.share;
        let reduced = far * -(mass.share - 1.0);
        match mass.coupling {
            Coupling::Shaft { compliance, damping_ratio } => {
                // Of a smaller number than this the stiffness is none.
                if compliance.re() < f64::MIN_POSITIVE {
                    return None;
                }
                let stiffness = S::constant(1.0) / compliance;
                let damping = damping_ratio * 2.0 * (stiffness * reduced).sqrt();
                let load_damping = S::constant(0.0);
                Some(Self { inertia: far, stiffness, damping, play: None, load_damping })
            }
            Coupling::Gap { width, contact_time, damping_ratio, load_damping } => {
                if far.re() == 0.0 {
                    return None;
                }
                let (stiffness, damping) = if contact_time.re() > 0.0 {
                    let stiffness = far / (contact_time * contact_time);
                    (stiffness, damping_ratio * 2.0 * (stiffness * reduced).sqrt())
                } else {
                    // Critically damped: it hardly rebounds.
                    (reduced * STOP * STOP, reduced * 2.0 * STOP)
                };
                let play = Some(width * 0.5);
                Some(Self { inertia: far, stiffness, damping, play, load_damping })
            }
        }
    }

    /// Where the second mass gets to, and how fast, while the motor goes from one situation to another.
    #[inline]
    pub(crate) fn swing(
        &self,
        start: &Situation<S>,
        end: &Situation<S>,
        span: S,
        (position, velocity): (S, S),
    ) -> (S, S) {
        let half = span * 0.5;
        let pull = self.pull(position - start.position, velocity - start.velocity);
        let slowing = -(pull / self.inertia + self.load_damping * velocity);
        let position = position + span * (velocity + half * slowing);
        let arriving = velocity + span * slowing;
        let pull_then = self.pull(position - end.position, arriving - end.velocity);
        let dragged = self.load_damping * (velocity + arriving);
        (position, velocity - (half * (pull + pull_then) / self.inertia + half * dragged))
    }

    /// Effort on the motor where the second mass is that far ahead of it, and that much faster.
    #[inline]
    pub fn pull(&self, ahead: S, faster: S) -> S {
        let Some(play) = self.play else {
            return self.stiffness * ahead + self.damping * faster;
        };
        let side = sign(ahead.re());
        let beyond = ahead * side - play;
        if beyond.re() <= 0.0 {
            return S::constant(0.0);
        }
        // Its damping sets in over a hundredth of the gap: a jump in the force would end inside a
        // step, and no derivative would be right.
        let depth = beyond / (play * 0.02);
        let set_in = if depth.re() < 1.0 { depth } else { S::constant(1.0) };
        let push = self.stiffness * beyond + self.damping * faster * side * set_in;
        // The end of a gap pushes and never pulls.
        if push.re() > 0.0 { push * side } else { S::constant(0.0) }
    }
}

/// A second mass seen from a measured motion of the motor.
///
/// While a rigid contact rests it holds what a shaft pulls at the motor, and what the mass does then is
/// nobody's effort: its centre of mass counts as going on as it went when the motor stopped. The end
/// of a gap knocks harder than a contact holds: then the motor moves, and does not rest.
#[derive(Debug, Clone)]
pub struct Beyond<S> {
    share: S,
    mass: Far<S>,
    /// How far the centre of mass is ahead, without what it did at rest.
    ahead: S,
    /// What of its rate was held at rests.
    held: S,
}

/// A mass behind the motor.
#[derive(Debug, Clone)]
enum Far<S> {
    /// On a shaft.
    Shaft(Twist<S>),
    /// In a gap with rigid ends.
    Gap(Flight<S>),
    /// In a gap whose ends yield.
    Yielding(Box<Bounce<S>>),
}

impl<S: Scalar> Beyond<S> {
    /// At rest; readings of the motor have counts of this size.
    pub fn new(mass: &SecondMass<S>, inertia: S, count: f64) -> Self {
        let zero = S::constant(0.0);
        let far = match mass.coupling {
            Coupling::Shaft { compliance, damping_ratio } => {
                Far::Shaft(Twist::new(mass.share, compliance, damping_ratio, inertia))
            }
            Coupling::Gap { width, contact_time, load_damping, .. } if contact_time.re() <= 0.0 => {
                Far::Gap(Flight::new(width, load_damping))
            }
            Coupling::Gap { width, contact_time, damping_ratio, load_damping } => {
                let numbers = [mass.share, width, contact_time, damping_ratio, load_damping];
                Far::Yielding(Box::new(Bounce::new(numbers, count)))
            }
        };
        Self { share: mass.share, mass: far, ahead: zero, held: zero }
    }

    /// Goes through a sample at whose end the motor has this acceleration and velocity, and a rigid
    /// contact has `held` the motor or not; gives how far the centre of mass is then ahead of the motor.
    pub fn advance(&mut self, acceleration: S, velocity: S, span: f64, held: bool) -> S {
        let (before, speed) = self.mass.state();
        self.mass.advance(acceleration, velocity, span);
        let (after, left) = self.mass.state();
        if held && matches!(self.mass, Far::Shaft(_)) {
            self.ahead += (self.share * speed + self.held) * span;
            self.held += self.share * (speed - left);
        } else {
            self.ahead += self.share * (after - before) + self.held * span;
        }
        self.ahead
    }
}

impl<S: Scalar> Beyond<S> {
    /// What friction of its own takes from the second mass, per inertia of both.
    pub fn slowing(&self, velocity: S) -> S {
        self.share
            * match &self.mass {
                Far::Shaft(_) => return S::constant(0.0),
                Far::Gap(flight) => flight.slowing(velocity),
                Far::Yielding(bounce) => bounce.slowing(velocity),
            }
    }
}

impl<S: Scalar> Far<S> {
    #[inline]
    fn advance(&mut self, acceleration: S, velocity: S, span: f64) {
        match self {
            Self::Shaft(twist) => twist.advance(acceleration, span),
            Self::Gap(flight) => flight.advance(acceleration, velocity, span),
            Self::Yielding(bounce) => bounce.advance(acceleration, velocity, span),
        }
    }

    /// How far it is ahead, and how fast it gets there.
    #[inline]
    fn state(&self) -> (S, S) {
        match self {
            Self::Shaft(twist) => (twist.ahead, twist.rate),
            Self::Gap(flight) => (flight.ahead, flight.rate),
            Self::Yielding(bounce) => bounce.state(),
        }
    }
}

/// How far a second mass is ahead of a motor whose motion is given.
///
/// e'' + 2·ζ·ω·e' + ω²·e = −x'' with ω² = 1/μ, μ = c·s·J, solved exactly for an acceleration that
/// changes linearly over a sample. As μ → 0 that goes over into e = −μ·x'' without a seam, which is
/// what its derivative at a rigid shaft is taken from.
#[derive(Debug, Clone, Copy)]
struct Twist<S> {
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
    fn new(share: S, compliance: S, damping_ratio: S, inertia: S) -> Self {
        let zero = S::constant(0.0);
        Self {
            square: compliance * share * inertia,
            ratio: damping_ratio * (-(share - 1.0)).sqrt(),
            ahead: zero,
            rate: zero,
            before: zero,
        }
    }

    /// As [`Flight::advance`].
    fn advance(&mut self, acceleration: S, span: f64) {
        let (from, to) = (self.before, acceleration);
        self.before = to;
        if self.square.re() <= 0.0 {
            self.ahead = -(self.square * to);
            return;
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
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::Dual;

    const SHARE: f64 = 0.4;
    const INERTIA: f64 = 0.01;

    fn twist<S: Scalar>(compliance: S) -> Twist<S> {
        let constant = S::constant;
        Twist::new(constant(SHARE), compliance, constant(0.05), constant(INERTIA))
    }

    #[test]
    fn the_end_of_a_gap_pushes_and_never_pulls() {
        let coupling =
            Coupling::Gap { width: 2e-3, contact_time: 0.0, damping_ratio: 0.5, load_damping: 0.0 };
        let mass = SecondMass { share: SHARE, coupling };
        let stop = Shaft::new(&mass, INERTIA).unwrap();
        assert_eq!(stop.pull(0.9e-3, 5.0), 0.0);
        assert!(stop.pull(1.1e-3, 0.0) > 0.0 && stop.pull(-1.1e-3, 0.0) < 0.0);
        assert_eq!(stop.pull(1.1e-3, -5.0), 0.0);
        assert!(Shaft::new(&SecondMass { share: 0.0, ..mass }, INERTIA).is_none());
        // T = k·d + c·d' with k = s·J/t² and c = 2·ζ·√(k·s·(1 − s)·J).
        let (contact_time, damping_ratio) = (1.5e-3, 0.3);
        let coupling =
            Coupling::Gap { width: 2e-3, contact_time, damping_ratio, load_damping: 0.4 };
        let yielding = Shaft::new(&SecondMass { share: SHARE, coupling }, INERTIA).unwrap();
        let stiffness = SHARE * INERTIA / (contact_time * contact_time);
        let damping = 2.0 * damping_ratio * (stiffness * SHARE * (1.0 - SHARE) * INERTIA).sqrt();
        let expected = stiffness * 0.2e-3 + damping * 0.01;
        assert!((yielding.pull(1.2e-3, 0.01) - expected).abs() < 1e-12 * expected);
        assert!((yielding.pull(-1.2e-3, -0.01) + expected).abs() < 1e-12 * expected);
        assert_eq!(yielding.pull(1.2e-3, -1.0), 0.0);
        assert_eq!(yielding.load_damping, 0.4);
    }

    #[test]
    fn a_steady_wave_twists_the_shaft_as_its_response_says() {
        // y/x = (1 + 2ζi·r)/(1 − r² + 2ζi·r), r = w/ω; e = y − x.
        let (dt, w) = (1e-4, 90.0_f64);
        for frequency in [30.0, 80.0, 4000.0] {
            let omega = 2.0 * std::f64::consts::PI * frequency;
            let compliance = 1.0 / (omega * omega * SHARE * INERTIA);
            let mut shaft = twist(compliance);
            let (r, z) = (w / omega, 0.05 * (1.0 - SHARE).sqrt());
            // e = r²/(1 − r² + 2ζr·i)·x
            let (a, b) = (1.0 - r * r, 2.0 * z * r);
            let size = r * r / (a * a + b * b);
            let mut worst: f64 = 0.0;
            for k in 1..60_000 {
                let t = f64::from(k) * dt;
                shaft.advance(-w * w * (w * t).sin(), dt);
                let exact = size * (a * (w * t).sin() - b * (w * t).cos());
                if t > 5.0 {
                    worst = worst.max((shaft.ahead - exact).abs() / (size * a.hypot(b)));
                }
            }
            assert!(worst < 2e-3, "{frequency} Hz: {worst}");
        }
    }

    #[test]
    fn a_rigid_shaft_shows_the_derivative_by_its_compliance() {
        let mut rigid = twist(Dual::variable(0.0, 0));
        let small = 1e-9;
        let mut soft = twist(small);
        for k in 1..2000 {
            let acceleration = (f64::from(k) * 0.02).sin();
            rigid.advance(Dual::constant(acceleration), 1e-3);
            soft.advance(acceleration, 1e-3);
            let (exact, chord) = (rigid.ahead, soft.ahead / small);
            assert_eq!(exact.re(), 0.0);
            let gone = -SHARE * INERTIA;
            assert!((Scalar::partial(exact, 0) - gone * acceleration).abs() < 1e-15);
            assert!((chord - gone * acceleration).abs() < 2e-2 * gone.abs(), "{k}");
        }
    }

    #[test]
    fn what_a_mass_does_behind_a_motor_at_rest_is_nobodys_effort() {
        // Evenly braked, then held: the shaft rings on, and its centre of mass counts as going on
        // as it went. Off again, it goes with the shaft as if there had been no rest.
        let (dt, braking) = (1e-3, -3.0);
        let mass = SecondMass {
            share: SHARE,
            coupling: Coupling::Shaft { compliance: 1e-3, damping_ratio: 0.05 },
        };
        let mut beyond = Beyond::new(&mass, INERTIA, 0.0);
        let mut bare = twist(1e-3);
        let mut both = |acceleration, held| {
            bare.advance(acceleration, dt);
            (beyond.advance(acceleration, 0.0, dt, held), SHARE * bare.ahead, SHARE * bare.rate)
        };
        let mut steady = (0.0, 0.0, 0.0);
        for _ in 0..2000 {
            steady = both(braking, false);
        }
        // e = −μ·x''
        assert!((steady.0 - 1e-3 * SHARE * SHARE * INERTIA * -braking).abs() < 1e-9);
        let mut rests = steady;
        for _ in 0..30 {
            rests = both(0.0, true);
            assert!((rests.0 - steady.0).abs() < 1e-9);
        }
        let (from, rate) = (rests.1, rests.2);
        let mut rang = 0.0_f64;
        for k in 1..100 {
            let (ahead, there, _) = both(2.0, false);
            let expected = there - from - rate * f64::from(k) * dt;
            assert!((ahead - rests.0 - expected).abs() < 1e-9, "{k}: {ahead} {expected}");
            rang = rang.max(expected.abs());
        }
        assert!(rang > 1e-6);
    }
}
