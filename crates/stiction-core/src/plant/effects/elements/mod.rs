//! What all effects are made of.

pub mod facts;
pub mod situation;
pub mod sorted;
pub mod spec;
