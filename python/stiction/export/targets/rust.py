"""Rust: the step of a plant's contact, its feed-forward and an observer, as a crate without std."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..firmware import Firmware
from ..made import Export
from ..rust_source import crate_files

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "the same as c in Rust: a crate without std, allocation or unsafe code"


def write(plant: Plant, speed: float) -> Export:
    """What the C of the plant states, as Rust."""
    made = Firmware.of(plant, speed)
    what = plant.friction.law + "".join(f" + {effect.name}" for effect in plant.effects)
    units = (plant.position_unit, plant.effort_unit)
    files = crate_files(made, what, units, made.held, made.lost)
    return Export("rust", files, made.held, made.lost, made.numbers)
