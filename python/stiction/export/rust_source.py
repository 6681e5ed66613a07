"""A Rust crate of a plant: its C translated, and what makes a crate of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from .contact_source import MATHS, structures_of
from .firmware import Firmware
from .translation import parse, rust_of

__all__ = ["crate_files"]

MANIFEST: Final = """\
# Made from a plant file by stiction; made again, not edited.
[package]
name = "stiction_plant"
version = "0.1.0"
edition = "2021"
publish = false

[lib]
path = "lib.rs"

[features]
f32 = [] # numbers of single precision

[dependencies]
libm = { version = "0.2", default-features = false }
"""
HEAD: Final = """\
//! {what}. Made from a plant file by stiction; made again, not edited.
//!
//! Velocity in {unit}/s, acceleration in {unit}/s², position in {unit}, time in s, temperature in
//! degrees Celsius; efforts in {effort}. Without the standard library, allocation or unsafe code.
//!
//! What it holds:
//!
{held}
//!
//! What it cannot hold:
//!
{lost}
#![no_std]
#![forbid(unsafe_code)]

mod math;
mod plant;

pub use plant::{{{public}}};

/// Numbers: f64, or f32 with the feature of that name.
#[cfg(not(feature = "f32"))]
pub type Real = f64;
/// Numbers: f64, or f32 with the feature of that name.
#[cfg(feature = "f32")]
pub type Real = f32;
"""
STEPS: Final = """
impl Default for Contact {
    fn default() -> Self {
        Self::new()
    }
}

impl Contact {
    /// A contact that was never moved.
    pub fn new() -> Self {
        let mut own = Self::ZERO;
        plant::stiction_init(&mut own);
        own
    }

    /// Once a sample of dt: friction at its end, positive when it resists positive motion, less
    /// what effects push. The velocity is held over dt. `effort` is all other effort on the body,
    /// gravity with it, positive along +x: at velocity 0 a contact with true stick returns it, up
    /// to what it holds. `load` is the part of it that loads the contact from outside,
    /// `temperature` NAN where nobody knows it.
    pub fn step(
        &mut self,
        velocity: Real,
        dt: Real,
        effort: Real,
        load: Real,
        temperature: Real,
    ) -> Real {
        plant::stiction_step(self, velocity, dt, effort, load, temperature)
    }
"""
PLACED: Final = """
    /// Puts the body where an encoder sees it, before a step; the contact does not move.
    pub fn set_position(&mut self, position: Real) {
        plant::stiction_set_position(self, position);
    }
"""
AHEAD: Final = """
/// Effort that friction takes in steady motion at a speed.
pub fn friction(velocity: Real) -> Real {
    plant::stiction_friction(velocity)
}

/// Effort that holds the machine at rest at a position.
pub fn place(position: Real) -> Real {
    plant::stiction_place(position)
}

/// Effort for a reference.
pub fn feedforward(velocity: Real, acceleration: Real, position: Real) -> Real {
    plant::stiction_feedforward(velocity, acceleration, position)
}

/// The input of the drive for an effort.
pub fn input(effort: Real) -> Real {
    plant::stiction_input(effort)
}

impl Observer {
    /// An observer of a bandwidth in rad/s.
    pub fn new(bandwidth: Real, velocity: Real) -> Self {
        let mut own = Self::ZERO;
        plant::stiction_observer_init(&mut own, bandwidth, velocity);
        own
    }

    /// Once a sample of dt: the input that was held over it, the velocity at its end and the
    /// friction of the model; what acts beside these on the body, positive along +x. What else is
    /// known, such as gravity, is taken off the friction.
    pub fn observe(&mut self, input: Real, velocity: Real, friction: Real, dt: Real) -> Real {
        plant::stiction_observe(self, input, velocity, friction, dt)
    }
}
"""
HANGS: Final = """
/// Effort of gravity, positive along +x.
pub fn gravity(position: Real) -> Real {
    plant::stiction_gravity(position)
}
"""
PLANT: Final = """\
//! The plant: translated from its C, statement by statement.
// C declares what it sets later.
#![allow(unused_assignments, clippy::all)]

use super::{math, Real};

"""
MATH: Final = """\
//! Functions of numbers, which core has not.
use super::Real;
"""
SIZE: Final = """
pub fn fabs(x: Real) -> Real {
    // A number without its sign is one that is shifted out and in again.
    Real::from_bits(x.to_bits() << 1 >> 1)
}
"""
FUNCTION: Final = """
pub fn {name}({given}) -> Real {{
    #[cfg(not(feature = "f32"))]
    return libm::{name}({names});
    #[cfg(feature = "f32")]
    return libm::{name}f({names});
}}
"""


def crate_files(
    made: Firmware,
    what: str,
    units: tuple[str, str],
    held: Sequence[str],
    lost: Sequence[str],
) -> dict[str, str]:
    """Text of each file of the crate, by its path.

    Parameters
    ----------
    made : Firmware
        The C of the plant.
    what : str
        Law and effects.
    units : tuple of str
        Of positions and of efforts.
    held, lost : sequence of str
        What the plant has and what is not in it, a sentence each.
    """
    plant = PLANT + rust_of(parse(structures_of(made.header) + made.body)) + "\n"
    public = "Contact, Observer" if made.steps else "Observer"
    unit, effort = units
    lib = HEAD.format(
        what=what, unit=unit, effort=effort, held=_listed(held), lost=_listed(lost), public=public
    )
    if made.steps:
        lib += STEPS + (PLACED if "stiction_set_position" in made.body else "") + "}\n"
    lib += AHEAD + (HANGS if "stiction_gravity" in made.body else "")
    return {
        "Cargo.toml": MANIFEST,
        "lib.rs": lib,
        "plant.rs": plant,
        "math.rs": MATH + "".join(map(_function, sorted(set(MATHS.findall(made.body))))),
    }


def _function(name: str) -> str:
    if name == "fabs":
        return SIZE
    names = ("x", "y") if name in ("hypot", "pow") else ("x",)
    return FUNCTION.format(
        name=name, given=", ".join(f"{each}: Real" for each in names), names=", ".join(names)
    )


def _listed(sentences: Sequence[str]) -> str:
    return "\n".join(f"//! - {each}" for each in sentences or ("nothing",))
