//! Takes a team of motors with one law through its samples.

use std::array::from_mut;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicBool, Ordering};

use stiction_dispatch::{Vector, Wide};

use super::record::{Record, SAMPLES};
use super::supply::{Ahead, Arrived, Supply, load_of};
use super::tally::Tally;
use crate::batch::ensemble::{Keep, Plan};
use crate::friction::elements::abreast::{Block, Bodies, Contacts, SideBySide};
use crate::friction::{Catalogued, FrictionLaw, LawState};
use crate::integrate::{Integrator, MOST_PARTS, Steps, step};
use crate::math::row::{Row, WIDTH, lanes};
use crate::math::scalar::Scalar;
use crate::plant::drive::Way;
use crate::plant::{Machine, Run};
use crate::simulate::model::CHUNK;
use crate::simulate::motor::{Column, Running};
use crate::support::interrupt;
use crate::support::samples::PerSample;

/// Members of a team at most: two blocks share the waiting, and more leave the nearest cache.
const MOST: usize = 2 * WIDTH;
// A stretch goes through one block or two.
const _: () = assert!(MOST == 2 * WIDTH);
/// Members of a team at least: fewer are done sooner one after the other.
pub const LEAST: usize = 3;

/// A motor of an ensemble.
#[derive(Debug)]
pub struct Motor<'a> {
    /// Its number.
    pub number: usize,
    /// The motor.
    pub running: &'a mut Running<f64>,
    /// Where its columns go.
    pub own: Vec<&'a mut [f64]>,
}

/// The same with its law known.
#[derive(Debug)]
pub struct Member<'a, S: Scalar, L: FrictionLaw<S>> {
    /// Its number in the ensemble.
    pub number: usize,
    /// Everything but friction.
    pub machine: &'a Machine<S>,
    /// Friction law.
    pub law: &'a L,
    /// Friction state.
    pub state: &'a mut L::State,
    /// Body.
    pub run: &'a mut Run<S>,
    /// What holds its input up.
    pub way: Option<&'a mut Way<S>>,
    /// Pieces of a step while its friction falls with speed.
    pub pieces: u32,
    /// Where its columns go.
    pub own: Vec<&'a mut [f64]>,
}

impl<S: Scalar, L: FrictionLaw<S>> Member<'_, S, L> {
    /// Room for what the next step may leave in the contact's memory.
    #[inline]
    fn make_room(&mut self, left: &mut usize) {
        if *left == 0 {
            *left = CHUNK;
            self.state.make_room(CHUNK + CHUNK / 4);
        }
        *left -= 1;
    }
}

/// Motors that go side by side, all with samples divided alike.
#[derive(Debug)]
pub struct Team<'a, S: Scalar, L: FrictionLaw<S>> {
    /// The motors.
    pub members: Vec<Member<'a, S, L>>,
    /// What they do.
    pub job: &'a Job<'a>,
    /// What has arrived of inputs that are held up or mapped.
    pub arrived: Arrived,
}

/// What a team does.
#[derive(Debug)]
pub struct Job<'a> {
    /// What is run and kept.
    pub plan: &'a Plan<'a>,
    /// Columns that are kept.
    pub kinds: &'a [Column],
    /// Duration of a sample.
    pub dt: f64,
    /// Steps of a sample.
    pub parts: u32,
    /// Whether a number was found that is not finite: then all is for nothing.
    pub halted: &'a AtomicBool,
}

impl<'a> Job<'a> {
    /// What a team of motors does that divide each sample into so many steps.
    pub fn new(
        plan: &'a Plan<'a>,
        kinds: &'a [Column],
        parts: u32,
        halted: &'a AtomicBool,
    ) -> Self {
        Self { plan, kinds, dt: plan.dt.at(0), parts, halted }
    }

