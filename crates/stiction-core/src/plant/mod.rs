//! The plant beside its friction law: drive, body, effects and sensor, and where they have come to.

pub mod body;
mod budget;
mod contact_effects;
pub mod drive;
pub mod effects;
mod ends;
mod gap;
mod machine;
pub(crate) mod naming;
mod place;
mod reach;
mod run;
pub mod sensor;
pub mod servo;
mod shaft;

pub use budget::Budget;
pub(crate) use budget::Work;
pub use contact_effects::{ContactEffects, Reach};
pub use machine::{Machine, SteadyCreep};
pub(crate) use place::ByPlace;
pub use run::{Before, Run};
pub use shaft::{Beyond, Shaft};
