//! Efforts of a team, a few samples ahead.

use stiction_dispatch::{CHUNKS, Mask, ROW, Vector, Wide, fetch};

use super::record::SAMPLES;
use super::team::{Member, Team};
use crate::batch::ensemble::{Inputs, Plan, Rows};
use crate::friction::FrictionLaw;
use crate::math::row::{Row, WIDTH};
use crate::math::scalar::Scalar;
use crate::support::samples::{PerSample, Surroundings};

/// The drives of a team and what they are about to do.
pub struct Supply {
    members: Vec<usize>,
    /// Where the inputs of each member begin, block by block; again those of the first one for lanes
    /// that are left over.
    starts: Vec<[usize; WIDTH]>,
    gains: Vec<Row>,
    limits: Vec<Row>,
    weights: Vec<Row>,
    efforts: Vec<Row>,
    loads: Vec<Row>,
    /// Whether efforts are gains times inputs, within a limit.
    direct: bool,
}

/// What arrives of inputs that are held up or mapped, in some samples.
#[derive(Debug, Default)]
pub struct Arrived {
    /// The first of them.
    first: usize,
    blocks: usize,
    /// Block by block in each sample; none where inputs are what arrives.
    rows: Vec<Row>,
}

impl Arrived {
    /// What arrives at a member of the team in a sample, where that is not the input itself.
    pub fn of(&self, member: usize, sample: usize) -> Option<f64> {
        let row = self.rows.get((sample - self.first) * self.blocks + member / WIDTH)?;
        Some(row.0[member % WIDTH])
    }
}

impl Supply {
    /// The drives of these motors.
    pub fn new<S: Scalar, L: FrictionLaw<S>>(members: &[Member<'_, S, L>], samples: usize) -> Self {
        let blocks = members.len().div_ceil(WIDTH);
        let zero = vec![Row::ZERO; blocks];
        let many = vec![Row::ZERO; blocks * SAMPLES];
        let (mut gains, mut limits, mut weights) = (zero.clone(), zero.clone(), zero);
        for (k, member) in members.iter().enumerate() {
            let [gain, limit, weight] = member.machine.bare_numbers();
            gains[k / WIDTH].0[k % WIDTH] = gain;
            limits[k / WIDTH].0[k % WIDTH] = limit;
            weights[k / WIDTH].0[k % WIDTH] = weight;
        }
        let direct = members.iter().all(|m| m.way.is_none() && !m.machine.effects.maps_inputs());
        let members: Vec<usize> = members.iter().map(|member| member.number).collect();
        let starts = members.chunks(WIDTH).map(|members| {
            let start = |lane: usize| members.get(lane).unwrap_or(&members[0]) * samples;
            std::array::from_fn(start)
        });
        let starts = starts.collect();
        Self { members, starts, gains, limits, weights, efforts: many.clone(), loads: many, direct }
    }

    /// Whether nothing holds inputs up or maps them.
    pub fn is_direct(&self) -> bool {
        self.direct
    }

    /// Efforts of each block in each sample.
    pub fn efforts(&self) -> &[Row] {
        &self.efforts
    }

    /// Numbers of the members.
    pub fn members(&self) -> &[usize] {
        &self.members
    }

    /// What is to be asked for in the samples before this one.
    pub fn ahead<'a>(&'a self, plan: &Plan<'a>, next: usize) -> Ahead<'a> {
        let values = match plan.inputs {
            Inputs::Each(values) => values,
            Inputs::Shared(_) => &[],
        };
        Ahead { values, starts: &self.starts, next }
    }

    /// Works out the efforts of some samples, where all that they are made of is finite. Returns whether
    /// it is.
    pub fn fill(&mut self, plan: &Plan<'_>, first: usize, length: usize) -> bool {
        plan.width.run_wide(Fill { supply: self, plan, first, length, raw: None })
    }

    /// The same where some of a team have inputs that are held up or mapped: member by member.
    pub fn fill_changed<S: Scalar, L: FrictionLaw<S>>(
        &mut self,
        team: &mut Team<'_, S, L>,
        first: usize,
        length: usize,
    ) -> bool {
        let (plan, dt) = (team.job.plan, team.job.dt);
        let blocks = team.members.len().div_ceil(WIDTH);
        let Arrived { rows, .. } = &mut team.arrived;
        rows.resize(blocks * SAMPLES, Row::ZERO);
        let fill = Fill { supply: self, plan, first, length, raw: Some(&mut *rows) };
        if !plan.width.run_wide(fill) {
            return false;
        }
        let mut inputs = [0.0; SAMPLES];
        let lanes = blocks * WIDTH;
        for k in 0..lanes {
            let (block, lane) = (k / WIDTH, k % WIDTH);
            let Some(member) = team.members.get_mut(k) else {
                // Lanes that are left over see what the first one of their block sees.
                for row in self.efforts[..length * blocks].iter_mut().skip(block).step_by(blocks) {
                    row.0[lane] = row.0[0];
                }
                continue;
            };
            for (sample, place) in inputs[..length].iter_mut().enumerate() {
                let input = &mut rows[sample * blocks + block].0[lane];
                if let Some(way) = &mut member.way {
                    *input = way.pass(*input, None, dt).re();
                }
                *place = *input;
            }
            member.machine.effects.map_inputs(&mut inputs[..length]);
            for (sample, input) in inputs[..length].iter().enumerate() {
                let row = sample * blocks + block;
                let load = match plan.loads {
                    Rows::Same(load) => load,
                    _ => self.loads[row].0[lane],
                };
                let load = S::constant(0.0 + load);
                self.efforts[row].0[lane] = member.machine.bare_effort(*input, load).re();
            }
        }
        (team.arrived.first, team.arrived.blocks) = (first, blocks);
        true
    }
}

/// What members are about to do after these samples, to be asked for while they go through them.
/// Each has its own place in memory, too short a way for the processor to see, and all places at once
/// are more than it fetches at a time.
#[derive(Clone, Copy)]
pub struct Ahead<'a> {
    values: &'a [f64],
    starts: &'a [[usize; WIDTH]],
    next: usize,
}

