//! Sine and cosine together, inlined: effects over position ask for them at every sample.

use stiction_dispatch::{Task, Width};

/// Beyond this the reduction by parts of π/2 loses digits, and the library takes over.
pub(super) const WIDEST: f64 = 1e5;
/// Added and taken off again, this rounds to a whole number, which then stands in the last bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// π/2 in two parts: the first one times a number below 2²⁰ is exact.
const HALF_PI: (f64, f64) = (1.570_796_326_734_125_6, 6.077_100_506_506_192e-11);

/// Sine and cosine, each within 2e-16 of the exact value up to |x| = 1e5.
///
/// Reduction after Cody and Waite, Software Manual for the Elementary Functions (1980); the
/// polynomials of fdlibm (Sun Microsystems, 1993).
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    if x.is_nan() || x.abs() > WIDEST {
        return x.sin_cos();
    }
    within_reach(x)
}

/// The nearest whole number, of what is below 2⁵¹.
#[inline(always)]
pub(super) fn round(x: f64) -> f64 {
    (x + ROUNDING) - ROUNDING
}

/// cos(order·x) and sin(order·x) of many x.
pub fn waves(order: f64, values: &[f64], cosines: &mut [f64], sines: &mut [f64]) {
    Width::widest().run(Waves { order, values, cosines, sines });
}

struct Waves<'a> {
    order: f64,
    values: &'a [f64],
    cosines: &'a mut [f64],
    sines: &'a mut [f64],
}

impl Task for Waves<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { order, values, cosines, sines } = self;
        // Without a choice among the numbers they are vectors.
        let near = values.iter().fold(true, |near, x| near & ((order * x).abs() <= WIDEST));
        for ((x, cosine), sine) in values.iter().zip(cosines).zip(sines) {
            (*sine, *cosine) = if near { within_reach(order * x) } else { sin_cos(order * x) };
        }
    }
}

#[inline(always)]
fn within_reach(x: f64) -> (f64, f64) {
    let shifted = x * std::f64::consts::FRAC_2_PI + ROUNDING;
    let quarter = shifted.to_bits();
    let turns = shifted - ROUNDING;
    let r = (x - turns * HALF_PI.0) - turns * HALF_PI.1;
    let z = r * r;
    let sine = r + r
        * z
        * (-1.666_666_666_666_663_2e-1
            + z * (8.333_333_333_322_49e-3
                + z * (-1.984_126_982_985_795e-4
                    + z * (2.755_731_370_707_006_8e-6
                        + z * (-2.505_076_025_340_686_3e-8 + z * 1.589_690_995_211_55e-10)))));
    let half = 0.5 * z;
    let near = 1.0 - half;
    let cosine = near
        + (((1.0 - near) - half)
            + z * z
                * (4.166_666_666_666_66e-2
                    + z * (-1.388_888_888_887_411e-3
                        + z * (2.480_158_728_947_673e-5
                            + z * (-2.755_731_435_139_066_3e-7
                                + z * (2.087_572_321_298_175e-9
                                    - z * 1.135_964_755_778_819_5e-11))))));
    let (s, c) = if quarter & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
    let s = if quarter & 2 == 0 { s } else { -s };
    let c = if (quarter + 1) & 2 == 0 { c } else { -c };
    (s, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_agree_with_the_library() {
        let mut worst = 0.0_f64;
        for k in 0..400_000 {
            let t = f64::from(k) / 400_000.0;
            for x in
                [t, 200.0 * t - 100.0, 2e5 * t - 1e5, f64::from(k) * std::f64::consts::FRAC_PI_2]
            {
                let (s, c) = sin_cos(x);
                worst = worst.max((s - x.sin()).abs()).max((c - x.cos()).abs());
            }
        }
        assert!(worst <= 2e-16, "{worst}");
    }

    #[test]
    fn many_at_once_are_what_each_is_alone() {
        for order in [0.0, 0.37, 80.0, 1e4] {
            let values: Vec<f64> = (0..501).map(|k| 0.1 * f64::from(k) - 20.0).collect();
            let (mut cosines, mut sines) = (vec![0.0; 501], vec![0.0; 501]);
            waves(order, &values, &mut cosines, &mut sines);
            for (k, x) in values.iter().enumerate() {
                assert_eq!((sines[k], cosines[k]), sin_cos(order * x), "{order} {x}");
            }
        }
    }

    #[test]
    fn what_is_out_of_reach_goes_to_the_library() {
        for x in [3e5, -1e18, 0.0, -0.0] {
            let (s, c) = sin_cos(x);
            assert_eq!((s, c), x.sin_cos());
        }
        let (s, c) = sin_cos(f64::NAN);
        assert!(s.is_nan() && c.is_nan());
        assert!(sin_cos(f64::INFINITY).0.is_nan());
    }
}
