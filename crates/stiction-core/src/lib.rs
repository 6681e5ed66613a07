//! Pre-sliding friction laws, the motors that carry them, and exact parameter derivatives.
//!
//! Pure numerics: no input, no output, no unsafe code. Every model is written once over
//! [`scalar::Scalar`], so that the same code yields values and derivatives.
//!
//! Eight rooms, each of which needs those above it in this list and none below:
//!
//! | room | what is in it |
//! |---|---|
//! | [`math`] | numbers, plain and with derivatives, and functions of them |
//! | [`support`] | errors, parameters, plain data, the bounds of a call |
//! | [`friction`] | friction laws and what they are made of |
//! | [`plant`] | drive, body, effects and sensor: all of a plant but its law |
//! | [`integrate`] | how a plant and its law get from one sample to the next |
//! | [`simulate`] | contacts and motors with their state |
//! | [`inverse`] | from a motion back to what made it, and derivatives by parameters |
//! | [`batch`] | ensembles, and motors side by side in the lanes of a vector |
//!
//! Inside the crate a path names the room; outside, modules are also found by their own names.

#![forbid(unsafe_code)]

pub mod math;
pub mod support;
#[macro_use]
pub mod friction;
pub mod batch;
pub mod integrate;
pub mod inverse;
pub mod plant;
pub mod simulate;

pub use batch::{ensemble, lanes};
pub use friction::elements::symbol;
pub use inverse::{
    follow, gradient, kernel, least_squares, sensitivity, shoot, signatures, smoothing,
};
pub use math::{dual, exponential, scalar, trig, wave};
pub use plant::{body, drive, effects, sensor, servo};
pub use simulate::{model, motor, segments};
pub use support::{error, finite, interrupt, motion, parameter, samples, work};
