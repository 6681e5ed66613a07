//! Rests that hold and slides that go on, in loops of their own.

use super::{Coulomb, CoulombState};
use crate::friction::elements::plain_steps::{PlainSteps, not_beyond_a_stop};
use crate::friction::elements::stribeck::{fall_power, fall_slope};
use crate::math::exponential::fading_within;
use crate::math::scalar::{Scalar, sign};

impl<S: Scalar> Coulomb<S> {
    /// Steps until a slide ends, through break-aways.
    #[inline(always)]
    pub(super) fn glide_on<G: PlainSteps<S, CoulombState<S>>>(
        &self,
        state: &mut CoulombState<S>,
        glide: &mut G,
    ) {
        if state.0.mode == 0.0 && !self.glide_at_rest(state, glide) {
            return;
        }
        self.glide_sliding(state, glide);
    }

    /// Steps at rest; whether the contact has broken away.
    #[inline(always)]
    fn glide_at_rest<G: PlainSteps<S, CoulombState<S>>>(
        &self,
        state: &mut CoulombState<S>,
        glide: &mut G,
    ) -> bool {
        let greatest = self.parameters.breakaway;
        if glide.velocity().re() != 0.0 {
            return false;
        }
        if let Some(force) = glide.hold(greatest, state) {
            state.0.force = force;
        }
        let greatest = if G::LEVELS { greatest * glide.levels().0 } else { greatest };
        glide.next().is_some_and(|effort| !state.0.holds(effort, greatest))
    }

    /// Steps of a slide.
    #[inline(always)]
    fn glide_sliding<G: PlainSteps<S, CoulombState<S>>>(
        &self,
        state: &mut CoulombState<S>,
        glide: &mut G,
    ) {
        let verlet = *glide.verlet();
        let (free, freely) = verlet.free();
        let (mode, mut force, mut velocity) = (state.0.mode, state.0.force, glide.velocity());
        let looks = glide.looks();
        if mode * velocity.re() < 0.0 {
            return;
        }
        while let Some(effort) = glide.next() {
            let net = effort - self.sliding_within::<G>(mode, velocity, *glide.levels()).0;
            let displacement = verlet.displacement(velocity, net);
            let predicted = verlet.predicted(velocity, net);
            let shown = || not_beyond_a_stop::<S, Self>(velocity, predicted);
            let effort_then = glide.there(effort, displacement, shown);
            let (there, slope) = self.sliding_within::<G>(mode, predicted, *glide.levels_there());
            // Mostly nothing damps: then nothing waits for what would, and for no division.
            let (damping, share, braking, undamped) = if slope.re() > 0.0 {
                let share = verlet.share(slope);
                (slope, share, verlet.braking(share), there - slope * predicted)
            } else {
                (S::constant(0.0), free, freely, there)
            };
            let arrived = verlet.unbraked(velocity, net + effort_then, share) - braking * undamped;
            if mode * arrived.re() <= 0.0 {
                break;
            }
            force = there;
            if looks {
                state.0.force = force;
            }
            let friction = undamped + damping * arrived;
            velocity = glide.accept(displacement, arrived, friction, state);
        }
        state.0.force = force;
    }

    /// As `sliding`, at these levels where there are any and as part of the loop that asks.
    #[inline(always)]
    fn sliding_within<G: PlainSteps<S, CoulombState<S>>>(
        &self,
        mode: f64,
        velocity: S,
        (level, viscous_level): (S, S),
    ) -> (S, S) {
        let p = &self.parameters;
        let raised = |force: S| if G::LEVELS { force * level } else { force };
        let viscous = if G::LEVELS { p.viscous * viscous_level } else { p.viscous };
        if !self.falls {
            return (raised(p.coulomb) * mode + viscous * velocity, viscous);
        }
        let power = fall_power(velocity, p.stribeck_velocity, p.stribeck_exponent);
        let left = fading_within(-power);
        let excess = p.breakaway - p.coulomb;
        let level = raised(p.coulomb + excess * left) * mode;
        if !S::CARRIES && p.viscous.re() == 0.0 && mode * velocity.re() > 0.0 {
            // It falls, whatever its slope; and nothing waits for a sum with 0.
            return (level, S::constant(0.0));
        }
        let force = level + viscous * velocity;
        let steepness = fall_slope(velocity, p.stribeck_exponent, power, left);
        (force, raised(excess * steepness) * (mode * sign(velocity.re())) + viscous)
    }
}
