//! Plastic module: creep that work hardening stops.
//!
//! h' = α·(f(|σ|) − h) where f(|σ|) > h, else 0;  x_p' = sgn(σ)·h';  f(s) = c·s^n, n > 1.
//! (Hsieh & Pan, Wear 242 (2000), §2.2.3 and §3.1: the behaviour is stated, the form of f is a
//! reconstruction.)

use crate::scalar::{Scalar, sign};

/// Parameters of the plastic module.
#[derive(Debug, Clone, Copy)]
pub struct Plastic<S> {
    /// c of f(s) = c·s^n.
    pub coefficient: S,
    /// n of f(s) = c·s^n.
    pub exponent: S,
    /// α.
    pub rate: S,
}

/// Hardening gained over a step, and how it depends on the displacement imposed.
#[derive(Debug, Clone, Copy)]
pub struct Creep<S> {
    /// Δh ≥ 0.
    pub hardening: S,
    /// Δx_p = sgn(σ)·Δh.
    pub displacement: S,
    /// ∂Δx_p/∂Δx at fixed duration.
    pub share: S,
}

impl<S: Scalar> Plastic<S> {
    /// Greatest hardening that a force of this magnitude can cause.
    #[inline]
    pub fn limit(&self, force: S) -> S {
        self.coefficient * force.power_of_magnitude(self.exponent)
    }

    /// Creep while the ends of the series are displaced by `displacement` over `duration`.
    ///
    /// `force` and `stiffness` are those of the spring at the start. With y = f − h and the spring
    /// linear over the step, y' = f'·k·s·x' − λ·y, λ = α·(1 + f'·k): the creep unloads the spring.
    /// That is solved exactly, so the result is stable for any duration.
    #[inline]
    pub fn creep(
        &self,
        hardening: S,
        force: S,
        stiffness: S,
        displacement: S,
        duration: S,
    ) -> Creep<S> {
        let zero = S::constant(0.0);
        let none = Creep { hardening: zero, displacement: zero, share: zero };
        let s = sign(force.re());
        if s == 0.0 || self.coefficient.re() == 0.0 || duration.re() <= 0.0 {
            return none;
        }
        let limit = self.limit(force);
        let margin = limit - hardening;
        // f'·k: the limit that a unit of spring elongation adds.
        let gain = self.exponent * limit / (force * s) * stiffness;
        let rate = self.rate * (gain + 1.0);
        let rise = gain * displacement * s / duration;
        let (start, left) = if margin.re() > 0.0 {
            (margin, duration)
        } else {
            // The limit overtakes the hardening inside the step or not at all.
            if (margin + rise * duration).re() <= 0.0 {
                return none;
            }
            (zero, duration + margin / rise)
        };
        let gone = -((-(rate * left)).exp_m1());
        // ∫(1 − e^(−λt))dt; below 1e-4 the difference loses digits and the series is exact to 1e-9.
        let z = rate * left;
        let lagged =
            if z.re() < 1e-4 { left * z * 0.5 * (-(z / 3.0 - 1.0)) } else { left - gone / rate };
        let gained = (start * gone + rise * lagged) * self.rate / rate;
        if gained.re() <= 0.0 {
            return none;
        }
        let by_rise = if margin.re() > 0.0 {
            lagged
        } else {
            // The later the onset, the shorter the creep: ∂left/∂rise = −margin/rise².
            lagged - gone * margin / rise
        };
        let share = by_rise * gain * self.rate / (rate * duration);
        Creep { hardening: gained, displacement: gained * s, share }
    }

    /// Creep rate h' at this hardening and force.
    #[inline]
    pub fn hardening_rate(&self, hardening: S, force: S) -> S {
        let margin = self.limit(force) - hardening;
        if margin.re() > 0.0 { self.rate * margin } else { S::constant(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODULE: Plastic<f64> = Plastic { coefficient: 1.6e-3, exponent: 2.0, rate: 2.0 };

    #[test]
    fn creep_under_constant_force_slows_and_stops() {
        let (mut h, dt) = (0.0, 1e-3);
        for k in 0..4000 {
            let exact = 1.6e-3 * 0.04 * (1.0 - (-2.0 * f64::from(k) * dt).exp());
            assert!((h - exact).abs() < 1e-15);
            h += MODULE.creep(h, 0.2, 0.0, 0.0, dt).hardening;
        }
        assert_eq!(MODULE.creep(1.0, 0.2, 0.0, 0.0, dt).hardening, 0.0);
    }

    #[test]
    fn share_is_the_derivative_by_the_displacement() {
        for hardening in [0.0, 5e-5, 6.5e-5] {
            for displacement in [1e-6, 2e-5, -1e-6] {
                for duration in [1e-5, 1e-3, 0.3] {
                    let at = |d: f64| MODULE.creep(hardening, 0.2, 2500.0, d, duration);
                    let step = displacement.abs() * 1e-4;
                    let chord = (at(displacement + step).displacement
                        - at(displacement - step).displacement)
                        / (2.0 * step);
                    assert!(
                        (at(displacement).share - chord).abs() < 1e-6 * (chord.abs() + 1e-6),
                        "{hardening} {displacement} {duration}: {} {chord}",
                        at(displacement).share
                    );
                }
            }
        }
    }

    #[test]
    fn a_long_step_is_stable() {
        let gained = MODULE.creep(0.0, 0.4, 3000.0, 0.0, 1e6).hardening;
        assert!(gained > 0.0 && gained < MODULE.limit(0.4));
    }
}
