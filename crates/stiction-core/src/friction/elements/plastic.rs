//! Plastic module: creep that work hardening stops.
//!
//! h' = α·(f(|σ|) − h) where f(|σ|) > h, else 0;  x_p' = sgn(σ)·h';  f(s) = c·s^n, n > 1.
//! (Hsieh & Pan, Wear 242 (2000), §2.2.3 and §3.1: the behaviour is stated, the form of f is a
//! reconstruction.)

use crate::math::logarithm::logarithm;
use crate::math::scalar::{COLUMNS, SHORTER, Scalar, logarithmic_mean, second_share, sign};

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
    /// What is left to the spring, Δx − Δx_p.
    pub left: S,
    /// ∂Δx_p/∂Δx at fixed duration.
    pub share: S,
}

/// What steps of one duration have in common.
#[derive(Debug, Clone, Copy)]
pub struct Pacing<S> {
    /// α·T.
    progress: S,
    /// 2·c, and α·T times that.
    doubled: f64,
    pace: S,
    /// Whether nothing can creep.
    still: bool,
    /// Whether f is a plain square, which costs no power.
    square: bool,
}

impl<S: Scalar> Plastic<S> {
    /// Greatest hardening that a force of this magnitude can cause.
    #[inline(always)]
    pub fn limit(&self, force: S) -> S {
        self.limit_and_power(force).0
    }

    /// The same, and |σ|^(n−1), of which its slope is a multiple: a quotient would be waited for.
    #[inline(always)]
    fn limit_and_power(&self, force: S) -> (S, S) {
        let power = force.power_of_magnitude(self.exponent - 1.0);
        (self.coefficient * (power * force.abs()), power)
    }

    /// Slope of that limit by the magnitude of the force; 0 at no force, as f'(0) = 0.
    #[inline(always)]
    pub fn limit_slope(&self, force: S) -> S {
        if force.re() == 0.0 {
            return S::constant(0.0);
        }
        let size = force * sign(force.re());
        if self.exponent.re() == 2.0 {
            // The same value whether or not the exponent is seeded.
            let slope = self.coefficient * 2.0 * size;
            if self.is_square() {
                return slope;
            }
            return slope + self.beyond_square(size.re());
        }
        self.slope_of(self.limit_and_power(force).1)
    }

    /// The same from |σ|^(n−1), which may cost a power.
    #[inline(always)]
    fn slope_of(&self, power: S) -> S {
        self.exponent * self.coefficient * power
    }

    /// What a seeded exponent of 2 adds to that slope: a derivative, and the value is 0.
    #[inline(always)] // rows that a function of its own leaves in short vectors are waited for
    fn beyond_square(&self, size: f64) -> S {
        (self.exponent - 2.0) * (self.coefficient.re() * size * (logarithm(size) * 2.0 + 1.0))
    }

    /// Whether f is a plain square, which costs no power.
    #[inline(always)]
    pub fn is_square(&self) -> bool {
        self.exponent.re() == 2.0 && !self.exponent.derivative_is_nonzero()
    }

    /// Creep while the ends of the series are displaced by `displacement` over `duration`.
    ///
    /// `force` is that of the spring at the start and `stiffness` its slope in a direction of its
    /// own motion. With y = f − h and the spring linear over the step,
    /// y' = f'·k·s·x' − λ·y, λ = α·(1 + f'·k): the creep unloads the spring. That is solved
    /// exactly, so the result is stable for any duration:
    /// Δh = α·T·(y₀·φ₁(λT) + f'·k·s·x'·T·φ₂(λT)).
    #[inline(always)]
    pub fn creep(
        &self,
        hardening: S,
        force: S,
        stiffness: impl Fn(f64) -> S,
        displacement: S,
        duration: S,
    ) -> Creep<S> {
        let pacing = self.pacing(duration);
        let plain = self.plain_creep::<false>(hardening, force, &stiffness, displacement, &pacing);
        match plain {
            Some(creep) => creep,
            None => self.any_creep(hardening, force, stiffness, displacement, duration),
        }
    }

    /// What steps of this duration have in common.
    #[inline(always)]
    pub fn pacing(&self, duration: S) -> Pacing<S> {
        let progress = self.rate * duration;
        let doubled = self.coefficient * 2.0;
        let off = self.coefficient.re() == 0.0 && !self.coefficient.derivative_is_nonzero();
        let still = off || duration.re() <= 0.0;
        let square = self.is_square();
        Pacing { progress, doubled: doubled.re(), pace: progress * doubled, still, square }
    }

