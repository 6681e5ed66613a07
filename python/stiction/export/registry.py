"""The targets: each module of ``targets`` is one, found by itself."""

from __future__ import annotations

import math
import pkgutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from ..errors import InputError
from ..keys import choice
from ..parameter import number
from .made import Export
from .speeds import speed_of
from .targets import __name__ as _package
from .targets import __path__ as _path

if TYPE_CHECKING:
    from ..plant import Plant
    from .runs import EffortRun, MotionRun

__all__ = ["Target", "export", "targets"]


@dataclass(frozen=True)
class Target:
    """A tool that a plant is written for.

    Attributes
    ----------
    name : str
    summary : str
        What is written, in a line.
    write : callable
        Of a plant and a greatest speed.
    runs : callable or None
        Of what was written and the plant: the ways in which the target is run to check it; None
        where it cannot be.
    """

    name: str
    summary: str
    write: Callable[[Plant, float], Export]
    runs: Callable[[Export, Plant], Sequence[MotionRun | EffortRun]] | None = None


@cache
def targets() -> dict[str, Target]:
    """All targets by name.

    A module of ``stiction.export.targets`` has ``SUMMARY`` and ``write(plant, speed)``, and may
    have ``runs(export, plant)``.
    """
    found = {}
    for module in pkgutil.iter_modules(_path):
        own = import_module(f"{_package}.{module.name}")
        found[module.name] = Target(module.name, own.SUMMARY, own.write, getattr(own, "runs", None))
    return dict(sorted(found.items()))


def export(plant: Plant, to: str, *, speed: float | None) -> Export:
    """A plant written for a target; see ``Plant.export``."""
    known = targets()
    at = speed_of(plant) if speed is None else number(speed, f"{plant.source}: speed")
    if not (math.isfinite(at) and at > 0.0):
        raise InputError(
            f"{plant.source}: speed = {at:g} is none; give the greatest speed at which friction "
            "matters, above 0, in rad/s or m/s"
        )
    made = known[choice(to, tuple(known), f"{plant.source}: to")].write(plant, at)
    return replace(made, plant=plant)
