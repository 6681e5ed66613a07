//! The positions behind given readings, and where between two of them a machine stops.

use crate::math::scalar::Scalar;
use crate::support::samples::PerSample;

/// Stamps before a stop that tell when it was: fewer know little over coarse counts, and over more the
/// deceleration changes.
const TELLING: usize = 5;
/// Samples without a way for which a machine may still be about to stop.
const LATE: isize = 3;

/// The positions behind the readings, three in a row, and what is derived from them.
pub struct Track<'a, S> {
    readings: &'a [f64],
    /// The position behind a reading, where that is another one.
    actual: Option<&'a dyn Fn(f64) -> S>,
    /// Positions at the stamps before, at and after the present one; kept where readings err.
    at: [S; 3],
    /// The present stamp.
    stamp: usize,
}

/// When a machine stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Samples from the start of the present one.
    pub left: f64,
    /// Way that the velocity at its start would make in a whole sample.
    pub way: f64,
    /// Whether it moved in every sample that may tell.
    pub sure: bool,
}

impl<'a, S: Scalar> Track<'a, S> {
    /// With this stamp as the present one. What readings show as it is depends on no parameter.
    pub fn new(readings: &'a [f64], actual: Option<&'a dyn Fn(f64) -> S>, stamp: usize) -> Self {
        let zero = S::constant(0.0);
        let mut track = Self { readings, actual, at: [zero; 3], stamp };
        if let Some(actual) = actual {
            track.at = track.near().map(actual);
        }
        track
    }

    /// Readings at the stamps before, at and after the present one.
    #[inline(always)]
    fn near(&self) -> [f64; 3] {
        let (readings, here) = (self.readings, self.stamp);
        // Written out: a map over an array is a call where nothing is optimised across units.
        let after = (here + 1).min(readings.len() - 1);
        [readings[here.saturating_sub(1)], readings[here], readings[after]]
    }

    /// Position at the present stamp.
    #[inline(always)]
    pub fn position(&self) -> S {
        if self.actual.is_some() { self.at[1] } else { S::constant(self.reading()) }
    }

    /// What the sensor reads at the present stamp.
    #[inline(always)]
    pub fn reading(&self) -> f64 {
        self.readings[self.stamp]
    }

    /// Displacement since the stamp before.
    #[inline(always)]
    pub fn displacement(&self) -> S {
        self.between(0, 1)
    }

    /// The same as it is read.
    #[inline(always)]
    pub fn displacement_read(&self) -> f64 {
        let near = self.near();
        near[1] - near[0]
    }

    /// Displacement from one of the three stamps to another.
    #[inline(always)]
    fn between(&self, from: usize, to: usize) -> S {
        if self.actual.is_some() {
            return self.at[to] - self.at[from];
        }
        let near = self.near();
        S::constant(near[to] - near[from])
    }

    /// On to the next stamp.
    #[inline(always)]
    pub fn advance(&mut self) {
        self.stamp += 1;
        if let Some(actual) = self.actual {
            let next = self.stamp + 1;
            let ahead = self.readings.get(next).map_or(self.at[2], |reading| actual(*reading));
            self.at = [self.at[1], self.at[2], ahead];
        }
    }

    /// Slope between the neighbours, so that what depends on velocity is not half a sample late; at
    /// the first and the last stamp there is only one side.
    #[inline(always)]
    pub fn velocity(&self, dt: &PerSample<'_>) -> S {
        if self.actual.is_some() {
            return (self.at[2] - self.at[0]) / self.span(dt);
        }
        S::constant(self.velocity_read(dt))
    }

    /// The same as it is read.
    #[inline(always)]
    fn velocity_read(&self, dt: &PerSample<'_>) -> f64 {
        let near = self.near();
        (near[2] - near[0]) / self.span(dt)
    }

    /// Time between the neighbours.
    #[inline(always)]
    fn span(&self, dt: &PerSample<'_>) -> f64 {
        let last = self.readings.len() - 1;
        let (before, after) = (self.stamp.saturating_sub(1), (self.stamp + 1).min(last));
        if after - before == 2 {
            return dt.at(before) + dt.at(before + 1);
        }
        (before..after).map(|j| dt.at(j)).sum()
    }

