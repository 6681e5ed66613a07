//! Building blocks that several laws share.

pub mod approach;
pub mod arcsinh;
pub mod bell;
pub mod bond;
pub mod branch;
pub mod bristle;
pub mod contact_age;
pub mod lag;
pub mod loading;
pub mod memory;
pub mod plastic;
pub mod reachable;
pub mod rigid;
pub mod series;
pub mod slides;
pub mod slip_hardening;
pub mod spring;
pub mod stop;
pub mod stribeck;
pub mod yield_curve;
