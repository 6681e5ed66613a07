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

/// Ratio of the ways of two samples of a machine that slows down steadily and stands at the end of the
/// second: beyond it the machine stopped before.
const FULL: f64 = 3.0;

/// Where in a sample a machine stops.
struct Stop {
    /// Share of the sample.
    share: f64,
    /// Way that the velocity at its start would make in a whole sample.
    way: f64,
}

/// Efforts at the end of a sample.
#[derive(Debug, Clone, Copy)]
pub struct Efforts<S> {
    /// Effort of the drive for the held input.
    pub driven: S,
    /// Gravity and added efforts.
    pub ambient: S,
    /// Friction.
    pub friction: S,
    /// Its mean over the sample, where the contact is rigid: it jumps inside samples.
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

    /// Displacement that was read in a sample; 0 beyond the ends.
    fn read(&self, sample: usize) -> f64 {
        let ends = (self.readings.get(sample), self.readings.get(sample.wrapping_add(1)));
        if let (Some(from), Some(to)) = ends { to - from } else { 0.0 }
    }

    /// Whether the machine rests in a sample: nothing moves in it, nor in one beside it. In slow
    /// motion over counts there are single samples without one.
    fn rests(&self, sample: usize) -> bool {
        let still = |sample| self.read(sample) == 0.0;
        still(sample) && (still(sample.wrapping_sub(1)) || still(sample + 1))
    }

    /// The same slope for a rigid contact: 0 where the machine rests before or after, and where it
    /// stopped. Between the neighbours it would seem to slide on for a sample or two.
    #[inline(always)]
    fn velocity_or_rest(&self, dt: &PerSample<'_>) -> S {
        let before = self.stamp.wrapping_sub(1);
        if self.rests(before) || self.rests(self.stamp) || self.stop(before).is_some() {
            return S::constant(0.0);
        }
        match self.stop(self.stamp) {
            Some(stop) => S::constant(stop.way / dt.at(self.stamp)),
            None => self.velocity(dt),
        }
    }

    /// Where in a sample a machine stops that slowed down steadily until then and rests or goes back
    /// afterwards; `None` where it does not.
    ///
    /// A dry contact slows a machine down faster than it lets it speed up again: the ways of the
    /// samples before tell best where it stopped. Those of the last two are as 2τ + 1 to τ² where
    /// the stop is in the second, at the share τ.
    fn stop(&self, sample: usize) -> Option<Stop> {
        let way = self.read(sample);
        let [earlier, before] = [2, 1].map(|back| self.read(sample.wrapping_sub(back)));
        if way * before > 0.0 {
            let ratio = before / way;
            if ratio <= FULL || !self.goes_no_further(sample + 1, way) {
                return None;
            }
            let share = (1.0 + (1.0 + ratio).sqrt()) / ratio;
            return Some(Stop { share, way: 2.0 * way / share });
        }
        let slowing = earlier * before > 0.0 && earlier.abs() > before.abs();
        if !slowing || earlier / before > FULL || !self.goes_no_further(sample, before) {
            return None;
        }
        let lost = earlier - before;
        let way = before - 0.5 * lost;
        Some(Stop { share: (way / lost).min(1.0), way })
    }

    /// Whether a machine that moved this way rests in a sample, or goes back as soon as it moves.
    fn goes_no_further(&self, sample: usize, way: f64) -> bool {
        let next = self.read(sample);
        let next = if next == 0.0 { self.read(sample + 1) } else { next };
        next * way < 0.0 || self.rests(sample)
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

    /// The same with efforts about the end of each sample: friction of a rigid contact, which jumps
    /// inside samples, is its mean over the sample before and the one after, as a held input is.
    pub fn follow_about(
        &mut self,
        motion: &MeasuredMotion<'_>,
        mut row: impl FnMut(usize, &Efforts<S>),
    ) {
        let mut waiting: Option<(usize, Efforts<S>)> = None;
        let MeasuredMotion { positions, inputs, around, dt } = *motion;
        self.follow(positions, inputs, around, dt, |k, efforts, _| {
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
        let slope = |track: &Track<'_, S>| {
            if L::RIGID { track.velocity_or_rest(&dt) } else { track.velocity(&dt) }
        };
        let mut velocity = slope(&track);
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
            // Where a machine with a rigid contact stops, the rest of the sample is one at rest.
            let stop = if L::RIGID { track.stop(k) } else { None };
            let share = stop.map_or(1.0, |stop| stop.share);
            let (moving, rest) = (span * share, span * (1.0 - share));
            let mut held = Along::new(at_contact, moving, (before, velocity), channels);
            if share > 0.0 {
                through_events(&mut held, law, state, moving);
            }
            if share < 1.0 {
                let moved = held.mean * share;
                held = Along::new(zero, rest, (zero, zero), channels);
                through_events(&mut held, law, state, rest);
                held.mean = moved + held.mean * (1.0 - share);
            }
            run.friction = held.outcome.force;
            let mut ahead = zero;
            if misreads {
                ahead += track.at[1] - track.readings[k + 1];
            }
            for mass in &mut *beyond {
                ahead += mass.advance(track.acceleration(&dt), duration);
            }
            let there = Whereabouts { machine: &*machine, at: &at, input, load };
            let (friction, mean) = (run.friction, L::RIGID.then_some(held.mean));
            row(k, Efforts { driven, ambient, friction, mean, ahead }, there);
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
