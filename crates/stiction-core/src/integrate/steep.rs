//! Steps of a body on friction that rises too steeply from rest to be linearised.

use super::fast::Attempt;
use crate::friction::{FrictionLaw, Motion, Push};
use crate::math::scalar::Scalar;
use crate::plant::{Machine, Run};

/// Parts of a step of the reference integrator.
const FINER: u32 = 8;

/// A step in which the law finds the velocity at the end, twice: with its contact as it would be
/// after an unbraked step, then with the contact and the efforts where that takes the body.
pub(super) fn attempt<S: Scalar, L: FrictionLaw<S>>(
    machine: &Machine<S>,
    run: &Run<S>,
    (input, load): (S, S),
    law: &L,
    state: &L::State,
    span: S,
) -> Attempt<S, L::Trial> {
    let start = run.situation();
    let effort = machine.driven(input, &start) + load + run.ambient;
    let channels = machine.channels(&start, effort, load);
    let friction = law.force(state, run.velocity, &channels);
    let (velocity, inertia) = (run.velocity, machine.inertia);
    let mut push = Push { velocity, friction, effort, inertia, span };
    let mut next = *run;
    let mut crept = S::constant(0.0);
    if machine.relaxes() {
        (next.relaxed, crept) = machine.relax(run.relaxed, friction, span);
    }
    let motion = |displacement: S, velocity: S| Motion {
        displacement: displacement - crept,
        duration: span,
        start_velocity: run.velocity,
        velocity,
    };
    let trial = law.advance(state, &motion(span * velocity, velocity), &channels);
    let first = law.arrive(&trial, &push, &channels);
    let end = start.after(first.displacement, first.velocity, span);
    machine.swing(&start, &end, span, &mut next);
    next.ambient = machine.ambient(&end, next.second_position, next.second_velocity);
    let effort_then = machine.driven(input, &end) + load + next.ambient;
    let channels = machine.channels(&end, effort_then, load);
    push.effort = (effort + effort_then) * 0.5;
    let trial = law.advance(state, &motion(first.displacement, first.velocity), &channels);
    let second = law.arrive(&trial, &push, &channels);
    next.position = run.position + second.displacement;
    next.velocity = second.velocity;
    next.time = end.time;
    next.path = run.path + second.displacement.abs();
    next.moved = run.moved + second.displacement;
    let motion = motion(second.displacement, second.velocity);
    let trial = law.advance(state, &motion, &channels);
    next.friction = law.outcome(&trial).force;
    Attempt { run: next, trial, motion }
}

/// The same in finer steps, for the reference integrator: nothing explicit is stable here.
pub(super) fn finer<S: Scalar, L: FrictionLaw<S>>(
    machine: &Machine<S>,
    run: &Run<S>,
    efforts: (S, S),
    law: &L,
    state: &L::State,
    span: S,
) -> Attempt<S, L::Trial> {
    let part = span / f64::from(FINER);
    let mut state = state.clone();
    let mut last = attempt(machine, run, efforts, law, &state, part);
    for _ in 1..FINER {
        law.commit(&mut state, &last.trial);
        let before = last.motion.displacement;
        last = attempt(machine, &last.run, efforts, law, &state, part);
        last.motion.displacement += before;
    }
    last.motion.duration = span;
    last.motion.start_velocity = run.velocity;
    last
}