impl<'a> Ahead<'a> {
    /// The same, for so many blocks.
    #[inline(always)]
    pub fn lines<const N: usize>(&self) -> Lines<'a, N> {
        let starts = self.starts.first_chunk().unwrap_or(&[[0; WIDTH]; N]);
        Lines { values: self.values.get(self.next..).unwrap_or_default(), starts }
    }
}

/// Where so many blocks go on, line by line of the caches.
#[derive(Clone, Copy)]
pub struct Lines<'a, const N: usize> {
    values: &'a [f64],
    starts: &'a [[usize; WIDTH]; N],
}

impl<const N: usize> Lines<'_, N> {
    /// Asks for the share of this sample: the lines of all members in as many samples as are given.
    #[inline(always)]
    pub fn fetch(&self, sample: usize) {
        let (lane, tile) = (sample % WIDTH, sample / WIDTH);
        for starts in self.starts {
            if let Some(value) = self.values.get(starts[lane] + tile * TILE) {
                fetch(value);
            }
        }
    }
}

/// Efforts of some samples, as a loop to run.
struct Fill<'a> {
    supply: &'a mut Supply,
    plan: &'a Plan<'a>,
    first: usize,
    length: usize,
    /// Where inputs go as they are, where no effort is made of them.
    raw: Option<&'a mut [Row]>,
}

impl Wide for Fill<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Vector>(self) -> bool {
        let Self { supply, plan, first, length, raw } = self;
        let Supply { members, gains, limits, weights, efforts, loads, .. } = supply;
        let stretch = (first, length);
        let load = if let Rows::Same(load) = plan.loads { Some(load) } else { None };
        if load.is_none()
            && !spread::<V, _>(loads, plan.loads, plan.samples, members, stretch, &AsTheyAre)
        {
            return false;
        }
        if let Some(raw) = raw {
            let inputs = plan.inputs.rows();
            return spread::<V, _>(raw, inputs, plan.samples, members, stretch, &AsTheyAre);
        }
        let drives = Drives { gains, limits, weights, load, loads };
        spread::<V, _>(efforts, plan.inputs.rows(), plan.samples, members, stretch, &drives)
    }
}

/// What is made of numbers that come in a row.
pub trait Through {
    /// What this takes for some lanes of a block.
    type Own<V: Vector>: Copy;
    /// The same.
    fn own<V: Vector>(&self, block: usize, chunk: usize) -> Self::Own<V>;
    /// What is made of the numbers of these lanes in a row.
    fn pass<V: Vector>(&self, numbers: V, own: Self::Own<V>, row: usize, chunk: usize) -> V;
}

/// Nothing.
pub struct AsTheyAre;

impl Through for AsTheyAre {
    type Own<V: Vector> = ();

    #[inline(always)]
    fn own<V: Vector>(&self, _block: usize, _chunk: usize) {}

