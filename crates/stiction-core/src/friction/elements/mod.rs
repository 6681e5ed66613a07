//! Building blocks that several laws share.

pub mod approach;
pub mod arcsinh;
pub mod bristle;
pub mod contact_age;
pub mod lag;
pub mod memory;
pub mod plastic;
pub mod reachable;
pub mod series;
pub mod slides;
pub mod spring;
pub mod stribeck;
pub mod yield_curve;
