//! What is kept of a team's motion.

use super::block::{Block, Contacts, Row};
use crate::friction::FrictionLaw;
use crate::motor::Column;
use crate::scalar::Scalar;

/// Samples between two looks at what was recorded.
pub const SAMPLES: usize = 64;

/// Columns of the last few samples, lane by lane.
#[derive(Debug)]
pub struct Record {
    position: Option<Vec<Row>>,
    velocity: Option<Vec<Row>>,
    friction: Option<Vec<Row>>,
}

impl Record {
    /// Room for what these columns are made of, in so many blocks.
    pub fn new(kinds: &[Column], blocks: usize) -> Self {
        let room = |wanted: &[Column]| {
            let needed = kinds.iter().any(|kind| wanted.contains(kind));
            needed.then(|| vec![Row::ZERO; SAMPLES * blocks])
        };
        Self {
            position: room(&[Column::Position, Column::Measured]),
            velocity: room(&[Column::Velocity]),
            friction: room(&[Column::Friction]),
        }
    }

    /// Records blocks in a sample.
    #[inline(always)]
    pub fn take<S: Scalar, L: FrictionLaw<S>, C: Contacts<S, L>, const N: usize>(
        &mut self,
        sample: usize,
        blocks: &mut [Block<C>; N],
    ) {
        record(&mut self.position, sample, || blocks.each_ref().map(|block| block.bodies.position));
        record(&mut self.velocity, sample, || blocks.each_ref().map(|block| block.bodies.velocity));
        record(&mut self.friction, sample, || {
            blocks.each_mut().map(|Block { bodies, contacts }| {
                contacts.settle(bodies);
                bodies.friction
            })
        });
    }

    /// What was recorded for a column: positions for what is measured.
    pub fn of(&self, kind: Column) -> &[Row] {
        let rows = match kind {
            Column::Position | Column::Measured => &self.position,
            Column::Velocity => &self.velocity,
            Column::Friction => &self.friction,
            Column::Law(_) => &None,
        };
        rows.as_deref().unwrap_or_default()
    }
}

/// Records the rows of a sample where they are wanted.
#[inline(always)]
fn record<const N: usize>(
    rows: &mut Option<Vec<Row>>,
    sample: usize,
    shown: impl FnOnce() -> [Row; N],
) {
    if let Some(rows) = rows.as_mut().and_then(|rows| rows.as_chunks_mut().0.get_mut(sample)) {
        *rows = shown();
    }
}
