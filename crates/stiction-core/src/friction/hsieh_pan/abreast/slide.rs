//! Any steps of sliding hooks.

use super::{Lanes, ROUNDING};
use crate::friction::elements::abreast::{Block, Bodies};
use crate::friction::elements::lag::shares;
use crate::math::exponential::{faded, fading};
use crate::math::row::{Row, WIDTH, bits, pick};
use crate::math::scalar::sign;

/// Steps of these sliding hooks of a row. The spring is asked only where it may hold one of them back
/// or catch its hook. Returns which of them have missed theirs.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // a lane of all rows at a time
pub(super) fn slide(block: &mut Block<Lanes>, lanes: u8) -> u8 {
    let Block { bodies, contacts } = block;
    let mut here = [0; WIDTH];
    let mut slid = Slides::default();
    let (mut faster, mut pulled) = (0, 0);
    for lane in 0..WIDTH {
        here[lane] = u64::from(lanes >> lane & 1);
        faster |= here[lane] & u64::from(slid.take(lane, contacts, bodies));
    }
    if faster != 0 {
        let mut behind = Row::ZERO;
        for lane in 0..WIDTH {
            behind.0[lane] = contacts.force.0[lane] * contacts.mode.0[lane];
        }
        let mut asked = here;
        for lane in 0..WIDTH {
            asked[lane] &= u64::from(!contacts.follows(lane, &slid));
        }
        let at = contacts.virgin_inverse(&behind, asked);
        for lane in 0..WIDTH {
            let limit = contacts.virgin(lane, at.0[lane] + slid.displacement.0[lane].abs()).0;
            let least = contacts.final_stiffness.0[lane] * slid.displacement.0[lane].abs();
            let slower = slid.sigma.0[lane] <= behind.0[lane] + least;
            let within = slid.sigma.0[lane] <= limit;
            let held_back = (asked[lane] != 0) & !slower & !within;
            slid.sigma.take(lane, held_back, limit);
            slid.damping.take(lane, held_back, 0.0);
        }
    }
    let mut asked = here;
    for lane in 0..WIDTH {
        asked[lane] &= u64::from(!contacts.slides_on(lane, &slid));
        pulled |= asked[lane];
    }
    let mut catches = [0; WIDTH];
    if pulled != 0 {
        let mut force = Row::ZERO;
        for lane in 0..WIDTH {
            force.0[lane] = slid.sigma.0[lane] * contacts.mode.0[lane];
        }
        let at = contacts.virgin_inverse(&force, asked);
        for lane in 0..WIDTH {
            let slope = contacts.virgin(lane, at.0[lane]).1;
            let pull = slid.to.0[lane] - slid.sigma.0[lane];
            let margin = contacts.reach.0[lane] * slope - pull;
            let goes_on = margin > 0.0;
            catches[lane] = asked[lane] & u64::from(!goes_on);
        }
    }
    let mut accepted = [0; WIDTH];
    for lane in 0..WIDTH {
        let here = (here[lane] != 0) & (catches[lane] == 0);
        accepted[lane] = u64::from(contacts.slid(lane, here, &slid, bodies));
    }
    lanes & !bits(&accepted)
}

/// Steps of sliding hooks, one in each lane.
#[derive(Clone, Copy, Default)]
struct Slides {
    net: Row,
    displacement: Row,
    predicted: Row,
    /// The sliding level at the end, and the force times the mode.
    to: Row,
    sigma: Row,
    damping: Row,
}

impl Slides {
    /// Takes in the step of a hook that no spring holds back: `HsiehPan::sliding_level` and `follow`.
    /// Returns whether it may be faster than the spring.
    #[inline(always)]
    fn take(&mut self, lane: usize, contacts: &Lanes, bodies: &Bodies) -> bool {
        let (velocity, mode) = (bodies.velocity.0[lane], contacts.mode.0[lane]);
        let net = bodies.effort.0[lane] - contacts.force.0[lane];
        let (displacement, predicted) = bodies.depart(lane, net);
        let (coulomb, excess) = (contacts.coulomb.0[lane], contacts.excess.0[lane]);
        let viscous = contacts.viscous.0[lane];
        let per_velocity = contacts.per_velocity.0[lane];
        let (share, before) = (predicted * per_velocity, velocity * per_velocity);
        let (power, power_before) = (share * share, before * before);
        let (left, left_before) = (fading(-power), fading(-power_before));
        let to = coulomb + excess * left + viscous * predicted.abs();
        let from = coulomb + excess * left_before + viscous * velocity.abs();
        let fall = -(left * (2.0 * power / predicted.abs()));
        let fall = pick(predicted == 0.0, 0.0, fall);
        let steepness = excess * fall + viscous;

        let (remainder, end_share) = shares(displacement.abs() * contacts.per_distance.0[lane]);
        let behind = contacts.force.0[lane] * mode;
        let damping = steepness * end_share * (mode * sign(predicted));
        self.net.0[lane] = net;
        self.displacement.0[lane] = displacement;
        self.predicted.0[lane] = predicted;
        self.to.0[lane] = to;
        self.sigma.0[lane] = from + (to - from) * end_share + (behind - from) * remainder;
        self.damping.0[lane] = if damping > 0.0 { damping } else { 0.0 };
        !contacts.follows(lane, self)
    }
}

