//! A second mass in a gap, seen from a measured motion of the motor.

use crate::math::scalar::{COLUMNS, Scalar, sign};

use super::ends::{Course, Ends, Mass};

/// How far a second mass is ahead of a motor whose motion is given, where it flies free in a gap.
///
/// e'' = −x'' − β·(x' + e') inside, with an acceleration that changes linearly over a sample and a
/// friction β that is the one of its beginning; at an end it stays until the motor leaves it behind.
#[derive(Debug, Clone)]
pub(super) struct Flight<S> {
    play: S,
    damping: S,
    pub(super) ahead: S,
    pub(super) rate: S,
    before: S,
}

impl<S: Scalar> Flight<S> {
    /// In the middle of the gap.
    pub(super) fn new(width: S, damping: S) -> Self {
        let zero = S::constant(0.0);
        Self { play: width * 0.5, damping, ahead: zero, rate: zero, before: zero }
    }

    /// What its own friction takes from it, per inertia.
    pub(super) fn slowing(&self, velocity: S) -> S {
        self.damping * (velocity + self.rate)
    }

    /// Goes through a sample at whose end the motor has this acceleration and this velocity.
    pub(super) fn advance(&mut self, acceleration: S, velocity: S, span: f64) {
        let slowing = self.slowing(velocity);
        let (from, to) = (self.before + slowing, acceleration + slowing);
        self.before = acceleration;
        let bent = (from * 2.0 + to) * (span * span / 6.0);
        self.ahead += self.rate * span - bent;
        self.rate -= (from + to) * (0.5 * span);
        let side = sign(self.ahead.re());
        if (self.ahead * side - self.play).re() >= 0.0 {
            self.ahead = self.play * side;
            if self.rate.re() * side > 0.0 {
                self.rate = S::constant(0.0);
            }
        }
    }
}

/// Masses whose mean stands for the one.
const MEMBERS: usize = 8;
/// Half of them see a reading too high by what the other half sees it too low.
const PAIRS: usize = MEMBERS / 2;
/// Share of a number over which its derivative is taken.
const CHORD: f64 = 0.1;
/// The same of a number that may be 0, for which this is little.
const LITTLE: f64 = 0.2;

/// How far a second mass is ahead of a motor whose motion is given, in a gap whose ends yield.
///
/// What an end throws back comes down at a moment that depends on the last digit of a reading, and
/// what it does after a few such flights is anybody's guess. So this is what may be expected: the mean
/// of masses that begin all over the gap, each behind a motion that would have been read as this one
/// was. Their derivatives are those of guesses, without bounds; the mean has chords, over a tenth
/// of each number, for all with the same errors of reading.
#[derive(Debug, Clone)]
pub(super) struct Bounce<S> {
    own: Crowd,
    /// By column of derivatives.
    beside: Vec<Beside>,
    /// Size of a count.
    count: f64,
    /// What readings may be off by at this sample and the two before, of one of each pair.
    off: [[f64; 3]; PAIRS],
    sample: u64,
    before: f64,
    damping: S,
}

/// The same masses where a parameter is another one.
#[derive(Debug, Clone)]
struct Beside {
    column: usize,
    less: Crowd,
    more: Crowd,
    /// Change of the parameter from one to the other.
    width: f64,
}

/// Masses in gaps of the same numbers.
#[derive(Debug, Clone)]
struct Crowd {
    ends: Ends,
    masses: [Mass; MEMBERS],
}

impl<S: Scalar> Bounce<S> {
    /// All over a gap whose ends yield, at rest: share of the inertia, width of the gap, contact time,
    /// damping ratio and damping of the load; readings of the motor have counts of this size.
    pub(super) fn new([share, width, contact_time, ratio, damping]: [S; 5], count: f64) -> Self {
        let numbers = [width, contact_time, ratio * (-(share - 1.0)).sqrt(), damping];
        let values = numbers.map(S::re);
        let usual = [values[0], values[1], values[2].max(LITTLE), values[3].max(LITTLE)];
        // What nothing is attached to may fly as it likes.
        let columns = if share.re() > 0.0 { 0..COLUMNS } else { 0..0 };
        let beside = columns.filter_map(|column| {
            let slopes = numbers.map(|number| number.partial(column));
            let most = slopes.iter().zip(usual).map(|(slope, usual)| slope.abs() / usual);
            let most = most.fold(0.0, f64::max);
            let step = if most > 0.0 { CHORD / most } else { return None };
            // No number of a gap falls below 0.
            let least = slopes.iter().zip(values).filter(|(slope, _)| **slope > 0.0);
            let back = least.map(|(slope, value)| value / slope).fold(step, f64::min);
            let at = |change: f64| {
                Crowd::new(std::array::from_fn(|n| (values[n] + change * slopes[n]).max(0.0)))
            };
            Some(Beside { column, less: at(-back), more: at(step), width: back + step })
        });
        Self {
            own: Crowd::new(values),
            beside: beside.collect(),
            count,
            off: [[0.0; 3]; PAIRS],
            sample: 0,
            before: 0.0,
            damping,
        }
    }

