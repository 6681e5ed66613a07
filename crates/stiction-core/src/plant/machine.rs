//! Everything of a plant but its friction law.

use stiction_dispatch::Task;

use super::body::Body;
use super::budget::Budget;
use super::drive::Drive;
use super::effects::{Effects, Passage, Relaxation, Situation};
use super::place::ByPlace;
use super::run::{Before, Run};
use super::sensor::Sensor;
use super::shaft::Shaft;
use crate::friction::Channels;
use crate::friction::elements::plastic::Plastic;
use crate::math::scalar::{Scalar, sign};

/// Drive, body, effects and sensor.
#[derive(Debug, Clone)]
pub struct Machine<S: Scalar> {
    /// From input to effort.
    pub drive: Drive<S>,
    /// Inertia and gravity.
    pub body: Body<S>,
    /// Effects beside the law.
    pub effects: Effects<S>,
    /// Position sensor.
    pub sensor: Sensor,
    pub(crate) relaxation: Option<Plastic<S>>,
    pub(crate) steady_creep: Option<SteadyCreep<S>>,
    pub(crate) shaft: Option<Shaft<S>>,
    /// Friction of slow sliding, which renews the relaxing junctions.
    sliding: S,
    /// Sum of the stiffnesses that effects add.
    stiffness: f64,
    /// Inertia on the motor's side of the shaft.
    pub(crate) inertia: S,
    /// Its reciprocal.
    pub(crate) lightness: S,
}

/// Creep that no hardening stops: its speed at a force is `coefficient`·|F|^n.
#[derive(Debug, Clone, Copy)]
pub struct SteadyCreep<S> {
    coefficient: S,
    exponent: S,
}

impl<S: Scalar> SteadyCreep<S> {
    /// Speed under a force.
    #[inline]
    pub fn speed(&self, force: S) -> S {
        self.coefficient * force.power_of_magnitude(self.exponent) * sign(force.re())
    }
}

impl<S: Scalar> Machine<S> {
    /// Puts the parts together; `sliding` is the law's friction of slow sliding.
    pub fn new(
        drive: Drive<S>,
        body: Body<S>,
        effects: Effects<S>,
        sensor: Sensor,
        sliding: S,
    ) -> Self {
        let there = |gain: S| gain.re() != 0.0 || gain.derivative_is_nonzero();
        let (mut relaxation, mut steady_creep) = (None, None);
        if sliding.re().is_finite() && sliding.re() > 0.0 {
            for each in effects.relaxations() {
                match *each {
                    Relaxation::Hardening { creep, exponent, rate } if there(creep) => {
                        let coefficient = creep / sliding.power_of_magnitude(exponent);
                        relaxation = Some(Plastic { coefficient, exponent, rate });
                    }
                    Relaxation::Steady { speed, exponent } if there(speed) => {
                        let coefficient = speed / sliding.power_of_magnitude(exponent);
                        steady_creep = Some(SteadyCreep { coefficient, exponent });
                    }
                    Relaxation::Hardening { .. } | Relaxation::Steady { .. } => (),
                }
            }
        }
        let masses = effects.second_masses().iter();
        let shaft = masses.filter_map(|m| Shaft::new(m, body.inertia)).next_back();
        let inertia = shaft.map_or(body.inertia, |shaft| body.inertia - shaft.inertia);
        let lightness = S::constant(1.0) / inertia;
        let stiffness = effects.stiffness(sliding.re());
        Self {
            drive,
            body,
            effects,
            sensor,
            relaxation,
            steady_creep,
            shaft,
            sliding,
            stiffness,
            inertia,
            lightness,
        }
    }

    /// Whether nothing but drive, inertia, weight, a constant effort and friction is there: such a machine
    /// has efforts that no motion changes, and levels of 1. What becomes of its input before that hangs on
    /// the input alone.
    pub fn is_bare(&self) -> bool {
        let alone = self.shaft.is_none() && !self.relaxes() && self.body.is_level();
        alone && self.effects.even_effort().is_some() && self.drive.servo.is_none()
    }

    /// Its gravity, added efforts, levels and what becomes of its input, where these go by the place alone and
    /// nothing else is there.
    pub(crate) fn by_place(&self) -> Option<ByPlace> {
        let alone = self.shaft.is_none() && self.has_rows() && !self.notes_samples();
        let drive = !self.drives_by_place() || self.effects.followed_input().is_some();
        let steady = !self.effects.damps() && self.drive.servo.is_none() && drive;
        if alone && steady { ByPlace::of(&self.body, &self.effects) } else { None }
    }

    /// Whether its steps may go in rows: nothing gives way in series with the contact.
    pub fn has_rows(&self) -> bool {
        !self.relaxes() && !self.effects.is_seeded()
    }