    /// The velocity at the present stamp; where a contact is rigid that of [`Self::rests_at`], and with
    /// it the stop in the sample that begins here. `before` is the one in the sample that ends.
    #[inline(always)]
    pub fn slope(
        &self,
        dt: &PerSample<'_>,
        rigid: bool,
        before: Option<Stop>,
    ) -> (S, Option<Stop>) {
        if !rigid {
            return (self.velocity(dt), None);
        }
        let stop = self.stop(self.stamp);
        let rest = self.rests_at(dt, before, stop);
        (rest.map_or_else(|| self.velocity(dt), S::constant), stop)
    }

    /// The same as it is read.
    #[inline(always)]
    pub fn slope_read(
        &self,
        dt: &PerSample<'_>,
        rigid: bool,
        before: Option<Stop>,
    ) -> (f64, Option<Stop>) {
        if !rigid {
            return (self.velocity_read(dt), None);
        }
        let stop = self.stop(self.stamp);
        let rest = self.rests_at(dt, before, stop);
        (rest.unwrap_or_else(|| self.velocity_read(dt)), stop)
    }

    /// The velocity of a machine with a rigid contact that rests before or after the present stamp, 0,
    /// or stops: between the neighbours it would seem to slide on for a sample or two.
    #[inline(always)]
    fn rests_at(
        &self,
        dt: &PerSample<'_>,
        before: Option<Stop>,
        stop: Option<Stop>,
    ) -> Option<f64> {
        if let Some(stop) = stop {
            return Some(stop.way / dt.at(self.stamp));
        }
        let ended = self.stamp.wrapping_sub(1);
        (before.is_some() || self.rests(ended) || self.rests(self.stamp)).then_some(0.0)
    }

    /// Second difference; 0 where a side is missing.
    #[inline(always)]
    pub fn acceleration(&self, dt: &PerSample<'_>) -> S {
        if self.stamp == 0 || self.stamp + 1 >= self.readings.len() {
            return S::constant(0.0);
        }
        let (before, after) = (dt.at(self.stamp - 1), dt.at(self.stamp));
        let bend = self.between(1, 2) / after - self.between(0, 1) / before;
        bend * 2.0 / (before + after)
    }

    /// When a machine stops that slows down and then rests or goes back; `None` where it does not do so
    /// in this sample, nor in those after it that show no motion any more: the last of its way is less
    /// than a count.
    #[inline(always)]
    pub fn stop(&self, sample: usize) -> Option<Stop> {
        // In most samples the machine goes on as before and after: there is nothing to look at.
        if let Some([one, two, three, four]) =
            self.readings.get(sample.wrapping_sub(1)..).and_then(|left| left.first_chunk())
            && ((one < two && two < three && three < four)
                || (one > two && two > three && three > four))
        {
            return None;
        }
        self.stop_near(sample)
    }

    fn stop_near(&self, sample: usize) -> Option<Stop> {
        for back in -1..=LATE {
            // The first sample without a way forward.
            let turn = sample.wrapping_add_signed(-back);
            if (turn..sample).any(|before| self.read(before) != 0.0) {
                return None;
            }
            let Some((ago, bend, forward, told)) = self.turn(turn) else { continue };
            let mut left = -ago - back as f64;
            if back < 0 {
                // The sample has a way, be it ever so short: a stop before it is one at its start.
                left = left.max(0.0);
            }
            if (back < 0 && left > 1.0) || (back >= 0 && left <= 0.0) {
                return None;
            }
            let goes_back = self.read(sample) * forward < 0.0;
            let left = if goes_back { left.min(1.0) } else { left };
            let sure = told == TELLING;
            return Some(Stop { left, way: 2.0 * bend * left * forward, sure });
        }
        None
    }

