//! Steps of eight contacts at once: each is plain.

use stiction_dispatch::Vector;

use super::{Dahl, DahlState};
use crate::friction::elements::abreast::{Block, Bodies, Contacts, Rest};
use crate::math::row::{Row, WIDTH};
use crate::math::scalar::{Scalar, sign};

/// Contacts of [`Dahl`] whose curve is a quotient, i = 2.
#[derive(Debug, Clone, Default)]
pub struct Lanes {
    dry: Row,
    direction: Row,
    reversals: Row,
    coulomb: Row,
    /// 1/F_c and γ/F_c.
    per_force: Row,
    pace: Row,
    viscous: Row,
    /// See `Verlet::dragged`, and 1/(J + h/2·F_v) and h/2 of that.
    stride: Row,
    kept: Row,
    share: Row,
    braking: Row,
}

/// Whether these contacts can go abreast.
pub fn fits<S: Scalar>(law: &Dahl<S>) -> bool {
    law.0.exponent.re() == 2.0 && !law.0.exponent.derivative_is_nonzero()
}

impl<S: Scalar> Contacts<S, Dahl<S>> for Lanes {
    fn fit(&mut self, lane: usize, law: &Dahl<S>, bodies: &Bodies) {
        let per_force = 1.0 / law.0.coulomb.re();
        self.coulomb.0[lane] = law.0.coulomb.re();
        self.per_force.0[lane] = per_force;
        self.pace.0[lane] = law.0.initial_stiffness.re() * per_force;
        self.viscous.0[lane] = law.0.viscous.re();
        let dragged = bodies.dragged(lane, law.0.viscous.re());
        self.stride.0[lane] = dragged.stride;
        self.kept.0[lane] = dragged.kept;
        self.share.0[lane] = dragged.share;
        self.braking.0[lane] = dragged.braking;
    }

    fn load(&mut self, lane: usize, _law: &Dahl<S>, state: &DahlState<S>) {
        self.dry.0[lane] = state.dry.re();
        self.direction.0[lane] = state.direction;
        self.reversals.0[lane] = state.reversals as f64;
    }

    fn store(&self, lane: usize, state: &mut DahlState<S>) {
        state.dry = S::constant(self.dry.0[lane]);
        state.direction = self.direction.0[lane];
        state.reversals = self.reversals.0[lane] as u64;
    }

    #[inline(always)]
    fn step<V: Vector, const N: usize>(blocks: &mut [Block<Self>; N]) -> Option<[Rest; N]> {
        for Block { bodies, contacts } in blocks {
            for lane in 0..WIDTH {
                contacts.step(lane, bodies);
            }
        }
        None
    }
}

impl Lanes {
    #[inline(always)]
    fn step(&mut self, lane: usize, bodies: &mut Bodies) {
        let (dry, damping) = (self.dry.0[lane], self.viscous.0[lane]);
        let (effort, velocity) = (bodies.effort.0[lane], bodies.velocity.0[lane]);
        let push = effort - dry;
        let displacement = self.stride.0[lane] * velocity + bodies.lever.0[lane] * push;
        let s = sign(displacement);
        let eta = self.pace.0[lane] * (displacement * s);
        let before = -(dry * s * self.per_force.0[lane] - 1.0);
        // `left_over` of the exponent 2.
        let r = before / (eta * before.abs() + 1.0);
        let moved = -(r - 1.0) * self.coulomb.0[lane] * s;
        let stays = s == 0.0;
        let after = if stays { dry } else { moved };
        let old = self.direction.0[lane];
        let direction = if stays { old } else { s };
        let both = push + effort;
        let unbraked =
            (self.kept.0[lane] * velocity + bodies.half.0[lane] * both) * self.share.0[lane];
        let arrived = unbraked - self.braking.0[lane] * after;
        let friction = after + damping * arrived;
        self.dry.0[lane] = after;
        self.direction.0[lane] = direction;
        self.reversals.0[lane] += if direction * old < 0.0 { 1.0 } else { 0.0 };
        bodies.accept(lane, true, displacement, arrived, friction);
    }
}
