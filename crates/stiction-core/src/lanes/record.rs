//! What is kept of a team's motion.

use super::block::{Bodies, Row};
use crate::motor::Column;

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

    /// Whether friction is wanted.
    #[inline(always)]
    pub fn shows_friction(&self) -> bool {
        self.friction.is_some()
    }

    /// Records a block at a place.
    #[inline(always)]
    pub fn take(&mut self, place: usize, bodies: &Bodies) {
        if let Some(row) = self.position.as_mut().and_then(|rows| rows.get_mut(place)) {
            *row = bodies.position;
        }
        if let Some(row) = self.velocity.as_mut().and_then(|rows| rows.get_mut(place)) {
            *row = bodies.velocity;
        }
        if let Some(row) = self.friction.as_mut().and_then(|rows| rows.get_mut(place)) {
            *row = bodies.friction;
        }
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
