//! Friction that is an arsinh of speed, and its balance with the momentum of a body.
//!
//! F = d·z, v = 2·V·e^(−q)·sinh(z): linear in z where it is too steep to be written over v.

use crate::math::scalar::{Scalar, sign};

/// Above this argument of [`arcsinh_of_exp`] the square root is its square to the last bit.
const LARGE: f64 = 20.0;
/// Logarithm of a way, a creep or a momentum from which on friction holds nothing back.
const LOOSE: f64 = 100.0;
/// Newton steps of [`Balance::solve`] at most; five to eight are usual.
const MOST_STEPS: u32 = 60;

/// arsinh(e^x) and its slope; e^x itself may be far out of range.
#[inline]
pub fn arcsinh_of_exp<S: Scalar>(x: S) -> (S, S) {
    if x.re() > LARGE {
        return (x + std::f64::consts::LN_2, S::constant(1.0));
    }
    let z = x.re().exp();
    let slope = z / z.hypot(1.0);
    (x.chain(z.asinh(), slope), x.chain(slope, slope * (1.0 - slope * slope)))
}

/// 2·scale·e^(−exponent)·sinh(z), the speed at which friction is `z` times its direct effect.
#[inline]
pub fn velocity_of<S: Scalar>(z: S, scale: S, exponent: S) -> S {
    if z.re().abs() < 1.0 {
        return scale * 2.0 * (-exponent).exp() * z.chain(z.re().sinh(), z.re().cosh());
    }
    scale * ((z - exponent).exp() - (-z - exponent).exp())
}

/// Momentum and friction over a step of duration h: J·(v₁ − v₀) = h·(E − F̄).
///
/// In units of h·d that is heavy·v₁ + mean(z₁) = wanted with
/// mean = z₁ − w·δ/√(1 + δ²/4),  δ = z₁ − z₀,  w = ½·heavy·|v₁|/(1 + heavy·|v₁|):
/// the trapezoidal rule for a small change, the mean of a logarithm for a start from rest, and the
/// end of the step alone where friction is stiff, so that a stop ends at rest and does not ring.
/// The left side rises with z₁ everywhere: there is one solution.
#[derive(Debug, Clone, Copy)]
pub struct Balance<S> {
    /// Inertia over h·d.
    pub heavy: S,
    /// Impulse without friction over h·d.
    pub wanted: S,
    /// z at the start of the step.
    pub old: S,
    /// V.
    pub scale: S,
    /// q.
    pub exponent: S,
}

impl<S: Scalar> Balance<S> {
    /// z and the velocity at the end of the step.
    pub fn solve(&self) -> (S, S) {
        if (self.heavy * self.scale).re().ln() - self.exponent.re() > LOOSE {
            // So little friction that the body does not feel it.
            return (S::constant(0.0), self.wanted / self.heavy);
        }
        let z = self.root();
        let (by_friction, mean) = self.shares(z);
        // The same number from the momentum, which keeps more digits of a fast motion.
        let fast = (self.heavy * by_friction).re().abs() > 1.0;
        (z, if fast { (self.wanted - mean) / self.heavy } else { by_friction })
    }

    /// The velocity and the mean friction that z at the end of a step means.
    #[inline]
    fn shares(&self, z: S) -> (S, S) {
        let velocity = velocity_of(z, self.scale, self.exponent);
        let momentum = (self.heavy * velocity).abs();
        let weight = momentum / (momentum + 1.0) * 0.5;
        let change = z - self.old;
        (velocity, z - weight * change / (change * change * 0.25 + 1.0).sqrt())
    }

    fn excess(&self, z: S) -> S {
        let (velocity, mean) = self.shares(z);
        self.heavy * velocity + mean - self.wanted
    }

