//! Efforts of a team, a few samples ahead.

use std::array::from_fn;

use stiction_dispatch::{Task, fetch};

use super::block::{Row, WIDTH};
use super::record::SAMPLES;
use super::team::Member;
use crate::ensemble::{Inputs, Plan, Rows};
use crate::friction::FrictionLaw;
use crate::motor::{PerSample, Surroundings};
use crate::scalar::Scalar;

/// The drives of a team and what they are about to do.
pub struct Supply {
    members: Vec<usize>,
    gains: Vec<Row>,
    limits: Vec<Row>,
    weights: Vec<Row>,
    efforts: Vec<Row>,
    loads: Vec<Row>,
}

impl Supply {
    /// The drives of these motors.
    pub fn new<S: Scalar, L: FrictionLaw<S>>(members: &[Member<'_, S, L>]) -> Self {
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
        let members = members.iter().map(|member| member.number).collect();
        Self { members, gains, limits, weights, efforts: many.clone(), loads: many }
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
        Ahead { values, members: &self.members, samples: plan.samples, next }
    }

    /// Works out the efforts of some samples.
    pub fn fill(&mut self, plan: &Plan<'_>, first: usize, length: usize) {
        plan.width.run(Fill { supply: self, plan, first, length });
    }
}

/// What members are about to do after these samples, to be asked for while they go through them.
/// Each has its own place in memory, too short a way for the processor to see, and all places at once
/// are more than it fetches at a time.
#[derive(Clone, Copy)]
pub struct Ahead<'a> {
    values: &'a [f64],
    members: &'a [usize],
    samples: usize,
    next: usize,
}

impl Ahead<'_> {
    /// Asks for the share of this sample: the lines of all members in as many samples as are given.
    #[inline(always)]
    pub fn fetch(&self, sample: usize) {
        let (lane, tile) = (sample % WIDTH, sample / WIDTH);
        for member in self.members.iter().skip(lane).step_by(WIDTH) {
            let place = member * self.samples + self.next + tile * TILE;
            if let Some(value) = self.values.get(place) {
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
}

impl Task for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { supply, plan, first, length } = self;
        let Supply { members, gains, limits, weights, efforts, loads } = supply;
        let inputs = match plan.inputs {
            Inputs::Shared(values) => Rows::Shared(values),
            Inputs::Each(values) => Rows::Each(values),
        };
        spread(efforts, inputs, plan.samples, members, (first, length));
        let drives = || gains.iter().zip(&*limits).zip(&*weights);
        let samples = efforts.chunks_exact_mut(gains.len()).take(length);
        if let Rows::Same(load) = plan.loads {
            for efforts in samples {
                for (effort, ((gain, limit), weight)) in efforts.iter_mut().zip(drives()) {
                    *effort = driven(*effort, Row([load; WIDTH]), (*gain, *limit, *weight));
                }
            }
            return;
        }
        spread(loads, plan.loads, plan.samples, members, (first, length));
        for (efforts, loads) in samples.zip(loads.chunks_exact(gains.len())) {
            for ((effort, load), ((gain, limit), weight)) in
                efforts.iter_mut().zip(loads).zip(drives())
            {
                *effort = driven(*effort, *load, (*gain, *limit, *weight));
            }
        }
    }
}

/// Efforts of some lanes. Copies, so that nobody has to ask whether they overlap.
#[inline(always)]
fn driven(input: Row, load: Row, (gain, limit, weight): (Row, Row, Row)) -> Row {
    let mut effort = Row::ZERO;
    for lane in 0..WIDTH {
        let (input, limit) = (input.0[lane], limit.0[lane]);
        let low = if input < -limit { -limit } else { input };
        let within = if input > limit { limit } else { low };
        effort.0[lane] = gain.0[lane] * within + (0.0 + load.0[lane]) + weight.0[lane];
    }
    effort
}

/// Samples that are put across lanes at a time: as many as are side by side in the caches.
const TILE: usize = 8;
// A line of each member is asked for in each stretch of samples.
const _: () = assert!(SAMPLES == WIDTH * TILE);

/// Numbers of some samples, lane by lane.
#[inline(always)]
pub fn spread(
    rows: &mut [Row],
    numbers: Rows<'_>,
    samples: usize,
    members: &[usize],
    (first, length): (usize, usize),
) {
    let blocks = members.len().div_ceil(WIDTH);
    match numbers {
        Rows::Same(value) => rows[..length * blocks].fill(Row([value; WIDTH])),
        Rows::Shared(values) => {
            let given = &values[first..first + length];
            for (rows, value) in rows.chunks_exact_mut(blocks).zip(given) {
                rows.fill(Row([*value; WIDTH]));
            }
        }
        Rows::Each(values) => {
            for (block, members) in members.chunks(WIDTH).enumerate() {
                // Lanes that are left over see what the first one sees.
                let given: [_; WIDTH] = from_fn(|lane| {
                    let member = members.get(lane).unwrap_or(&members[0]);
                    values[member * samples + first..][..length].as_chunks::<TILE>()
                });
                for tile in 0..length / TILE {
                    let tiles: [&[f64; TILE]; WIDTH] = given.map(|(tiles, _)| &tiles[tile]);
                    for k in 0..TILE {
                        let row = Row(tiles.map(|values| values[k]));
                        rows[(tile * TILE + k) * blocks + block] = row;
                    }
                }
                for k in 0..length % TILE {
                    let row = Row(given.map(|(_, rest)| rest[k]));
                    rows[(length - length % TILE + k) * blocks + block] = row;
                }
            }
        }
    }
}

/// Load of a sample, added up as a run of one motor adds it.
pub fn load_of(loads: PerSample<'_>, sample: usize) -> f64 {
    0.0 + Surroundings::from(loads).load.at(sample)
}
