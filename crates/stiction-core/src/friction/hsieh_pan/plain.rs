//! Steps of a bare body in which no mode changes, in loops of their own.

use super::super::elements::spring::{Branch, Curve, Here, Loading};
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

/// What a sticking hook changes from step to step.
#[derive(Debug, Clone, Copy)]
struct Sticking<S> {
    here: Here<S>,
    plastic: S,
    hardening: S,
}

impl<S: Scalar> Sticking<S> {
    #[inline(always)]
    fn of(state: &HsiehPanState<S>) -> Self {
        Self { here: state.spring.here(), plastic: state.plastic, hardening: state.hardening }
    }

    #[inline(always)]
    fn keep(&self, state: &mut HsiehPanState<S>) {
        state.spring.slide(&self.here);
        state.series = self.here.force;
        state.plastic = self.plastic;
        state.hardening = self.hardening;
    }
}

impl<S: Scalar> HsiehPan<S> {
    /// Steps of a hook, whose damper sits beside the spring, in its present mode.
    #[inline(always)]
    pub(super) fn glide_in_mode<E: Fn(usize) -> S, V: Seen<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut Glide<S, E, V>,
    ) {
        if state.mode != 0.0 {
            self.glide_sliding(state, glide);
        } else if self.plastic.is_square() {
            self.glide_sticking::<true, _, _>(state, glide);
        } else {
            self.glide_sticking::<false, _, _>(state, glide);
        }
    }

    /// Steps of a sticking hook in which creep neither sets in nor ends.
    #[inline(always)]
    fn glide_sticking<
        const SQUARE: bool,
        E: Fn(usize) -> S,
        V: Seen<S, HsiehPanState<S>>,
    >(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut Glide<S, E, V>,
    ) {
        let (curve, module) = (&self.curve, &self.plastic);
        let damping = self.parameters.damping;
        let greatest = self.parameters.breakaway.re();
        let looks = glide.seen.looks();
        let verlet = glide.verlet.dragged(damping);
        let share = verlet.share(damping);
        let (span, braking) = (verlet.span(), verlet.braking(share));
        let mut branch = state.spring.present(curve);
        let mut now = Sticking::of(state);
        let mut velocity = glide.run.velocity;
        while let Some(effort) = glide.next() {
            let here = now.here;
            let push = effort - here.force;
            let displacement = verlet.displacement(velocity, push);
            let towards = |direction| {
                if direction == here.direction { here.slope } else { after_reversal(curve) }
            };
            let creep =
                module.plain_creep::<SQUARE>(now.hardening, here.force, towards, displacement, span);
            let Some(creep) = creep else { break };
            let unbraked = verlet.unbraked(velocity, push + effort, share);
            let arrived;
            if let Some(there) = here.onward(curve, &branch, creep.left) {
                arrived = unbraked - braking * there.force;
                if breaks(there.force, greatest, arrived) {
                    break;
                }
                now.here = there;
            } else {
                let turned = self.turned(state, &now, creep.left, (unbraked, braking));
                let Some(turned) = turned else { break };
                (now.here, branch, arrived) = turned;
            }
            velocity = arrived;
            now.plastic += creep.displacement;
            now.hardening += creep.hardening;
            if looks {
                now.keep(state);
            }
            glide.accept(displacement, velocity, now.here.force + damping * velocity, state);
        }
        now.keep(state);
    }

    /// Where the spring gets through its reverse points, or evaluated from the last of them, and the
    /// velocity then; nowhere where the hook breaks away or a point more needs room.
    #[cold]
    #[inline(never)]
    fn turned(
        &self,
        state: &mut HsiehPanState<S>,
        now: &Sticking<S>,
        displacement: S,
        (unbraked, braking): (S, S),
    ) -> Option<(Here<S>, Branch, S)> {
        now.keep(state);
        let walk = state.spring.walk(&self.curve, displacement);
        let arrived = unbraked - braking * walk.end.force;
        let crowded = walk.added.is_some() && !state.spring.memory.has_room();
        if crowded || breaks(walk.end.force, self.parameters.breakaway.re(), arrived) {
            return None;
        }
        state.spring.accept(&walk);
        state.spring.count(&walk, &mut state.statistics);
        Some((state.spring.here(), state.spring.present(&self.curve), arrived))
    }

    /// Plain steps of a sliding hook.
    #[inline(always)]
    fn glide_sliding<E: Fn(usize) -> S, V: Seen<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut Glide<S, E, V>,
    ) {
        let (mode, latched) = (state.mode, state.latched);
        let least = self.parameters.slip_distance * self.parameters.final_stiffness;
        let greatest = self.parameters.breakaway.re();
        let looks = glide.seen.looks();
        let (verlet, duration) = (glide.verlet, glide.verlet.span());
        let free = verlet.share(S::constant(0.0));
        let freely = verlet.braking(free);
        let (mut series, mut velocity) = (state.series, glide.run.velocity);
        if mode * velocity.re() < 0.0 {
            return;
        }
        while let Some(effort) = glide.next() {
            let net = effort - series;
            let displacement = verlet.displacement(velocity, net);
            let predicted = verlet.predicted(velocity, net);
            let motion =
                Motion { displacement, duration, start_velocity: velocity, velocity: predicted };
            let slide = self.slide(mode, latched, series, &motion, &Channels::default());
            let Outcome { force, damping, .. } = slide.outcome;
            // Mostly nothing damps: then nothing waits for what would, and for no division.
            let (share, braking, undamped) = if damping.re() == 0.0 {
                (free, freely, force)
            } else {
                let share = verlet.share(damping);
                (share, verlet.braking(share), force - damping * predicted)
            };
            let arrived = verlet.unbraked(velocity, net + effort, share) - braking * undamped;
            // As `margin` says; what it has to solve for is not plain.
            let held = (least - slide.pull).re() > 0.0 || greatest - force.re().abs() <= 0.0;
            if !held || mode * arrived.re() <= 0.0 {
                break;
            }
            series = slide.series;
            velocity = arrived;
            if looks {
                state.series = series;
                state.spring.force = series;
            }
            glide.accept(displacement, velocity, undamped + damping * velocity, state);
        }
        state.series = series;
        state.spring.force = series;
    }
}

/// Whether a hook under this force breaks away at its greatest, moving at this velocity.
#[inline(always)]
fn breaks<S: Scalar>(force: S, greatest: f64, velocity: S) -> bool {
    force.re().abs() >= greatest && velocity.re() * force.re() > 0.0
}
