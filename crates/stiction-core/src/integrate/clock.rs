//! Sums of one number with itself, which a rest asks for many of.

/// Time after so many steps of this duration, to the bit as if they were added one by one.
///
/// Between two powers of two floats are multiples of one spacing, so that each sum is rounded by as
/// much: all steps are equally long there. (Where a step ends in half a spacing, sums are rounded to
/// even multiples, from the second one on by as much.) Those that stay there are one product.
pub fn after_steps(mut time: f64, span: f64, mut steps: usize) -> f64 {
    while steps > 0 {
        let before = time;
        time += span;
        steps -= 1;
        if octave(before) != octave(time) {
            continue;
        }
        let step = (time + span) - time;
        let mut some = steps;
        while some > 0 {
            let far = time + some as f64 * step;
            if octave(far) == octave(time) {
                (time, steps) = (far, steps - some);
                break;
            }
            some /= 2;
        }
    }
    time
}

/// Sign and exponent.
fn octave(number: f64) -> u64 {
    number.to_bits() >> 52
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_at_once_are_steps_one_by_one() {
        let spans = [1e-4, 1e-3, 1.0 / 3.0, 0.5, 3e-17, f64::from_bits(1), 7.0, 1e300, 0.0];
        // Half a spacing at 1 and at 2, at which sums go to even multiples.
        let ties = [1.0, 3.0, 5.0, 7.0].map(|odd| odd * 2.0_f64.powi(-53));
        let starts = [0.0, 1e-4, 0.999_999, 1.0, 1.0 + f64::EPSILON, 1.999, -0.3, -1.0, 1e9, 9e15];
        for span in spans.into_iter().chain(ties) {
            for start in starts {
                let mut time: f64 = start;
                for steps in 0..3000 {
                    let given = after_steps(start, span, steps);
                    assert_eq!(given.to_bits(), time.to_bits(), "{start} {span} {steps}");
                    time += span;
                }
            }
        }
    }
}
