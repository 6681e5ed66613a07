//! Plastic module: creep that work hardening stops.
//!
//! h' = α·(f(|σ|) − h) where f(|σ|) > h, else 0;  x_p' = sgn(σ)·h';  f(s) = c·s^n, n > 1.
//! (Hsieh & Pan, Wear 242 (2000), §2.2.3 and §3.1: the behaviour is stated, the form of f is a
//! reconstruction.)

use crate::scalar::{COLUMNS, Scalar, logarithmic_mean, sign};

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

    /// Slope of that limit by the magnitude of the force; 0 at no force, as f'(0) = 0.
    #[inline]
    pub fn limit_slope(&self, force: S) -> S {
        if force.re() == 0.0 {
            return S::constant(0.0);
        }
        self.exponent * self.limit(force) / (force * sign(force.re()))
    }

    /// Creep while the ends of the series are displaced by `displacement` over `duration`.
    ///
    /// `force` is that of the spring at the start and `stiffness` its slope in a direction of its
    /// own motion. With y = f − h and the spring linear over the step,
    /// y' = f'·k·s·x' − λ·y, λ = α·(1 + f'·k): the creep unloads the spring. That is solved
    /// exactly, so the result is stable for any duration:
    /// Δh = α·T·(y₀·φ₁(λT) + f'·k·s·x'·T·φ₂(λT)).
    #[inline]
    pub fn creep(
        &self,
        hardening: S,
        force: S,
        stiffness: impl FnOnce(f64) -> S,
        displacement: S,
        duration: S,
    ) -> Creep<S> {
        let zero = S::constant(0.0);
        let none = Creep { hardening: zero, displacement: zero, share: zero };
        let s = sign(force.re());
        let off = self.coefficient.re() == 0.0 && !self.coefficient.derivative_is_nonzero();
        if s == 0.0 || off || duration.re() <= 0.0 {
            return none;
        }
        let limit = self.limit(force);
        let margin = limit - hardening;
        let starts = self.sign_of(margin) > 0.0;
        // Creep that outruns the displacement takes the spring back, onto its steepest branch.
        let creeping = if starts { self.rate * margin } else { zero };
        let net = displacement.re() / duration.re() - s * creeping.re();
        let stiffness = stiffness(if net == 0.0 { -s } else { sign(net) });
        // f'·k: the limit that a unit of spring elongation adds.
        let gain = self.limit_slope(force) * stiffness;
        let rate = self.rate * (gain + 1.0);
        let rise = gain * displacement * s / duration;
        let (start, left) = if starts {
            (margin, duration)
        } else {
            // The limit overtakes the hardening inside the step or not at all.
            if rise.re() <= 0.0 || (margin + rise * duration).re() <= 0.0 {
                return none;
            }
            (zero, duration + margin / rise)
        };
        let mut left = left;
        let mut means = exponential_means(rate * left);
        let at_end = start * (-(rate * left * means.0 - 1.0)) + rise * left * means.0;
        if starts && rise.re() < 0.0 && at_end.re() < 0.0 {
            // Unloading takes the limit below the hardening inside the step: creep ends there.
            left = -(start / rise) * logarithmic_mean(rate * start / rise);
            means = exponential_means(rate * left);
        }
        let (mean, second) = means;
        let lagged = left * left * second;
        let gained = (start * left * mean + rise * lagged) * self.rate;
        let by_rise = if starts {
            lagged
        } else {
            // The later the onset, the shorter the creep: ∂left/∂rise = −margin/rise².
            lagged - left * mean * margin / rise
        };
        let share = by_rise * gain * self.rate / duration;
        Creep { hardening: gained, displacement: gained * s, share }
    }

    /// Sign of a quantity that vanishes with the coefficient: where that is 0, the sign it takes
    /// as soon as the coefficient is above 0, so that derivatives see what switching it on does.
    #[inline]
    fn sign_of(&self, quantity: S) -> f64 {
        if self.coefficient.re() != 0.0 {
            return sign(quantity.re());
        }
        let own = (0..COLUMNS).find(|k| self.coefficient.partial(*k) != 0.0);
        own.map_or(0.0, |k| sign(quantity.partial(k) * self.coefficient.partial(k)))
    }

    /// Creep rate h' at this hardening and force.
    #[inline]
    pub fn hardening_rate(&self, hardening: S, force: S) -> S {
        let margin = self.limit(force) - hardening;
        if margin.re() > 0.0 { self.rate * margin } else { S::constant(0.0) }
    }
}

/// φ₁(z) = (1 − e^(−z))/z and φ₂(z) = (1 − φ₁)/z.
#[inline]
fn exponential_means<S: Scalar>(z: S) -> (S, S) {
    if z.re() < 0.02 {
        // Series: the next terms are below 1e-17.
        // 1/2 − z/6 + z²/24 − z³/120 + z⁴/720 − z⁵/5040 + z⁶/40320
        let mut second = S::constant(1.0 / 40320.0);
        for term in [-1.0 / 5040.0, 1.0 / 720.0, -1.0 / 120.0, 1.0 / 24.0, -1.0 / 6.0, 0.5] {
            second = second * z + term;
        }
        return (-(z * second - 1.0), second);
    }
    let mean = -((-z).exp_m1()) / z;
    (mean, -(mean - 1.0) / z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    const MODULE: Plastic<f64> = Plastic { coefficient: 1.6e-3, exponent: 2.0, rate: 2.0 };

    #[test]
    fn creep_under_constant_force_slows_and_stops() {
        let (mut h, dt) = (0.0, 1e-3);
        for k in 0..4000 {
            let exact = 1.6e-3 * 0.04 * (1.0 - (-2.0 * f64::from(k) * dt).exp());
            assert!((h - exact).abs() < 1e-15);
            h += MODULE.creep(h, 0.2, |_| 0.0, 0.0, dt).hardening;
        }
        assert_eq!(MODULE.creep(1.0, 0.2, |_| 0.0, 0.0, dt).hardening, 0.0);
    }

    #[test]
    fn share_is_the_derivative_by_the_displacement() {
        for hardening in [0.0, 5e-5, 6.5e-5] {
            for displacement in [1e-6, 2e-5, -1e-6] {
                for duration in [1e-5, 1e-3, 0.3] {
                    let at = |d: f64| MODULE.creep(hardening, 0.2, |_| 2500.0, d, duration);
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
    fn the_means_agree_where_series_and_formula_meet() {
        let (a, b) = exponential_means(0.02 - 1e-12);
        let (c, d) = exponential_means(0.02 + 1e-12);
        assert!((a - c).abs() < 1e-12 && (b - d).abs() < 2e-12);
    }

    #[test]
    fn a_rate_of_zero_creeps_nothing_and_keeps_its_derivative() {
        let module = Plastic {
            coefficient: Dual::constant(1.6e-3),
            exponent: Dual::constant(2.0),
            rate: Dual::variable(0.0, 0),
        };
        let (zero, dt) = (Dual::constant(0.0), Dual::constant(1e-3));
        let crept = module.creep(zero, Dual::constant(0.2), |_| zero, zero, dt).hardening;
        assert_eq!(crept.re(), 0.0);
        assert!((crept.partial(0) - 1.6e-3 * 0.04 * 1e-3).abs() < 1e-18);
    }

    #[test]
    fn a_long_step_is_stable() {
        let gained = MODULE.creep(0.0, 0.4, |_| 3000.0, 0.0, 1e6).hardening;
        assert!(gained > 0.0 && gained < MODULE.limit(0.4));
    }
}
