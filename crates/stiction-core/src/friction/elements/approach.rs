//! What is left on the way to a steady force, where no formula solves the way.

use crate::math::scalar::Scalar;

/// Greatest change of ln r over a step at r = 1; the error of a step is of its fifth power.
const STEP: f64 = 1.0 / 32.0;
/// Nothing is left below this.
const NOTHING: f64 = 1e-17;
/// A way of which much less is left, in e-folds, ...
const LONG: f64 = 1.0;
/// ... is gone in steps of at most so many times [`STEP`], ...
const MOST_LONGER: f64 = 32.0;
/// ... and ends in closed form, where that is off by no more.
const CLOSED: f64 = 1e-10;
/// Of so many e-folds nothing is left.
const MOST_E_FOLDS: f64 = 40.0;
/// Greatest change of ln r over a part of a way.
const PART: f64 = 0.25;
/// Places on 0 … 1 and weights of Gauss's rule of five points.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// r after a way, where dr/dσ = −r·rate(r), 0 < r ≤ 1 and rate > 0 settles as r → 0.
///
/// Runge-Kutta of fourth order on q = −ln r, whose rate is smooth and, far out, constant: steps grow
/// as r^(−1/4), so that however long the way is, some two hundred of them end it.
#[inline]
pub fn approach<S: Scalar>(r: S, way: S, rate: impl Fn(S) -> S) -> S {
    follow(r, way, None, rate)
}

/// [`approach`] where the rate is nowhere below 1 and 1 + `bend`·r − … near the end.
///
/// No more than r·e^(−way) is left then. Of a long way that is little, so that large steps are as good; and as
/// soon as the closed form of 1 + bend·r would err by no more than they do, it ends the way.
#[inline]
pub fn approach_bending<S: Scalar>(r: S, way: S, bend: S, rate: impl Fn(S) -> S) -> S {
    follow(r, way, Some(bend), rate)
}

#[inline(always)]
fn follow<S: Scalar>(r: S, way: S, bend: Option<S>, rate: impl Fn(S) -> S) -> S {
    let mut left = way;
    let mut r = r;
    while left.re() > 0.0 {
        if r.re() < NOTHING {
            return S::constant(0.0);
        }
        let mut longer = r.re().powf(-0.25);
        if let Some(bend) = bend
            && left.re() > LONG
        {
            let end = r.re() * (-left.re()).exp();
            let bent = bend.re() * r.re();
            // What r² leaves out, and what the next power of a sine does.
            let off = bent * r.re() * (0.5 + bent / 9.0);
            if end * off.min(1.0) <= CLOSED {
                let scale = S::constant(1.0) / bend;
                return approach_evenly(r, left, scale, scale);
            }
            longer = longer.max(end.powf(-0.25).min(MOST_LONGER));
        }
        let k1 = rate(r);
        let reach = STEP * longer / k1.re();
        let last = left.re() <= reach;
        let h = if last { left } else { S::constant(reach) };
        let at = |k: S, share: f64| r * (-(k * h * share)).exp();
        let k2 = rate(at(k1, 0.5));
        let k3 = rate(at(k2, 0.5));
        let k4 = rate(at(k3, 1.0));
        r = at((k1 + (k2 + k3) * 2.0 + k4) / 6.0, 1.0);
        if last {
            break;
        }
        left -= h;
    }
    r
}

/// The way from r to `target` < r, r ≤ 2 or so: what [`approach`] needs to get there.
///
/// ∫ dq/rate over q = −ln r by Gauss's rule of five points on parts of at most a quarter of an e-fold.
#[inline]
pub fn way_to<S: Scalar>(r: S, target: S, rate: impl Fn(S) -> S) -> S {
    let begin = r.ln();
    let width = begin - target.ln();
    let parts = (width.re() / PART).ceil().clamp(1.0, 200.0);
    let mut sum = S::constant(0.0);
    for part in 0..parts as usize {
        for (place, weight) in GAUSS {
            let share = (part as f64 + place) / parts;
            sum += S::constant(weight) / rate((begin - width * share).exp());
        }
    }
    sum * width / parts
}

