//! Least squares over many rows and few columns, within bounds.
//!
//! A residual and its slopes come from whoever knows the model, recording by recording, and are read where
//! they lie; what is summed over rows, and the steps that follow from these sums, is here.

mod descent;
mod rows;
mod solve;

pub use descent::{Bounds, Minimum, Parts, Problem, Pull, Settings, Slopes, minimise};
pub use rows::Block;
