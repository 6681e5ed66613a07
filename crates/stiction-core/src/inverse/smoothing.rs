//! Smoothing of a measured motion: as far as noise makes it necessary and the motion allows it.

use stiction_dispatch::{Task, Width};

use crate::support::interrupt;

/// Standard deviations by which estimates from narrow and wide windows may differ.
const TRUSTED: f64 = 2.0;
/// Half the samples, less one, over which one width goes over into the next: a jump would turn the
/// motion round.
const BLENDED: usize = 4;

/// Positions behind readings, each from the widest window that noise does not refute.
///
/// Parabolas are fitted to windows of 2·half + 1 samples. About every sample the widest one is taken whose
/// estimate agrees with those of all narrower ones: near a stop a narrow one, in slow motion a wide one.
/// Beyond the ends the last reading goes on.
///
/// Source: Lepski, Theory Probab. Appl. 35 (1990); intersection of intervals after Goldenshluger,
/// Nemirovski, Math. Methods Statist. 6 (1997).
///
/// `noise` is the standard deviation of the readings; `halves` rise from 0.
pub fn adaptively_smoothed(readings: &[f64], noise: f64, halves: &[usize]) -> Vec<f64> {
    if readings.is_empty() || halves.len() < 2 {
        return readings.to_vec();
    }
    Width::widest().run(Smoothing { readings, noise, halves })
}

/// Positions behind readings that flicker: motion inside a backlash of `width` does not get through.
///
/// The mean of what a follower with that backlash does and of what one does that goes back in time: each of
/// them turns round late in its own time, and where one of them rests the other one moves the right way.
pub fn played(readings: &[f64], width: f64) -> Vec<f64> {
    let (Some(first), Some(last)) = (readings.first(), readings.last()) else { return Vec::new() };
    let half = 0.5 * width;
    let follow = |at: &mut f64, value: &f64| {
        *at = at.clamp(value - half, value + half);
        *at
    };
    let (mut forwards, mut backwards) = (*first, *last);
    let mut found: Vec<f64> = readings.iter().map(|value| follow(&mut forwards, value)).collect();
    for (value, mean) in readings.iter().zip(&mut found).rev() {
        *mean = 0.5 * (*mean + follow(&mut backwards, value));
    }
    found
}

/// The middle of a parabola through 2·half + 1 samples as a sum over them (Savitzky, Golay, Anal. Chem. 36
/// (1964)): weights of the middle and of each pair about it. The sum of their squares is the first.
fn parabola(half: usize) -> Vec<f64> {
    if half == 0 {
        return vec![1.0];
    }
    let h = half as f64;
    let whole = (2.0 * h - 1.0) * (2.0 * h + 1.0) * (2.0 * h + 3.0);
    let weight = |j: usize| 3.0 * (3.0 * h * h + 3.0 * h - 1.0 - 5.0 * (j * j) as f64) / whole;
    (0..=half).map(weight).collect()
}

struct Smoothing<'a> {
    readings: &'a [f64],
    noise: f64,
    halves: &'a [usize],
}

impl Task for Smoothing<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run(self) -> Vec<f64> {
        let Self { readings, noise, halves } = self;
        let number = readings.len();
        let edge = halves.iter().copied().max().unwrap_or(0);
        let (first, last) = (readings[0], readings[number - 1]);
        let mut padded = vec![first; edge];
        padded.extend_from_slice(readings);
        padded.resize(number + 2 * edge, last);
        let mut low = vec![f64::NEG_INFINITY; number];
        let mut high = vec![f64::INFINITY; number];
        // 1 as long as all windows so far agree, and how many have agreed but for the first.
        let (mut agrees, mut level) = (vec![1.0; number], vec![0.0; number]);
        let mut estimates = Vec::with_capacity(halves.len());
        for (k, &half) in halves.iter().enumerate() {
            let weights = parabola(half);
            let middle = &padded[edge..edge + number];
            let mut estimate: Vec<f64> = middle.iter().map(|x| weights[0] * x).collect();
            for (j, weight) in weights.iter().enumerate().skip(1) {
                if interrupt::due() {
                    return estimate;
                }
                let before = &padded[edge - j..][..number];
                let after = &padded[edge + j..][..number];
                for ((sum, one), other) in estimate.iter_mut().zip(before).zip(after) {
                    *sum += weight * (one + other);
                }
            }
            let error = TRUSTED * noise * weights[0].sqrt();
            let counts = if k > 0 { 1.0 } else { 0.0 };
            let bounds = low.iter_mut().zip(&mut high);
            let so_far = agrees.iter_mut().zip(&mut level);
            for ((estimate, (low, high)), (agrees, level)) in
                estimate.iter().zip(bounds).zip(so_far)
            {
                *low = low.max(estimate - error);
                *high = high.min(estimate + error);
                *agrees *= f64::from(u8::from(*low <= *high));
                *level += counts * *agrees;
            }
            estimates.push(estimate);
        }
        let least = about(&level, f64::INFINITY, f64::min);
        let width = (2 * BLENDED + 1) as f64;
        let blended = about(&least, 0.0, |sum, level| sum + level);
        let widest = (halves.len() - 2) as f64;
        (0..number)
            .map(|k| {
                let level = blended[k] / width;
                let below = level.floor().min(widest);
                let (narrow, wide) =
                    (estimates[below as usize][k], estimates[below as usize + 1][k]);
                narrow + (level - below) * (wide - narrow)
            })
            .collect()
    }
}