/// r after a way, where dr/dσ = −r·(r + gap)/distance with gap > 0: [`approach`] in closed form.
#[inline]
pub fn approach_evenly<S: Scalar>(r: S, way: S, gap: S, distance: S) -> S {
    let z = gap * way / distance;
    if z.re() > MOST_E_FOLDS {
        return S::constant(0.0);
    }
    r / (z.exp_m1() * (r / gap + 1.0) + 1.0)
}

/// The way from r to `target` < r: what [`approach_evenly`] needs to get there.
#[inline]
pub fn way_evenly_to<S: Scalar>(r: S, target: S, gap: S, distance: S) -> S {
    let ratio = (r - target) * gap / (target * (gap + r));
    let x = ratio.re();
    ratio.chain(x.ln_1p(), 1.0 / (1.0 + x)) * distance / gap
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_to_a_remainder_leaves_that_remainder() {
        for target in [0.9_f64, 0.3, 1e-3, 1e-8] {
            let way = way_to(1.0, target, |r: f64| r + 1.0);
            // dr/dσ = −r·(1 + r): the way is ln((1 + r)/r) between both ends.
            let exact = ((1.0 + target) / (2.0 * target)).ln();
            assert!((way - exact).abs() < 1e-10 * exact, "{target}: {way} {exact}");
        }
    }

    #[test]
    fn an_even_way_is_the_one_that_is_followed_step_by_step() {
        for (gap, distance) in [(0.02, 1e-4), (1.0, 3.0), (40.0, 0.7)] {
            let rate = |r: f64| (r + gap) / distance;
            for way in [1e-6, 0.1, 2.0].map(|share: f64| share * distance) {
                let there = approach_evenly(1.3, way, gap, distance);
                let followed = approach(1.3, way, rate);
                assert!((there - followed).abs() < 1e-8 * followed + 1e-16, "{there} {followed}");
                // Where nothing is left, no way is long enough.
                if there > 0.0 {
                    let back = way_evenly_to(1.3, there, gap, distance);
                    assert!((back - way).abs() < 1e-9 * way, "{back} {way}");
                }
            }
        }
    }

    #[test]
    fn a_way_that_bends_is_the_one_of_small_steps() {
        use std::f64::consts::FRAC_PI_2;
        for whole in [0.02_f64, 0.1, 0.37, 1.0] {
            let rate = |r: f64| {
                let square = (r / whole * FRAC_PI_2).sin().powi(2);
                square / r - (square - 1.0)
            };
            let bend = (FRAC_PI_2 / whole).powi(2);
            for share in [1.0, 0.3, 0.01] {
                for way in [0.3, 1.1, 3.0, 7.0, 12.0, 30.0, 50.0, 1e6] {
                    let found = approach_bending(share * whole, way, bend, rate);
                    // Halves of steps at which nothing is done at once.
                    let parts = 400;
                    let part = way.min(60.0) / f64::from(parts);
                    let exact = (0..parts).fold(share * whole, |r, _| approach(r, part, rate));
                    assert!((found - exact).abs() < 5e-9, "{whole} {share} {way}: {found} {exact}");
                }
            }
        }
    }

    #[test]
    fn a_logistic_way_is_followed_for_any_length() {
        // dr/dσ = −r·(1 + r): r/(1 + r) decays exponentially.
        for way in [1e-9_f64, 1e-3, 0.1, 3.0, 30.0, 1e6] {
            let share = 0.5 * (-way).exp();
            let exact = share / (1.0 - share);
            let found = approach(1.0, way, |r: f64| r + 1.0);
            assert!((found - exact).abs() < 1e-8 * exact + 1e-16, "{way}: {found} {exact}");
        }
    }
}
