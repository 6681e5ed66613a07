"""Coordinates in which a residual shows its cause."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..fitting.rows import Rows
from ..trajectory import FloatArray
from .evidence import Evidence

__all__ = ["COORDINATES", "Coordinate", "Look", "looks"]

TURNING_SHARE: Final = 1e-3
"""Speeds below this share of the usual one have no direction of their own: the last one holds."""


@dataclass(frozen=True)
class Look:
    """What the rows of one recording are looked at by, before masking.

    Attributes
    ----------
    time, position, velocity, acceleration, effort, rate : numpy.ndarray, shape (n,)
        Through the kernel; ``rate`` is that of the effort, ``time`` the session clock.
    direction : numpy.ndarray, shape (n,)
        Of the motion, −1 or 1; the last one where the machine rests.
    angle : numpy.ndarray, shape (n,)
        Position within a turn; over a stroke of a linear machine the position itself.
    travelled, elapsed : numpy.ndarray, shape (n,)
        Distance and time since the direction last changed.
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    effort: FloatArray
    rate: FloatArray
    direction: FloatArray
    angle: FloatArray
    travelled: FloatArray
    elapsed: FloatArray


@dataclass(frozen=True)
class Coordinate:
    """One way to look at a residual.

    Attributes
    ----------
    name : str
        As in findings.json.
    axis : str
        What its axis says, with {x} and {f} for the units of position and effort.
    odd : bool
        The residual is counted along the motion: friction that is too low is positive both ways.
    values : callable
        From a ``Look`` to numpy.ndarray, shape (n,).
    slow : bool
        It changes over the session, not within a recording.
    """

    name: str
    axis: str
    odd: bool
    values: Callable[[Look], FloatArray]
    slow: bool = False


COORDINATES: Final = (
    Coordinate("velocity", "velocity, {x}/s", False, lambda look: look.velocity),
    Coordinate("speed", "speed, {x}/s", True, lambda look: np.abs(look.velocity)),
    Coordinate("position", "position, {x}", False, lambda look: look.position),
    Coordinate("position along the motion", "position, {x}", True, lambda look: look.position),
    Coordinate("angle", "angle in the turn, rad", False, lambda look: look.angle),
    Coordinate("angle along the motion", "angle in the turn, rad", True, lambda look: look.angle),
    Coordinate("acceleration", "acceleration, {x}/s²", False, lambda look: look.acceleration),
    Coordinate("effort", "measured effort, {f}", False, lambda look: look.effort),
    Coordinate("rate of the effort", "rate of the effort, {f}/s", False, lambda look: look.rate),
    Coordinate(
        "distance since the reversal",
        "distance since the reversal, {x}",
        True,
        lambda look: look.travelled,
    ),
    Coordinate(
        "time since the reversal", "time since the reversal, s", True, lambda look: look.elapsed
    ),
    Coordinate("session time", "session clock, s", False, lambda look: look.time, slow=True),
    Coordinate(
        "session time along the motion", "session clock, s", True, lambda look: look.time, slow=True
    ),
)
"""Coordinates in which the rest is looked at."""


def looks(evidence: Evidence, clocks: Sequence[float], rows: Sequence[Rows]) -> list[Look]:
    """What the rows of each recording are looked at by.

    ``clocks`` holds when each recording starts on the session clock, s.
    """
    return evidence.each(lambda each: _look(evidence, clocks[each.index], each), rows)


def _look(evidence: Evidence, clock: float, rows: Rows) -> Look:
    form = rows.form
    velocity = form.velocity
    usual = float(np.sqrt(np.mean(velocity**2)))
    direction = np.where(np.abs(velocity) > TURNING_SHARE * usual, np.sign(velocity), 0.0)
    direction = _carried(direction)
    turned = np.flatnonzero(np.diff(direction)) + 1
    last = np.zeros(len(direction), dtype=np.int64)
    last[turned] = turned
    last = np.maximum.accumulate(last)
    position = form.mean(form.position[1:])
    effort = form.measured(evidence.plant)
    spacing = form.dt * form.stride
    since: FloatArray = np.arange(len(direction), dtype=np.float64) - last
    return Look(
        time=form.time - evidence.recordings[rows.index].time[0] + clock,
        position=position,
        velocity=velocity,
        acceleration=form.acceleration,
        effort=effort,
        rate=np.gradient(effort, spacing),
        direction=direction,
        angle=np.mod(position, 2.0 * np.pi) if evidence.plant.motion == "rotary" else position,
        travelled=np.abs(position - position[last]),
        elapsed=since * spacing,
    )


def _carried(direction: FloatArray) -> FloatArray:
    """Directions with each 0 replaced by what was before it, at the start by what comes."""
    index = np.where(direction != 0.0, np.arange(len(direction)), 0)
    carried: FloatArray = direction[np.maximum.accumulate(index)]
    moving = carried[carried != 0.0]
    carried[carried == 0.0] = moving[0] if len(moving) else 1.0
    return carried