    /// Whether such a row ends with its sample: something takes note of it.
    pub fn notes_samples(&self) -> bool {
        self.effects.remembers() || self.drive.servo.is_some()
    }

    /// Whether the effort of the drive goes by where the body is and how fast.
    pub fn drives_by_place(&self) -> bool {
        self.drive.servo.is_some() || self.effects.maps_by_place()
    }

    /// A body at this position and velocity.
    pub fn start(&self, position: S, velocity: S) -> Run<S> {
        let zero = S::constant(0.0);
        let mut run = Run {
            position,
            velocity,
            time: zero,
            path: zero,
            moved: zero,
            transmitted: None,
            temperature: None,
            wound: zero,
            enabled: true,
            friction: zero,
            second_position: position,
            second_velocity: velocity,
            relaxed: zero,
            ambient: zero,
            budget: Budget::default(),
        };
        self.refresh(&mut run);
        run
    }

    /// Recomputes what is derived from the other fields, after these were set from outside.
    pub fn refresh(&self, run: &mut Run<S>) {
        run.ambient = self.ambient(&run.situation(), run.second_position, run.second_velocity);
    }

    /// Bound of ω² of anything that swings, with this stiffness of the friction.
    pub(crate) fn fastest_square(&self, friction: f64) -> f64 {
        let near =
            friction + self.stiffness + self.body.gravity_amplitude.re().abs() + self.servo().0;
        let shaft = self.shaft.map_or((0.0, 0.0), |shaft| {
            let stiffness = shaft.stiffness.re();
            (stiffness, stiffness / shaft.inertia.re())
        });
        (near + shaft.0) / self.inertia.re() + shaft.1
    }

    /// ω·h of the fastest ring over so long a time, see [`Self::fastest_square`].
    pub(crate) fn phase(&self, friction: f64, duration: f64) -> f64 {
        duration * self.fastest_square(friction).sqrt()
    }

    /// Stiffness and damping by which a servo holds its goal.
    pub(crate) fn servo(&self) -> (f64, f64) {
        let servo = self.drive.servo.as_ref();
        servo.map_or((0.0, 0.0), |servo| servo.stiffness_and_damping(self.drive.gain.re()))
    }

    /// Shaft effort on the motor's side.
    #[inline]
    pub(crate) fn shaft(&self, at: &Situation<S>, position: S, velocity: S) -> S {
        self.shaft.map_or(S::constant(0.0), |shaft| {
            shaft.pull(position - at.position, velocity - at.velocity)
        })
    }

    /// Moves the second mass on while the motor goes from one situation to another.
    #[inline]
    pub(crate) fn swing(
        &self,
        start: &Situation<S>,
        end: &Situation<S>,
        span: S,
        run: &mut Run<S>,
    ) {
        if let Some(shaft) = &self.shaft {
            let second = (run.second_position, run.second_velocity);
            (run.second_position, run.second_velocity) = shaft.swing(start, end, span, second);
        }
    }

    /// Effort that does not come from input and load.
    #[inline]
    pub(crate) fn ambient(&self, at: &Situation<S>, second: S, second_velocity: S) -> S {
        let effort = self.surroundings(at);
        if self.shaft.is_some() { effort + self.shaft(at, second, second_velocity) } else { effort }
    }

    /// Gravity and added efforts.
    #[inline]
    pub(crate) fn surroundings(&self, at: &Situation<S>) -> S {
        let gravity = self.body.gravity(at.position);
        if !self.effects.adds_efforts() {
            return gravity + 0.0;
        }
        gravity + self.effects.effort(&Situation { sliding: self.sliding, ..*at })
    }

    /// The same as part of whoever asks for it, in a situation that is told what it lacks.
    #[inline(always)]
    pub(crate) fn added_there(&self, at: &mut Situation<S>) -> S {
        let gravity = self.body.gravity(at.position);
        if !self.effects.adds_efforts() {
            return gravity + 0.0;
        }
        at.sliding = self.sliding;
        gravity + self.effects.effort_within(at)
    }

    /// The same once for all laws.
    #[inline(never)]
    pub(crate) fn added_apart(&self, at: &mut Situation<S>) -> S {
        self.added_there(at)
    }

    /// Levels of the contact under all effort but friction, of which the load is a part, likewise.
    #[inline(always)]
    pub(crate) fn levels_there(&self, at: &mut Situation<S>, effort: S, load: S) -> (S, S) {
        let load = load + self.body.gravity(at.position);
        at.load = at.carried(load);
        at.motor = effort - load;
        at.sliding = self.sliding;
        self.effects.levels_within(at)
    }

    /// The same once for all laws.
    #[inline(never)]
    pub(crate) fn levels_apart(&self, at: &mut Situation<S>, effort: S, load: S) -> (S, S) {
        self.levels_there(at, effort, load)
    }

