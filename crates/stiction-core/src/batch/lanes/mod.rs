//! Motors side by side: as many as fit into the vectors of the processor go through plain steps in
//! one loop.
//!
//! A law tells the form of its contacts for that ([`crate::friction::elements::abreast`]). What does not
//! fit into rows (a point of a memory) is noted lane by lane. A lane whose step a law leaves out
//! (a mode changes) stays where it is, and takes that step alone, as a motor on its own would.
//!
//! The equations are those of [`crate::integrate`], operation by operation, and no product is fused
//! with a sum: results are the same to the bit as those of each motor alone, for any number of
//! threads and on any processor.

mod bodies;
mod record;
mod supply;
mod tally;
mod team;

pub use stiction_dispatch::Width;

pub use team::{Job, LEAST, Member, Motor, Team, take_abreast};