    /// How far it is ahead, and how fast it gets there.
    pub(super) fn state(&self) -> (S, S) {
        let (ahead, rate) = self.own.mean();
        let (mut ahead, mut rate) = (S::constant(ahead), S::constant(rate));
        for each in &self.beside {
            let (less, more) = (each.less.mean(), each.more.mean());
            let by = S::variable(0.0, each.column) / each.width;
            ahead += by * (more.0 - less.0);
            rate += by * (more.1 - less.1);
        }
        (ahead, rate)
    }

    /// As [`Flight::slowing`].
    pub(super) fn slowing(&self, velocity: S) -> S {
        self.damping * (velocity + self.state().1)
    }

    /// As [`Flight::advance`].
    pub(super) fn advance(&mut self, acceleration: S, velocity: S, span: f64) {
        self.sample += 1;
        for (pair, off) in self.off.iter_mut().enumerate() {
            let part = drawn(self.sample * PAIRS as u64 + pair as u64) - 0.5;
            *off = [off[1], off[2], self.count * part];
        }
        let bent = self.off.map(|[one, two, three]| (three - 2.0 * two + one) / (span * span));
        let (from, to) = (self.before, acceleration.re());
        self.before = to;
        let velocity = velocity.re();
        let besides = self.beside.iter_mut().flat_map(|each| [&mut each.less, &mut each.more]);
        for crowd in besides.chain([&mut self.own]) {
            crowd.advance([from, to], velocity, &bent, span);
        }
    }
}

impl Crowd {
    fn new([width, contact_time, ratio, damping]: [f64; 4]) -> Self {
        let ends = Ends::new(width, contact_time, ratio, damping);
        let masses = std::array::from_fn(|n| {
            Mass::at(ends.play * ((2 * n + 1) as f64 / MEMBERS as f64 - 1.0))
        });
        Self { ends, masses }
    }

    fn mean(&self) -> (f64, f64) {
        let sums = self
            .masses
            .iter()
            .fold((0.0, 0.0), |(ahead, rate), mass| (ahead + mass.ahead, rate + mass.rate));
        (sums.0 / MEMBERS as f64, sums.1 / MEMBERS as f64)
    }

    fn advance(&mut self, [from, to]: [f64; 2], velocity: f64, bent: &[f64; PAIRS], span: f64) {
        self.ends.prepare(span);
        for (n, mass) in self.masses.iter_mut().enumerate() {
            let bent = if n % 2 == 0 { bent[n / 2] } else { -bent[n / 2] };
            let now = from + bent + self.ends.damping * (velocity + mass.rate);
            mass.advance(&self.ends, Course { now, slope: (to - from) / span }, span);
        }
    }
}

