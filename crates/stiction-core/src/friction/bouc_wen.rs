//! The Bouc-Wen model as friction: smooth hysteresis of one equation.

use super::elements::approach::approach;
use super::elements::reachable::reachable;
use super::{
    Channels, Entry, EntryReader, FrictionLaw, LawState, Motion, Outcome, Rest, Statistics,
};
use crate::math::scalar::{Scalar, logarithmic_mean, sign};
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

/// Greatest step towards zero force, in shares of F_c; less where n is great.
const STEP: f64 = 1.0 / 32.0;
/// |u| up to which |u|^n, which is not smooth at zero, is followed by a series, and its terms.
const SMALL: f64 = 0.1;
const TERMS: u32 = 10;
/// Nodes and weights on 0 … 1.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_0, 0.118_463_442_528_094_5),
    (0.230_765_344_947_158_5, 0.239_314_335_249_683_2),
    (0.5, 0.284_444_444_444_444_4),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_2),
    (0.953_089_922_969_332, 0.118_463_442_528_094_5),
];

parameters! {
    /// Parameters of [`BoucWen`].
    pub struct BoucWenParameters {
        coulomb: Effort, "force that a long motion approaches, F_c = (A/(β + γ))^(1/n)",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "slope of the force at zero force, A",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        exponent: One, "sharpness of the knee, n",
            default Value(1.5), neutral None, typical 1.5, bounds 1.0, 20.0;
        unloading_share: One, "how much stiffer unloading is than at zero force, b = β/(β + γ); 1/2: as stiff",
            default Value(0.75), neutral None, typical 0.75, bounds 0.5, 1.0;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`BoucWen`] may bring along.
    pub struct BoucWenStart {
        force: Effort, "force at the start; levels off from 98 % of F_c on, below F_c",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
    }
}

/// Hysteresis whose slope falls with a power of the force.
///
/// z' = v·(A − (β·sgn(z·v) + γ)·|z|^n);  F = L·z + F_v·v, z a force
/// = v·A·(1 − (b·sgn(z·v) + 1 − b)·|z/F_c|^n),  F_c = (A/(β + γ))^(1/n), b = β/(β + γ)
///
/// At v = 0 the force stays where it is: no creep, no true stick. Reverse points are not
/// remembered. Memory: z. Passive, as b ≥ 1/2 (|γ| ≤ β) makes unloading no softer than A.
/// Source: Wen, J. Eng. Mech. Div. ASCE 102 (1976), after Bouc (1967).
#[derive(Debug, Clone)]
pub struct BoucWen<S>(BoucWenParameters<S>);

/// Force of [`BoucWen`] at level 1, without its viscous part.
#[derive(Debug, Clone, Copy)]
pub struct BoucWenState<S> {
    dry: S,
    /// Direction of the last motion.
    direction: f64,
    reversals: u64,
}

/// A step of [`BoucWen`].
#[derive(Debug, Clone, Copy)]
pub struct BoucWenTrial<S> {
    after: BoucWenState<S>,
    outcome: Outcome<S>,
}

impl<S: Scalar> BoucWenState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> BoucWenState<T> {
        BoucWenState {
            dry: convert(self.dry),
            direction: self.direction,
            reversals: self.reversals,
        }
    }
}

impl<S: Scalar> LawState<S> for BoucWenState<S> {
    const OUTPUTS: &'static [&'static str] = &["dry_friction"];

    fn output(&self, _index: usize) -> S {
        self.dry
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        vec![
            ("dry_friction", Entry::Number(self.dry.re())),
            ("direction", Entry::Number(self.direction)),
            ("reversals", Entry::Number(self.reversals as f64)),
        ]
    }

    fn statistics(&self) -> Statistics {
        Statistics { reversals: self.reversals, ..Statistics::default() }
    }
}

impl<S: Scalar> BoucWen<S> {
    /// Slope by displacement as a share of A, at u = ±z/F_c in the direction of motion.
    #[inline]
    fn share(&self, u: S) -> S {
        let power = u.power_of_magnitude(self.0.exponent);
        if u.re() < 0.0 { power * self.stiffening() + 1.0 } else { -(power - 1.0) }
    }

    /// (β − γ)/(β + γ).
    #[inline]
    fn stiffening(&self) -> S {
        self.0.unloading_share * 2.0 - 1.0
    }

    /// u after η = A·|Δx|/F_c: down to where |u|^n is small, through zero by its series, and up.
    #[inline]
    fn followed(&self, u: S, eta: S) -> S {
        let (mut u, mut left) = (u, eta);
        if u.re() < -SMALL {
            let step = STEP * (4.0 / self.0.exponent.re()).min(1.0) * (-u.re()).max(1.0);
            let reach = left * self.share(u);
            if reach.re() <= step && (u + reach).re() < -SMALL {
                return self.unloaded_little(u, left);
            }
            while u.re() < -SMALL {
                let last = -u.re() - SMALL <= 1.5 * step;
                let part = if last { -(u + SMALL) } else { S::constant(step) };
                let needed = self.way(u, part);
                if needed.re() > left.re() {
                    // Within this part: Newton on its way.
                    let mut part = left * self.share(u);
                    for _ in 0..4 {
                        part += (left - self.way(u, part)) * self.share(u + part);
                    }
                    return u + part;
                }
                left -= needed;
                u = if last { S::constant(-SMALL) } else { u + part };
            }
        }
        if u.re() < SMALL {
            let (from, to) = (self.small_way(u), self.small_way(S::constant(SMALL)));
            let target = from + left;
            if target.re() <= to.re() {
                let mut u = target;
                for _ in 0..4 {
                    u += (target - self.small_way(u)) * self.share(u);
                }
                return u;
            }
            left -= to - from;
            u = S::constant(SMALL);
        }
        if u.re() >= 1.0 {
            // Only a state that a caller made is beyond.
            return S::constant(1.0);
        }
        let n = self.0.exponent;
        // What is left to F_c: dr/dη = −(1 − (1 − r)^n).
        let r = approach(-(u - 1.0), left, |r| -(-(r * logarithmic_mean(r) * n)).exp_m1() / r);
        -(r - 1.0)
    }

