//! Steps of a bare body in which no mode changes, in loops of their own.

use super::super::elements::branch::{Fading, Here};
use super::super::elements::loading::{Curve, Loading};
use super::super::elements::plastic::Creep;
use super::super::elements::spring::SpringState;
use super::super::{Motion, Outcome, PlainSteps};
use super::HsiehPan;
use super::state::HsiehPanState;
use crate::math::scalar::Scalar;

/// The slope right after a reversal: rare, and a function so that nobody waits for the choice.
#[cold]
#[inline(never)]
fn after_reversal<S: Scalar>(curve: &Curve<S>) -> S {
    curve.initial_stiffness()
}

/// The branch on which a spring is.
fn branch_of<S: Scalar>(curve: &Curve<S>, spring: &SpringState<S>) -> Option<Fading<S>> {
    curve.fading(&spring.present(curve), spring.direction)
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

    /// What it is after a step.
    #[inline(always)]
    fn after(&self, here: Here<S>, creep: &Creep<S>) -> Self {
        let plastic = self.plastic + creep.displacement;
        Self { here, plastic, hardening: self.hardening + creep.hardening }
    }

    /// See [`Here::apart`].
    #[inline(always)]
    fn apart(&self) -> Self {
        let [plastic, hardening] = [self.plastic, self.hardening].map(S::alone);
        Self { here: self.here.apart(), plastic, hardening }
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
    pub(super) fn glide_in_mode<G: PlainSteps<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut G,
    ) {
        if state.mode != 0.0 {
            self.glide_sliding(state, glide);
        } else if self.plastic.is_square() {
            self.glide_sticking::<true, _>(state, glide);
        } else {
            self.glide_sticking::<false, _>(state, glide);
        }
    }

    /// Steps of a sticking hook until it breaks away.
    #[inline(always)]
    fn glide_sticking<const SQUARE: bool, G: PlainSteps<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut G,
    ) {
        let (curve, module) = (&self.curve, &self.plastic);
        let damping = self.parameters.damping;
        let greatest = self.parameters.breakaway.re();
        let looks = glide.looks();
        let verlet = glide.verlet().dragged(damping);
        let share = verlet.share(damping);
        let (pacing, braking) = (module.pacing(verlet.span()), verlet.braking(share));
        let Some(mut branch) = branch_of(curve, &state.spring) else { return };
        let mut now = Sticking::of(state);
        let mut velocity = glide.velocity();
        while let Some(effort) = glide.next() {
            let here = now.here;
            let push = effort - Self::raised::<G>(here.force, glide.levels().0);
            let displacement = verlet.displacement(velocity, push);
            let towards = |direction| {
                if direction == here.direction { here.slope } else { after_reversal(curve) }
            };
            let creep = module.plain_creep::<SQUARE>(
                now.hardening,
                here.force,
                towards,
                displacement,
                &pacing,
            );
            let predicted = || verlet.predicted(velocity, push - damping * velocity);
            let effort_then = glide.there(effort, displacement, predicted);
            let unbraked = verlet.unbraked(velocity, push + effort_then, share);
            let plain = creep.and_then(|creep| Some((creep, here.onward(&branch, creep.left)?)));
            let arrived;
            let level = glide.levels_there().0;
            if let Some((creep, there)) = plain {
                arrived = unbraked - braking * Self::raised::<G>(there.force, level);
                if breaks(there.force, greatest, arrived) {
                    break;
                }
                now = now.after(there, &creep);
            } else {
                // A copy for the call: what it may look at could not stay in registers.
                let begun = now.apart();
                let level = if G::LEVELS { level } else { S::constant(1.0) };
                let rest = (unbraked, braking, level);
                let apart = self.step_apart(state, &begun, displacement, verlet.span(), rest);
                let Some(apart) = apart else { break };
                (now, branch, arrived) = apart;
            }
            if looks {
                now.keep(state);
            }
            glide.pulled(displacement, now.here.force);
            let friction = Self::raised::<G>(now.here.force, level) + damping * arrived;
            velocity = glide.accept(displacement, arrived, friction, state);
        }
        now.apart().keep(state);
    }

    /// A force at a level, where there is one.
    #[inline(always)]
    fn raised<G: PlainSteps<S, HsiehPanState<S>>>(force: S, level: S) -> S {
        if G::LEVELS { force * level } else { force }
    }

    /// A step in which creep sets in or ends, or the spring gets through its reverse points or is
    /// evaluated from the last of them, and the velocity then; nowhere where the hook breaks away or a
    /// point more needs room.
    #[cold]
    #[inline(never)]
    fn step_apart(
        &self,
        state: &mut HsiehPanState<S>,
        now: &Sticking<S>,
        displacement: S,
        duration: S,
        (unbraked, braking, level): (S, S, S),
    ) -> Option<(Sticking<S>, Fading<S>, S)> {
        now.keep(state);
        let spring = &mut state.spring;
        let towards = |direction| spring.slope_towards(&self.curve, direction);
        let force = now.here.force;
        let creep = self.plastic.creep(now.hardening, force, towards, displacement, duration);
        let walk = spring.walk(&self.curve, creep.left);
        let arrived = unbraked - braking * (walk.end.force * level);
        let crowded = walk.added.is_some() && !spring.memory.has_room();
        if crowded || breaks(walk.end.force, self.parameters.breakaway.re(), arrived) {
            return None;
        }
        spring.accept(&walk);
        spring.count(&walk, &mut state.statistics);
        let there = now.after(spring.here(), &creep);
        Some((there, branch_of(&self.curve, spring)?, arrived))
    }

    /// Plain steps of a sliding hook.
    #[inline(always)]
    fn glide_sliding<G: PlainSteps<S, HsiehPanState<S>>>(
        &self,
        state: &mut HsiehPanState<S>,
        glide: &mut G,
    ) {
        let (mode, latched) = (state.mode, state.latched);
        let least = self.parameters.slip_distance * self.parameters.final_stiffness;
        let greatest = self.parameters.breakaway.re();
        let looks = glide.looks();
        let (verlet, duration) = (*glide.verlet(), glide.verlet().span());
        let (free, freely) = verlet.free();
        let (mut series, mut velocity) = (state.series, glide.velocity());
        if mode * velocity.re() < 0.0 {
            return;
        }
        while let Some(effort) = glide.next() {
            let net = effort - Self::raised::<G>(series, glide.levels().0);
            let displacement = verlet.displacement(velocity, net);
            let predicted = verlet.predicted(velocity, net);
            let motion =
                Motion { displacement, duration, start_velocity: velocity, velocity: predicted };
            let effort_then = glide.there(effort, displacement, || predicted);
            let slide = self.slide(mode, latched, series, &motion, &glide.channels_there());
            let Outcome { force, damping, .. } = slide.outcome;
            // Mostly nothing damps: then nothing waits for what would, and for no division.
            let (share, braking, undamped) = if damping.re() == 0.0 {
                (free, freely, force)
            } else {
                let share = verlet.share(damping);
                (share, verlet.braking(share), force - damping * predicted)
            };
            let arrived = verlet.unbraked(velocity, net + effort_then, share) - braking * undamped;
            // As `margin` says; what it has to solve for is not plain.
            let held = (least - slide.pull).re() > 0.0 || greatest - slide.series.re().abs() <= 0.0;
            if !held || mode * arrived.re() <= 0.0 {
                break;
            }
            series = slide.series;
            if looks {
                state.series = series;
                state.spring.force = series;
            }
            let friction = undamped + damping * arrived;
            velocity = glide.accept(displacement, arrived, friction, state);
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