/// A number from 0 to 1 that looks drawn, the same in every run (Steele, Lea, Flood, OOPSLA (2014)).
fn drawn(place: u64) -> f64 {
    let mut bits = place.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^= bits >> 31;
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::Dual;

    /// Share, width, contact time, damping ratio and damping of the load.
    const NUMBERS: [f64; 5] = [0.3, 3e-3, 1.5e-3, 0.4, 0.3];
    const COUNT: f64 = 2e-5;

    #[test]
    fn a_free_mass_crosses_its_gap_in_the_time_that_the_motor_leaves_it_behind() {
        // The motor brakes evenly from rest against the front end: e = a·t²/2 until the other end.
        let (gap, braking, dt) = (2e-3, 40.0, 1e-4);
        let mut flight = Flight::new(gap, 0.0);
        for _ in 0..500 {
            flight.advance(braking, 0.0, dt);
        }
        assert_eq!(flight.ahead, -0.5 * gap);
        flight.advance(-braking, 0.0, dt);
        for k in 1..200 {
            flight.advance(-braking, 0.0, dt);
            // Half a sample late: the acceleration turns round over the first one.
            let t = f64::from(k) * dt;
            let exact = (-0.5 * gap + 0.5 * braking * t * t).min(0.5 * gap);
            assert!((flight.ahead - exact).abs() < braking * dt * (t + dt), "{k}");
        }
        assert_eq!(flight.ahead, 0.5 * gap);
    }

    #[test]
    fn a_load_with_friction_falls_behind_a_motor_that_goes_on_evenly() {
        // e = −v·(t − (1 − e^(−β·t))/β) behind a motor that goes with v.
        let (gap, speed, damping, dt) = (1.0, 3.0, 0.7, 1e-3);
        let mut flight = Flight::new(gap, damping);
        let mut bounce = Bounce::new([0.3, gap, 1e-3, 0.4, damping], 0.0);
        let (begun, _) = bounce.state();
        assert!(begun.abs() < 1e-15);
        for k in 1..400 {
            flight.advance(0.0, speed, dt);
            bounce.advance(0.0, speed, dt);
            let t = f64::from(k) * dt;
            let exact = -speed * (t + (-damping * t).exp_m1() / damping);
            assert!((flight.ahead - exact).abs() < 1e-3 * exact.abs() + 1e-6, "{k}");
            assert!((flight.slowing(speed) - damping * speed * (-damping * t).exp()).abs() < 1e-3);
            // Of masses all over the gap some have come to the end of it.
            assert!(k > 100 || (bounce.state().0 - flight.ahead).abs() < 1e-9, "{k}");
        }
    }

    fn shaking(k: i32) -> (f64, f64) {
        let t = f64::from(k) * 1e-3;
        (60.0 * (19.0 * t).sin() + 9.0 * (173.0 * t).cos(), -60.0 / 19.0 * (19.0 * t).cos())
    }

    #[test]
    fn derivatives_are_those_chords_of_what_may_be_expected() {
        let seeded = std::array::from_fn(|n| Dual::variable(NUMBERS[n], n));
        let mut dual = Bounce::new(seeded, COUNT);
        let mut own = Bounce::new(NUMBERS, COUNT);
        let near = |n: usize, part: f64| {
            let mut other = NUMBERS;
            other[n] *= 1.0 + part;
            Bounce::new(other, COUNT)
        };
        let mut off: Vec<_> = (1..5).map(|n| (near(n, -CHORD), near(n, CHORD))).collect();
        for k in 1..1000 {
            let (acceleration, velocity) = shaking(k);
            dual.advance(Dual::constant(acceleration), Dual::constant(velocity), 1e-3);
            own.advance(acceleration, velocity, 1e-3);
            assert_eq!(dual.state().0.re(), own.state().0);
            for (n, (less, more)) in (1..).zip(&mut off) {
                less.advance(acceleration, velocity, 1e-3);
                more.advance(acceleration, velocity, 1e-3);
                let chord = (more.state().0 - less.state().0) / (2.0 * CHORD * NUMBERS[n]);
                let slope = Scalar::partial(dual.state().0, n);
                assert!((slope - chord).abs() < 1e-9 * (1.0 + chord.abs()), "{n} {k}: {slope}");
            }
        }
    }

    #[test]
    fn chords_follow_what_a_small_gap_or_a_late_arrival_does() {
        // Evenly pushed into an end: e = gap/2 + a·T², whose derivatives are ½, 2·a·T and none.
        let pushed = 30.0;
        let mut dual = Bounce::new(std::array::from_fn(|n| Dual::variable(NUMBERS[n], n)), COUNT);
        for _ in 1..2000 {
            dual.advance(Dual::constant(-pushed), Dual::constant(0.0), 1e-3);
        }
        let (ahead, _) = dual.state();
        let exact = 0.5 * NUMBERS[1] + pushed * NUMBERS[2].powi(2);
        // Readings that tremble press no mass to a hundredth of the gap.
        assert!((ahead.re() - exact).abs() < 1e-2 * NUMBERS[1]);
        assert!((Scalar::partial(ahead, 1) - 0.5).abs() < 1e-2);
        let slope = 2.0 * pushed * NUMBERS[2];
        assert!((Scalar::partial(ahead, 2) - slope).abs() < 0.1 * slope);
        assert!(Scalar::partial(ahead, 3).abs() < 1e-2 * NUMBERS[1] / LITTLE);
    }

    #[test]
    fn numbers_at_their_lower_ends_have_chords_to_one_side() {
        let numbers = [0.3, 3e-3, 1e-3, 0.0, 0.0];
        let mut dual = Bounce::new(std::array::from_fn(|n| Dual::variable(numbers[n], n)), COUNT);
        for k in 1..1000 {
            let (acceleration, velocity) = shaking(k);
            dual.advance(Dual::constant(acceleration), Dual::constant(velocity), 1e-3);
            assert!(dual.state().0.is_finite() && dual.state().1.is_finite());
        }
        assert!(dual.beside.iter().all(|each| each.width > 0.0));
        assert_eq!(dual.beside.len(), 4);
    }
}
