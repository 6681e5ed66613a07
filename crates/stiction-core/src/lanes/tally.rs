//! What is reduced on the way.

use super::block::{Row, WIDTH};
use super::record::{Record, SAMPLES};
use super::supply::spread;
use super::team::{Job, Team};
use crate::ensemble::Keep;
use crate::friction::FrictionLaw;
use crate::motor::Column;
use crate::scalar::Scalar;

/// Sums or extremes of each column, lane by lane.
pub struct Tally {
    blocks: usize,
    /// Of each block of each column: the sum of squares, or the least and the greatest.
    kept: Vec<[Row; 2]>,
    targets: Vec<Row>,
}

impl Tally {
    /// Nothing yet.
    pub fn new(job: &Job<'_>, blocks: usize) -> Self {
        let nothing = match job.plan.keep {
            Keep::Extremes => [Row([f64::INFINITY; WIDTH]), Row([f64::NEG_INFINITY; WIDTH])],
            Keep::Every(_) | Keep::Last | Keep::Rms(_) => [Row::ZERO; 2],
        };
        let targets = vec![Row::ZERO; SAMPLES * blocks];
        Self { blocks, kept: vec![nothing; job.kinds.len() * blocks], targets }
    }

    /// What was kept of a column of a member.
    pub fn of(&self, column: usize, member: usize) -> [f64; 2] {
        self.kept[column * self.blocks + member / WIDTH].map(|row| row.0[member % WIDTH])
    }

    /// Takes in what was recorded of some samples.
    pub fn add<S: Scalar, L: FrictionLaw<S>>(
        &mut self,
        team: &Team<'_, S, L>,
        record: &Record,
        first: usize,
        length: usize,
    ) {
        let (blocks, plan) = (self.blocks, team.job.plan);
        let squares = match plan.keep {
            Keep::Rms(target) => {
                let numbers = team.members.iter().map(|member| member.number);
                let part = (first, length, blocks);
                spread(&mut self.targets, target, plan.samples, numbers, part);
                true
            }
            Keep::Extremes => false,
            Keep::Every(_) | Keep::Last => return,
        };
        for (column, kind) in team.job.kinds.iter().enumerate() {
            let rows = record.of(*kind);
            for block in 0..blocks {
                let [mut first, mut second] = self.kept[column * blocks + block];
                for sample in 0..length {
                    let place = sample * blocks + block;
                    let mut seen = rows[place];
                    if *kind == Column::Measured {
                        for (lane, value) in seen.0.iter_mut().enumerate() {
                            let Some(member) = team.members.get(block * WIDTH + lane) else {
                                break;
                            };
                            *value = member.machine.measured(*value);
                        }
                    }
                    let target = self.targets[place];
                    for lane in 0..WIDTH {
                        let value = seen.0[lane];
                        if squares {
                            let beside = value - target.0[lane];
                            first.0[lane] += beside * beside;
                        } else {
                            first.0[lane] = first.0[lane].min(value);
                            second.0[lane] = second.0[lane].max(value);
                        }
                    }
                }
                self.kept[column * blocks + block] = [first, second];
            }
        }
    }
}
