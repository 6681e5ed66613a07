"""The greatest speed at which friction matters, where nobody states one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from .._support.given import number
from ..errors import InputError

if TYPE_CHECKING:
    from ..plant import Plant
    from ..recording import Recording

__all__ = ["greatest_speed", "recorded_speed", "speed_of"]

USUAL: Final = {"rotary": 10.0, "linear": 0.2}
"""rad/s, and m/s of a machine that goes straight, such as a ball screw."""
FALLEN: Final = 3.0
"""Speed at which a fall of friction is over, in those over which it falls."""
SEEN_OVER_S: Final = 0.02
"""Time over which a speed is measured, s: shorter ones see the counts of an encoder."""
NEARLY_GREATEST: Final = 99.0
"""Percent of the speeds of a recording that are no greater."""


def speed_of(plant: Plant) -> float:
    """Of a plant: what is usual for its motion, and beyond the fall that it states.

    Returns
    -------
    float
        rad/s or m/s.
    """
    stated = plant.parameters
    falls = [stated[n].value for n in stated if n.endswith((".stribeck_velocity", "beck.velocity"))]
    return max(USUAL[plant.motion], *(FALLEN * each for each in falls), 0.0)


def greatest_speed(plant: Plant, asked: float | None) -> float:
    """The speed that is asked for, or else that of the plant.

    Returns
    -------
    float
        rad/s or m/s.

    Raises
    ------
    InputError
        One that is no number above 0.
    """
    at = speed_of(plant) if asked is None else number(asked, f"{plant.source}: speed")
    if not (math.isfinite(at) and at > 0.0):
        raise InputError(
            f"{plant.source}: speed = {at:g} is none; give the greatest speed at which friction "
            "matters, above 0, in rad/s or m/s"
        )
    return at


def recorded_speed(recordings: Sequence[Recording]) -> float | None:
    """The greatest speed of recordings, but for its last percent; None where nothing moves.

    Parameters
    ----------
    recordings : sequence of Recording

    Returns
    -------
    float or None
        rad/s or m/s.
    """
    found = [_speed(np.asarray(each.time), np.asarray(each.position)) for each in recordings]
    greatest = max(found, default=0.0)
    return greatest if 0.0 < greatest < np.inf else None


def _speed(time: np.ndarray, position: np.ndarray) -> float:
    whole = np.isfinite(time) & np.isfinite(position)
    time, position = time[whole], position[whole]
    if len(time) < 2:
        return 0.0
    apart = max(1, round(SEEN_OVER_S * (len(time) - 1) / max(time[-1] - time[0], 1e-300)))
    passed = time[apart:] - time[:-apart]
    moves = passed > 0.0
    speeds = np.abs(position[apart:] - position[:-apart])[moves] / passed[moves]
    return float(np.percentile(speeds, NEARLY_GREATEST)) if len(speeds) else 0.0
