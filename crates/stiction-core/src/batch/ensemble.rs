//! Many machines side by side: the same motor with parameters, inputs and loads of their own.
//!
//! Members share nothing, so that what comes out is the same to the bit for any number of threads,
//! and the same as one motor after the other.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::batch::kept::Kept;
use crate::batch::lanes::{self, Job, Width};
use crate::friction::Statistics;
use crate::integrate::Integrator;
use crate::simulate::motor::{Column, Motor, MotorSpec, Running, Standing};
use crate::support::error::{Error, Result};
use crate::support::finite;
use crate::support::interrupt::{self, Pace};
use crate::support::samples::{PerSample, Surroundings};
use crate::support::work::{self, Meter};

/// What members of an ensemble differ in: rows of values, one for each path.
#[derive(Debug, Clone, Copy)]
pub struct Changes<'a> {
    /// Paths of parameters, `friction.creep_rate`.
    pub paths: &'a [String],
    /// Values of each path for all members, one path after the other.
    pub values: &'a [f64],
}

/// Numbers for each sample of each member.
#[derive(Debug, Clone, Copy)]
pub enum Rows<'a> {
    /// The same for all.
    Same(f64),
    /// One for each sample, the same for all members.
    Shared(&'a [f64]),
    /// One for each sample of each member, one member after the other.
    Each(&'a [f64]),
}

impl<'a> Rows<'a> {
    /// Those of one member, `samples` of them.
    pub fn of(&self, member: usize, samples: usize) -> PerSample<'a> {
        match *self {
            Self::Same(value) => PerSample::Same(value),
            Self::Shared(values) => PerSample::Each(values),
            Self::Each(values) => {
                PerSample::Each(&values[member * samples..(member + 1) * samples])
            }
        }
    }

    fn check(&self, name: &str, members: usize, samples: usize) -> Result<()> {
        let (given, wanted) = match self {
            Self::Same(_) => return Ok(()),
            Self::Shared(values) => (values.len(), samples),
            Self::Each(values) => (values.len(), members * samples),
        };
        if given == wanted {
            return Ok(());
        }
        Err(Error::Length { name: name.to_owned(), given, wanted })
    }

    fn all(&self) -> &'a [f64] {
        match *self {
            Self::Same(_) => &[],
            Self::Shared(values) | Self::Each(values) => values,
        }
    }
}

/// Inputs for each sample.
#[derive(Debug, Clone, Copy)]
pub enum Inputs<'a> {
    /// The same for all members.
    Shared(&'a [f64]),
    /// Those of one member after the other.
    Each(&'a [f64]),
}

impl<'a> Inputs<'a> {
    /// Those of one member, `samples` of them.
    pub fn of(&self, member: usize, samples: usize) -> &'a [f64] {
        match *self {
            Self::Shared(values) => values,
            Self::Each(values) => &values[member * samples..(member + 1) * samples],
        }
    }

    /// As numbers for each sample of each member.
    pub fn rows(&self) -> Rows<'a> {
        match *self {
            Self::Shared(values) => Rows::Shared(values),
            Self::Each(values) => Rows::Each(values),
        }
    }
}

/// What is kept of each column.
#[derive(Debug, Clone, Copy)]
pub enum Keep<'a> {
    /// Every so many samples one value: those at the ends of sample `every`, 2·`every` …
    Every(usize),
    /// The value at the end.
    Last,
    /// Root mean square of the distance from a target.
    Rms(Rows<'a>),
    /// Least and greatest value.
    Extremes,
}

impl Keep<'_> {
    /// Values that a column keeps of a member.
    pub fn width(&self, samples: usize) -> usize {
        match self {
            Self::Every(every) => samples / every,
            Self::Last | Self::Rms(_) => 1,
            Self::Extremes => 2,
        }
    }
}

/// A run of all members.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// Samples.
    pub samples: usize,
    /// Inputs held over each.
    pub inputs: Inputs<'a>,
    /// External effort.
    pub loads: Rows<'a>,
    /// Duration of each sample.
    pub dt: PerSample<'a>,
    /// What is kept.
    pub keep: Keep<'a>,
    /// Threads that share the members.
    pub threads: usize,
    /// Vectors in which they go side by side; no bit depends on it.
    pub width: Width,
}

/// Samples from which on numbers are looked at on the way, where a copy of the machines, which takes
/// back what they did until then, costs less than to read all numbers once more.
const MANY: usize = 1000;
/// Steps of all members together that take longer than anybody waits without a wish to interrupt them.
const LONG: f64 = 1e6;
/// Plain steps that a step of a member takes as long as, at least.
const PER_MEMBER: u64 = 16;