/// Something of each value and its neighbours; beyond the ends they come again the other way round.
#[inline(always)]
fn about(values: &[f64], begin: f64, taken: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let number = values.len();
    let mirrored = |k: isize| {
        let period = 2 * number as isize;
        let k = k.rem_euclid(period);
        values[k.min(period - 1 - k) as usize]
    };
    let edge = BLENDED as isize;
    let padded: Vec<f64> = (-edge..number as isize + edge).map(mirrored).collect();
    let mut found = vec![begin; number];
    for shift in 0..=2 * BLENDED {
        for (found, value) in found.iter_mut().zip(&padded[shift..]) {
            *found = taken(*found, *value);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_goes_through_what_is_one() {
        for half in [0, 1, 2, 5, 16] {
            let weights = parabola(half);
            let at = |j: isize| 3.0 + 0.5 * j as f64 - 0.25 * (j * j) as f64;
            let pairs = (1..=half).map(|j| weights[j] * (at(j as isize) + at(-(j as isize))));
            let middle = weights[0] * at(0) + pairs.sum::<f64>();
            assert!((middle - 3.0).abs() < 1e-12, "{half}: {middle}");
            let squares =
                weights[0] * weights[0] + weights[1..].iter().map(|w| 2.0 * w * w).sum::<f64>();
            assert!((squares - weights[0]).abs() < 1e-12, "{half}");
        }
    }

    #[test]
    fn a_steady_motion_is_smoothed_widely_and_a_jump_stays() {
        let noise = 1e-3;
        let mut state = 7_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let steady: Vec<f64> =
            (0..400).map(|k| 0.01 * f64::from(k) + 12f64.sqrt() * noise * random()).collect();
        let halves = [0, 1, 2, 4, 8, 16];
        let smoothed = adaptively_smoothed(&steady, noise, &halves);
        let left = |values: &[f64]| {
            let errors = values.iter().enumerate().skip(40).take(320);
            (errors.map(|(k, x)| (x - 0.01 * k as f64).powi(2)).sum::<f64>() / 320.0).sqrt()
        };
        assert!(left(&smoothed) < 0.6 * left(&steady), "{} {}", left(&smoothed), left(&steady));
        let jump: Vec<f64> = (0..100).map(|k| f64::from(k / 50)).collect();
        let kept = adaptively_smoothed(&jump, 1e-6, &halves);
        assert!(jump.iter().zip(&kept).all(|(a, b)| (a - b).abs() < 1e-5));
        assert!(adaptively_smoothed(&[], noise, &halves).is_empty());
    }

    #[test]
    fn what_flickers_rests_and_no_turn_is_late() {
        let flicker: Vec<f64> = (0..50).map(|k| f64::from(k % 2)).collect();
        let rests = played(&flicker, 2.0);
        assert!(rests.windows(2).all(|pair| pair[0] == pair[1]));
        let triangle: Vec<f64> = (0..101).map(|k| 50.0 - f64::from(k - 50).abs()).collect();
        let found = played(&triangle, 3.0);
        let turns = |values: &[f64]| values.windows(2).take_while(|pair| pair[1] > pair[0]).count();
        assert_eq!(turns(&found[2..]), turns(&triangle[2..]));
        assert!(triangle.iter().zip(&found).all(|(given, played)| (given - played).abs() <= 1.5));
        assert!(played(&[], 1.0).is_empty());
    }

    #[test]
    fn neighbours_beyond_the_ends_are_mirrored() {
        let values = [5.0, 1.0, 4.0, 3.0, 2.0, 9.0, 8.0];
        let least = about(&values, f64::INFINITY, f64::min);
        assert_eq!(least, [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0]);
        let sums = about(&values, 0.0, |a, b| a + b);
        assert_eq!(sums[0], 5.0 + 1.0 + 4.0 + 3.0 + 2.0 + 5.0 + 1.0 + 4.0 + 3.0);
    }
}
