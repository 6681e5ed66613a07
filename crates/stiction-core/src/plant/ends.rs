//! A mass between the ends of a gap that yield, behind a motor whose motion is given.

use crate::math::scalar::sign;

/// Changes between flight and contact that a sample may have; after these the mass stays at the end.
const MOST_CHANGES: usize = 16;
/// Steps in which a sample is looked through for the end of a contact, at most.
const MOST_STEPS: f64 = 64.0;
/// Length of one of these steps as a phase of the contact, rad.
const STEP: f64 = 0.5;
/// Secants by which a moment is found, at most.
const MOST_SECANTS: usize = 50;
/// How closely it is found, as a share of the time until then.
const CLOSE: f64 = 1e-13;
/// What dips into an end by less than this share of half the gap lands there and is not thrown back.
const LANDING: f64 = 0.02;

/// The ends of a gap, and what slows the mass between them.
#[derive(Debug, Clone)]
pub(super) struct Ends {
    /// Half the width of the gap.
    pub(super) play: f64,
    /// Friction of the mass over its inertia, 1/s.
    pub(super) damping: f64,
    omega: f64,
    /// ζ of the mass on an end of a motor that is held.
    ratio: f64,
    /// The sample for which [`Self::passed`] holds.
    span: f64,
    /// What a contact does until each step of a whole sample.
    passed: Vec<Passed>,
}

/// A decaying cosine, and a sine over its frequency.
#[derive(Debug, Clone, Copy)]
struct Passed {
    time: f64,
    cosine: f64,
    sine: f64,
}

/// Acceleration of the motor at some moment, and its slope.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    pub(super) now: f64,
    pub(super) slope: f64,
}

/// Where a mass is in its gap.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Where {
    /// Between the ends.
    Inside,
    /// Pushed by the end on this side, 1 or −1.
    Touching(f64),
    /// Thrown back faster than that end follows: beyond it, and not pushed.
    Off(f64),
}

/// A mass ahead of the motor.
///
/// e'' = −x'' in flight; at an end d'' + 2·ζ·ω·d' + ω²·d = −x'' for the depth d = e ∓ gap/2 as long as
/// ω²·d + 2·ζ·ω·d' pushes, with an acceleration that changes linearly over a sample. Both are solved
/// exactly, and the moments between them are found to the last digits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mass {
    pub(super) ahead: f64,
    pub(super) rate: f64,
    place: Where,
}

impl Mass {
    /// At rest, inside the gap.
    pub(super) fn at(ahead: f64) -> Self {
        Self { ahead, rate: 0.0, place: Where::Inside }
    }

    /// Goes through a sample of this duration, for which the ends are prepared.
    pub(super) fn advance(&mut self, ends: &Ends, mut course: Course, span: f64) {
        let mut left = span;
        for _ in 0..MOST_CHANGES {
            let (then, time) = match self.place {
                Where::Inside => self.until_arrival(ends, course, left),
                Where::Touching(side) => self.until_thrown(ends, course, left, side),
                Where::Off(side) => self.until_caught(ends, course, left, side),
            };
            let before = self.place;
            *self = then;
            if then.place == before {
                return;
            }
            if let (Where::Inside, Where::Touching(side)) = (before, then.place)
                && then.rate * side < LANDING * ends.omega * ends.play
            {
                (self.ahead, self.rate) = (ends.play * side, 0.0);
            }
            course.now += course.slope * time;
            left -= time;
        }
        let side = 1.0_f64.copysign(self.ahead);
        *self = Self { ahead: ends.play * side, rate: 0.0, place: Where::Touching(side) };
    }

    /// A flight of this duration.
    fn flown(self, course: Course, time: f64) -> Self {
        let Course { now, slope } = course;
        Self {
            ahead: self.ahead + (self.rate - (now + slope * time / 3.0) * time * 0.5) * time,
            rate: self.rate - (now + slope * time * 0.5) * time,
            ..self
        }
    }

    /// A contact that went on for so long.
    fn pressed(self, ends: &Ends, course: Course, passed: Passed, side: f64) -> Self {
        let Ends { omega, ratio, .. } = *ends;
        let square = omega * omega;
        let lag = 2.0 * ratio * course.slope / omega;
        let following = |acceleration: f64| -((acceleration - lag) / square);
        let (edge, drift) = (ends.play * side, -(course.slope / square));
        let depth = self.ahead - edge - following(course.now);
        let speed = self.rate - drift;
        let decay = ratio * omega;
        let Passed { time, cosine, sine } = passed;
        let then = following(course.now + course.slope * time);
        Self {
            ahead: edge + then + depth * cosine + (speed + decay * depth) * sine,
            rate: drift + speed * cosine - (decay * speed + square * depth) * sine,
            ..self
        }
    }