    /// The same where creep goes on through a short step or has none: nearly every one. `SQUARE`
    /// promises [`Self::is_square`].
    #[inline(always)]
    pub fn plain_creep<const SQUARE: bool>(
        &self,
        hardening: S,
        force: S,
        stiffness: impl Fn(f64) -> S,
        displacement: S,
        pacing: &Pacing<S>,
    ) -> Option<Creep<S>> {
        let zero = S::constant(0.0);
        let none = Creep { hardening: zero, displacement: zero, left: displacement, share: zero };
        if force.re() == 0.0 || pacing.still {
            return Some(none);
        }
        let s = 1.0_f64.copysign(force.re());
        let (limit, power) = if SQUARE {
            (self.coefficient * (force * force), zero)
        } else {
            self.limit_and_power(force)
        };
        let margin = limit - hardening;
        let starts = self.sign_of(margin) > 0.0;
        let progress = pacing.progress;
        // What would be gained under a held force, to first order.
        let held = if starts { progress * margin } else { zero };
        // Creep that outruns the displacement takes the spring back, onto its steepest branch.
        let net = displacement.re() - s * held.re();
        let stiffness = stiffness(if net == 0.0 { -s } else { sign(net) });
        // f'·k, the limit that a unit of spring elongation adds, and α·T times that.
        let (gain, pace) = if SQUARE || self.exponent.re() == 2.0 {
            let size = force.abs();
            let mut pace = pacing.pace * size * stiffness;
            if !SQUARE && !pacing.square {
                pace += self.beyond_square(size.re()) * (progress.re() * stiffness.re());
            }
            (pacing.doubled * size.re() * stiffness.re(), pace)
        } else {
            let gain = self.slope_of(power) * stiffness;
            (gain.re(), progress * gain)
        };
        // By how much the displacement raises the limit.
        let risen = gain * (displacement.re() * s);
        if !starts {
            // The limit overtakes the hardening inside the step or not at all.
            let overtakes = risen > 0.0 && margin.re() + risen > 0.0;
            return if overtakes { None } else { Some(none) };
        }
        let z = progress + pace;
        if z.re() >= SHORTER {
            return None;
        }
        let second = second_share(z);
        if risen < 0.0 {
            let mean = 1.0 - z.re() * second.re();
            if margin.re() * (1.0 - z.re() * mean) + risen * mean < 0.0 {
                return None;
            }
        }
        // Written so that what waits longest, φ₂, comes in last.
        let lagged = second * (held * s * z - pace * displacement);
        let gained = held - lagged * s;
        let left = (displacement - held * s) + lagged;
        Some(Creep { hardening: gained, displacement: gained * s, left, share: pace * second })
    }

    /// Any creep but none.
    #[inline(never)]
    fn any_creep(
        &self,
        hardening: S,
        force: S,
        stiffness: impl Fn(f64) -> S,
        displacement: S,
        duration: S,
    ) -> Creep<S> {
        let zero = S::constant(0.0);
        let s = sign(force.re());
        let margin = self.limit(force) - hardening;
        let starts = self.sign_of(margin) > 0.0;
        let progress = self.rate * duration;
        let held = if starts { progress * margin } else { zero };
        let net = displacement.re() - s * held.re();
        let stiffness = stiffness(if net == 0.0 { -s } else { sign(net) });
        let gain = self.limit_slope(force) * stiffness;
        let z = progress + progress * gain;
        if !starts {
            return self.overtaken(margin, z, gain, displacement, duration, s);
        }
        let risen = gain * (displacement * s);
        let (mean, second) = exponential_means(z);
        let at_end = margin.re() * (1.0 - z.re() * mean.re()) + risen.re() * mean.re();
        if risen.re() < 0.0 && at_end < 0.0 {
            return self.outrun(margin, z, gain, displacement, duration, s);
        }
        let gained = held * mean + progress * risen * second;
        let displaced = gained * s;
        let share = gain * progress * second;
        Creep { hardening: gained, displacement: displaced, left: displacement - displaced, share }
    }

    /// Creep that begins inside the step, where the limit overtakes the hardening.
    fn overtaken(
        &self,
        margin: S,
        z: S,
        gain: S,
        displacement: S,
        duration: S,
        s: f64,
    ) -> Creep<S> {
        let rise = gain * displacement * s / duration;
        let left = duration + margin / rise;
        let (mean, second) = exponential_means(z / duration * left);
        let lagged = left * left * second;
        // The later the onset, the shorter the creep: ∂left/∂rise = −margin/rise².
        let by_rise = lagged - left * mean * margin / rise;
        self.partly(rise * lagged, by_rise, gain, displacement, duration, s)
    }

    /// Creep that ends inside the step, where unloading takes the limit below the hardening.
    fn outrun(&self, margin: S, z: S, gain: S, displacement: S, duration: S, s: f64) -> Creep<S> {
        let rise = gain * displacement * s / duration;
        let rate = z / duration;
        let left = -(margin / rise) * logarithmic_mean(rate * margin / rise);
        let (mean, second) = exponential_means(rate * left);
        let lagged = left * left * second;
        self.partly(margin * left * mean + rise * lagged, lagged, gain, displacement, duration, s)
    }

    fn partly(
        &self,
        gained: S,
        by_rise: S,
        gain: S,
        displacement: S,
        duration: S,
        s: f64,
    ) -> Creep<S> {
        let hardening = gained * self.rate;
        let displaced = hardening * s;
        let share = by_rise * gain * self.rate / duration;
        Creep { hardening, displacement: displaced, left: displacement - displaced, share }
    }

    /// Sign of a quantity that vanishes with the coefficient: where that is 0, the sign it takes
    /// as soon as the coefficient is above 0, so that derivatives see what switching it on does.
    #[inline(always)]
    fn sign_of(&self, quantity: S) -> f64 {
        if self.coefficient.re() != 0.0 {
            return sign(quantity.re());
        }
        let own = (0..COLUMNS).find(|k| self.coefficient.partial(*k) != 0.0);
        own.map_or(0.0, |k| sign(quantity.partial(k) * self.coefficient.partial(k)))
    }

    /// Creep rate h' at this hardening and force.
    #[inline(always)]
    pub fn hardening_rate(&self, hardening: S, force: S) -> S {
        let margin = self.limit(force) - hardening;
        if margin.re() > 0.0 { self.rate * margin } else { S::constant(0.0) }
    }
}

/// φ₁(z) = (1 − e^(−z))/z and φ₂(z) = (1 − φ₁)/z.
#[inline(always)]
fn exponential_means<S: Scalar>(z: S) -> (S, S) {
    if z.re() < SHORTER {
        let second = second_share(z);
        return (-(z * second - 1.0), second);
    }
    let mean = -((-z).exp_m1()) / z;
    (mean, -(mean - 1.0) / z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::Dual;

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
        let (a, b) = exponential_means(SHORTER - 1e-12);
        let (c, d) = exponential_means(SHORTER + 1e-12);
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
