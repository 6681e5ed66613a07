//! Contacts and motors on their way: parts, state and what a session does with them.

pub mod model;
pub mod motor;
pub(crate) mod range;
pub mod segments;
