//! Rests that hold and slides that go on, in loops of their own.

use super::{Coulomb, CoulombState};
use crate::friction::elements::stribeck::{fall_power, fall_slope};
use crate::integrate::{Efforts, Glide, Seen, not_beyond_a_stop};
use crate::math::exponential::fading_within;
use crate::math::scalar::{Scalar, sign};

impl<S: Scalar> Coulomb<S> {
    /// Steps until a slide ends, through break-aways.
    #[inline(always)]
    pub(super) fn glide_on<E: Efforts<S>, V: Seen<S, CoulombState<S>>>(
        &self,
        state: &mut CoulombState<S>,
        glide: &mut Glide<S, E, V>,
    ) {
        if state.0.mode == 0.0 && !self.glide_at_rest(state, glide) {
            return;
        }
        self.glide_sliding(state, glide);
    }

    /// Steps at rest; whether the contact has broken away.
    #[inline(always)]
    fn glide_at_rest<E: Efforts<S>, V: Seen<S, CoulombState<S>>>(
        &self,
        state: &mut CoulombState<S>,
        glide: &mut Glide<S, E, V>,
    ) -> bool {
        let greatest = self.parameters.breakaway;
        if glide.run.velocity.re() != 0.0 {
            return false;
        }
        if let Some(force) = glide.hold(greatest, state) {
            state.0.force = force;
        }
        let greatest = if E::HELD { greatest } else { greatest * glide.levels.0 };
        glide.next().is_some_and(|effort| !state.0.holds(effort, greatest))
    }

    /// Steps of a slide.
    #[inline(always)]
    fn glide_sliding<E: Efforts<S>, V: Seen<S, CoulombState<S>>>(
        &self,
        state: &mut CoulombState<S>,
        glide: &mut Glide<S, E, V>,
    ) {
        let verlet = glide.verlet;
        let (free, freely) = verlet.free();
        let (mode, mut force, mut velocity) = (state.0.mode, state.0.force, glide.run.velocity);
        let looks = glide.seen.looks();
        if mode * velocity.re() < 0.0 {
            return;
        }
        while let Some(effort) = glide.next() {
            let net = effort - self.sliding_within::<E>(mode, velocity, glide.levels).0;
            let displacement = verlet.displacement(velocity, net);
            let predicted = verlet.predicted(velocity, net);
            let shown = || not_beyond_a_stop::<S, Self>(velocity, predicted);
            let effort_then = glide.there(effort, displacement, shown);
            let (there, slope) = self.sliding_within::<E>(mode, predicted, glide.beside.levels);
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
    fn sliding_within<E: Efforts<S>>(
        &self,
        mode: f64,
        velocity: S,
        (level, viscous_level): (S, S),
    ) -> (S, S) {
        let p = &self.parameters;
        let raised = |force: S| if E::HELD { force } else { force * level };
        let viscous = if E::HELD { p.viscous } else { p.viscous * viscous_level };
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