    fn root(&self) -> S {
        // On real parts, within a bracket: the mean lies within 1 of z, and momentum alone would do
        // from `inertial` on.
        let wanted = self.wanted.re();
        let side = sign(wanted);
        let reach = wanted.abs() + 1.0;
        let inertial = (reach / (self.heavy * self.scale * 2.0).re()).ln() + self.exponent.re();
        let (mut low, mut high) = (0.0, arcsinh_of_exp(inertial).0.min(reach));
        let mut z = if side == 0.0 { 0.0 } else { high };
        for _ in 0..MOST_STEPS {
            let there = side * self.excess(S::constant(side * z)).re();
            if there == 0.0 {
                break;
            }
            if there > 0.0 {
                high = z;
            } else {
                low = z;
            }
            let newton = z - there / self.steepness(side * z);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let moved = (next - z).abs();
            z = next;
            if moved <= 1e-15 * z || high - low <= 1e-15 * high {
                break;
            }
        }
        // One step in the full number type carries the derivatives.
        let root = S::constant(side * z);
        root - self.excess(root) / self.steepness(side * z)
    }

    /// Slope of the left side by z.
    #[inline]
    fn steepness(&self, z: f64) -> f64 {
        let q = self.exponent.re();
        let heavy = (self.heavy * self.scale).re();
        let (forth, back) = ((z - q).exp(), (-z - q).exp());
        let momentum = heavy * (forth - back).abs();
        let by_momentum = heavy * (forth + back);
        let left = 1.0 / (1.0 + momentum);
        let change = z - self.old.re();
        let root = (1.0 + 0.25 * change * change).sqrt();
        let by_weight = 0.5 * by_momentum * sign(z) * left * left * change / root;
        let by_change = 0.5 * momentum * left / (root * root * root);
        by_momentum + 1.0 - by_weight - by_change
    }
}

/// A spring in series with friction that is an arsinh of the speed of slip: over a displacement u·t
/// A·dz/dt = u − v(z), in units of A = d/k.
#[derive(Debug, Clone, Copy)]
pub struct Series<S> {
    /// u·t/A, not negative.
    pub way: S,
    /// V·t/A.
    pub creep: S,
    /// q.
    pub exponent: S,
}

impl<S: Scalar> Series<S> {
    /// z at the end, and the share of a change of q over the step that counts.
    ///
    /// In e^z that is Riccati's equation with constant coefficients; solved in logarithms.
    pub fn advance(&self, z: S) -> (S, S) {
        // What z tends to: arsinh(u/(2·V·e^(−q))).
        let goal = if self.way.re() > 0.0 {
            arcsinh_of_exp((self.way / (self.creep * 2.0)).ln() + self.exponent).0
        } else {
            S::constant(0.0)
        };
        if self.creep.re().ln() - self.exponent.re() > LOOSE || self.way.re().ln() > LOOSE {
            return (goal, S::constant(1.0));
        }
        let slow = (-self.exponent).exp() * self.creep;
        let whole = (self.way * self.way + slow * slow * 4.0).sqrt();
        let decay = whole.re();
        if decay <= 0.0 {
            return (z + self.way, S::constant(0.5));
        }
        let left = (-whole).exp();
        let gone = -(-whole).exp_m1();
        let below = z - goal;
        let beyond = goal * -2.0;
        let small = left * beyond.exp();
        // ln(e^x + e^y) is x + raised(y − x): the first x is written into z, or digits would go.
        let grown = small.chain(small.re().ln_1p(), 1.0 / (1.0 + small.re()));
        let over = grown + raised(beyond + gone.ln() - below - grown);
        let under = raised(beyond + whole) - whole;
        let under = under + raised(below + gone.ln() - under);
        (z + over - under, late_share(whole))
    }
}

/// ln(1 + e^x).
#[inline]
fn raised<S: Scalar>(x: S) -> S {
    let share = (-x.re().abs()).exp();
    let slope = if x.re() > 0.0 { 1.0 } else { share } / (1.0 + share);
    x.chain(x.re().max(0.0) + share.ln_1p(), slope)
}

