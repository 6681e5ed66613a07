//! Many motors at once: ensembles, and motors side by side in the lanes of a vector.

pub mod ensemble;
mod kept;
pub mod lanes;
