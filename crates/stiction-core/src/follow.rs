//! A machine moved along positions that were measured or prescribed: the efforts it needs.

use std::ops::Range;

use crate::drive::Way;
use crate::effects::{Passage, Situation};
use crate::friction::{FrictionLaw, LawState};
use crate::integrate::{Along, Beyond, Machine, Run, through_events};
use crate::model::CHUNK;
use crate::motor::{PerSample, Running, Surroundings};
use crate::scalar::Scalar;

/// Efforts at the end of a sample.
#[derive(Debug, Clone, Copy)]
pub struct Efforts<S> {
    /// Effort of the drive for the held input.
    pub driven: S,
    /// Gravity and added efforts.
    pub ambient: S,
    /// Friction.
    pub friction: S,
    /// How far the centre of mass is ahead of what the sensor reads.
    pub ahead: S,
}

/// Where the plant is at the end of a sample, and what its drive is commanded, for those who ask: what
/// of the input reached it, or the voltage of a servo.
#[derive(Debug)]
pub struct Whereabouts<'a, S: Scalar> {
    machine: &'a Machine<S>,
    at: &'a Situation<S>,
    input: S,
    load: S,
}

impl<S: Scalar> Whereabouts<'_, S> {
    /// Where the plant is.
    pub fn situation(&self) -> Situation<S> {
        self.machine.at_contact(self.at, self.load)
    }

    /// What the drive is commanded.
    pub fn command(&self) -> S {
        self.machine.command(self.input, &self.situation())
    }
}

/// The positions behind the readings, three in a row, and what is derived from them.
pub(crate) struct Track<'a, S> {
    readings: &'a [f64],
    actual: &'a dyn Fn(f64) -> S,
    /// Positions at the stamps before, at and after the present one.
    at: [S; 3],
    /// The present stamp.
    stamp: usize,
}

impl<'a, S: Scalar> Track<'a, S> {
    /// With this stamp as the present one.
    pub(crate) fn new(readings: &'a [f64], actual: &'a dyn Fn(f64) -> S, stamp: usize) -> Self {
        let last = readings.len() - 1;
        let near = [stamp.saturating_sub(1), stamp, (stamp + 1).min(last)];
        Self { readings, actual, at: near.map(|stamp| actual(readings[stamp])), stamp }
    }

    /// Position at the present stamp.
    pub(crate) fn position(&self) -> S {
        self.at[1]
    }

    #[inline(always)]
    fn advance(&mut self) {
        self.stamp += 1;
        let next = (self.stamp + 1).min(self.readings.len() - 1);
        let ahead =
            if next == self.stamp { self.at[2] } else { (self.actual)(self.readings[next]) };
        self.at = [self.at[1], self.at[2], ahead];
    }

    /// Slope between the neighbours, so that what depends on velocity is not half a sample late; at
    /// the first and the last stamp there is only one side.
    #[inline(always)]
    pub(crate) fn velocity(&self, dt: &PerSample<'_>) -> S {
        let last = self.readings.len() - 1;
        let (before, after) = (self.stamp.saturating_sub(1), (self.stamp + 1).min(last));
        let span: f64 = (before..after).map(|j| dt.at(j)).sum();
        (self.at[2] - self.at[0]) / span
    }

    /// Second difference; 0 where a side is missing.
    #[inline(always)]
    fn acceleration(&self, dt: &PerSample<'_>) -> S {
        if self.stamp == 0 || self.stamp + 1 >= self.readings.len() {
            return S::constant(0.0);
        }
        let (before, after) = (dt.at(self.stamp - 1), dt.at(self.stamp));
        let bend = (self.at[2] - self.at[1]) / after - (self.at[1] - self.at[0]) / before;
        bend * 2.0 / (before + after)
    }
}

impl<S: Scalar> Running<S> {
    /// The position at which the sensor reads this.
    pub fn actual(&self, reading: f64) -> f64 {
        self.machine.effects.behind(S::constant(reading)).re()
    }