    /// Until it reaches an end.
    fn until_arrival(self, ends: &Ends, course: Course, left: f64) -> (Self, f64) {
        let mut start = 0.0;
        let Course { now, slope } = course;
        let reach = (self.rate.abs() + (now.abs() + slope.abs() * left) * left) * left;
        if self.ahead.abs() + reach < ends.play {
            return (self.flown(course, left), left);
        }
        // Between the moments at which it turns round it goes one way.
        for stop in turns(self.rate, course, left) {
            let there = self.flown(course, stop);
            let side = sign(there.ahead);
            if ends.depth(there, side) > 0.0 {
                let time = root([start, stop], |time| ends.depth(self.flown(course, time), side));
                let place = Where::Touching(side);
                return (Self { place, ..self.flown(course, time) }, time);
            }
            start = stop;
        }
        (self.flown(course, left), left)
    }

    /// Until an end does not push any more.
    fn until_thrown(self, ends: &Ends, course: Course, left: f64, side: f64) -> (Self, f64) {
        let mut start = 0.0;
        let mut last = self;
        let whole = left == ends.span;
        let number = ends.steps(left);
        for step in 1..=number as usize {
            let passed = if whole {
                ends.passed[step - 1]
            } else {
                ends.passed(left * step as f64 / number)
            };
            last = self.pressed(ends, course, passed, side);
            if ends.push(last, side) <= 0.0 {
                let after = |time| self.pressed(ends, course, ends.passed(time), side);
                let time = root([start, passed.time], |time| -ends.push(after(time), side));
                return (Self { place: Where::Off(side), ..after(time) }, time);
            }
            start = passed.time;
        }
        (last, left)
    }

    /// Until what an end has thrown back is out of its reach, or pushed again.
    fn until_caught(self, ends: &Ends, course: Course, left: f64, side: f64) -> (Self, f64) {
        let mut start = 0.0;
        let number = ends.steps(left);
        for step in 1..=number as usize {
            let stop = left * step as f64 / number;
            let there = self.flown(course, stop);
            let out = |mass: Self| -ends.depth(mass, side);
            let pushed = |mass: Self| ends.push(mass, side);
            let (place, time) = if out(there) >= 0.0 {
                (Where::Inside, root([start, stop], |time| out(self.flown(course, time))))
            } else if pushed(there) > 0.0 {
                let time = root([start, stop], |time| pushed(self.flown(course, time)));
                (Where::Touching(side), time)
            } else {
                start = stop;
                continue;
            };
            return (Self { place, ..self.flown(course, time) }, time);
        }
        (self.flown(course, left), left)
    }
}

impl Ends {
    /// A gap of this width with this contact time, ζ of the mass alone, and friction over inertia.
    pub(super) fn new(width: f64, contact_time: f64, ratio: f64, damping: f64) -> Self {
        let (play, omega) = (0.5 * width, 1.0 / contact_time);
        Self { play, damping, omega, ratio, span: 0.0, passed: Vec::new() }
    }

    /// Makes ready for samples of this duration.
    pub(super) fn prepare(&mut self, span: f64) {
        if span != self.span {
            self.span = span;
            let number = self.steps(span);
            let steps = 1..=number as usize;
            self.passed = steps.map(|step| self.passed(span * step as f64 / number)).collect();
        }
    }

    fn passed(&self, time: f64) -> Passed {
        let swing = self.omega * (1.0 - self.ratio * self.ratio).sqrt();
        let left = (-self.ratio * self.omega * time).exp();
        let (sine, cosine) = (swing * time).sin_cos();
        Passed { time, cosine: left * cosine, sine: left * sine / swing }
    }

    /// In how many steps a time is looked through.
    fn steps(&self, time: f64) -> f64 {
        (time * self.omega / STEP).ceil().clamp(1.0, MOST_STEPS)
    }

    /// Depth in an end; negative where the mass is not in it.
    fn depth(&self, mass: Mass, side: f64) -> f64 {
        mass.ahead * side - self.play
    }

    /// What an end pushes with, per inertia; it does not where that is negative.
    fn push(&self, mass: Mass, side: f64) -> f64 {
        let Self { omega, ratio, .. } = *self;
        omega * (omega * self.depth(mass, side) + 2.0 * ratio * mass.rate * side)
    }
}

/// The moments at which a flight turns round, and its end.
fn turns(rate: f64, Course { now, slope }: Course, end: f64) -> impl Iterator<Item = f64> {
    // rate = now·t + slope·t²/2, without a difference of what is nearly the same.
    let root = (now * now + 2.0 * slope * rate).max(0.0).sqrt();
    let sum = now + if now < 0.0 { -root } else { root };
    let (one, other) = (2.0 * rate / sum, -sum / slope);
    let (early, late) = if one < other { (one, other) } else { (other, one) };
    // What is no number is within no bounds.
    let within = move |time: &f64| *time > 0.0 && *time < end;
    [early, late].into_iter().filter(within).chain([end])
}