    /// What the drive is commanded: the input, or the voltage that a servo makes of its goal.
    #[inline]
    pub fn command(&self, input: S, at: &Situation<S>) -> S {
        match &self.drive.servo {
            None => input,
            Some(servo) => servo.voltage(self.error(input, at), at.velocity, at.wound),
        }
    }

    /// Distance of what the sensor reads from the goal.
    #[inline]
    fn error(&self, goal: S, at: &Situation<S>) -> S {
        goal - if self.effects.misreads() { self.effects.sensor(at.position) } else { at.position }
    }

    /// Gravity and added efforts of a bare machine.
    #[inline(always)]
    pub(crate) fn weight(&self) -> S {
        let gravity = self.body.level_gravity();
        match self.effects.even_effort() {
            Some(effort) => gravity + effort,
            None => gravity + 0.0,
        }
    }

    /// Gain and limit of the drive and the weight of this bare machine, as plain numbers.
    pub fn bare_numbers(&self) -> [f64; 3] {
        [self.drive.gain.re(), self.drive.limit, self.weight().re()]
    }

    /// What the sensor reads where the body is.
    pub fn measured(&self, position: f64) -> f64 {
        self.sensor.read(self.effects.sensor(S::constant(position)).re())
    }

    /// Effort of the drive under an input, and a load, where that goes by neither place nor speed.
    #[inline(always)]
    pub fn driven_directly(&self, input: f64, load: S) -> S {
        if self.effects.maps_inputs() {
            return self.driven_anywhere(S::constant(input), load);
        }
        self.drive.direct(input) + load
    }

    /// The same under an input that may depend on parameters.
    #[inline(never)]
    pub fn driven_anywhere(&self, input: S, load: S) -> S {
        self.driven(input, &Situation::resting()) + load
    }

    /// All effort but friction on this bare machine under an input, as effects have mapped it, and a load.
    #[inline(always)]
    pub fn bare_effort(&self, input: f64, load: S) -> S {
        self.drive.direct(input) + load + self.weight()
    }

    /// Effort of the drive of a bare machine.
    #[inline(always)]
    pub(crate) fn bare_drive(&self, input: S, enabled: bool) -> S {
        if !enabled {
            S::constant(0.0)
        } else if self.effects.maps_inputs() {
            self.driven(input, &Situation::resting())
        } else {
            self.drive.direct(input)
        }
    }

    /// Effort of the drive.
    #[inline]
    pub(crate) fn driven(&self, input: S, at: &Situation<S>) -> S {
        self.driven_within(input, at)
    }

    /// The same as part of whoever asks for it.
    #[inline(always)]
    fn driven_within(&self, input: S, at: &Situation<S>) -> S {
        if !at.enabled {
            return S::constant(0.0);
        }
        self.drive.effort(self.effects.input_within(self.command(input, at), at), at.velocity)
    }

    /// Speed that a run comes to within a step under this input and load, where effects damp it.
    pub(crate) fn reached(&self, run: &Run<S>, input: S, load: S, span: f64) -> f64 {
        let speed = run.velocity.re().abs();
        let effort = (self.driven(input, &run.situation()) + load + run.ambient).re();
        let gained = effort.abs() * span / self.inertia.re();
        let free = if effort * run.velocity.re() < 0.0 { gained - speed } else { gained + speed };
        // Damping that grows with the speed bears the effort before that.
        let borne = 0.5 * self.effects.damping(free) * free;
        let within = if borne > effort.abs() { free * (effort.abs() / borne).sqrt() } else { free };
        within.max(speed)
    }

    /// Lets a servo sum up its distance from the goal over a sample.
    #[inline]
    pub fn wind(&self, run: &mut Run<S>, goal: S, span: f64) {
        if let Some(servo) = &self.drive.servo
            && run.enabled
        {
            let error = self.error(goal, &run.situation());
            run.wound = servo.wind(error, run.velocity, run.wound, S::constant(span));
        }
    }

    /// All effort but friction and shaft, then the drive's share and the rest of it.
    #[inline]
    pub fn efforts(&self, at: &Situation<S>, input: S, load: S) -> (S, S, S) {
        let driven = self.driven(input, at);
        let ambient = self.surroundings(at);
        (driven + load + ambient, driven, ambient)
    }

    /// A situation with what it lacks of the contact under all effort but friction, of which the load is a
    /// part.
    #[inline]
    pub fn at_contact(&self, at: &Situation<S>, effort: S, load: S) -> Situation<S> {
        let load = load + self.body.gravity(at.position);
        Situation { load: at.carried(load), motor: effort - load, sliding: self.sliding, ..*at }
    }

    /// Whether efforts are those of a plain drive and of a weight, and no effect lies between them
    /// and the contact.
    pub fn is_direct(&self) -> bool {
        self.drive.servo.is_none() && self.body.is_level() && self.effects.lets_pass()
    }

