//! Plain steps of eight contacts at once: rests that hold, and slides that go on.

use stiction_dispatch::Vector;

use super::{Coulomb, CoulombState};
use crate::friction::elements::abreast::{Block, Bodies, Contacts, Rest};
use crate::friction::elements::bell::Bells;
use crate::math::row::{Row, WIDTH};
use crate::math::scalar::{Scalar, sign};

/// Contacts of [`Coulomb`] whose level falls as a bell or not at all.
#[derive(Debug, Clone, Default)]
pub struct Lanes {
    /// 0 sticks, ±1 slides.
    mode: Row,
    force: Row,
    breakaway: Row,
    viscous: Row,
    level: Bells,
}

/// Whether these contacts can go abreast.
pub fn fits<S: Scalar>(law: &Coulomb<S>) -> bool {
    !law.falls || law.parameters.stribeck_exponent.re() == 2.0
}

impl<S: Scalar> Contacts<S, Coulomb<S>> for Lanes {
    fn fit(&mut self, lane: usize, law: &Coulomb<S>, _bodies: &Bodies) {
        let p = &law.parameters;
        let excess = (p.breakaway - p.coulomb).re();
        self.level.fit(lane, [p.coulomb.re(), excess, p.stribeck_velocity.re()]);
        self.breakaway.0[lane] = p.breakaway.re();
        self.viscous.0[lane] = p.viscous.re();
    }

    fn load(&mut self, lane: usize, _law: &Coulomb<S>, state: &CoulombState<S>) {
        self.mode.0[lane] = state.0.mode;
        self.force.0[lane] = state.0.force.re();
    }

    fn store(&self, lane: usize, state: &mut CoulombState<S>) {
        state.0.force = S::constant(self.force.0[lane]);
    }

    #[inline(always)]
    fn step<V: Vector, const N: usize>(blocks: &mut [Block<Self>; N]) -> Option<[Rest; N]> {
        let rests = blocks.each_mut().map(|Block { bodies, contacts }| {
            for lane in 0..WIDTH {
                contacts.step(lane, bodies);
            }
            bodies.rest()
        });
        Some(rests)
    }
}

impl Lanes {
    #[inline(always)]
    fn step(&mut self, lane: usize, bodies: &mut Bodies) {
        let (effort, before) = (bodies.effort.0[lane], bodies.velocity.0[lane]);
        let (mode, viscous) = (self.mode.0[lane], self.viscous.0[lane]);
        let net = effort - (self.level.at(lane, before).0 * mode + viscous * before);
        let (displacement, velocity) = bodies.depart(lane, net);
        let (level, steepness) = self.level.at(lane, velocity);
        let force = level * mode + viscous * velocity;
        let slope = steepness * (mode * sign(velocity)) + viscous;
        let damping = if slope > 0.0 { slope } else { 0.0 };
        let undamped = force - damping * velocity;
        let arrived = bodies.arrive(lane, net + effort, damping, undamped);
        let friction = undamped + damping * arrived;

        let sticks = mode == 0.0;
        let rests = sticks & (before == 0.0) & (effort.abs() <= self.breakaway.0[lane]);
        let slides = !sticks & (mode * before >= 0.0) & (mode * arrived > 0.0);
        let plain = rests | slides;
        bodies.missed[lane] = u64::from(!plain);
        self.force.take(lane, plain, if rests { effort } else { force });
        // −0 leaves also a position of −0 where it is.
        let displacement = if rests { -0.0 } else { displacement };
        let arrived = if rests { before } else { arrived };
        let friction = if rests { effort } else { friction };
        bodies.accept(lane, plain, displacement, arrived, friction);
    }
}
