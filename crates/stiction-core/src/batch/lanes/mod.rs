//! Motors side by side: as many as fit into the vectors of the processor go through plain steps in
//! one loop.
//!
//! A law offers such a loop through [`FrictionLaw::abreast`]: its [`Contacts`] keep what runs from
//! step to step of [`WIDTH`] contacts in rows and take a step of all of them without a choice. What
//! does not fit into rows (a point of a memory) is noted lane by lane. A lane whose step a law leaves out
//! (a mode changes) stays where it is, and takes that step alone, as a motor on its own would.
//!
//! The equations are those of [`crate::integrate`], operation by operation, and no product is fused
//! with a sum: results are the same to the bit as those of each motor alone, for any number of
//! threads and on any processor.

mod block;
mod record;
mod supply;
mod tally;
mod team;

pub use stiction_dispatch::Width;

pub use block::{Block, Bodies, Contacts, Rest, Row, WIDTH, bits, lanes, pick};
pub use team::{Job, LEAST, Member, Motor, Team};

use crate::friction::FrictionLaw;

/// What takes a team through its samples.
pub type Abreast<S, L> = fn(&mut Team<'_, S, L>);

/// The loop for motors with these contacts.
pub fn by<S: crate::math::scalar::Scalar, L: FrictionLaw<S>, C: Contacts<S, L>>() -> Abreast<S, L> {
    |team| team.walk::<C>()
}
