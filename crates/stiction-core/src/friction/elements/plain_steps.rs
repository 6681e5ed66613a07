//! Plain steps in a row, as a law goes through them: what it is told, and what it tells.

use super::contact::{Channels, Motion};
use super::law::FrictionLaw;
use crate::math::scalar::Scalar;
use crate::math::verlet::Verlet;

/// A row of plain steps of a body whose contact has a state `T`: what [`FrictionLaw::glide`] goes
/// through. Whoever steps the body has it; a law knows no more of that than is said here.
pub trait PlainSteps<S: Scalar, T> {
    /// Whether friction has levels beside 1.
    const LEVELS: bool;

    /// The body's share of a step.
    fn verlet(&self) -> &Verlet<S>;
    /// Velocity of the body before the first step.
    fn velocity(&self) -> S;
    /// Levels at the start of the step that is looked at, where there are any.
    fn levels(&self) -> &(S, S);
    /// The same at the end of the step that was asked of [`Self::there`].
    fn levels_there(&self) -> &(S, S);
    /// Whether the contact is looked at after each sample.
    fn looks(&self) -> bool;
    /// All effort but friction at the start of the next step, where there is one.
    fn next(&self) -> Option<S>;
    /// What reaches the contact at the start of the next step, but for its effort.
    fn channels(&self) -> Channels<S>;
    /// The same at the end of the step that was asked of [`Self::there`].
    fn channels_there(&self) -> Channels<S>;
    /// All effort but friction at the end of a step that began under `effort`, displaced the body so far
    /// and shows this velocity at its end.
    fn there(&mut self, effort: S, displacement: S, shown: impl FnOnce() -> S) -> S;
    /// Sees how far the body goes in a step and the force of its spring then, before the velocity
    /// is known: of a law that has one ([`FrictionLaw::springs`]).
    fn pulled(&mut self, displacement: S, force: S);
    /// Accepts samples at rest while the contact, which looks the same all the time, holds the effort, up
    /// to one at level 1; friction at their end, where there are any.
    fn hold(&mut self, greatest: S, contact: &T) -> Option<S>;
    /// Accepts a step; the velocity to go on with, which is another one where the contact gave what it
    /// did not have.
    fn accept(&mut self, displacement: S, velocity: S, friction: S, contact: &T) -> S;
}

/// Goes through all steps with a law that knows no events and asks for nothing but the motion: each
/// of them is plain.
#[inline(always)]
pub fn glide_on<S, L, G>(law: &L, state: &mut L::State, glide: &mut G)
where
    S: Scalar,
    L: FrictionLaw<S, State: Copy>,
    G: PlainSteps<S, L::State>,
{
    let duration = glide.verlet().span();
    // Copies that nobody else sees stay in registers.
    let (mut now, mut start_velocity) = (*state, glide.velocity());
    while let Some(effort) = glide.next() {
        let (held, drag) = law.friction(&now, start_velocity, &glide.channels());
        let push = effort - held;
        let (verlet, net) = match drag {
            None => (*glide.verlet(), push),
            Some(damping) => (glide.verlet().dragged(damping), push - damping * start_velocity),
        };
        let displacement = verlet.displacement(start_velocity, push);
        let velocity = verlet.predicted(start_velocity, net);
        let motion = Motion { displacement, duration, start_velocity, velocity };
        let effort_then = glide.there(effort, displacement, || velocity);
        let trial = law.advance(&now, &motion, &glide.channels_there());
        let (outcome, undamped) = (law.outcome(&trial), law.undamped(&trial, velocity));
        let arrived = verlet.arrive(start_velocity, push + effort_then, outcome.damping, undamped);
        law.commit(&mut now, &trial);
        let friction = undamped + outcome.damping * arrived;
        start_velocity = glide.accept(displacement, arrived, friction, &now);
    }
    *state = now;
}

/// The velocity that an attempt which began with `before` shows to what acts by speed. A rigid contact stops a
/// body where its velocity would turn round: what lies beyond is cut off, and drag there, of an overshoot of
/// any size, must not lead back to where it seems that nothing happened.
#[inline(always)]
pub(crate) fn not_beyond_a_stop<S: Scalar, L: FrictionLaw<S>>(before: S, velocity: S) -> S {
    let turned = L::RIGID && before.re() * velocity.re() < 0.0;
    if turned { S::constant(0.0) } else { velocity }
}
