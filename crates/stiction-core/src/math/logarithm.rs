//! ln x without a call: around one a loop over rows of derivatives puts all it has in registers into
//! memory.
//!
//! x = 2ⁿ·m, √½ ≤ m < √2, s = (m − 1)/(m + 1): ln m = 2·s·(1 + s²/3 + s⁴/5 + …), of which ten terms
//! leave 3e-17.

use std::f64::consts::{LN_2, SQRT_2};

/// 1/3, 1/5 …
const TERMS: [f64; 10] = {
    let mut terms = [0.0; 10];
    let mut k = 0;
    while k < terms.len() {
        terms[k] = 1.0 / (2 * k + 3) as f64;
        k += 1;
    }
    terms
};

/// ln x, to 4e-16 of it, or of a half where it is less than that.
#[inline(always)]
pub fn logarithm(x: f64) -> f64 {
    if !(f64::MIN_POSITIVE..=f64::MAX).contains(&x) {
        return by_the_library(x);
    }
    // The exponent, counted from √½ on.
    let exponent = x.to_bits().wrapping_sub((0.5 * SQRT_2).to_bits()).cast_signed() >> 52;
    let m = f64::from_bits(x.to_bits().wrapping_sub((exponent << 52).cast_unsigned()));
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let (fourth, t) = (square * square, |k: usize| TERMS[k] + square * TERMS[k + 1]);
    let eighth = fourth * fourth;
    let rest = ((t(0) + fourth * t(2)) + eighth * (t(4) + fourth * t(6))) + eighth * eighth * t(8);
    exponent as f64 * LN_2 + (2.0 * s + 2.0 * s * (square * rest))
}

/// Of what is no usual number.
#[cold]
#[inline(never)]
fn by_the_library(x: f64) -> f64 {
    x.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_agrees_with_the_library() {
        let mut x = 3e-308_f64;
        while x < 1e308 {
            let exact = x.ln();
            assert!((logarithm(x) - exact).abs() <= 4e-16 * exact.abs().max(0.5), "{x}");
            x *= 1.0 + 0.013;
        }
        for k in -2000..2000 {
            let x = 1.0 + f64::from(k) * 1e-4;
            assert!((logarithm(x) - x.ln()).abs() <= 4e-16 * x.ln().abs().max(1e-9), "{x}");
        }
        for x in [1.0, 0.0, 5e-324, f64::INFINITY] {
            assert_eq!(logarithm(x), x.ln());
        }
        assert!(logarithm(f64::NAN).is_nan() && logarithm(-1.0).is_nan());
    }
}