impl<'a> Plan<'a> {
    /// All that has a number for each sample.
    fn tables(&self) -> [(&'static str, Rows<'a>); 3] {
        let target = if let Keep::Rms(target) = self.keep { target } else { Rows::Same(0.0) };
        [("current", self.inputs.rows()), ("load", self.loads), ("target", target)]
    }

    /// Refuses numbers that are not finite.
    fn check_finite(&self) -> Result<()> {
        self.tables().iter().try_for_each(|(name, rows)| finite::check(name, rows.all()))
    }

    /// Whether all numbers of a member are finite.
    fn is_finite_for(&self, member: usize) -> bool {
        let own = self.tables().map(|(name, rows)| match rows.of(member, self.samples) {
            PerSample::Each(values) => finite::check(name, values).is_ok(),
            PerSample::Same(_) => true,
        });
        own == [true; 3]
    }
}

/// Machines of one kind, each with its state.
#[derive(Debug, Clone)]
pub struct Ensemble {
    spec: MotorSpec,
    members: Vec<Running<f64>>,
    /// What a second of all of them costs at least.
    rate: f64,
}

impl Ensemble {
    /// So many copies of a motor in its present state, with the changes made.
    pub fn new(motor: &Motor, members: usize, changes: Changes<'_>) -> Result<Self> {
        let spec = motor.spec();
        let known = spec.parameters();
        let mut places = Vec::with_capacity(changes.paths.len());
        for path in changes.paths {
            let place = known.iter().position(|(name, _)| name == path);
            places.push(place.ok_or_else(|| {
                let names = known.iter().map(|(name, _)| name.as_str());
                Error::unknown("parameter path", path, names)
            })?);
        }
        if changes.values.len() != places.len() * members {
            let wanted = places.len() * members;
            let given = changes.values.len();
            return Err(Error::Length { name: "parameters".to_owned(), given, wanted });
        }
        let plain: Vec<f64> = known.iter().map(|(_, value)| *value).collect();
        let members = (0..members).map(|member| {
            let mut values = plain.clone();
            for (row, place) in places.iter().enumerate() {
                values[*place] = changes.values[row * members + member];
            }
            if !places.is_empty() {
                spec.allows(&values)
                    .map_err(|error| Error::Member { member, problem: error.to_string() })?;
            }
            let mut running = Running::new(spec, &values);
            running.resume(motor.running());
            Ok(running)
        });
        let members = members.collect::<Result<Vec<_>>>()?;
        let rate = members.iter().map(|running| running.cost(1.0)).sum();
        Ok(Self { spec: spec.clone(), members, rate })
    }

    /// The motor that all of them are copies of.
    pub fn spec(&self) -> &MotorSpec {
        &self.spec
    }

    /// Branch counters of each member.
    pub fn statistics(&self) -> impl Iterator<Item = Statistics> {
        self.members.iter().map(Running::statistics)
    }

    /// The state of a member.
    pub fn running(&self, member: usize) -> Option<&Running<f64>> {
        self.members.get(member)
    }

    /// Number of members.
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// One sample of every member; fills position and velocity at its end. Where one of them cannot be
    /// stepped, or that leads to no number, all of them stay where they are.
    pub fn step(
        &mut self,
        inputs: PerSample<'_>,
        loads: PerSample<'_>,
        dt: f64,
        positions: &mut [f64],
        velocities: &mut [f64],
    ) -> Result<()> {
        let members = self.members.len();
        inputs.check("current", members)?;
        loads.check("load", members)?;
        for (name, given) in [("position", positions.len()), ("velocity", velocities.len())] {
            if given != members {
                return Err(Error::Length { name: name.to_owned(), given, wanted: members });
            }
        }
        self.check_work(loads, dt)?;
        let steps = self.steps_of(dt);
        let before = (steps > LONG).then(|| self.members.clone());
        let each = PER_MEMBER + (steps / members.max(1) as f64) as u64;
        let mut pace = Pace::default();
        let mut meter = Meter::new(work::allowed(members));
        // Those that may run away go first, and back where one of them does.
        let mut watched: Vec<(usize, Standing)> = Vec::new();
        for k in 0..members {
            let running = &mut self.members[k];
            if running.needs_no_watch(inputs.at(k), loads.at(k), dt) {
                continue;
            }
            if before.is_some() && pace.due(PER_MEMBER) {
                break;
            }
            let standing = running.standing();
            if let Err(error) =
                running.step_watched_within(inputs.at(k), loads.at(k), dt, &mut meter)
            {
                for (k, standing) in watched {
                    self.members[k].return_to(standing);
                }
                return Err(Error::Member { member: k, problem: error.to_string() });
            }
            watched.push((k, standing));
        }
        let mut watched = watched.into_iter().map(|(k, _)| k).peekable();
        for (k, running) in self.members.iter_mut().enumerate() {
            if before.is_some() && pace.due(each) {
                break;
            }
            if watched.next_if_eq(&k).is_none() {
                running.step_or_stay(inputs.at(k), loads.at(k), dt)?;
            }
            positions[k] = running.run.position;
            velocities[k] = running.run.velocity;
        }
        if let Some(before) = before
            && interrupt::due()
        {
            self.members = before;
            return Err(Error::Interrupted);
        }
        Ok(())
    }

