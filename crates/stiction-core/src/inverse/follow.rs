//! A machine moved along positions that were measured or prescribed: the efforts it needs.

use std::ops::Range;

use stiction_dispatch::Task;

use crate::friction::{Channels, FrictionLaw, LawState, Motion};
use crate::integrate::Along;
use crate::inverse::track::{Stop, Track};
use crate::math::scalar::Scalar;
use crate::plant::drive::{Way, arriving};
use crate::plant::effects::{Passage, Situation};
use crate::plant::{Beyond, Budget, Machine, Run};
use crate::simulate::model::CHUNK;
use crate::simulate::motor::Running;
use crate::support::interrupt;
use crate::support::motion::MeasuredMotion;

/// Efforts at the end of a sample.
#[derive(Debug, Clone, Copy)]
pub struct Efforts<S> {
    /// Effort of the drive for the held input.
    pub driven: S,
    /// Gravity and added efforts, less what a load behind a gap loses by friction of its own.
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
        let (effort, ..) = self.machine.efforts(self.at, self.input, self.load);
        self.machine.at_contact(self.at, effort, self.load)
    }

    /// What the drive is commanded.
    pub fn command(&self) -> S {
        self.machine.command(self.input, &self.situation())
    }
}

/// Who sees the efforts of each sample, in the loop itself: a function might be one of its own, to
/// which rows of derivatives go through memory.
pub(crate) trait Sees<S: Scalar> {
    /// Sees those of a sample.
    fn see(&mut self, sample: usize, efforts: &Efforts<S>, there: &Whereabouts<'_, S>);
}

/// What is called with sample, efforts and whereabouts.
type Row<'a, S> = dyn FnMut(usize, &Efforts<S>, &Whereabouts<'_, S>) + 'a;

/// A function that sees them: one loop for all of these.
struct Called<'a, 'b, S: Scalar>(&'a mut Row<'b, S>);

impl<S: Scalar> Sees<S> for Called<'_, '_, S> {
    #[inline(always)]
    fn see(&mut self, sample: usize, efforts: &Efforts<S>, there: &Whereabouts<'_, S>) {
        (self.0)(sample, efforts, there);
    }
}

/// Who sees efforts that may be averaged about the end of each sample.
pub(crate) trait SeesAbout<S: Scalar> {
    /// Sees those about the end of a sample.
    fn see(&mut self, sample: usize, efforts: &Efforts<S>);
}

/// Friction of a rigid contact, which jumps inside samples, as its mean over the sample before and the
/// one after.
struct About<'a, S, R> {
    row: &'a mut R,
    waiting: Option<(usize, Efforts<S>)>,
}