    #[inline(always)]
    fn pass<V: Vector>(&self, numbers: V, (): (), _row: usize, _chunk: usize) -> V {
        numbers
    }
}

/// Efforts, of inputs.
struct Drives<'a> {
    gains: &'a [Row],
    limits: &'a [Row],
    weights: &'a [Row],
    /// The load, where it is the same for all.
    load: Option<f64>,
    loads: &'a [Row],
}

impl Through for Drives<'_> {
    type Own<V: Vector> = [V; 3];

    #[inline(always)]
    fn own<V: Vector>(&self, block: usize, chunk: usize) -> [V; 3] {
        [self.gains[block].at(chunk), self.limits[block].at(chunk), self.weights[block].at(chunk)]
    }

    #[inline(always)]
    fn pass<V: Vector>(
        &self,
        input: V,
        [gain, limit, weight]: [V; 3],
        row: usize,
        chunk: usize,
    ) -> V {
        let load = match self.load {
            Some(load) => V::all(load),
            None => self.loads[row].at::<V>(chunk),
        };
        gain * input.at_least(limit.minus()).at_most(limit) + (V::all(0.0) + load) + weight
    }
}

/// Samples that are put across lanes at a time: as many as are side by side in the caches.
const TILE: usize = ROW;
// A line of each member is asked for in each stretch of samples.
const _: () = assert!(SAMPLES == WIDTH * TILE);

/// 0 where a number is finite, elsewhere none.
#[inline(always)]
#[allow(clippy::eq_op)] // which tells it
fn nought<V: Vector>(number: V) -> V {
    number - number
}

/// What is made of the numbers of some samples, lane by lane. Returns whether all of them are finite.
#[inline(always)]
pub fn spread<V: Vector, T: Through>(
    rows: &mut [Row],
    numbers: Rows<'_>,
    samples: usize,
    members: &[usize],
    (first, length): (usize, usize),
    through: &T,
) -> bool {
    let blocks = members.len().div_ceil(WIDTH);
    let mut nothing = V::all(0.0);
    match numbers {
        Rows::Same(_) | Rows::Shared(_) => {
            let same = Rows::of(&numbers, 0, samples);
            for (k, row) in rows.iter_mut().enumerate().take(length * blocks) {
                let number = V::all(same.at(first + k / blocks));
                nothing = nothing + nought(number);
                for chunk in 0..V::CHUNKS {
                    let own = through.own::<V>(k % blocks, chunk);
                    row.put(chunk, through.pass(number, own, k, chunk));
                }
            }
        }
        Rows::Each(values) => {
            for (block, members) in members.chunks(WIDTH).enumerate() {
                let mut own = [through.own::<V>(block, 0); CHUNKS];
                for (chunk, own) in own.iter_mut().enumerate().take(V::CHUNKS) {
                    *own = through.own(block, chunk);
                }
                let mut given: [&[f64]; WIDTH] = [&[]; WIDTH];
                for (lane, given) in given.iter_mut().enumerate() {
                    // Lanes that are left over see what the first one sees.
                    let member = members.get(lane).unwrap_or(&members[0]);
                    *given = &values[member * samples + first..][..length];
                }
                for tile in 0..length.div_ceil(TILE) {
                    let mut last = [[0.0; TILE]; WIDTH];
                    let mut tiles = [&[0.0; TILE]; WIDTH];
                    for ((tiles, last), given) in tiles.iter_mut().zip(&mut last).zip(given) {
                        *tiles = match given[tile * TILE..].first_chunk() {
                            Some(numbers) => numbers,
                            None => {
                                let rest = &given[tile * TILE..];
                                last[..rest.len()].copy_from_slice(rest);
                                last
                            }
                        };
                    }
                    let across = V::across(tiles);
                    for (place, across) in across.iter().enumerate() {
                        let k = (tile * TILE + place) * blocks + block;
                        let Some(row) = rows.get_mut(k) else { break };
                        for chunk in 0..V::CHUNKS {
                            let numbers = across[chunk];
                            nothing = nothing + nought(numbers);
                            row.put(chunk, through.pass(numbers, own[chunk], k, chunk));
                        }
                    }
                }
            }
        }
    }
    nothing.within(V::all(0.0)).bits().count_ones() as usize == V::LANES
}

/// Load of a sample, added up as a run of one motor adds it.
pub fn load_of(loads: PerSample<'_>, sample: usize) -> f64 {
    0.0 + Surroundings::from(loads).load.at(sample)
}