    /// Whether effects or the integrator may divide samples further than parameters do.
    fn may_divide_further(&self) -> bool {
        self.spec.integrator != Integrator::Fast || !self.spec.effects.is_empty()
    }

    /// Refuses a sample of all members that takes more work than a call may make.
    fn check_work(&self, loads: PerSample<'_>, dt: f64) -> Result<()> {
        let members = self.members.len();
        let meter = Meter::new(work::allowed(members));
        let most = if self.may_divide_further() { f64::INFINITY } else { dt * self.rate };
        // Few members cannot come to it, and of plain ones nobody has to be asked.
        let dearest = self.spec.integrator.dearest_sample();
        if meter.foresee(most.min(members as f64 * dearest)).is_ok() {
            return Ok(());
        }
        let each = self.members.iter().enumerate();
        let cost = each.map(|(k, running)| running.cost_here(loads.at(k), dt).min(dearest)).sum();
        meter.foresee(cost).map_err(|error| self.spec.blame(error))
    }

    /// Whether one would want to interrupt samples of this plan.
    fn takes_long(&self, plan: &Plan<'_>) -> bool {
        plan.samples > 0 && self.steps_of(plan.dt.at(0)) * plan.samples as f64 > LONG
    }

    /// Steps of a sample of all members, if they are like the first.
    fn steps_of(&self, dt: f64) -> f64 {
        self.members
            .first()
            .map_or(0.0, |first| first.division(dt).steps * self.members.len() as f64)
    }

