//! What every room stands on beside numbers: errors, parameters, plain data, and the bounds of a call.

pub mod error;
pub mod finite;
pub mod interrupt;
pub mod motion;
#[macro_use]
pub mod parameter;
pub mod samples;
pub mod work;
