//! Plain steps, in which nothing turns round and no mode changes, in loops of their own.

use super::super::elements::spring::{Curve, Loading};
use super::super::{Channels, Motion, Outcome};
use super::HsiehPan;
use super::state::HsiehPanState;
use crate::integrate::{Glide, Seen};
use crate::scalar::Scalar;

/// The slope right after a reversal: rare, and a function so that nobody waits for the choice.
#[cold]
#[inline(never)]
fn after_reversal<S: Scalar>(curve: &Curve<S>) -> S {
    curve.initial_stiffness()
}

impl<S: Scalar> HsiehPan<S> {
    /// Plain steps of a sticking hook whose damper sits beside the spring.
    #[inline(always)]
    pub(super) fn glide_sticking<const SQUARE: bool, E: Fn(usize) -> S, V: Seen<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut Glide<S, E, V>,
    ) {
        let damping = self.parameters.damping;
        let greatest = self.parameters.breakaway.re();
        let span = glide.verlet.span();
        let branch = state.spring.present(&self.curve);
        let mut here = state.spring.here();
        let (mut plastic, mut hardening) = (state.plastic, state.hardening);
        let mut velocity = glide.run.velocity;
        while let Some(effort) = glide.next() {
            let net = effort - (here.force + damping * velocity);
            let (displacement, predicted) = glide.verlet.depart(velocity, net);
            let towards = |direction| {
                if direction == here.direction { here.slope } else { after_reversal(&self.curve) }
            };
            let creep =
                self.plastic.plain_creep::<SQUARE>(hardening, here.force, towards, displacement, span);
            let Some(creep) = creep else { return };
            let (unbraked, braking) = glide.verlet.unbraked(velocity, net + effort, damping);
            let Some(there) = here.onward(&self.curve, &branch, creep.left) else { return };
            let arrived = unbraked - braking * there.force;
            if there.force.re().abs() >= greatest && arrived.re() * there.force.re() > 0.0 {
                return;
            }
            here = there;
            velocity = arrived;
            plastic += creep.displacement;
            hardening += creep.hardening;
            state.spring.slide(&here);
            state.series = here.force;
            state.plastic = plastic;
            state.hardening = hardening;
            let friction = here.force + damping * predicted + damping * (velocity - predicted);
            glide.accept(displacement, velocity, friction, state);
        }
    }

    /// Plain steps of a sliding hook.
    #[inline(always)]
    pub(super) fn glide_sliding<E: Fn(usize) -> S, V: Seen<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut Glide<S, E, V>,
    ) {
        let (mode, latched) = (state.mode, state.latched);
        let least = self.parameters.slip_distance * self.parameters.final_stiffness;
        let greatest = self.parameters.breakaway.re();
        let (mut series, mut velocity) = (state.series, glide.run.velocity);
        while let Some(effort) = glide.next() {
            if mode * velocity.re() < 0.0 {
                return;
            }
            let net = effort - series;
            let (displacement, predicted) = glide.verlet.depart(velocity, net);
            let duration = glide.verlet.span();
            let motion =
                Motion { displacement, duration, start_velocity: velocity, velocity: predicted };
            let slide = self.slide(mode, latched, series, &motion, &Channels::default());
            let Outcome { force, damping, .. } = slide.outcome;
            let undamped = force - damping * predicted;
            let arrived = glide.verlet.arrive(velocity, net + effort, damping, undamped);
            // As `margin` says; what it has to solve for is not plain.
            let held = (least - slide.pull).re() > 0.0 || greatest - force.re().abs() <= 0.0;
            if !held || mode * arrived.re() <= 0.0 {
                return;
            }
            series = slide.series;
            velocity = arrived;
            state.series = series;
            state.spring.force = series;
            let friction = force + damping * (velocity - predicted);
            glide.accept(displacement, velocity, friction, state);
        }
    }
}