    /// How many samples before a stamp a machine stopped (below 0 for after it) that goes forward until
    /// then and no further; half its deceleration, way per sample squared; which way it went; and how
    /// many stamps tell that.
    ///
    /// A dry contact slows a machine down faster than it lets it speed up again: the way to the stop
    /// tells best when it was. The root of the way that is left falls in a straight line, by which
    /// the stamps before are weighted with that way: their readings err by the same.
    fn turn(&self, stamp: usize) -> Option<(f64, f64, f64, usize)> {
        let last = self.read(stamp.wrapping_sub(1));
        if last == 0.0 || last * self.read(stamp) > 0.0 || !self.goes_no_further(stamp, last) {
            return None;
        }
        let there = *self.readings.get(stamp)?;
        let mut sums = [0.0; 5];
        let mut told = 0;
        for back in 1..=TELLING.min(stamp) {
            if self.read(stamp - back) * last <= 0.0 {
                break;
            }
            let (ago, left) = (back as f64, (there - self.readings[stamp - back]).abs());
            let root = left.sqrt();
            for (sum, term) in sums.iter_mut().zip([1.0, ago, ago * ago, root, ago * root]) {
                *sum += left * term;
            }
            told += 1;
        }
        let [one, first, second, root, product] = sums;
        let spread = one * second - first * first;
        let slope = (one * product - first * root) / spread;
        let ago = (slope * first - root) / (slope * one);
        // One stamp has no slope, and what does not slow down does not stop by itself.
        (told > 1 && slope > 0.0).then(|| (ago, slope * slope, last.signum(), told))
    }

    /// Displacement that was read in a sample; 0 beyond the ends.
    fn read(&self, sample: usize) -> f64 {
        self.readings.get(sample..).map_or(0.0, |left| match left {
            [from, to, ..] => to - from,
            _ => 0.0,
        })
    }

    /// Whether the machine rests in the sample that begins at the present stamp.
    #[inline]
    pub fn rests_next(&self) -> bool {
        self.rests(self.stamp)
    }

    /// Whether the machine rests in a sample: nothing moves in it, nor in one beside it. In slow
    /// motion over counts there are single samples without one.
    fn rests(&self, sample: usize) -> bool {
        let still = |sample| self.read(sample) == 0.0;
        let inside = sample < self.readings.len() - 1;
        inside && still(sample) && (still(sample.wrapping_sub(1)) || still(sample + 1))
    }

    /// Whether a machine that moved this way rests in a sample, or goes back as soon as it moves.
    fn goes_no_further(&self, sample: usize, way: f64) -> bool {
        let next = self.read(sample);
        let next = if next == 0.0 { self.read(sample + 1) } else { next };
        next * way < 0.0 || self.rests(sample)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings of a machine that slows down by `twice` the half of it per sample squared, stops at a
    /// time in samples and rests.
    fn coasting(stop: f64, half: f64) -> Vec<f64> {
        (0..12).map(|k| -half * (stop - f64::from(k)).max(0.0).powi(2)).collect()
    }

    #[test]
    fn a_steady_deceleration_tells_where_a_machine_stopped() {
        for (stop, half) in [(6.3, 2.0), (6.0, 1.0), (6.0 + 1e-7, 1.0), (6.9, 1e-6), (5.5, 1e3)] {
            let readings = coasting(stop, half);
            let track = Track::<f64>::new(&readings, None, 0);
            let found: Vec<(usize, Stop)> =
                (0..11).filter_map(|k| track.stop(k).map(|stop| (k, stop))).collect();
            let [(sample, Stop { left, way, sure })] = found[..] else { panic!("{found:?}") };
            assert!((sample as f64 + left - stop).abs() < 1e-9, "{stop}: {sample} {left}");
            assert!((way - 2.0 * half * left).abs() < 1e-9 * half);
            assert!(sure);
        }
    }

    #[test]
    fn the_last_way_of_a_machine_may_be_less_than_a_count() {
        let readings: Vec<f64> = coasting(8.4, 0.3).iter().map(|x| x.round()).collect();
        // -21, -16, -12, -9, -6, -3, -2, -1, 0, 0 ...
        let track = Track::<f64>::new(&readings, None, 0);
        let stop = track.stop(8).expect("it stops");
        assert!((stop.left - 0.4).abs() < 0.3, "{stop:?}");
        assert_eq!(track.stop(9), None);
    }

    #[test]
    fn what_goes_on_does_not_stop() {
        let steady: Vec<f64> = (0..20).map(f64::from).collect();
        let slow: Vec<f64> = (0..20).map(|k| f64::from(k / 2)).collect();
        let once = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        for readings in [&steady[..], &slow, &once, &[0.0; 5], &[0.0, 1.0]] {
            let track = Track::<f64>::new(readings, None, 0);
            assert!((0..readings.len()).all(|k| track.stop(k).is_none()), "{readings:?}");
        }
    }
}