    /// Moves the contact along given positions, one more than there are inputs, and reports the
    /// efforts at the end of each sample. The inertia term is the caller's: it needs the
    /// acceleration, which no difference of neighbouring samples gives.
    pub fn follow(
        &mut self,
        positions: &[f64],
        inputs: PerSample<'_>,
        around: Surroundings<'_>,
        dt: PerSample<'_>,
        row: impl FnMut(usize, Efforts<S>, Whereabouts<'_, S>),
    ) {
        self.follow_on(positions, 0..positions.len() - 1, inputs, around, dt, row);
    }

    /// Follows some of the samples, from where the last one before them ended. A second mass swings
    /// in from rest.
    pub(crate) fn follow_on(
        &mut self,
        positions: &[f64],
        samples: Range<usize>,
        inputs: PerSample<'_>,
        around: Surroundings<'_>,
        dt: PerSample<'_>,
        row: impl FnMut(usize, Efforts<S>, Whereabouts<'_, S>),
    ) {
        let misreads = self.machine.effects.misreads();
        let sensor = self.machine.effects.clone();
        let actual = |reading: f64| {
            let reading = S::constant(reading);
            if misreads { sensor.behind(reading) } else { reading }
        };
        let inertia = self.machine.body.inertia;
        let masses = self.machine.effects.second_masses().iter();
        let mut beyond: Vec<Beyond<S>> = masses.map(|mass| Beyond::new(mass, inertia)).collect();
        let (way, machine, run) = (self.way.as_mut(), &mut self.machine, &mut self.run);
        let beyond = beyond.as_mut_slice();
        let track = Track::new(positions, &actual, samples.start);
        with_law_and_state!(&self.law, &mut self.state, |law, state| {
            let contact = (law, state);
            Following {
                way,
                machine,
                run,
                beyond,
                contact,
                track,
                samples,
                inputs,
                around,
                dt,
                row,
            }
            .run()
        });
    }
}

/// A machine on its way along positions, as a loop to run.
struct Following<'a, 'b, S: Scalar, L: FrictionLaw<S>, R> {
    way: Option<&'a mut Way<S>>,
    machine: &'a mut Machine<S>,
    run: &'a mut Run<S>,
    beyond: &'a mut [Beyond<S>],
    contact: (&'a L, &'a mut L::State),
    track: Track<'b, S>,
    samples: Range<usize>,
    inputs: PerSample<'a>,
    around: Surroundings<'a>,
    dt: PerSample<'a>,
    row: R,
}

impl<S, L, R> Following<'_, '_, S, L, R>
where
    S: Scalar,
    L: FrictionLaw<S>,
    R: FnMut(usize, Efforts<S>, Whereabouts<'_, S>),
{
    fn run(self) {
        let Self { mut way, machine, run, beyond, contact: (law, state), mut track, .. } = self;
        let Self { samples, inputs, around, dt, mut row, .. } = self;
        let zero = S::constant(0.0);
        let misreads = machine.effects.misreads();
        let mut velocity = track.velocity(&dt);
        for (passed, k) in samples.enumerate() {
            if passed % CHUNK == 0 {
                state.make_room(CHUNK + CHUNK / 4);
            }
            let duration = dt.at(k);
            let span = S::constant(duration);
            let load = S::constant(around.load.at(k));
            let before = velocity;
            track.advance();
            velocity = track.velocity(&dt);
            let displacement = track.at[1] - track.at[0];
            run.position = track.at[1];
            run.velocity = velocity;
            run.time += span;
            run.path += displacement.abs();
            run.temperature = around.temperature_at(k);
            run.enabled = around.enabled_at(k);
            run.second_position = run.position;
            run.second_velocity = velocity;
            if machine.effects.remembers() {
                let passage = Passage { displacement, friction: run.friction, span };
                machine.effects.remember(&passage);
            }
            let at = run.situation();
            let input = arriving(&mut way, inputs.at(k), duration);
            let (effort, driven, ambient) = machine.efforts(&at, input, load);
            let channels = machine.channels(&at, effort, load);
            let mut at_contact = displacement;
            if machine.relaxes() {
                let (hardened, crept) = machine.relax(run.relaxed, run.friction, span);
                run.relaxed = hardened;
                at_contact -= crept;
            }
            let mut held = Along::new(at_contact, span, (before, velocity), channels);
            through_events(&mut held, law, state, span);
            run.friction = held.outcome.force;
            let mut ahead = zero;
            if misreads {
                ahead += track.at[1] - track.readings[k + 1];
            }
            for mass in &mut *beyond {
                ahead += mass.advance(track.acceleration(&dt), duration);
            }
            let there = Whereabouts { machine: &*machine, at: &at, input, load };
            row(k, Efforts { driven, ambient, friction: run.friction, ahead }, there);
            machine.wind(run, input, duration);
        }
    }
}

/// What of the input reaches the drive during a sample.
#[inline(always)]
pub(crate) fn arriving<S: Scalar>(way: &mut Option<&mut Way<S>>, input: f64, dt: f64) -> S {
    match way {
        None => S::constant(input),
        Some(way) => way.pass(input, dt),
    }
}