    /// Into how many steps this motor divides each sample of a plan, where it can go through that
    /// abreast of others.
    pub fn parts(motor: &Running<f64>, plan: &Plan<'_>, kinds: &[Column]) -> Option<u32> {
        let PerSample::Same(dt) = plan.dt else { return None };
        // States of a law are in rows of its own: they are put back to be looked at.
        let seldom = matches!(plan.keep, Keep::Last);
        let shown = seldom || !kinds.iter().any(|kind| matches!(kind, Column::Law(_)));
        let plain = motor.integrator == Integrator::Fast && motor.machine.is_bare();
        if !shown || !plain || !motor.machine.glides(&motor.run) || !motor.law.goes_abreast() {
            return None;
        }
        let steps = motor.division(dt).steps;
        (steps <= MOST_PARTS).then_some(steps as u32)
    }

    /// Members of a team where so many motors are shared among so many threads.
    pub fn members(motors: usize, threads: usize) -> usize {
        motors.div_ceil(threads.max(1)).next_multiple_of(WIDTH).clamp(WIDTH, MOST)
    }

    /// Duration of a step.
    fn span(&self) -> f64 {
        self.dt / f64::from(self.parts)
    }
}

/// The steps of some samples.
struct Stretch<'a, 'b, S: Scalar, L: FrictionLaw<S>, C> {
    team: &'a mut Team<'b, S, L>,
    blocks: &'a mut [Block<C>],
    /// Steps that each contact has room for.
    room: &'a mut [usize],
    /// Efforts of each block in each sample of this stretch.
    efforts: &'a [Row],
    ahead: Ahead<'a>,
    record: &'a mut Record,
    /// The first sample.
    first: usize,
}

impl<S: Scalar, L: FrictionLaw<S>, C: Contacts<S, L>> Wide for Stretch<'_, '_, S, L, C> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vector>(mut self) {
        let blocks = std::mem::take(&mut self.blocks);
        if let Ok(pair) = blocks.try_into() {
            self.go::<V, 2>(pair);
        } else if let [block] = blocks {
            self.go::<V, 1>(from_mut(block));
        }
    }
}

impl<S: Scalar, L: FrictionLaw<S>, C: Contacts<S, L>> Stretch<'_, '_, S, L, C> {
    /// All samples of these blocks. What it needs of others is at hand before the first of them: what
    /// is looked for step by step takes the place of vectors that wait.
    #[inline(always)]
    fn go<V: Vector, const N: usize>(self, blocks: &mut [Block<C>; N]) {
        let Self { team, room, efforts, ahead, record, first, .. } = self;
        let samples = efforts.as_chunks::<N>().0;
        let (lines, mut rows) = (ahead.lines::<N>(), record.rows::<N>());
        let parts = team.job.parts;
        let (mut sample, mut left) = (0, 0);
        // No loop in a loop: the compiler fetches numbers ahead of the inner one, each sample anew.
        loop {
            if left == 0 {
                let Some(efforts) = samples.get(sample) else { return };
                lines.fetch(sample);
                for (block, effort) in blocks.iter_mut().zip(efforts) {
                    block.bodies.effort = *effort;
                }
                left = parts;
            }
            let rests = C::step::<V, N>(blocks);
            for block in &mut *blocks {
                block.bodies.taken += 1;
            }
            if let Some(rests) = rests {
                for (k, (block, rest)) in blocks.iter_mut().zip(rests).enumerate() {
                    if rest.changed != 0 {
                        team.note(k, rest.changed, block, room);
                    }
                    if rest.missed != 0 {
                        team.make_up(k, rest.missed, first + sample, block, room);
                    }
                }
            }
            left -= 1;
            if left == 0 {
                rows.take::<S, L, C>(sample, blocks);
                sample += 1;
            }
        }
    }
}

/// Takes motors with contacts of one kind that go abreast through their samples.
pub fn take_abreast(job: &Job<'_>, motors: Vec<Motor<'_>>) {
    let Some(first) = motors.first() else { return };
    with_law!(&first.running.law, |law| {
        let kind = kind_of(law);
        take(kind, job, motors);
    });
}

