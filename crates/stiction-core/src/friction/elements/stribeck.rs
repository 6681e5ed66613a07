//! The fall of friction with speed that several laws share.

use crate::math::exponential::{fading_of, fading_within};
use crate::math::scalar::Scalar;
use crate::support::error::{Error, Result};

/// e^(−|v/v_s|^δ) and its slope by speed |v|; the slope is taken as 0 at v = 0, where it is not
/// defined for δ ≤ 1.
///
/// Source: Bo, Pavelescu, Wear 82 (1982).
#[inline(always)]
pub fn fall<S: Scalar>(velocity: S, stribeck_velocity: S, exponent: S) -> (S, S) {
    let power = fall_power(velocity, stribeck_velocity, exponent);
    let left = fading_of(-power);
    (left, fall_slope(velocity, exponent, power, left))
}

/// |v/v_s|^δ.
#[inline(always)]
pub fn fall_power<S: Scalar>(velocity: S, stribeck_velocity: S, exponent: S) -> S {
    fall_power_by(velocity, S::constant(1.0) / stribeck_velocity, exponent)
}

/// The same with 1/v_s known.
#[inline(always)]
pub fn fall_power_by<S: Scalar>(velocity: S, per_velocity: S, exponent: S) -> S {
    (velocity * per_velocity).power_of_magnitude(exponent)
}

/// The slope of [`fall`], of which `left` is what is left at this power.
#[inline(always)]
pub fn fall_slope<S: Scalar>(velocity: S, exponent: S, power: S, left: S) -> S {
    if velocity.re() == 0.0 {
        return S::constant(0.0);
    }
    // The quotient waits for no exponential.
    -(left * (exponent * power / velocity.abs()))
}

/// About the steepest fall by speed of `excess` times that: sets how far a step may reach.
pub fn steepest(excess: f64, stribeck_velocity: f64, exponent: f64) -> f64 {
    excess / stribeck_velocity * exponent.max(1.0)
}

/// Friction of steady sliding without its viscous part: g(v) = F_c + (F_s − F_c)·e^(−|v/v_s|^δ).
#[derive(Debug, Clone, Copy)]
pub struct SlidingLevel<S> {
    /// F_c.
    pub coulomb: S,
    /// F_s − F_c.
    excess: S,
    velocity: S,
    exponent: S,
    falls: bool,
}

impl<S: Scalar> SlidingLevel<S> {
    /// The level with these F_c, F_s, v_s and δ.
    pub fn new(coulomb: S, breakaway: S, velocity: S, exponent: S) -> Self {
        let excess = breakaway - coulomb;
        // A gradient by F_s is asked for at F_s = F_c as well, hence the second condition.
        let falls = excess.re() != 0.0 || excess.derivative_is_nonzero();
        Self { coulomb, excess, velocity, exponent, falls }
    }

    /// g and its slope by speed |v|.
    #[inline(always)]
    pub fn at(&self, velocity: S) -> (S, S) {
        self.at_by(velocity, fading_of)
    }

    /// [`Self::at`] as part of the loop that asks for it.
    #[inline(always)]
    pub fn at_within(&self, velocity: S) -> (S, S) {
        self.at_by(velocity, fading_within)
    }

    #[inline(always)]
    fn at_by(&self, velocity: S, fading: impl Fn(S) -> S) -> (S, S) {
        if !self.falls {
            return (self.coulomb, S::constant(0.0));
        }
        let power = fall_power(velocity, self.velocity, self.exponent);
        let left = fading(-power);
        let steepness = fall_slope(velocity, self.exponent, power, left);
        (self.coulomb + self.excess * left, self.excess * steepness)
    }

    /// F_c, F_s − F_c and v_s where the fall is a bell, or where there is none.
    pub fn bell(&self) -> Option<[f64; 3]> {
        let bell = !self.falls || self.exponent.re() == 2.0;
        bell.then(|| [self.coulomb, self.excess, self.velocity].map(Scalar::re))
    }

    /// F_s, the greatest.
    pub fn greatest(&self) -> S {
        self.coulomb + self.excess
    }

    /// About the steepest fall by speed.
    pub fn steepest_fall(&self) -> f64 {
        steepest(self.excess.re(), self.velocity.re(), self.exponent.re())
    }
}

/// Refuses F_c above F_s.
pub fn check_levels(coulomb: f64, breakaway: f64) -> Result<()> {
    if coulomb > breakaway {
        return Err(Error::Order {
            lesser: "coulomb".to_owned(),
            lesser_value: coulomb,
            relation: "not exceed",
            greater: "breakaway".to_owned(),
            greater_value: breakaway,
        });
    }
    Ok(())
}
