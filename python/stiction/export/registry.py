"""The targets: each module of ``targets`` is one, found by itself."""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from .._support.keys import choice
from ..plant.assumed import assumptions
from .made import Export
from .speeds import greatest_speed
from .targets import __name__ as _package
from .targets import __path__ as _path

if TYPE_CHECKING:
    from ..plant import Plant
    from .runs import EffortRun, MotionRun, StepRun

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
    write_robot : callable or None
        Of the plants of all joints and their greatest speeds, by joint: all of them as one; None
        where each joint is written by itself.
    """

    name: str
    summary: str
    write: Callable[[Plant, float], Export]
    runs: Callable[[Export, Plant], Sequence[MotionRun | EffortRun | StepRun]] | None = None
    write_robot: Callable[[Mapping[str, Plant], Mapping[str, float]], Export] | None = None


@cache
def targets() -> dict[str, Target]:
    """All targets by name.

    A module of ``stiction.export.targets`` has ``SUMMARY`` and ``write(plant, speed)``, and may
    have ``runs(export, plant)`` and ``write_robot(plants, speeds)``.
    """
    found = {}
    for module in pkgutil.iter_modules(_path):
        own = import_module(f"{_package}.{module.name}")
        optional = (getattr(own, name, None) for name in ("runs", "write_robot"))
        found[module.name] = Target(module.name, own.SUMMARY, own.write, *optional)
    return dict(sorted(found.items()))


def export(plant: Plant, to: str, *, speed: float | None) -> Export:
    """A plant written for a target; see ``Plant.export``."""
    known = targets()
    at = greatest_speed(plant, speed)
    made = known[choice(to, tuple(known), f"{plant.source}: to")].write(plant, at)
    return replace(made, plant=plant, speed=at, assumed=assumptions(plant))