    /// What reaches the contact, and the effort of the drive and the rest of it but the load, where
    /// [`Self::is_direct`]; to places that hold what was there before, which few samples change.
    #[inline(always)]
    pub fn reach_directly(
        &self,
        at: &Situation<S>,
        input: S,
        load: S,
        channels: &mut Channels<S>,
        [driven, ambient]: [&mut S; 2],
    ) {
        *driven = if at.enabled { self.drive.direct(input) } else { S::constant(0.0) };
        *ambient = self.weight();
        channels.effort = *driven + load + *ambient;
        channels.load = at.carried(load + self.body.level_gravity());
        channels.temperature = at.temperature;
    }

    /// What reaches the contact of a bare machine.
    #[inline]
    pub(crate) fn plain_channels(&self, at: &Situation<S>, effort: S, load: S) -> Channels<S> {
        let load = at.carried(load + self.body.level_gravity());
        Channels { effort, load, temperature: at.temperature, ..Channels::default() }
    }

    /// What reaches the contact.
    #[inline]
    pub fn channels(&self, at: &Situation<S>, effort: S, load: S) -> Channels<S> {
        let (level, viscous_level) = if self.effects.changes_levels() {
            self.effects.levels(&self.at_contact(at, effort, load))
        } else {
            self.effects.levels(at)
        };
        let load = at.carried(load + self.body.gravity(at.position));
        Channels { effort, load, level, viscous_level, temperature: at.temperature }
    }

    /// Whether a friction of this size slides, which renews relaxing junctions.
    #[inline]
    pub(crate) fn slides(&self, friction: S) -> bool {
        friction.re().abs() >= SLIDING_SHARE * self.sliding.re()
    }

    /// Hardening of the relaxation module after a step under this friction, and how far the contact
    /// crept.
    #[inline]
    pub fn relax(&self, hardened: S, friction: S, span: S) -> (S, S) {
        let zero = S::constant(0.0);
        if self.slides(friction) {
            return (zero, zero);
        }
        let (mut after, mut crept) = (hardened, zero);
        if let Some(module) = self.relaxation {
            let creep = module.creep(hardened, friction, |_| zero, zero, span);
            after += creep.hardening;
            crept += creep.displacement;
        }
        if let Some(creep) = self.steady_creep {
            crept += creep.speed(friction) * span;
        }
        (after, crept)
    }

    /// Creep of a body at rest, as far as the effort that makes it goes on: what creeps to where the
    /// effort is balanced stays there.
    #[inline]
    pub(crate) fn not_beyond(&self, effort: S, crept: S) -> S {
        let gravity = self.body.gravity_amplitude.re().abs();
        let near = self.stiffness + gravity;
        let way = effort.abs() / near;
        if near > 0.0 && crept.re().abs() > way.re() { way * sign(crept.re()) } else { crept }
    }

    /// Creep no faster than the effort could have driven a free body over all the way that it has crept
    /// since its junctions were new: so it has no energy that the effort did not give.
    #[inline]
    pub(crate) fn not_faster(&self, effort: S, crept: S, before: S, span: S) -> S {
        let half = effort.abs() * span * span / self.body.inertia;
        let most = half + (half * half + half * before * 2.0).sqrt();
        if crept.re().abs() > most.re() { most * sign(crept.re()) } else { crept }
    }

    /// Whether the contact creeps of itself.
    #[inline]
    pub fn relaxes(&self) -> bool {
        self.relaxation.is_some() || self.steady_creep.is_some()
    }

    /// The same as a call: what all effects need is not compiled into every loop.
    #[inline(never)]
    pub(crate) fn driven_there(&self, input: S, at: &Situation<S>) -> S {
        if !S::CARRIES {
            return self.driven(input, at);
        }
        let mut driven = S::constant(0.0);
        S::run(DrivenThere { machine: self, input: &input, at, driven: &mut driven });
        driven
    }

    /// Lets effects remember the sample that a run went through, from where it stood before.
    #[inline]
    pub fn remember(&mut self, before: Before<S>, run: &mut Run<S>) {
        if self.effects.remembers() {
            let passage = Passage {
                displacement: run.position - before.position,
                friction: before.friction,
                span: run.time - before.time,
            };
            self.effects.remember(&passage);
            run.moved = S::constant(0.0);
        }
    }
}

/// Effort of the drive, as a task: rows of derivatives want the widest vectors.
struct DrivenThere<'a, S: Scalar> {
    machine: &'a Machine<S>,
    input: &'a S,
    at: &'a Situation<S>,
    driven: &'a mut S,
}

impl<S: Scalar> Task for DrivenThere<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        *self.driven = self.machine.driven_within(*self.input, self.at);
    }
}

/// Share of the friction of slow sliding from which on a contact counts as sliding.
const SLIDING_SHARE: f64 = 0.98;
