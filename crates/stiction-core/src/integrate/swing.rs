//! A step of the body as a damped oscillator on its contact.

use std::cell::Cell;

use super::events::{Stepper, earliest};
use super::plain::hold;
use super::response::{halves, usable};
use super::{fast, steep};
use crate::friction::{Channels, FrictionLaw, Motion};
use crate::plant::effects::Situation;
use crate::plant::{Machine, Run};

/// Nothing brings a slide back: its errors add up.
const SLIDING: f64 = 5.0;
/// How long a slide is thought to carry an error of the velocity on, at most, s.
const LONGEST_SLIDE: f64 = 1.0;

/// A step of the oscillator.
pub struct Swing<'a> {
    pub machine: &'a Machine<f64>,
    pub run: &'a mut Run<f64>,
    pub input: f64,
    pub load: f64,
    pub stiffness: f64,
    pub damping: f64,
    pub evaluations: Cell<u64>,
}

/// Where a step leads.
#[derive(Debug, Clone, Copy)]
pub struct Landing<T> {
    pub run: Run<f64>,
    pub trial: T,
    pub motion: Motion<f64>,
    /// The contact half way, to see what comes and goes within the step.
    pub middle: Option<(T, Motion<f64>)>,
    /// Estimate of the error of the position.
    pub error: f64,
}

impl Swing<'_> {
    pub fn count(&self, evaluations: u64) {
        self.evaluations.set(self.evaluations.get() + evaluations);
    }

    /// Effort and channels somewhere else.
    pub fn around(&self, at: &Situation<f64>) -> (f64, Channels<f64>) {
        let run = &*self.run;
        let ambient = self.machine.ambient(at, run.second_position, run.second_velocity);
        let effort = self.machine.driven(self.input, at) + self.load + ambient;
        (effort, self.machine.channels(at, effort, self.load))
    }

    /// Effort and channels at the present.
    pub fn here(&self) -> (f64, Channels<f64>) {
        let at = self.run.situation();
        let effort = self.machine.driven(self.input, &at) + self.load + self.run.ambient;
        (effort, self.machine.channels(&at, effort, self.load))
    }

    pub fn net<L: FrictionLaw<f64>>(&self, law: &L, state: &L::State) -> f64 {
        let (effort, channels) = self.here();
        effort - law.force(state, self.run.velocity, &channels)
    }

    pub fn after(&self, at: &Situation<f64>, friction: f64) -> Run<f64> {
        let mut next = *self.run;
        next.position = at.position;
        next.velocity = at.velocity;
        next.time = at.time;
        next.path = at.path;
        next.moved = at.moved;
        next.friction = friction;
        self.machine.refresh(&mut next);
        next
    }

    /// As one step and as two halves of it.
    pub fn doubled<L: FrictionLaw<f64>>(
        &self,
        law: &L,
        state: &L::State,
        span: f64,
    ) -> Landing<L::Trial> {
        let efforts = (self.input, self.load);
        self.count(9);
        let whole = steep::attempt(self.machine, self.run, efforts, law, state, span);
        let half = 0.5 * span;
        let first = steep::attempt(self.machine, self.run, efforts, law, state, half);
        let mut between = state.clone();
        law.commit(&mut between, &first.trial);
        let fast::Attempt { run, trial, mut motion } =
            steep::attempt(self.machine, &first.run, efforts, law, &between, half);
        motion.displacement += first.motion.displacement;
        motion.duration = span;
        motion.start_velocity = self.run.velocity;
        let error = (run.position - whole.run.position).abs()
            + (run.velocity - whole.run.velocity).abs() * span;
        Landing { run, trial, motion, middle: None, error: SLIDING * error }
    }
}

