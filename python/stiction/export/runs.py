"""What a target does when it is run: where a joint moves, or the effort that a curve asks for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .._native import Motion
from .._support.arrays import FloatArray

if TYPE_CHECKING:
    from ..plant import Plant
    from ..residual.weak_form import Start

__all__ = [
    "EffortRun",
    "Led",
    "MotionRun",
    "StepRun",
    "Windows",
    "dry_friction",
    "gravity_effort",
]


@dataclass(frozen=True)
class Windows:
    """Where along a recording a machine is started anew, and under what it runs from there.

    Attributes
    ----------
    dt : float
        s.
    position : numpy.ndarray, shape (rows,)
        Measured, as it drives friction; rad or m.
    input, load : numpy.ndarray, shape (rows - 1,)
        Held over each sample; the load in N·m or N.
    starts : numpy.ndarray of int, shape (windows,)
        Rows at which the windows start, rising.
    length : int
        Samples of each.
    clock, path : float
        Of the session at the first row, s and rad or m.
    contact : dict or None
        Friction state there, None where it was never moved.
    steps : numpy.ndarray, shape (rows - 1,), or None
        Duration of each sample, s, where they differ.
    enabled : numpy.ndarray of bool, shape (rows - 1,), or None
        Whether the drive was on; None where it was all the time.
    pace : float or None
        Velocity at the first row where more is known than its neighbours, rad/s or m/s.
    """

    dt: float
    position: FloatArray
    input: FloatArray
    load: FloatArray
    starts: np.ndarray[Any, np.dtype[np.intp]]
    length: int
    clock: float = 0.0
    path: float = 0.0
    contact: Start = None
    steps: FloatArray | None = None
    enabled: np.ndarray[Any, np.dtype[np.bool_]] | None = None
    pace: float | None = None

    def duration(self, sample: int) -> float:
        """Of a sample, s."""
        return self.dt if self.steps is None else float(self.steps[sample])

    def drives(self, sample: int) -> bool:
        """Whether the drive is on during a sample."""
        return self.enabled is None or bool(self.enabled[sample])

    def velocity(self, row: int) -> float:
        """Measured velocity at a row, the slope between its neighbours; rad/s or m/s."""
        if row == 0 and self.pace is not None:
            return self.pace
        first, last = max(row - 1, 0), min(row + 1, len(self.position) - 1)
        return float(self.position[last] - self.position[first]) / (self.dt * (last - first))

    def motion(self, first: int, last: int) -> Motion:
        """The measured motion from one row to another, as it leads a contact."""
        inside = slice(first, last)
        position = self.position[first : last + 1]
        return Motion(position, self.input[inside], self.dt, load=self.load[inside], averaged=True)


@dataclass(frozen=True)
class MotionRun:
    """A target that moves.

    Attributes
    ----------
    name : str
        How it was run, "" where there is one way alone or for the plain one.
    positions : callable
        Of ``Windows``; returns where it is after each sample, rad or m, shape (windows, length).
    """

    name: str
    positions: Callable[[Windows], FloatArray]


@dataclass(frozen=True)
class EffortRun:
    """A target that says which effort a motion takes beside that of the inertia.

    Attributes
    ----------
    name : str
        As for ``MotionRun``.
    effort : callable
        Of velocities and positions, shape (n,) each; returns efforts, N·m or N, shape (n,).
    """

    name: str
    effort: Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True)
class Led:
    """A contact led along a measured motion, sample by sample.

    Attributes
    ----------
    dt : float
        s.
    position : numpy.ndarray, shape (rows,)
        As it drives friction; rad or m.
    drive, load : numpy.ndarray, shape (rows - 1,)
        Efforts held over each sample, N·m or N.
    temperature : numpy.ndarray, shape (rows - 1,), or None
        Degrees Celsius; None where it was not measured.
    """

    dt: float
    position: FloatArray
    drive: FloatArray
    load: FloatArray
    temperature: FloatArray | None


@dataclass(frozen=True)
class StepRun:
    """A target that steps a contact along a motion.

    Attributes
    ----------
    name : str
        As for ``MotionRun``.
    effort : callable
        Of ``Led``; returns what friction takes at the end of each sample, less gravity and what
        effects add, N·m or N, shape (rows - 1,).
    """

    name: str
    effort: Callable[[Led], FloatArray]


def dry_friction(plant: Plant, friction: float, damping: float) -> tuple[EffortRun]:
    """The run of a joint that knows dry friction and damping, and whose bodies have their mass."""

    def effort(velocity: FloatArray, position: FloatArray) -> FloatArray:
        resisted: FloatArray = friction * np.sign(velocity) + damping * velocity
        return resisted + gravity_effort(plant, position)

    return (EffortRun("", effort),)


def gravity_effort(plant: Plant, position: FloatArray) -> FloatArray:
    """Effort that bears the mass which the bodies of a simulator have to be given; N·m or N."""
    zero = plant.body.get("gravity_zero_rad")
    angle = position - (0.0 if zero is None else zero.value)
    borne: FloatArray = plant.gravity * np.sin(angle) + plant.weight
    return borne
