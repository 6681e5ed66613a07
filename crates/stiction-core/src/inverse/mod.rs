//! From a motion back to what made it: efforts along it, their derivatives, and how well they fit.

pub mod follow;
pub mod gradient;
pub mod kernel;
pub mod least_squares;
mod motor;
pub mod sensitivity;
pub mod shoot;
pub mod signatures;
pub mod smoothing;
pub(crate) mod traces;
pub(crate) mod track;
