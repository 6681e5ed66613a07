//! Steps of a bare body, in a loop of their own.

use super::{MaxwellSlip, MaxwellSlipState};
use crate::friction::PlainSteps;
use crate::friction::elements::yield_curve::{Course, YieldCurve};
use crate::math::scalar::Scalar;

impl<S: Scalar> MaxwellSlip<S> {
    /// Steps along branches, all of them exponential or not, until a reverse point more needs room.
    #[inline(always)]
    pub(super) fn glide_on<G: PlainSteps<S, MaxwellSlipState<S>>, const EXPONENTIAL: bool>(
        &self,
        state: &mut MaxwellSlipState<S>,
        glide: &mut G,
    ) {
        let (curve, damping) = (&self.curve, self.parameters.viscous);
        let looks = glide.looks();
        let plainly = glide.verlet().dragged(damping);
        let mut share = plainly.share(damping);
        let mut braking = plainly.braking(share);
        let mut shared = damping;
        let mut course = curve.course(&state.spring);
        let (mut here, mut velocity) = (state.spring.here(), glide.velocity());
        while let Some(effort) = glide.next() {
            let mut verlet = plainly;
            let (mut push, mut dragging) = (effort - here.force, damping);
            if G::LEVELS {
                push = effort - here.force * glide.levels().0;
                dragging = damping * glide.levels().1;
                verlet = glide.verlet().dragged(dragging);
            }
            let displacement = verlet.displacement(velocity, push);
            let predicted = || verlet.predicted(velocity, push - dragging * velocity);
            let effort_then = glide.there(effort, displacement, predicted);
            let mut dragged_then = damping;
            if G::LEVELS {
                dragged_then = damping * glide.levels_there().1;
                // Mostly the same as before: then no step waits for a division.
                if S::CARRIES || dragged_then.re() != shared.re() {
                    share = verlet.share(dragged_then);
                    braking = verlet.braking(share);
                    shared = dragged_then;
                }
            }
            let unbraked = verlet.unbraked(velocity, push + effort_then, share);
            if let Some(there) = curve.along::<EXPONENTIAL>(&course, &here, displacement) {
                here = there;
            } else {
                state.spring.slide(&here.apart());
                let Some(turned) = Self::turned(curve, state, displacement) else { break };
                course = turned;
                here = state.spring.here();
            }
            let undamped = if G::LEVELS { here.force * glide.levels_there().0 } else { here.force };
            let arrived = unbraked - braking * undamped;
            if looks {
                state.spring.slide(&here.apart());
            }
            glide.pulled(displacement, here.force);
            velocity =
                glide.accept(displacement, arrived, undamped + dragged_then * arrived, state);
        }
        state.spring.slide(&here.apart());
    }

    /// Takes the spring through its reverse points; nowhere where one more needs room.
    #[cold]
    #[inline(never)]
    fn turned(
        curve: &YieldCurve<S>,
        state: &mut MaxwellSlipState<S>,
        displacement: S,
    ) -> Option<Course<S>> {
        let walk = state.spring.walk(curve, displacement);
        if walk.added.is_some() && !state.spring.memory.has_room() {
            return None;
        }
        state.spring.accept(&walk);
        state.spring.count(&walk, &mut state.statistics);
        Some(curve.course(&state.spring))
    }
}