/// 1/(1 − e^(−x)) − 1/x: of a target that changes evenly, what a follower at rate x has seen.
#[inline]
fn late_share<S: Scalar>(x: S) -> S {
    let w = x.re();
    if w < 1e-2 {
        return x.chain(0.5 + w / 12.0, 1.0 / 12.0 - w * w / 240.0);
    }
    let gone = -(-w).exp_m1();
    x.chain(1.0 / gone - 1.0 / w, 1.0 / (w * w) - (1.0 - gone) / (gone * gone))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::Dual;

    #[test]
    fn arsinh_of_an_exponential_has_no_seam_and_no_end() {
        for x in [-800.0, -3.0, 0.0, 2.0, LARGE] {
            let exact = f64::exp(x).asinh();
            assert!((arcsinh_of_exp(x).0 - exact).abs() <= 1e-15 * exact.abs(), "{x}");
        }
        let beyond = arcsinh_of_exp(LARGE + 1e-9).0 - arcsinh_of_exp(LARGE).0;
        assert!((beyond - 1e-9).abs() < 1e-14);
        assert!(arcsinh_of_exp(1e6).0.is_finite());
    }

    #[test]
    fn a_spring_on_such_friction_follows_small_steps() {
        for exponent in [0.3, 4.0] {
            for (way, creep) in [(0.0, 3.0), (1e-4, 1e-3), (2.0, 0.5), (40.0, 2.0)] {
                for start in [-6.0, 0.0, 1.0, 9.0] {
                    let (steps, mut z) = (400_000, start);
                    for _ in 0..steps {
                        let rate = |z: f64| way - velocity_of(z, creep, exponent);
                        let middle = z + 0.5 * rate(z) / f64::from(steps);
                        z += rate(middle) / f64::from(steps);
                    }
                    let (exact, _) = Series { way, creep, exponent }.advance(start);
                    assert!((exact - z).abs() < 1e-5, "{exponent} {way} {start}: {exact} {z}");
                }
            }
        }
        let deep = Series { way: 3.0, creep: 1.0, exponent: 1e4 };
        assert!((deep.advance(-5e3).0 + 4997.0).abs() < 1e-9);
        let loose = Balance { heavy: 2.0, wanted: 6.0, old: 0.0, scale: 1e-3, exponent: -5e3 };
        assert_eq!(loose.solve(), (0.0, 3.0));
        let stiff = Series { way: 1e200, creep: 1e190, exponent: 60.0 };
        assert!((stiff.advance(3.0).0 - (60.0 + 10.0 * f64::ln(10.0))).abs() < 1e-9);
        assert!((deep.advance(1e4).0 - (1e4 + f64::ln(3.0))).abs() < 1.0);
    }

    #[test]
    fn a_balance_is_met_from_deep_rest_to_fast_slides_with_its_derivatives() {
        for exponent in [0.5, 60.0, 1e4] {
            for heavy in [1e-3, 1.0, 1e6] {
                for wanted in [-2.0 * exponent - 9.0, -0.4 * exponent, 0.0, 0.7 * exponent, 1e5] {
                    for old in [-exponent, 0.0, exponent] {
                        let balance = |exponent: Dual, wanted: Dual| Balance {
                            heavy: Dual::constant(heavy),
                            wanted,
                            old: Dual::constant(old),
                            scale: Dual::constant(1e-3),
                            exponent,
                        };
                        let at = |e: f64, w: f64| balance(Dual::constant(e), Dual::constant(w));
                        let (z, _) = at(exponent, wanted).solve();
                        let scale = wanted.abs() + z.re().abs() + 1.0;
                        let left = at(exponent, wanted).excess(z).re();
                        assert!(left.abs() < 1e-12 * scale, "{exponent} {heavy} {wanted}: {left}");
                        let seeded =
                            balance(Dual::variable(exponent, 0), Dual::variable(wanted, 1));
                        let step = 1e-5;
                        for (column, e, w) in [(0, step, 0.0), (1, 0.0, step)] {
                            let up = at(exponent + e, wanted + w).solve().0.re();
                            let down = at(exponent - e, wanted - w).solve().0.re();
                            let chord = (up - down) / (2.0 * step);
                            let slope = Scalar::partial(seeded.solve().0, column);
                            let noise = 1e-4 + 1e-9 * scale;
                            assert!((slope - chord).abs() < noise, "{slope} against {chord}");
                        }
                    }
                }
            }
        }
    }
}
