//! Spring and damper side by side, in series with the plastic module: the force through the series
//! drives the creep, and the creep lowers that force. Each question is one scalar root.

use super::lag::follow;
use super::loading::Loading;
use super::plastic::{Creep, Plastic};
use super::spring::{SpringState, Walk};
use crate::friction::Motion;
use crate::math::scalar::{Scalar, sign};
use crate::support::work;

/// Passes to a root that come with a step; each of those beyond, with its three powers, costs as much as one.
const PASSES_OF_A_STEP: usize = 3;

/// A step of the series.
#[derive(Debug, Clone, Copy)]
pub struct SeriesStep<S> {
    /// What the spring does.
    pub walk: Walk<S>,
    /// What the plastic module does.
    pub creep: Creep<S>,
    /// Force through the series at the end.
    pub force: S,
    /// ∂force/∂velocity at the end, at fixed displacement.
    pub damping: S,
    /// ∂force/∂velocity for a velocity held over the step.
    pub slope: S,
}

/// Steps spring ∥ damper in series with the plastic module.
///
/// The force T = S(x_s) + C·(x' − x_p') goes from its root at the start of the step to that at
/// its end; between them f(|T|) is taken as linear, for which the hardening has a closed form.
/// Where a great force at the start would let it creep past the force 0, which no creep does, f is
/// that of the end all along.
#[inline(never)] // springs without a damper beside them are not to carry it through their loop
pub fn step<S: Scalar>(
    spring: &SpringState<S>,
    curve: &impl Loading<S>,
    plastic: &Plastic<S>,
    damper: S,
    hardening: S,
    motion: &Motion<S>,
) -> SeriesStep<S> {
    let zero = S::constant(0.0);
    let (from, _) = instant(plastic, damper, spring.force, hardening, motion.start_velocity);
    let uncrept_walk = spring.walk(curve, motion.displacement);
    let uncrept = uncrept_walk.end.force + damper * motion.velocity;
    let s = sign(uncrept.re());
    let z = plastic.rate * motion.duration;
    let past_zero = {
        let at_rest = follow(hardening, plastic.limit(from), plastic.limit(zero), z);
        let gain = at_rest.value - hardening;
        let walk = spring.walk(curve, motion.displacement - gain * s);
        gain.re() > 0.0 && (walk.end.force + damper * motion.velocity).re() * s < 0.0
    };
    let reaching = |force: S| {
        let limit = plastic.limit(force);
        let followed =
            follow(hardening, if past_zero { limit } else { plastic.limit(from) }, limit, z);
        let share = if past_zero { -(followed.remainder - 1.0) } else { followed.end_share };
        (followed.value - hardening, share)
    };
    // Hardening gained, and its slope by the force at the end.
    let gained = |force: S| {
        let (gain, share) = reaching(force);
        if gain.re() > 0.0 { (gain, share * plastic.limit_slope(force)) } else { (zero, zero) }
    };
    // What T must equal; it falls as |T| grows, so the root is bracketed by 0 and the force that
    // no creep would leave.
    let needed = |force: S| {
        let (gain, gain_slope) = gained(force);
        let walk = spring.walk(curve, motion.displacement - gain * s);
        let creeping = plastic.hardening_rate(hardening + gain, force);
        let quickening = if creeping.re() > 0.0 {
            plastic.rate * (plastic.limit_slope(force) - gain_slope)
        } else {
            zero
        };
        let value = walk.end.force + damper * (motion.velocity - creeping * s);
        let softening = walk.end.slope * gain_slope + damper * quickening;
        (walk, gain, value, softening + 1.0)
    };
    let (mut low, mut high) = (0.0, uncrept.re().abs());
    // The miss is known to the rounding of its terms; a strong damper's are far above the force that is left.
    let rounding = 4.0 * f64::EPSILON * high;
    let mut force = uncrept;
    for pass in 0..60 {
        if pass >= PASSES_OF_A_STEP {
            work::spend(work::STEP);
        }
        let (_, _, value, rise) = needed(force);
        let miss = force - value;
        let over = miss.re() * s;
        if over > 0.0 {
            high = high.min(force.re().abs());
        } else {
            low = force.re().abs().max(low);
        }
        let next = force - miss / rise;
        let inside = next.re() * s >= low && next.re() * s <= high;
        let settled = miss.re().abs() <= rounding;
        let value = if inside { next.re() } else { 0.5 * (low + high) * s };
        // The derivatives of a Newton pass are those of the root also where round-off takes its value
        // past the bracket.
        force = next.chain(value, 1.0);
        if settled || s == 0.0 {
            break;
        }
    }
    let (walk, gain, _, softened) = needed(force);
    let damping = damper / softened;
    // A held velocity moves the force at the start as well, and with it the creep.
    let from_slope = plastic.limit_slope(from);
    let started = if plastic.hardening_rate(hardening, from).re() > 0.0 {
        damper / (damper * plastic.rate * from_slope + 1.0)
    } else {
        damper
    };
    let followed = follow(hardening, plastic.limit(from), plastic.limit(force), z);
    let by_start = if gain.re() > 0.0 && !past_zero {
        -(followed.end_share + followed.remainder - 1.0)
            * from_slope
            * started
            * (s * sign(from.re()))
    } else {
        zero
    };
    let creeping = plastic.hardening_rate(hardening + gain, force).re() > 0.0;
    let recovered = if creeping { damper * plastic.rate } else { zero };
    let held = walk.end.slope * motion.duration + damper - by_start * (walk.end.slope - recovered);
    SeriesStep {
        walk,
        creep: Creep {
            hardening: gain,
            displacement: gain * s,
            left: motion.displacement - gain * s,
            share: zero,
        },
        force,
        damping,
        slope: held / softened,
    }
}

