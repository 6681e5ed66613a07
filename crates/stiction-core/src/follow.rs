//! A machine moved along positions that were measured or prescribed: the efforts it needs.

use std::ops::Range;

use crate::drive::Way;
use crate::effects::{Passage, Situation};
use crate::friction::{FrictionLaw, LawState};
use crate::integrate::{Along, Beyond, Machine, Run, through_events};
use crate::model::CHUNK;
use crate::motor::{PerSample, Running, Surroundings};
use crate::scalar::Scalar;
use crate::sensitivity::MeasuredMotion;
use crate::track::Track;

/// Efforts at the end of a sample.
#[derive(Debug, Clone, Copy)]
pub struct Efforts<S> {
    /// Effort of the drive for the held input.
    pub driven: S,
    /// Gravity and added efforts.
    pub ambient: S,
    /// Friction.
    pub friction: S,
    /// Its mean over the sample, where the contact is rigid and that is asked for.
    pub mean: Option<S>,
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
        motion: &MeasuredMotion<'_>,
        row: impl FnMut(usize, Efforts<S>, Whereabouts<'_, S>),
    ) {
        self.follow_on(motion, 0..motion.samples(), row);
    }

    /// The same with efforts that may be averaged about the end of each sample: friction of a rigid
    /// contact, which jumps inside samples, is then its mean over the sample before and the one after,
    /// as a held input is.
    pub fn follow_about(
        &mut self,
        motion: &MeasuredMotion<'_>,
        mut row: impl FnMut(usize, &Efforts<S>),
    ) {
        let mut waiting: Option<(usize, Efforts<S>)> = None;
        self.follow(motion, |k, efforts, _| {
            let Some(mean) = efforts.mean else { return row(k, &efforts) };
            if let Some((before, last)) = &mut waiting {
                last.friction = (last.friction + mean) * 0.5;
                row(*before, last);
            }
            waiting = Some((k, Efforts { friction: mean, ..efforts }));
        });
        if let Some((k, last)) = waiting {
            row(k, &last);
        }
    }

    /// Follows some of the samples, from where the last one before them ended. A second mass swings
    /// in from rest.
    pub(crate) fn follow_on(
        &mut self,
        motion: &MeasuredMotion<'_>,
        samples: Range<usize>,
        row: impl FnMut(usize, Efforts<S>, Whereabouts<'_, S>),
    ) {
        let MeasuredMotion { positions, inputs, around, dt, averaged } = *motion;
        let misreads = self.machine.effects.misreads();
        let sensor = self.machine.effects.clone();
        let behind = |reading: f64| sensor.behind(S::constant(reading));
        let actual: Option<&dyn Fn(f64) -> S> = if misreads { Some(&behind) } else { None };
        let inertia = self.machine.body.inertia;
        let masses = self.machine.effects.second_masses().iter();
        let mut beyond: Vec<Beyond<S>> = masses.map(|mass| Beyond::new(mass, inertia)).collect();
        let (way, machine, run) = (self.way.as_mut(), &mut self.machine, &mut self.run);
        let beyond = beyond.as_mut_slice();
        let track = Track::new(positions, actual, samples.start);
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
                averaged,
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
    averaged: bool,
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
        let Self { samples, inputs, around, dt, averaged, mut row, .. } = self;
        let located = L::RIGID && averaged;
        let zero = S::constant(0.0);
        let misreads = machine.effects.misreads();
        let slope = |track: &Track<'_, S>| {
            if located { track.velocity_or_rest(&dt) } else { track.velocity(&dt) }
        };
        let mut velocity = slope(&track);
        let mut at = run.situation();
        let some = !samples.is_empty();
        for (passed, k) in samples.enumerate() {
            if passed % CHUNK == 0 {
                state.make_room(CHUNK + CHUNK / 4);
            }
            let duration = dt.at(k);
            let span = S::constant(duration);
            let load = S::constant(around.load.at(k));
            let before = velocity;
            track.advance();
            velocity = slope(&track);
            let displacement = track.displacement();
            at.position = track.position();
            at.velocity = velocity;
            at.time += span;
            at.path += displacement.abs();
            at.temperature = around.temperature_at(k);
            at.enabled = around.enabled_at(k);
            if machine.effects.remembers() {
                let passage = Passage { displacement, friction: run.friction, span };
                machine.effects.remember(&passage);
            }
            let input = arriving(&mut way, inputs.at(k), duration);
            let (effort, driven, ambient) = machine.efforts(&at, input, load);
            let channels = machine.channels(&at, effort, load);
            let mut at_contact = displacement;
            if machine.relaxes() {
                let (hardened, crept) = machine.relax(run.relaxed, run.friction, span);
                run.relaxed = hardened;
                at_contact -= crept;
            }
            // Where a machine with a rigid contact stops, the rest of the sample is one at rest.
            let stop = if located { track.stop(k) } else { None };
            let share = stop.map_or(1.0, |stop| stop.left.min(1.0));
            let moving = if share < 1.0 { span * share } else { span };
            let mut held = Along::new(at_contact, moving, (before, velocity), channels);
            if share > 0.0 {
                through_events(&mut held, law, state, moving);
            }
            if share < 1.0 {
                let (moved, rest) = (held.mean * share, span * (1.0 - share));
                held = Along::new(zero, rest, (zero, zero), channels);
                through_events(&mut held, law, state, rest);
                held.mean = moved + held.mean * (1.0 - share);
            }
            run.friction = held.outcome.force;
            let mut ahead = zero;
            if misreads {
                ahead += at.position - track.reading();
            }
            for mass in &mut *beyond {
                ahead += mass.advance(track.acceleration(&dt), duration);
            }
            let there = Whereabouts { machine: &*machine, at: &at, input, load };
            let (friction, mean) = (run.friction, located.then_some(held.mean));
            row(k, Efforts { driven, ambient, friction, mean, ahead }, there);
            if machine.drive.servo.is_some() {
                run.stand(&at);
                machine.wind(run, input, duration);
                at.wound = run.wound;
            }
        }
        if some {
            run.stand(&at);
        }
    }
}

impl<S: Scalar> Run<S> {
    /// Where a motion that is given has come to.
    fn stand(&mut self, at: &Situation<S>) {
        self.position = at.position;
        self.velocity = at.velocity;
        self.time = at.time;
        self.path = at.path;
        self.temperature = at.temperature;
        self.enabled = at.enabled;
        self.second_position = at.position;
        self.second_velocity = at.velocity;
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
