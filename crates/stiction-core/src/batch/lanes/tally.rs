//! What is reduced on the way.

use stiction_dispatch::{Vector, Wide};

use super::record::{Record, SAMPLES};
use super::supply::{AsTheyAre, spread};
use super::team::{Job, Team};
use crate::batch::ensemble::{Keep, Rows};
use crate::friction::FrictionLaw;
use crate::math::row::{Row, WIDTH};
use crate::math::scalar::Scalar;
use crate::simulate::motor::Column;

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
        let targets = match job.plan.keep {
            Keep::Rms(Rows::Same(target)) => vec![Row([target; WIDTH])],
            _ => vec![Row::ZERO; SAMPLES * blocks],
        };
        Self { blocks, kept: vec![nothing; job.kinds.len() * blocks], targets }
    }

    /// What was kept of a column of a member.
    pub fn of(&self, column: usize, member: usize) -> [f64; 2] {
        self.kept[column * self.blocks + member / WIDTH].map(|row| row.0[member % WIDTH])
    }

    /// Takes in what was recorded of some samples of these members. Returns whether all targets of theirs
    /// are finite.
    pub fn add<S: Scalar, L: FrictionLaw<S>>(
        &mut self,
        team: &Team<'_, S, L>,
        record: &Record,
        members: &[usize],
        (first, length): (usize, usize),
    ) -> bool {
        if !matches!(team.job.plan.keep, Keep::Rms(_) | Keep::Extremes) {
            return true;
        }
        team.job.plan.width.run_wide(Add { tally: self, team, record, members, first, length })
    }
}

/// Taking in some samples, as a loop to run.
struct Add<'a, S: Scalar, L: FrictionLaw<S>> {
    tally: &'a mut Tally,
    team: &'a Team<'a, S, L>,
    record: &'a Record,
    members: &'a [usize],
    first: usize,
    length: usize,
}

impl<S: Scalar, L: FrictionLaw<S>> Wide for Add<'_, S, L> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Vector>(self) -> bool {
        let Self { tally, team, record, members, first, length } = self;
        let (blocks, plan) = (tally.blocks, team.job.plan);
        let squares = matches!(plan.keep, Keep::Rms(_));
        // The same for all is there since the start.
        if let Keep::Rms(target @ (Rows::Shared(_) | Rows::Each(_))) = plan.keep
            && !spread::<V, _>(
                &mut tally.targets,
                target,
                plan.samples,
                members,
                (first, length),
                &AsTheyAre,
            )
        {
            return false;
        }
        for (column, kind) in team.job.kinds.iter().enumerate() {
            if squares && *kind != Column::Measured {
                let kept = &mut tally.kept[column * blocks..][..blocks];
                let rows = &record.of(*kind)[..length * blocks];
                // Two blocks wait for their sums at the same time.
                match blocks {
                    2 => add_squares::<V, 2>(kept, rows, &tally.targets),
                    _ => add_squares::<V, 1>(kept, rows, &tally.targets),
                }
                continue;
            }
            for block in 0..blocks {
                let kept = &mut tally.kept[column * blocks + block];
                let targets = tally.targets.iter().skip(block % tally.targets.len());
                let targets = targets.step_by(blocks).cycle();
                let rows = record.of(*kind).iter().skip(block).step_by(blocks).take(length);
                if *kind == Column::Measured {
                    let members = team.members.iter().skip(block * WIDTH);
                    let read = rows.map(|row| {
                        let mut row = *row;
                        for (value, member) in row.0.iter_mut().zip(members.clone()) {
                            *value = member.machine.measured(*value);
                        }
                        row
                    });
                    *kept = taken_in(*kept, read.zip(targets), squares);
                } else {
                    *kept = taken_in(*kept, rows.copied().zip(targets), squares);
                }
            }
        }
        true
    }
}

/// Adds the squares of the distances of rows from targets, one for all or one for each, in so many
/// blocks.
#[inline(always)]
fn add_squares<V: Vector, const BLOCKS: usize>(
    kept: &mut [[Row; 2]],
    rows: &[Row],
    targets: &[Row],
) {
    let same = targets.len() == 1;
    for chunk in 0..V::CHUNKS {
        let mut sums = [V::all(0.0); BLOCKS];
        for (sum, [kept, _]) in sums.iter_mut().zip(&*kept) {
            *sum = kept.at(chunk);
        }
        for (k, rows) in rows.as_chunks::<BLOCKS>().0.iter().enumerate() {
            for (block, (sum, row)) in sums.iter_mut().zip(rows).enumerate() {
                let target = &targets[if same { 0 } else { k * BLOCKS + block }];
                let beside = row.at::<V>(chunk) - target.at::<V>(chunk);
                *sum = *sum + beside * beside;
            }
        }
        for (sum, [kept, _]) in sums.iter().zip(&mut *kept) {
            kept.put(chunk, *sum);
        }
    }
}

/// What is kept, with these values in it. Copies, so that they stay in registers.
#[inline(always)]
fn taken_in<'a>(
    [mut first, mut second]: [Row; 2],
    samples: impl Iterator<Item = (Row, &'a Row)>,
    squares: bool,
) -> [Row; 2] {
    if squares {
        for (seen, target) in samples {
            for lane in 0..WIDTH {
                let beside = seen.0[lane] - target.0[lane];
                first.0[lane] += beside * beside;
            }
        }
    } else {
        for (seen, _) in samples {
            for lane in 0..WIDTH {
                first.0[lane] = first.0[lane].min(seen.0[lane]);
                second.0[lane] = second.0[lane].max(seen.0[lane]);
            }
        }
    }
    [first, second]
}