    /// Runs all members on. Each of `columns` is filled one member after the other, with
    /// [`Keep::width`] values of each. Where a number is not finite, they stay where they are.
    pub fn run(&mut self, plan: &Plan<'_>, columns: &mut [(Column, &mut [f64])]) -> Result<()> {
        let (members, samples) = (self.members.len(), plan.samples);
        for (name, rows) in plan.tables() {
            rows.check(name, members, samples)?;
        }
        plan.dt.check("dt", samples)?;
        let width = plan.keep.width(samples);
        let kinds: Vec<Column> = columns.iter().map(|(kind, _)| *kind).collect();
        for (_, values) in columns.iter() {
            let (given, wanted) = (values.len(), members * width);
            if given != wanted {
                return Err(Error::Length { name: "out".to_owned(), given, wanted });
            }
        }
        let longest = plan.dt.greatest();
        for (member, running) in self.members.iter().enumerate() {
            running
                .check_step(longest)
                .map_err(|error| Error::Member { member, problem: error.to_string() })?;
        }
        let most = work::allowed(members * samples);
        let foreseen =
            |running: &Running<f64>| running.foreseen(&Surroundings::NONE, plan.dt, samples);
        let cost: f64 = self.members.iter().map(foreseen).sum();
        Meter::new(most).foresee(cost).map_err(|error| self.spec.blame(error))?;
        let long = samples >= MANY || self.takes_long(plan) || cost > LONG;
        let before = (long || self.may_divide_further()).then(|| self.members.clone());
        // Of what is short, nothing could be taken back.
        let most = before.as_ref().map(|_| most);
        let spent = Mutex::new(0.0);
        let too_much = || most.is_some_and(|most| spent.lock().is_ok_and(|spent| *spent > most));
        if samples < MANY {
            plan.check_finite()?;
        }
        let halted = AtomicBool::new(false);
        let mut parts: Vec<_> =
            columns.iter_mut().map(|(_, values)| values.chunks_mut(width.max(1))).collect();
        let motors = self.members.iter_mut().enumerate().map(|(number, running)| {
            let own = parts.iter_mut().map(|part| part.next().unwrap_or_default()).collect();
            lanes::Motor { number, running, own }
        });
        let queue = Mutex::new(Work::of(motors, plan, &kinds, &halted).into_iter());
        let failed: Mutex<Option<(usize, Error)>> = Mutex::new(None);
        let labour = || {
            loop {
                let next = queue.lock().map_or(None, |mut queue| queue.next());
                let mut motor = match next {
                    None => break,
                    Some(Work::Team(job, motors)) => {
                        lanes::take_abreast(&job, motors);
                        continue;
                    }
                    Some(Work::Alone(motor)) => motor,
                };
                let member = motor.number;
                if too_much() {
                    break;
                }
                motor.running.allowance = Some(most.unwrap_or(f64::INFINITY));
                if halted.load(Ordering::Relaxed) || !plan.is_finite_for(member) {
                    halted.store(true, Ordering::Relaxed);
                    break;
                }
                if let Err(error) =
                    simulate(motor.running, member, plan, &kinds, &mut motor.own)
                    && let Ok(mut failed) = failed.lock()
                    // The first by number, whichever thread met its own first.
                    && failed.as_ref().is_none_or(|(before, _)| member < *before)
                {
                    *failed = Some((member, error));
                }
                let left = motor.running.allowance.take();
                if let (Some(most), Some(left), Ok(mut spent)) = (most, left, spent.lock()) {
                    // What has run out has spent more than there was.
                    *spent += if left > 0.0 { most - left } else { f64::INFINITY };
                }
            }
        };
        interrupt::shared(plan.threads.min(members), labour);
        let interrupted = interrupt::check();
        let too_much = too_much();
        if halted.load(Ordering::Relaxed) || interrupted.is_err() || too_much {
            if let Some(before) = before {
                self.members = before;
            }
            interrupted?;
            plan.check_finite()?;
        }
        if let (true, Some(most)) = (too_much, most) {
            return Err(self.spec.blame(work::too_much(most, work::PARTS)));
        }
        match failed.into_inner() {
            Ok(Some((member, error))) => Err(Error::Member { member, problem: error.to_string() }),
            _ => Ok(()),
        }
    }
}

/// What a thread takes on at a time.
enum Work<'a> {
    Alone(lanes::Motor<'a>),
    Team(Job<'a>, Vec<lanes::Motor<'a>>),
}

impl<'a> Work<'a> {
    /// All members: those that can in teams, with samples divided alike.
    fn of(
        motors: impl Iterator<Item = lanes::Motor<'a>>,
        plan: &'a Plan<'a>,
        kinds: &'a [Column],
        halted: &'a AtomicBool,
    ) -> Vec<Self> {
        let mut work = Vec::new();
        let mut teams: BTreeMap<u32, Vec<lanes::Motor<'a>>> = BTreeMap::new();
        for motor in motors {
            match Job::parts(motor.running, plan, kinds) {
                Some(parts) => teams.entry(parts).or_default().push(motor),
                None => work.push(Self::Alone(motor)),
            }
        }
        for (parts, motors) in teams {
            let size = Job::members(motors.len(), plan.threads);
            let mut motors = motors.into_iter();
            loop {
                // Into room of its own size: what is split off keeps the room of all that were left.
                let mut team = Vec::with_capacity(size.min(motors.len()));
                team.extend(motors.by_ref().take(size));
                match team.len() {
                    0 => break,
                    some if some < lanes::LEAST => work.extend(team.into_iter().map(Self::Alone)),
                    _ => work.push(Self::Team(Job::new(plan, kinds, parts, halted), team)),
                }
            }
        }
        work
    }
}

/// Runs one member on and keeps what is wanted of it.
fn simulate(
    running: &mut Running<f64>,
    member: usize,
    plan: &Plan<'_>,
    kinds: &[Column],
    own: &mut [&mut [f64]],
) -> Result<()> {
    let samples = plan.samples;
    let inputs = plan.inputs.of(member, samples);
    let around = Surroundings::from(plan.loads.of(member, samples));
    let target = if let Keep::Rms(target) = plan.keep { target } else { Rows::Same(0.0) };
    let target = target.of(member, samples);
    let mut kept = Kept::new(plan.keep, target, samples, kinds, own);
    running.simulate_rows(inputs, around, |_| 0.0, plan.dt, &mut kept)?;
    kept.end();
    Ok(())
}
