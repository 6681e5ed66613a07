//! Steps of eight contacts at once: what [`FrictionLaw::glide`](crate::friction::FrictionLaw::glide)
//! does.

use stiction_dispatch::Vector;

use super::{BristleState, LuGre};
use crate::friction::elements::abreast::{Block, Bodies, Contacts, Rest};
use crate::friction::elements::bell::Bells;
use crate::friction::elements::lag::shares;
use crate::friction::elements::slides::SlidesAbreast;
use crate::math::row::{Row, WIDTH};
use crate::math::scalar::{Scalar, sign};

/// Contacts of [`LuGre`] whose level falls as a bell or not at all, with a damping that does not fall.
#[derive(Debug, Clone, Default)]
pub struct Lanes {
    deflection: Row,
    slides: SlidesAbreast,
    stiffness: Row,
    /// 1/σ₀.
    compliance: Row,
    damping: Row,
    viscous: Row,
    coulomb: Row,
    level: Bells,
}

/// Whether these contacts can go abreast.
pub fn fits<S: Scalar>(law: &LuGre<S>) -> bool {
    law.0.damping_velocity.re().is_infinite() && law.0.level.bell().is_some()
}

impl<S: Scalar> Contacts<S, LuGre<S>> for Lanes {
    fn fit(&mut self, lane: usize, law: &LuGre<S>, _bodies: &Bodies) {
        let bristle = &law.0;
        if let Some(bell) = bristle.level.bell() {
            self.level.fit(lane, bell);
        }
        self.stiffness.0[lane] = bristle.stiffness.re();
        self.compliance.0[lane] = 1.0 / bristle.stiffness.re();
        self.damping.0[lane] = bristle.damping.re();
        self.viscous.0[lane] = bristle.viscous.re();
        self.coulomb.0[lane] = bristle.level.coulomb.re();
    }

    fn load(&mut self, lane: usize, _law: &LuGre<S>, state: &BristleState<S>) {
        self.deflection.0[lane] = state.deflection.re();
        self.slides.load(lane, &state.slides);
    }

    fn store(&self, lane: usize, state: &mut BristleState<S>) {
        state.deflection = S::constant(self.deflection.0[lane]);
        self.slides.store(lane, &mut state.slides);
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
        let (stiffness, damper) = (self.stiffness.0[lane], self.damping.0[lane]);
        let viscous = self.viscous.0[lane];
        let (from, _) = self.level.at(lane, before);
        let borne = stiffness * self.deflection.0[lane];
        let per_from = 1.0 / from;
        let slipping = borne * sign(before) * per_from;
        let others = borne + viscous * before;
        let net = effort - (others + damper * (before * -(slipping - 1.0)));
        let (displacement, velocity) = bodies.depart(lane, net);

        // `LuGre::bend`.
        let (to, steepness) = self.level.at(lane, velocity);
        let s = sign(displacement);
        let path = stiffness * displacement * s;
        let per_to = 1.0 / to;
        let z = path * (per_from * 0.5 + per_to * 0.5);
        let (remainder, end_share) = shares(z);
        let followed = from + (to - from) * end_share + (borne * s - from) * remainder;
        let stays = s == 0.0;
        let bent = if stays { borne } else { followed * s };
        let by_end = if stays { 0.0 } else { steepness * end_share };

        // `Bristle::outcome`.
        let towards = sign(velocity);
        let share = bent * towards * per_to;
        let by_speed = -(share * (steepness * per_to));
        let bends = -(share - 1.0);
        let slips = (per_to * by_end + by_speed) * towards;
        let implicit = (by_end + viscous) + damper * (bends - velocity * slips);
        let damping = if implicit > 0.0 { implicit } else { 0.0 };
        let force = (bent + viscous * velocity) + damper * (velocity * bends);
        let undamped = force - damping * velocity;
        let arrived = bodies.arrive(lane, net + effort, damping, undamped);
        let friction = undamped + damping * arrived;

        // A velocity that is held has a formula of its own.
        let plain = stays | (before != velocity);
        bodies.missed[lane] = u64::from(!plain);
        self.deflection.take(lane, plain, bent * self.compliance.0[lane]);
        self.slides.step(lane, plain, velocity, bent, self.coulomb.0[lane]);
        bodies.accept(lane, plain, displacement, arrived, friction);
    }
}