/// The law of a contact, without the contact.
fn kind_of<L>(_: &L) -> PhantomData<L> {
    PhantomData
}

/// The same for motors whose law is known.
fn take<L: Catalogued<f64>>(_: PhantomData<L>, job: &Job<'_>, motors: Vec<Motor<'_>>) {
    let members = motors.into_iter().map(|Motor { number, running, own }| {
        let pieces = running.division(job.dt).pieces;
        let Running { machine, law, state, run, way, .. } = running;
        let (law, state) = L::among(law, state).expect("motors of an ensemble have one law");
        Member { number, machine, law, state, run, way: way.as_mut(), pieces, own }
    });
    let mut team = Team { members: members.collect(), job, arrived: Arrived::default() };
    let Some(law) = team.members.first().map(|member| member.law) else { return };
    law.abreast(&mut team);
}

impl<S: Scalar, L: FrictionLaw<S>> SideBySide<S, L> for &mut Team<'_, S, L> {
    type Output = ();

    #[inline(never)]
    fn with<C: Contacts<S, L>>(self) {
        self.walk::<C>();
    }
}

impl<S: Scalar, L: FrictionLaw<S>> Team<'_, S, L> {
    /// Runs all samples with these contacts.
    pub fn walk<C: Contacts<S, L>>(&mut self) {
        let mut blocks = self.blocks::<C>();
        let count = blocks.len();
        let plan = self.job.plan;
        let samples = plan.samples;
        let mut record = Record::new(self.kept(), count);
        let mut supply = Supply::new(&self.members, samples);
        let mut tally = Tally::new(self.job, count);
        let mut room = vec![0_usize; self.members.len()];
        let mut first = 0;
        while first < samples {
            let length = SAMPLES.min(samples - first);
            let finite = if supply.is_direct() {
                supply.fill(plan, first, length)
            } else {
                supply.fill_changed(self, first, length)
            };
            if !finite || self.job.halted.load(Ordering::Relaxed) || interrupt::due() {
                self.job.halted.store(true, Ordering::Relaxed);
                return;
            }
            plan.width.run_wide(Stretch {
                team: self,
                blocks: &mut blocks,
                room: &mut room,
                efforts: &supply.efforts()[..length * count],
                ahead: supply.ahead(plan, first + length),
                record: &mut record,
                first,
            });
            self.show(&record, first, length, count);
            if !tally.add(self, &record, supply.members(), (first, length)) {
                self.job.halted.store(true, Ordering::Relaxed);
                return;
            }
            first += length;
        }
        for block in &mut blocks {
            block.contacts.settle(&mut block.bodies);
        }
        for (k, member) in self.members.iter_mut().enumerate() {
            let block = &blocks[k / WIDTH];
            block.bodies.store(k % WIDTH, block.bodies.taken, member.run);
            block.contacts.store(k % WIDTH, member.state);
        }
        self.end(&tally);
    }

    /// Notes what the last step of a block has changed in contacts of these lanes.
    #[inline(never)]
    fn note<C: Contacts<S, L>>(
        &mut self,
        k: usize,
        changed: u8,
        block: &mut Block<C>,
        room: &mut [usize],
    ) {
        for lane in lanes(changed) {
            let Some(member) = self.members.get_mut(k * WIDTH + lane) else { return };
            member.make_room(&mut room[k * WIDTH + lane]);
            block.contacts.note(lane, member.law, member.state);
        }
    }

    /// Takes the last step of a block for those that missed it.
    #[inline(never)]
    fn make_up<C: Contacts<S, L>>(
        &mut self,
        k: usize,
        missed: u8,
        sample: usize,
        block: &mut Block<C>,
        room: &mut [usize],
    ) {
        block.contacts.settle(&mut block.bodies);
        for lane in lanes(missed) {
            self.step_alone(k * WIDTH + lane, sample, block, room);
        }
    }

    /// All motors in blocks; lanes that are left over do what the first motor does, unseen.
    fn blocks<C: Contacts<S, L>>(&mut self) -> Vec<Block<C>> {
        let count = self.members.len().div_ceil(WIDTH);
        let mut blocks = vec![Block { bodies: Bodies::still(), contacts: C::default() }; count];
        for (k, member) in self.members.iter_mut().enumerate() {
            let Block { bodies, contacts } = &mut blocks[k / WIDTH];
            let lane = k % WIDTH;
            bodies.fit(lane, &member.machine.verlet(S::constant(self.job.span())));
            bodies.load(lane, member.run);
            bodies.in_pieces |= u8::from(member.pieces > 1) << lane;
            contacts.fit(lane, member.law, bodies);
            contacts.load(lane, member.law, member.state);
        }
        blocks
    }

    /// One step of one motor with all that may happen in it.
    fn step_alone<C: Contacts<S, L>>(
        &mut self,
        k: usize,
        sample: usize,
        block: &mut Block<C>,
        room: &mut [usize],
    ) {
        let Some(member) = self.members.get_mut(k) else { return };
        let lane = k % WIDTH;
        // The row is through with the step already.
        block.bodies.store(lane, block.bodies.taken - 1, member.run);
        block.contacts.store(lane, member.state);
        member.make_room(&mut room[k]);
        let (input, load) = applied(self.job.plan, member.number, sample);
        let input = self.arrived.of(k, sample).unwrap_or(input);
        let (input, load) = (S::constant(input), S::constant(load));
        let steps = Steps::of(self.job.dt, self.job.parts, member.pieces);
        let Member { machine, law, state, run, .. } = member;
        step::<_, _, true>(machine, *law, state, run, input, load, steps);
        block.bodies.load(lane, member.run);
        block.contacts.load(lane, member.law, member.state);
    }

    /// Columns that are kept of every sample.
    fn kept(&self) -> &[Column] {
        if matches!(self.job.plan.keep, Keep::Last) { &[] } else { self.job.kinds }
    }

    /// Takes over rows of what was recorded of some samples.
    fn show(&mut self, record: &Record, first: usize, length: usize, blocks: usize) {
        let Keep::Every(every) = self.job.plan.keep else { return };
        for (k, member) in self.members.iter_mut().enumerate() {
            for (kind, own) in self.job.kinds.iter().zip(&mut member.own) {
                let rows = record.of(*kind);
                let mut row = first / every;
                while (row + 1) * every <= first + length {
                    let place = ((row + 1) * every - 1 - first) * blocks + k / WIDTH;
                    let value = rows[place].0[k % WIDTH];
                    let measured = *kind == Column::Measured;
                    own[row] = if measured { member.machine.measured(value) } else { value };
                    row += 1;
                }
            }
        }
    }

    /// Writes down what is left of the whole run.
    fn end(&mut self, tally: &Tally) {
        let samples = self.job.plan.samples;
        for (k, member) in self.members.iter_mut().enumerate() {
            let (run, machine, state) = (&*member.run, member.machine, &*member.state);
            for (column, (kind, own)) in self.job.kinds.iter().zip(&mut member.own).enumerate() {
                match self.job.plan.keep {
                    Keep::Last if samples > 0 => {
                        own[0] = match *kind {
                            Column::Position => run.position.re(),
                            Column::Velocity => run.velocity.re(),
                            Column::Friction => run.friction.re(),
                            Column::Measured => machine.measured(run.position.re()),
                            Column::Law(index) => state.output(index).re(),
                        };
                    }
                    Keep::Rms(_) => own[0] = (tally.of(column, k)[0] / samples as f64).sqrt(),
                    Keep::Extremes => own.copy_from_slice(&tally.of(column, k)),
                    Keep::Last | Keep::Every(_) => (),
                }
            }
        }
    }
}

/// Input and load of a motor in a sample.
fn applied(plan: &Plan<'_>, member: usize, sample: usize) -> (f64, f64) {
    let loads = plan.loads.of(member, plan.samples);
    (plan.inputs.of(member, plan.samples)[sample], load_of(loads, sample))
}
