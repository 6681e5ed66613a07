//! What laws are made of: the trait that all of them fulfil, and blocks that several of them share.

pub mod approach;
pub mod arcsinh;
pub mod bell;
pub mod bond;
pub mod branch;
pub mod bristle;
pub mod contact;
pub mod contact_age;
pub mod entry;
pub mod lag;
pub mod law;
pub mod loading;
pub mod memory;
pub mod plain_steps;
pub mod plastic;
pub mod reachable;
pub mod rigid;
pub mod series;
pub mod slides;
pub mod slip_hardening;
pub mod spec;
pub mod spring;
pub mod stop;
pub mod stribeck;
pub mod symbol;
pub mod yield_curve;
