//! Response of a damped oscillator, exact for any duration: what the adaptive integrator steps by.

/// Below this K·t² + 2·c·t the closed forms cancel and a series is exact.
const SERIES: f64 = 0.05;
/// Below this K·t² a stiffness is better left to the remainder.
const SOFT: f64 = 1e-2;
/// Coefficients of the series: the next is below 1e-17.
const TERMS: usize = 12;
/// Coefficients that are less, as shares of the first, change nothing.
const NOTHING: f64 = 1e-18;
/// 1/n; the first is not asked for.
const SHARES: [f64; TERMS + 4] = {
    let mut shares = [0.0; TERMS + 4];
    let mut n = 1;
    while n < shares.len() {
        shares[n] = 1.0 / n as f64;
        n += 1;
    }
    shares
};

/// g, its slope and its repeated integrals at a time t, where g'' + 2·c·g' + K·g = 0, g(0) = 0,
/// g'(0) = 1.
///
/// With J·x'' + C·x' + k·x = r₀ + r₁·t + r₂·t², x(0) = 0 and x'(0) = v₀,
/// x = v₀·g + (r₀·G₁ + r₁·G₂ + 2·r₂·G₃)/J and x' = v₀·g' + (r₀·g + r₁·G₁ + 2·r₂·G₂)/J.
#[derive(Debug, Clone, Copy)]
pub(super) struct Response {
    pub impulse: f64,
    pub slope: f64,
    pub first: f64,
    pub second: f64,
    pub third: f64,
}

/// The stiffness by which a step of this duration can be taken: K, or 0 where that is too soft.
#[inline]
pub(super) fn usable(square: f64, span: f64) -> f64 {
    if square * span * span < SOFT { 0.0 } else { square }
}

/// Responses after half a span and after all of it; `square` is K as [`usable`] returns it, `decay`
/// is c.
#[inline]
pub(super) fn halves(square: f64, decay: f64, span: f64) -> (Response, Response) {
    let half = 0.5 * span;
    if square * span * span + 2.0 * decay * span < SERIES {
        return (series(square, decay, half), series(square, decay, span));
    }
    if square == 0.0 {
        return (sliding(decay, half), sliding(decay, span));
    }
    let surplus = square - decay * decay;
    if surplus > 1e-6 * square {
        let omega = surplus.sqrt();
        let left = (-decay * half).exp();
        let (sine, cosine) = (omega * half).sin_cos();
        let at = |t: f64, left: f64, sine: f64, cosine: f64| {
            let impulse = left * sine / omega;
            closed(square, decay, t, impulse, left * cosine - decay * impulse)
        };
        let doubled = (2.0 * sine * cosine, cosine * cosine - sine * sine);
        return (at(half, left, sine, cosine), at(span, left * left, doubled.0, doubled.1));
    }
    let apart = (-surplus).max(0.0).sqrt();
    let at = |t: f64| {
        if apart <= 1e-3 * decay {
            let left = (-decay * t).exp();
            return closed(square, decay, t, t * left, (1.0 - decay * t) * left);
        }
        let (slow, fast) = (square / (decay + apart), decay + apart);
        let (late, early) = ((-slow * t).exp(), (-fast * t).exp());
        let impulse = (late - early) / (fast - slow);
        closed(square, decay, t, impulse, (fast * early - slow * late) / (fast - slow))
    };
    (at(half), at(span))
}

/// Each integral of the equation of g gives the next one.
#[inline]
fn closed(square: f64, decay: f64, t: f64, impulse: f64, slope: f64) -> Response {
    let twice = 2.0 * decay;
    let first = (1.0 - slope - twice * impulse) / square;
    let second = (t - impulse - twice * first) / square;
    let third = (0.5 * t * t - first - twice * second) / square;
    Response { impulse, slope, first, second, third }
}

/// Without stiffness.
fn sliding(decay: f64, t: f64) -> Response {
    let twice = 2.0 * decay;
    let impulse = -(-twice * t).exp_m1() / twice;
    let first = (t - impulse) / twice;
    let second = (0.5 * t * t - first) / twice;
    let third = (t * t * t / 6.0 - second) / twice;
    Response { impulse, slope: 1.0 - twice * impulse, first, second, third }
}

fn series(square: f64, decay: f64, t: f64) -> Response {
    let mut response = Response { impulse: 0.0, slope: 0.0, first: 0.0, second: 0.0, third: 0.0 };
    let (damped, swung, per_time) = (2.0 * decay * t, square * t * t, 1.0 / t);
    // Coefficients of g times t^n, n = 0, 1, …
    let (mut before, mut at) = (0.0, t);
    for n in 1..=TERMS {
        let once = at * t * SHARES[n + 1];
        let twice = once * t * SHARES[n + 2];
        response.impulse += at;
        response.slope += at * n as f64 * per_time;
        response.first += once;
        response.second += twice;
        response.third += twice * t * SHARES[n + 3];
        let next = -(damped * at + swung * before * SHARES[n]) * SHARES[n + 1];
        // Without damping every second one is 0.
        if at.abs() + next.abs() < NOTHING * t {
            break;
        }
        (before, at) = (at, next);
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The equation and its integrals, by many small steps of the midpoint rule.
    fn numbers(square: f64, decay: f64, t: f64) -> [f64; 5] {
        let steps = 400_000;
        let h = t / f64::from(steps);
        let rates = |y: [f64; 5]| [y[1], -2.0 * decay * y[1] - square * y[0], y[0], y[2], y[3]];
        let mut y = [0.0, 1.0, 0.0, 0.0, 0.0];
        for _ in 0..steps {
            let k = rates(y);
            let mut middle = y;
            (0..5).for_each(|j| middle[j] += 0.5 * h * k[j]);
            let k = rates(middle);
            (0..5).for_each(|j| y[j] += h * k[j]);
        }
        y
    }

    #[test]
    fn responses_solve_the_oscillator_in_every_regime() {
        for (square, decay, span) in [
            (4e5, 30.0, 5e-3),
            (4e5, 30.0, 2e-4),
            (4e5, 632.0, 3e-3),
            (4e5, 632.455_532, 3e-3),
            (4e5, 5000.0, 3e-3),
            (0.0, 3.0, 1.0),
            (0.0, 0.01, 1.0),
            (0.0, 0.0, 0.7),
        ] {
            let (half, whole) = halves(square, decay, span);
            for (response, t) in [(half, 0.5 * span), (whole, span)] {
                let exact = numbers(square, decay, t);
                let got = [
                    response.impulse,
                    response.slope,
                    response.first,
                    response.second,
                    response.third,
                ];
                let sizes = [t, 1.0, t * t / 2.0, t.powi(3) / 6.0, t.powi(4) / 24.0];
                for j in 0..5 {
                    let off = (got[j] - exact[j]).abs() / sizes[j];
                    assert!(off < 1e-8, "{square} {decay} {t}: {j} {} {}", got[j], exact[j]);
                }
            }
        }
    }
}
