//! Numbers: plain and with derivatives, and functions of them. On the ground: nothing here knows a plant.

pub mod dual;
pub mod exponential;
pub(crate) mod logarithm;
pub mod row;
pub mod scalar;
pub mod trig;
pub mod verlet;
pub mod wave;