impl Lanes {
    /// Whether the force rises for certain by less than that of the spring, whose curve is no softer
    /// anywhere below the level of break-away.
    #[inline(always)]
    fn follows(&self, lane: usize, slid: &Slides) -> bool {
        let behind = self.force.0[lane] * self.mode.0[lane];
        let distance = slid.displacement.0[lane].abs();
        (slid.sigma.0[lane] <= behind - ROUNDING * behind.abs() + self.softest.0[lane] * distance)
            & (slid.sigma.0[lane] <= self.greatest.0[lane])
    }

    /// Whether the hook goes on for certain, whatever the slope of the spring.
    #[inline(always)]
    fn slides_on(&self, lane: usize, slid: &Slides) -> bool {
        let (sigma, pull) = (slid.sigma.0[lane], slid.to.0[lane] - slid.sigma.0[lane]);
        let force = (sigma * self.mode.0[lane]).abs();
        (self.least.0[lane] - pull > 0.0) | (self.greatest.0[lane] - force <= 0.0)
    }

    /// The virgin curve at an elongation and its slope there.
    #[inline(always)]
    fn virgin(&self, lane: usize, x: f64) -> (f64, f64) {
        let d = x.abs() * self.twice.0[lane];
        let gone = faded(-(d * self.inverse_distance.0[lane]));
        let force = self.final_stiffness.0[lane] * d + self.faded_force.0[lane] * gone;
        let slope = self.initial_stiffness.0[lane] - self.fading.0[lane] * gone;
        (force * (1.0 / self.twice.0[lane]).copysign(x), slope)
    }

    /// `Curve::virgin_inverse`, good where it is `asked` for.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // likewise
    fn virgin_inverse(&self, force: &Row, asked: [u64; WIDTH]) -> Row {
        let mut at = Row::ZERO;
        let mut found = asked.map(|asked| asked ^ 1);
        for lane in 0..WIDTH {
            let (twice, target) = (self.twice.0[lane], force.0[lane].abs());
            let (last, distance) = (self.final_stiffness.0[lane], self.distance.0[lane]);
            let rest = last / self.fading.0[lane];
            let share = twice * target / self.faded_force.0[lane];
            let linear = rest + 1.0 - 0.5 * share;
            let root = (linear * linear + 2.0 * rest * share).sqrt();
            let near = 2.0 * share / (linear + root);
            let u = pick(linear > 0.0, near, (root - linear) / rest);
            at.0[lane] = u * distance / twice;
        }
        for _ in 0..60 {
            let mut more = 0;
            for lane in 0..WIDTH {
                let (x, target) = (at.0[lane], force.0[lane].abs());
                let (there, slope) = self.virgin(lane, x);
                let last = self.final_stiffness.0[lane];
                let bend = (last - slope) * self.twice.0[lane] / self.distance.0[lane];
                let step = (target - there) / slope;
                let moved = step / (1.0 + 0.5 * step * bend / slope);
                let next = pick(found[lane] != 0, x, x + moved);
                at.0[lane] = next;
                found[lane] |= u64::from(moved.abs() <= 1e-3 * next);
                more |= found[lane] ^ 1;
            }
            if more == 0 {
                break;
            }
        }
        for lane in 0..WIDTH {
            let s = if force.0[lane] < 0.0 { -1.0 } else { 1.0 };
            let (there, slope) = self.virgin(lane, at.0[lane]);
            at.0[lane] = ((force.0[lane] * s - there) / slope + at.0[lane]) * s;
        }
        at
    }

    /// The end of a step of a sliding hook, accepted where one is `here` and goes on. Returns whether it
    /// was.
    #[inline(always)]
    fn slid(&mut self, lane: usize, here: bool, slid: &Slides, bodies: &mut Bodies) -> bool {
        let (effort, velocity) = (bodies.effort.0[lane], bodies.velocity.0[lane]);
        let (mode, damping) = (self.mode.0[lane], slid.damping.0[lane]);
        let force = slid.sigma.0[lane] * mode;
        let undamped = force - damping * slid.predicted.0[lane];
        let arrived = bodies.arrive(lane, slid.net.0[lane] + effort, damping, undamped);
        let (turned, stops) = (mode * velocity < 0.0, mode * arrived <= 0.0);
        let accepted = here & !turned & !stops;
        self.force.take(lane, accepted, force);
        let friction = undamped + damping * arrived;
        bodies.accept(lane, accepted, slid.displacement.0[lane], arrived, friction);
        accepted
    }
}