impl<S: Scalar, R: SeesAbout<S>> Sees<S> for About<'_, S, R> {
    #[inline(always)]
    fn see(&mut self, sample: usize, efforts: &Efforts<S>, _: &Whereabouts<'_, S>) {
        let Some(mean) = efforts.mean else { return self.row.see(sample, efforts) };
        let Some((before, last)) = &mut self.waiting else {
            self.waiting = Some((sample, Efforts { friction: mean, ..*efforts }));
            return;
        };
        last.friction = (last.friction + mean) * 0.5;
        self.row.see(*before, last);
        // One by one, or a copy of all would be a call.
        *before = sample;
        last.friction = mean;
        last.driven = efforts.driven;
        last.ambient = efforts.ambient;
        last.ahead = efforts.ahead;
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
        mut row: impl FnMut(usize, &Efforts<S>, &Whereabouts<'_, S>),
    ) {
        self.follow_on(motion, 0..motion.samples(), &mut Called(&mut row));
    }

    /// Moves the contact along some of the samples and tells nobody.
    pub(crate) fn follow_to(&mut self, motion: &MeasuredMotion<'_>, samples: Range<usize>) {
        self.follow_on(motion, samples, &mut Called(&mut |_, _, _| ()));
    }

    /// The same with efforts that may be averaged about the end of each sample: friction of a rigid
    /// contact, which jumps inside samples, is then its mean over the sample before and the one after,
    /// as a held input is.
    pub(crate) fn follow_about(
        &mut self,
        motion: &MeasuredMotion<'_>,
        row: &mut impl SeesAbout<S>,
    ) {
        let mut about = About { row, waiting: None };
        self.follow_on(motion, 0..motion.samples(), &mut about);
        if let Some((k, last)) = about.waiting {
            about.row.see(k, &last);
        }
    }

    /// Follows some of the samples, from where the last one before them ended. A second mass swings
    /// in from rest.
    fn follow_on(
        &mut self,
        motion: &MeasuredMotion<'_>,
        samples: Range<usize>,
        row: &mut impl Sees<S>,
    ) {
        let misreads = self.machine.effects.misreads();
        let sensor = self.machine.effects.clone();
        let behind = |reading: f64| sensor.behind(S::constant(reading));
        let actual: Option<&dyn Fn(f64) -> S> = if misreads { Some(&behind) } else { None };
        let inertia = self.machine.body.inertia;
        let count = self.machine.sensor.count;
        let masses = self.machine.effects.second_masses().iter();
        let mut beyond: Vec<Beyond<S>> =
            masses.map(|mass| Beyond::new(mass, inertia, count)).collect();
        let (way, machine, run) = (self.way.as_mut(), &mut self.machine, &mut self.run);
        let beyond = beyond.as_mut_slice();
        let track = Track::new(motion.positions, actual, samples.start);
        with_law_and_state!(&self.law, &mut self.state, |law, state| {
            let contact = (law, state);
            S::run(Following { way, machine, run, beyond, contact, track, samples, motion, row });
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
    motion: &'a MeasuredMotion<'b>,
    row: &'a mut R,
}

impl<S, L, R> Task for Following<'_, '_, S, L, R>
where
    S: Scalar,
    L: FrictionLaw<S>,
    R: Sees<S>,
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { mut way, machine, run, beyond, contact: (law, state), mut track, .. } = self;
        let Self { samples, motion, row, .. } = self;
        let MeasuredMotion { inputs, around, dt, averaged, .. } = *motion;
        let located = L::RIGID && averaged;
        let bends = !L::RIGID && averaged;
        let count = machine.sensor.count;
        let zero = S::constant(0.0);
        let misreads = machine.effects.misreads();
        let remembers = machine.effects.remembers();
        let relaxes = machine.relaxes();
        let direct = machine.is_direct();
        let servo = machine.drive.servo.is_some();
        let earlier = samples.start.checked_sub(1).filter(|_| located);
        let earlier = earlier.and_then(|sample| track.stop(sample));
        let (velocity, mut stop) = track.slope(&dt, located, earlier);
        let mut at = machine.at_contact(&run.situation(), S::constant(0.0), S::constant(0.0));
        let some = !samples.is_empty();
        // What readings show as it is depends on no parameter: of these only the values change.
        let mut step =
            Motion { displacement: zero, duration: zero, start_velocity: zero, velocity };
        let mut load = zero;
        if some && !misreads {
            (at.position, at.velocity) = (zero, zero);
        }
        let mut channels = machine.channels(&at, zero, zero);
        let mean = located.then_some(zero);
        let friction = run.friction;
        let mut efforts = Efforts { driven: zero, ambient: zero, friction, mean, ahead: zero };
        let mut held = false;
        for (passed, k) in samples.enumerate() {
            if passed % CHUNK == 0 {
                if interrupt::due() {
                    break;
                }
                state.make_room(CHUNK + CHUNK / 4);
            }
            let duration = dt.at(k);
            load.put(around.load.at(k));
            let stops = stop;
            track.advance();
            step.duration.put(duration);
            at.time.put(at.time.re() + duration);
            if misreads {
                step.start_velocity = step.velocity;
                (step.velocity, stop) = track.slope(&dt, located, stops);
                step.displacement = track.displacement();
                at.position = track.position();
                at.velocity = step.velocity;
                at.path += step.displacement.abs();
            } else {
                let (velocity, next) = track.slope_read(&dt, located, stops);
                let displacement = track.displacement_read();
                stop = next;
                step.start_velocity.put(step.velocity.re());
                step.velocity.put(velocity);
                step.displacement.put(displacement);
                at.position.put(track.reading());
                at.velocity.put(velocity);
                at.path.put(at.path.re() + displacement.abs());
            }
            at.transmitted = around.transmitted_at(k);
            at.temperature = around.temperature_at(k);
            at.enabled = around.enabled_at(k);
            if remembers {
                let Motion { displacement, duration: span, .. } = step;
                let passage = Passage { displacement, friction: efforts.friction, span };
                machine.effects.remember(&passage);
            }
            let input = arriving(&mut way, inputs.at(k), None, duration);
            let Efforts { driven, ambient, .. } = &mut efforts;
            if direct {
                machine.reach_directly(&at, input, load, &mut channels, [driven, ambient]);
            } else {
                machine.reach(&mut at, [&input, &load], &mut channels, [driven, ambient]);
            }
            if relaxes {
                let friction = efforts.friction;
                let (hardened, crept) = machine.relax(run.relaxed, friction, step.duration);
                run.relaxed = hardened;
                step.displacement -= crept;
            }
            let Efforts { friction, mean, .. } = &mut efforts;
            let (contact, mean) = ((law, &mut *state), mean.as_mut());
            match stops {
                Some(Stop { left, .. }) if left < 1.0 => {
                    stopping(&step, left, &channels, contact, friction, mean);
                }
                _ if bends && step.start_velocity.re() * step.velocity.re() < 0.0 => {
                    turning(&step, &channels, contact, friction, count);
                }
                _ => Along::through_events(&step, &channels, contact, friction, mean),
            }
            if relaxes {
                step.displacement = zero;
            }
            if misreads || !beyond.is_empty() {
                efforts.ahead = if misreads { at.position - track.reading() } else { zero };
                // Between two counts of a slow motion nobody knows what moves: no mass rings there.
                let stopped = stops.is_some_and(|stop| stop.left < 1.0 && stop.sure);
                // A stop inside the sample shows in the acceleration at its end.
                held = (held || stopped) && track.rests_next();
                for mass in &mut *beyond {
                    let speed = at.velocity;
                    efforts.ahead += mass.advance(track.acceleration(&dt), speed, duration, held);
                    let dragged = mass.slowing(speed) * machine.body.inertia;
                    // Not the contact's: what remembers that must not see it.
                    efforts.ambient -= dragged;
                }
            }
            row.see(k, &efforts, &Whereabouts { machine: &*machine, at: &at, input, load });
            if servo {
                run.friction = efforts.friction;
                run.stand(&at);
                machine.wind(run, input, duration);
                at.wound = run.wound;
            }
        }
        if some {
            run.friction = efforts.friction;
            run.stand(&at);
        }
    }
}

/// A sample in which a machine with a rigid contact stops after this share of it: the rest of it is one
/// at rest.
#[cold]
#[inline(never)]
fn stopping<S: Scalar, L: FrictionLaw<S>>(
    step: &Motion<S>,
    share: f64,
    channels: &Channels<S>,
    (law, state): (&L, &mut L::State),
    force: &mut S,
    mean: Option<&mut S>,
) {
    let zero = S::constant(0.0);
    let (mut moved, mut rested) = (zero, zero);
    if share > 0.0 {
        let moving = Motion { duration: step.duration * share, ..*step };
        Along::through_events(&moving, channels, (law, &mut *state), force, Some(&mut moved));
    }
    let rest = Motion::held(zero, step.duration * (1.0 - share));
    Along::through_events(&rest, channels, (law, state), force, Some(&mut rested));
    if let Some(mean) = mean {
        *mean = moved * share + rested * (1.0 - share);
    }
}

/// A sample in which a contact that yields turns back: it goes as far as the machine does, and from there
/// to where the sample ends. Straight to its end it would not have been where it turned, and what
/// remembers turns would be short of a·h²/8 each time, whose force grows with the square of the sample.
///
/// In between the motion is the cubic with the positions and velocities of both ends. A way of no more
/// than a count beyond them may be none: readings that rest go to and fro by as much.
#[cold]
#[inline(never)]
fn turning<S: Scalar, L: FrictionLaw<S>>(
    step: &Motion<S>,
    channels: &Channels<S>,
    (law, state): (&L, &mut L::State),
    force: &mut S,
    count: f64,
) {
    let (start, end) = (step.start_velocity * step.duration, step.velocity * step.duration);
    let Some(share) = turn(start.re(), step.displacement.re(), end.re()) else {
        return Along::through_events(step, channels, (law, state), force, None);
    };
    let (left, square) = (1.0 - share, share * share);
    // Where it turns it does not move: that a parameter makes it turn sooner changes nothing.
    let out = start * (share * left * left) + step.displacement * (square * (3.0 - 2.0 * share))
        - end * (square * left);
    let (reached, ended) = (out.re(), step.displacement.re());
    if (reached - ended.max(0.0)).max(ended.min(0.0) - reached) <= count {
        return Along::through_events(step, channels, (law, state), force, None);
    }
    let zero = S::constant(0.0);
    let there =
        Motion { displacement: out, duration: step.duration * share, velocity: zero, ..*step };
    Along::through_events(&there, channels, (law, &mut *state), force, None);
    let back = Motion {
        displacement: step.displacement - out,
        duration: step.duration * left,
        start_velocity: zero,
        ..*step
    };
    Along::through_events(&back, channels, (law, state), force, None);
}

/// The share of a sample after which a cubic turns that starts and ends with these velocities, of
/// opposite signs and times the duration, and makes this way; `None` at its very ends.
fn turn(start: f64, way: f64, end: f64) -> Option<f64> {
    let (a, b) = (3.0 * (start + end) - 6.0 * way, 6.0 * way - 4.0 * start - 2.0 * end);
    let half = -0.5 * (b + (b * b - 4.0 * a * start).max(0.0).sqrt().copysign(b));
    [half / a, start / half].into_iter().find(|share| (ENDS..=1.0 - ENDS).contains(share))
}

/// Share of a sample from whose ends a turn lies no further than round-off.
const ENDS: f64 = 1e-6;

impl<S: Scalar> Run<S> {
    /// Where a motion that is given has come to.
    fn stand(&mut self, at: &Situation<S>) {
        self.position = at.position;
        self.velocity = at.velocity;
        self.time = at.time;
        self.path = at.path;
        self.transmitted = at.transmitted;
        self.temperature = at.temperature;
        self.enabled = at.enabled;
        self.second_position = at.position;
        self.second_velocity = at.velocity;
        // Whatever moved it, it was not counted.
        self.budget = Budget::unknown();
    }
}
