//! Pre-sliding friction laws, the motors that carry them, and exact parameter derivatives.
//!
//! Pure numerics: no input, no output, no unsafe code. Every model is written once over
//! [`scalar::Scalar`], so that the same code yields values and derivatives.

#![forbid(unsafe_code)]

#[macro_use]
pub mod friction;

pub mod body;
pub mod drive;
pub mod dual;
pub mod effects;
pub mod ensemble;
pub mod error;
pub mod exponential;
pub mod finite;
pub mod follow;
pub mod gradient;
pub mod integrate;
pub mod interrupt;
pub mod kernel;
pub mod lanes;
pub mod least_squares;
mod logarithm;
pub mod model;
pub mod motor;
mod naming;
pub mod parameter;
mod range;
pub mod scalar;
pub mod segments;
pub mod sensitivity;
pub mod sensor;
pub mod servo;
pub mod shoot;
pub mod signatures;
pub mod smoothing;
pub mod symbol;
mod traces;
mod track;
pub mod trig;
pub mod wave;
pub mod work;