    /// Way from zero to u for |u| ≤ [`SMALL`]: the integral of the geometric series of 1/share.
    #[inline]
    fn small_way(&self, u: S) -> S {
        let n = self.0.exponent;
        let power = u.power_of_magnitude(n);
        let ratio = if u.re() < 0.0 { -(power * self.stiffening()) } else { power };
        let (mut sum, mut term) = (S::constant(1.0), S::constant(1.0));
        for k in 1..=TERMS {
            term *= ratio;
            sum += term / (n * f64::from(k) + 1.0);
        }
        u * sum
    }

    /// A short step against the force: Runge-Kutta of fourth order.
    #[inline]
    fn unloaded_little(&self, u: S, way: S) -> S {
        let k1 = self.share(u);
        let k2 = self.share(u + way * k1 * 0.5);
        let k3 = self.share(u + way * k2 * 0.5);
        let k4 = self.share(u + way * k3);
        u + way * (k1 + (k2 + k3) * 2.0 + k4) / 6.0
    }

    /// Way over which u rises by `part` against the force: Gauss's rule of five points.
    #[inline]
    fn way(&self, u: S, part: S) -> S {
        let mut sum = S::constant(0.0);
        for (at, weight) in GAUSS {
            sum += S::constant(weight) / self.share(u + part * at);
        }
        sum * part
    }
}

impl<S: Scalar> FrictionLaw<S> for BoucWen<S> {
    type State = BoucWenState<S>;
    type Trial = BoucWenTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = BoucWenParameters::<f64>::SPECS;
    const START: &'static [ParameterSpec] = BoucWenStart::<f64>::SPECS;
    const SUMMARY: &'static str =
        "smooth hysteresis of one equation, with a knee as sharp as one likes";
    const SOURCE: &'static str = "Wen, J. Eng. Mech. Div. ASCE 102 (1976)";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        Self(BoucWenParameters::from_values(values))
    }

    fn initial(&self) -> BoucWenState<S> {
        BoucWenState { dry: S::constant(0.0), direction: 0.0, reversals: 0 }
    }

    fn primed(&self, values: &[S]) -> BoucWenState<S> {
        let dry = reachable(BoucWenStart::from_values(values).force, self.0.coulomb);
        BoucWenState { dry, direction: sign(dry.re()), ..self.initial() }
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<BoucWenState<S>> {
        let mut read = EntryReader::new(entries);
        let state = BoucWenState {
            dry: S::constant(read.number("dry_friction", false)?),
            direction: read.choice("direction", &[-1.0, 0.0, 1.0])?,
            reversals: read.count("reversals")?,
        };
        read.finish()?;
        Ok(state)
    }

    fn sliding_force(&self) -> S {
        self.0.coulomb
    }

    fn greatest_stiffness(&self) -> f64 {
        // Right after a reversal at F_c.
        self.0.initial_stiffness.re() * (1.0 + self.stiffening().re())
    }

    fn greatest_damping(&self) -> f64 {
        self.0.viscous.re()
    }

    #[inline]
    fn force(&self, state: &BoucWenState<S>, velocity: S, channels: &Channels<S>) -> S {
        state.dry * channels.level + self.0.viscous * channels.viscous_level * velocity
    }

    #[inline]
    fn advance(
        &self,
        state: &BoucWenState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> BoucWenTrial<S> {
        let p = &self.0;
        let damping = p.viscous * channels.viscous_level;
        let moving = sign(motion.displacement.re());
        let u = state.dry / p.coulomb;
        let (dry, share) = if moving == 0.0 {
            // The slope differs to either side: the mean of the two.
            (state.dry, (self.share(u) + self.share(-u)) * 0.5)
        } else {
            let eta = p.initial_stiffness * motion.displacement * moving / p.coulomb;
            let u = self.followed(u * moving, eta);
            (u * p.coulomb * moving, self.share(u))
        };
        let direction = if moving == 0.0 { state.direction } else { moving };
        let turned = u64::from(direction * state.direction < 0.0);
        let slope = p.initial_stiffness * share * channels.level * motion.duration + damping;
        let force = dry * channels.level + damping * motion.velocity;
        BoucWenTrial {
            after: BoucWenState { dry, direction, reversals: state.reversals + turned },
            outcome: Outcome { force, slope, damping },
        }
    }

    #[inline]
    fn outcome(&self, trial: &BoucWenTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &BoucWenState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, BoucWenTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline]
    fn commit(&self, state: &mut BoucWenState<S>, trial: &BoucWenTrial<S>) {
        *state = trial.after;
    }
}
