//! What is kept of a team's motion.

use crate::friction::FrictionLaw;
use crate::friction::elements::abreast::{Block, Contacts};
use crate::math::row::Row;
use crate::math::scalar::Scalar;
use crate::simulate::motor::Column;

/// Samples between two looks at what was recorded.
pub const SAMPLES: usize = 64;

/// Columns of the last few samples, lane by lane; nothing of those that nobody wants.
#[derive(Debug)]
pub struct Record {
    position: Vec<Row>,
    velocity: Vec<Row>,
    friction: Vec<Row>,
}

impl Record {
    /// Room for what these columns are made of, in so many blocks.
    pub fn new(kinds: &[Column], blocks: usize) -> Self {
        let room = |wanted: &[Column]| {
            let needed = kinds.iter().any(|kind| wanted.contains(kind));
            if needed { vec![Row::ZERO; SAMPLES * blocks] } else { Vec::new() }
        };
        Self {
            position: room(&[Column::Position, Column::Measured]),
            velocity: room(&[Column::Velocity]),
            friction: room(&[Column::Friction]),
        }
    }

    /// Its rows, for so many blocks.
    pub fn rows<const N: usize>(&mut self) -> Recording<'_, N> {
        Recording {
            position: self.position.as_chunks_mut().0,
            velocity: self.velocity.as_chunks_mut().0,
            friction: self.friction.as_chunks_mut().0,
        }
    }

    /// What was recorded for a column: positions for what is measured.
    pub fn of(&self, kind: Column) -> &[Row] {
        match kind {
            Column::Position | Column::Measured => &self.position,
            Column::Velocity => &self.velocity,
            Column::Friction => &self.friction,
            Column::Law(_) => &[],
        }
    }
}

/// Rows of a record by samples: of each those of all blocks, or none at all.
#[derive(Debug)]
pub struct Recording<'a, const N: usize> {
    position: &'a mut [[Row; N]],
    velocity: &'a mut [[Row; N]],
    friction: &'a mut [[Row; N]],
}

impl<const N: usize> Recording<'_, N> {
    /// Records blocks in a sample.
    #[inline(always)]
    pub fn take<S: Scalar, L: FrictionLaw<S>, C: Contacts<S, L>>(
        &mut self,
        sample: usize,
        blocks: &mut [Block<C>; N],
    ) {
        // Row by row: an array of them would go by way of the stack.
        if let Some(rows) = self.position.get_mut(sample) {
            for (row, block) in rows.iter_mut().zip(&*blocks) {
                *row = block.bodies.position;
            }
        }
        if let Some(rows) = self.velocity.get_mut(sample) {
            for (row, block) in rows.iter_mut().zip(&*blocks) {
                *row = block.bodies.velocity;
            }
        }
        if let Some(rows) = self.friction.get_mut(sample) {
            for (row, Block { bodies, contacts }) in rows.iter_mut().zip(blocks) {
                contacts.settle(bodies);
                *row = bodies.friction;
            }
        }
    }
}