/// Where something that is below 0 at the first of two moments, and not at the second, comes to 0: by
/// secants, the Illinois way (Dowell, Jarratt, BIT 11 (1971)), and then not below 0.
fn root([mut before, mut after]: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    let least = CLOSE * after;
    let (mut low, mut high) = (value(before), value(after));
    if low >= 0.0 {
        return before;
    }
    let mut last = 0.0;
    for _ in 0..MOST_SECANTS {
        if after - before <= least {
            break;
        }
        let middle = (before * high - after * low) / (high - low);
        if !(middle > before && middle < after) {
            break;
        }
        let there = value(middle);
        // Where the same end moves twice the other one counts half.
        let twice = if there * last > 0.0 { 0.5 } else { 1.0 };
        if there < 0.0 {
            (before, low, high) = (middle, there, twice * high);
        } else {
            (after, high, low) = (middle, there, twice * low);
        }
        last = there;
    }
    after
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPAN: f64 = 1e-3;

    /// A motor that swings and shakes.
    fn shaking(k: i32) -> f64 {
        let t = f64::from(k) * SPAN;
        40.0 * (9.0 * t).sin() + 25.0 * (41.3 * t).sin() + 9.0 * (173.0 * t).cos()
    }

    /// Where a mass is at the end of each sample.
    fn passes(ends: &mut Ends, samples: i32, course: impl Fn(i32) -> f64) -> Vec<Mass> {
        let (mut mass, mut now) = (Mass::at(0.0), 0.0);
        ends.prepare(SPAN);
        let through = (1..samples).map(|k| {
            let then = course(k);
            mass.advance(ends, Course { now, slope: (then - now) / SPAN }, SPAN);
            now = then;
            mass
        });
        through.collect()
    }

    /// The same in small steps of the equations themselves.
    fn stepped(ends: &Ends, samples: i32) -> Vec<f64> {
        let parts = 2000;
        let h = SPAN / f64::from(parts);
        let (mut ahead, mut rate, mut before) = (0.0_f64, 0.0_f64, 0.0);
        let mut seen = Vec::new();
        for k in 1..samples {
            for part in 0..parts {
                let now = (f64::from(part) + 0.5) / f64::from(parts);
                let half = ahead + 0.5 * h * rate;
                let (side, depth) = (half.signum(), half.abs() - ends.play);
                let damped = 2.0 * ends.ratio * ends.omega * rate * side;
                let push = (ends.omega * ends.omega * depth + damped).max(0.0);
                let push = if depth > 0.0 { push * side } else { 0.0 };
                rate -= h * (before + (shaking(k) - before) * now + push);
                ahead = half + 0.5 * h * rate;
            }
            before = shaking(k);
            seen.push(ahead);
        }
        seen
    }

    #[test]
    fn ends_that_yield_throw_back_as_their_equations_say() {
        for (width, time, ratio) in [(3e-3, 1.5e-3, 0.2), (1e-3, 4e-4, 0.5), (1e-3, 3e-3, 0.0)] {
            let mut ends = Ends::new(width, time, ratio, 0.0);
            let exact = stepped(&ends, 300);
            let mut thrown = false;
            for (mass, exact) in passes(&mut ends, 300, shaking).iter().zip(exact) {
                // What hardly dips into an end lands there, and so much may be missing.
                assert!((mass.ahead - exact).abs() < LANDING * width, "{width} {time}");
                thrown |= matches!(mass.place, Where::Off(_));
            }
            assert!(thrown || ratio == 0.0);
        }
    }

    #[test]
    fn a_mass_that_is_pushed_evenly_rests_in_the_end_as_deep_as_its_stiffness_says() {
        let (width, time, pushed) = (2e-3, 1.2e-3, -30.0);
        let mut ends = Ends::new(width, time, 0.4, 0.0);
        let last = *passes(&mut ends, 1000, |_| pushed).last().unwrap();
        assert!((last.ahead - (0.5 * width - pushed * time * time)).abs() < 1e-12);
        assert!(last.rate.abs() < 1e-9 && last.place == Where::Touching(1.0));
    }

    #[test]
    fn no_numbers_make_a_mass_leave_the_finite_or_go_on_without_end() {
        for (width, time) in [(1e-12, 1e-9), (1e-12, 1.0), (1e3, 1e-9), (1e-3, 1e-6), (1e-4, 1e-2)]
        {
            for (ratio, size) in [(0.0, 1.0), (0.0, 1e6), (0.9, 1e-9), (0.9, 0.0), (0.3, 1e4)] {
                let mut ends = Ends::new(width, time, ratio, 0.0);
                for mass in passes(&mut ends, 2000, |k| size * shaking(k)) {
                    assert!(mass.ahead.is_finite() && mass.rate.is_finite(), "{width} {time}");
                }
            }
        }
    }
}
