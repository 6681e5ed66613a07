//! Efforts of a team, a few samples ahead.

use super::block::{Row, WIDTH};
use super::record::SAMPLES;
use super::team::Member;
use crate::ensemble::{Inputs, Plan, Rows};
use crate::friction::FrictionLaw;
use crate::motor::{PerSample, Surroundings};
use crate::scalar::Scalar;

/// The drives of a team and what they are about to do.
pub struct Supply {
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
        Self { gains, limits, weights, efforts: many.clone(), loads: many }
    }

    /// Efforts of each block in each sample.
    pub fn efforts(&self) -> &[Row] {
        &self.efforts
    }

    /// Works out the efforts of some samples.
    pub fn fill(
        &mut self,
        plan: &Plan<'_>,
        members: impl Iterator<Item = usize> + Clone,
        first: usize,
        length: usize,
    ) {
        let blocks = self.gains.len();
        let inputs = match plan.inputs {
            Inputs::Shared(values) => Rows::Shared(values),
            Inputs::Each(values) => Rows::Each(values),
        };
        spread(&mut self.efforts, inputs, plan.samples, members.clone(), (first, length, blocks));
        spread(&mut self.loads, plan.loads, plan.samples, members, (first, length, blocks));
        for sample in 0..length {
            for block in 0..blocks {
                let place = sample * blocks + block;
                let (input, load) = (self.efforts[place], self.loads[place]);
                let (gain, limit, weight) =
                    (self.gains[block], self.limits[block], self.weights[block]);
                let mut effort = Row::ZERO;
                for lane in 0..WIDTH {
                    let (input, limit) = (input.0[lane], limit.0[lane]);
                    let low = if input < -limit { -limit } else { input };
                    let within = if input > limit { limit } else { low };
                    effort.0[lane] = gain.0[lane] * within + (0.0 + load.0[lane]) + weight.0[lane];
                }
                self.efforts[place] = effort;
            }
        }
    }
}

/// Numbers of some samples, lane by lane.
pub fn spread(
    rows: &mut [Row],
    numbers: Rows<'_>,
    samples: usize,
    members: impl Iterator<Item = usize>,
    (first, length, blocks): (usize, usize, usize),
) {
    match numbers {
        Rows::Same(value) => rows[..length * blocks].fill(Row([value; WIDTH])),
        Rows::Shared(values) => {
            let given = &values[first..first + length];
            for (rows, value) in rows.chunks_exact_mut(blocks).zip(given) {
                rows.fill(Row([*value; WIDTH]));
            }
        }
        Rows::Each(values) => {
            for (k, member) in members.enumerate() {
                let begin = member * samples + first;
                let given = &values[begin..begin + length];
                for (rows, value) in rows.chunks_exact_mut(blocks).zip(given) {
                    rows[k / WIDTH].0[k % WIDTH] = *value;
                }
            }
        }
    }
}

/// Load of a sample, added up as a run of one motor adds it.
pub fn load_of(loads: PerSample<'_>, sample: usize) -> f64 {
    0.0 + Surroundings::from(loads).load.at(sample)
}