/// Force through the series and creep rate at an instant: T = S + C·(v − s·h'(T)).
pub fn instant<S: Scalar>(
    plastic: &Plastic<S>,
    damper: S,
    spring: S,
    hardening: S,
    velocity: S,
) -> (S, S) {
    let uncrept = spring + damper * velocity;
    let s = sign(uncrept.re());
    let rate = |t: S| plastic.hardening_rate(hardening, t);
    if rate(uncrept).re() == 0.0 {
        return (uncrept, S::constant(0.0));
    }
    // T + C·h'(T) is convex in |T|: Newton from the uncrept force falls to the root without
    // passing it, and its last pass carries the derivatives.
    let mut t = uncrept;
    for pass in 0..60 {
        if pass >= PASSES_OF_A_STEP {
            work::spend(work::STEP);
        }
        let rise = if rate(t).re() > 0.0 {
            plastic.limit_slope(t) * plastic.rate
        } else {
            S::constant(0.0)
        };
        let miss = t - uncrept + damper * rate(t) * s;
        let next = t - miss / (rise * damper + 1.0);
        let moved = (next.re() - t.re()).abs();
        t = next;
        if moved <= 4.0 * f64::EPSILON * uncrept.re().abs() {
            break;
        }
    }
    (t, rate(t))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::elements::loading::{Curve, VirginCurve};
    use crate::math::scalar::Dual;

    fn moved<S: Scalar>(displacement: S, hardening: S, velocity: f64) -> S {
        let k = |value: f64| S::constant(value);
        let curve = Curve::new(k(6300.0), k(1400.0), k(2.1e-4), VirginCurve::Same);
        let plastic = Plastic { coefficient: k(3.6e-3), exponent: k(1.5), rate: k(2.3) };
        let mut spring = SpringState::relaxed(&curve);
        spring.place(&curve, k(8e-5), curve.virgin(k(8e-5)).force);
        let motion = Motion {
            displacement,
            duration: k(4.7e-4),
            start_velocity: k(0.9 * velocity),
            velocity: k(velocity),
        };
        step(&spring, &curve, &plastic, k(0.23), hardening, &motion).force
    }

    // Where round-off took the last Newton pass past its bracket, the force had no derivative.
    #[test]
    fn the_force_has_its_derivative_wherever_the_root_lies() {
        for k in 1..20_000 {
            let velocity = 1e-5 * f64::from(k);
            let displacement = 4.7e-4 * velocity;
            let hardening = 1e-7 * f64::from(k % 37);
            let by_way =
                moved(Dual::variable(displacement, 0), Dual::constant(hardening), velocity);
            let width = 1e-4 * displacement;
            let (high, low) = (
                moved(displacement + width, hardening, velocity),
                moved(displacement - width, hardening, velocity),
            );
            let chord = (high - low) / (2.0 * width);
            let digits = 1e-15 * high.abs() / width;
            assert!((by_way.partial(0) - chord).abs() <= 1e-4 * chord.abs() + digits, "{k}");
        }
    }
}