impl<L: FrictionLaw<f64>> Stepper<f64, L> for Swing<'_> {
    type Attempt = Landing<L::Trial>;
    /// Its evaluations are counted.
    const COST: u64 = 0;

    // J·d'' + C·d' + k·d = r(t) with r = E − F + k·d + C·d', d the displacement from the start. A
    // parabola through r at 0, h/2 and h; the position at the end needs the first two alone: the
    // third has no share in it up to h⁴.
    fn attempt(&self, law: &L, state: &L::State, span: f64) -> Landing<L::Trial> {
        if L::STEEP {
            return self.doubled(law, state, span);
        }
        let (machine, run) = (self.machine, &*self.run);
        let start = run.situation();
        let (inertia, before) = (machine.inertia, run.velocity);
        if span <= 0.0 {
            let (_, channels) = self.here();
            let motion = Motion::held(before, 0.0);
            let trial = law.advance(state, &motion, &channels);
            self.count(1);
            let run = self.after(&start, law.outcome(&trial).force);
            return Landing { run, trial, motion, middle: None, error: 0.0 };
        }
        let square = usable(self.stiffness / inertia, span);
        let (stiffness, damping) = (square * inertia, self.damping);
        let (half, whole) = halves(square, 0.5 * damping / inertia, span);
        let evaluate = |displacement: f64, velocity: f64, duration: f64| {
            let at = start.after(displacement, velocity, duration);
            let (effort, channels) = self.around(&at);
            let motion = Motion { displacement, duration, start_velocity: before, velocity };
            let trial = law.advance(state, &motion, &channels);
            self.count(1);
            let force = law.outcome(&trial).force;
            (trial, motion, effort - force + stiffness * displacement + damping * velocity)
        };
        let first = self.net(law, state) + damping * before;
        let accelerated = first / inertia;
        let (trial, motion, second) = evaluate(
            before * half.impulse + accelerated * half.first,
            before * half.slope + accelerated * half.impulse,
            0.5 * span,
        );
        let middle = Some((trial, motion));
        let rise = 2.0 * (second - first) / span / inertia;
        let displacement = before * whole.impulse + accelerated * whole.first + rise * whole.second;
        let predicted = before * whole.slope + accelerated * whole.impulse + rise * whole.first;
        let (trial, mut motion, third) = evaluate(displacement, predicted, span);
        let bend = 2.0 * (first - 2.0 * second + third) / (span * span) / inertia;
        let rise = (4.0 * second - third - 3.0 * first) / span / inertia;
        let velocity = before * whole.slope
            + accelerated * whole.impulse
            + rise * whole.first
            + 2.0 * bend * whole.second;
        let outcome = law.outcome(&trial);
        motion.velocity = velocity;
        let friction = outcome.force + outcome.damping * (velocity - predicted);
        let run = self.after(&start.after(displacement, velocity, span), friction);
        // A ring turns an error of the velocity round; a slide carries it on until it stops.
        let stops = (before.abs() + velocity.abs()) / (accelerated.abs() + f64::MIN_POSITIVE);
        let slides = stops.min(LONGEST_SLIDE).max(span);
        let reach = if square > 0.0 { slides.min(1.0 / square.sqrt()) } else { slides };
        // What the guess half way, under r(0) alone, has missed there; friction goes by the position
        // where it is a spring, by the velocity where it slides.
        let change = ((second - first).abs() + (third - second).abs()) / inertia;
        let guess = middle.as_ref().map_or(motion, |(_, motion)| *motion);
        let (astray, way) = if square > 0.0 {
            let better = before * half.impulse
                + accelerated * half.first
                + rise * half.second
                + 2.0 * bend * half.third;
            let way = guess.displacement.abs() + (displacement - guess.displacement).abs();
            ((better - guess.displacement).abs(), way)
        } else {
            let better = before * half.slope
                + accelerated * half.impulse
                + rise * half.first
                + 2.0 * bend * half.second;
            let way = (guess.velocity - before).abs() + (predicted - guess.velocity).abs();
            ((better - guess.velocity).abs(), way)
        };
        let misled = change * astray / (way + f64::MIN_POSITIVE) * span * (2.0 / 3.0);
        let mut missed = (velocity - predicted).abs() + misled;
        if square == 0.0 {
            missed *= SLIDING;
        }
        let error = missed * reach;
        Landing { run, trial, motion, middle, error }
    }

    fn contact<'a>(&self, attempt: &'a Self::Attempt) -> (&'a L::Trial, &'a Motion<f64>) {
        (&attempt.trial, &attempt.motion)
    }

    fn accept(&mut self, law: &L, state: &mut L::State, attempt: &Self::Attempt, stopped: bool) {
        law.commit(state, &attempt.trial);
        *self.run = attempt.run;
        if stopped {
            self.run.velocity = 0.0;
        }
    }

    fn velocity(&self) -> f64 {
        self.run.velocity
    }

    fn hold(&mut self, law: &L, state: &mut L::State, span: f64) -> bool {
        hold(self.machine, self.run, (self.input, self.load), law, state, span)
    }
}

/// Steps up to the event that an attempt ran past, if it did, and passes it; when that was.
pub fn located<L: FrictionLaw<f64>>(
    swing: &mut Swing<'_>,
    law: &L,
    state: &mut L::State,
    attempt: &Landing<L::Trial>,
    span: f64,
) -> Option<f64> {
    let early = attempt
        .middle
        .as_ref()
        .and_then(|(trial, motion)| law.event(state, trial, motion))
        .map(|event| (event, 0.5 * span));
    let late = || law.event(state, &attempt.trial, &attempt.motion).map(|event| (event, span));
    let (event, within) = early.or_else(late)?;
    let attempt = swing.attempt(law, state, within);
    let (event, at, shortened) = earliest(swing, law, state, event, (within, attempt));
    let stopped = event == crate::friction::Event::Reversal && at > 0.0;
    Stepper::<f64, L>::accept(swing, law, state, &shortened, stopped);
    law.switch(state, event);
    Some(at)
}
