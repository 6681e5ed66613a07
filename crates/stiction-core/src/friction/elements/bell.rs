//! Levels that fall with speed as a bell does, side by side.

use crate::math::exponential::fading;
use crate::math::row::Row;

/// F_c + (F_s − F_c)·e^(−(v/v_s)²), one in each lane: [`super::stribeck::SlidingLevel`] with δ = 2.
#[derive(Debug, Clone, Default)]
pub struct Bells {
    coulomb: Row,
    excess: Row,
    per_velocity: Row,
}

impl Bells {
    /// Takes F_c, F_s − F_c and v_s.
    pub fn fit(&mut self, lane: usize, [coulomb, excess, velocity]: [f64; 3]) {
        self.coulomb.0[lane] = coulomb;
        self.excess.0[lane] = excess;
        self.per_velocity.0[lane] = 1.0 / velocity;
    }

    /// The level and its slope by speed |v|.
    #[inline(always)]
    pub fn at(&self, lane: usize, velocity: f64) -> (f64, f64) {
        let excess = self.excess.0[lane];
        let share = velocity * self.per_velocity.0[lane];
        let power = share * share;
        let left = fading(-power);
        let fall = -(left * (2.0 * power / velocity.abs()));
        let flat = (velocity == 0.0) | (excess == 0.0);
        (self.coulomb.0[lane] + excess * left, if flat { 0.0 } else { excess * fall })
    }
}
