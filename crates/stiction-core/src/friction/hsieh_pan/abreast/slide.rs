//! Steps of sliding hooks.

use super::Lanes;
use crate::exponential::fading;
use crate::friction::elements::lag::shares;
use crate::lanes::{Block, Bodies, WIDTH};
use crate::scalar::sign;

/// Steps of sliding hooks in one block or two, stage by stage.
#[inline(always)]
pub(super) fn slide<const N: usize>(blocks: &mut [Block<Lanes>; N]) {
    const { assert!(N == 1 || N == 2) };
    for lane in 0..WIDTH {
        let (p, q) = (&blocks[0], &blocks[N - 1]);
        let levels = [p.contacts.level(lane, &p.bodies), q.contacts.level(lane, &q.bodies)];
        let lags = [p.contacts.lag(lane, &levels[0]), q.contacts.lag(lane, &levels[1])];
        for (k, Block { bodies, contacts }) in blocks.iter_mut().enumerate() {
            contacts.slide(lane, &levels[k], &lags[k], bodies);
        }
    }
}

/// Sliding levels at the start and at the end of a step, and how the latter falls with speed.
#[derive(Clone, Copy)]
struct Levels {
    net: f64,
    displacement: f64,
    predicted: f64,
    from: f64,
    to: f64,
    steepness: f64,
}

/// How a force follows them.
#[derive(Clone, Copy)]
struct Lag {
    remainder: f64,
    end_share: f64,
}

impl Lanes {
    /// Where a step of a sliding hook goes to, and `HsiehPan::sliding_level`.
    #[inline(always)]
    fn level(&self, lane: usize, bodies: &Bodies) -> Levels {
        let velocity = bodies.velocity.0[lane];
        let net = bodies.effort.0[lane] - self.force.0[lane];
        let (displacement, predicted) = bodies.depart(lane, net);
        let (coulomb, excess) = (self.coulomb.0[lane], self.excess.0[lane]);
        let viscous = self.viscous.0[lane];
        let (share, before) =
            (predicted * self.per_velocity.0[lane], velocity * self.per_velocity.0[lane]);
        let (power, power_before) = (share * share, before * before);
        let (left, left_before) = (fading(-power), fading(-power_before));
        let to = coulomb + excess * left + viscous * predicted.abs();
        let from = coulomb + excess * left_before + viscous * velocity.abs();
        let fall = if predicted == 0.0 { 0.0 } else { -(left * (2.0 * power / predicted.abs())) };
        let steepness = excess * fall + viscous;
        Levels { net, displacement, predicted, from, to, steepness }
    }

    /// `follow`.
    #[inline(always)]
    fn lag(&self, lane: usize, levels: &Levels) -> Lag {
        let z = levels.displacement.abs() * self.per_distance.0[lane];
        let (remainder, end_share) = shares(z);
        Lag { remainder, end_share }
    }

    /// The end of a step of a sliding hook, accepted where it is plain.
    #[inline(always)]
    fn slide(&mut self, lane: usize, levels: &Levels, lag: &Lag, bodies: &mut Bodies) {
        let Levels { net, displacement, predicted, from, to, steepness } = *levels;
        let (effort, velocity) = (bodies.effort.0[lane], bodies.velocity.0[lane]);
        let mode = self.mode.0[lane];
        let behind = self.force.0[lane] * mode;
        let sigma = from + (to - from) * lag.end_share + (behind - from) * lag.remainder;
        let follows = sigma <= behind + self.final_stiffness.0[lane] * displacement.abs();

        let damping = steepness * lag.end_share * (mode * sign(predicted));
        let damping = if damping > 0.0 { damping } else { 0.0 };
        let force = sigma * mode;
        let undamped = force - damping * predicted;
        let arrived = bodies.arrive(lane, net + effort, damping, undamped);
        let pull = to - sigma;
        let held = (self.least.0[lane] - pull > 0.0) | (self.greatest.0[lane] - force.abs() <= 0.0);

        let (turned, stops) = (mode * velocity < 0.0, mode * arrived <= 0.0);
        let here = mode != 0.0;
        let plain = follows & held & !turned & !stops;
        let accepted = here & plain;
        bodies.missed[lane] |= u64::from(here & !plain);
        self.force.take(lane, accepted, force);
        let friction = undamped + damping * arrived;
        bodies.accept(lane, accepted, displacement, arrived, friction);
    }
}
