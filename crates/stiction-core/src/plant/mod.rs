//! The plant beside its friction law: drive, body, effects and sensor.

pub mod body;
pub mod drive;
pub mod effects;
pub(crate) mod naming;
pub mod sensor;
pub mod servo;
