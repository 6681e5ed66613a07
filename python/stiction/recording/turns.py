"""Angles that begin anew after a turn, as absolute encoders give them."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from .._support.arrays import FloatArray

__all__ = ["unwrap"]

_TURN: Final = 2.0 * math.pi
_SLACK: Final = 1e-3
"""Of a turn: readings of one are rounded."""
_JUMPS: Final = 0.75
"""A step of at least this share of a turn begins it anew."""
_USUAL: Final = 0.99
"""Share of the other steps..."""
_TIMES: Final = 5.0
"""... and this many times their size a jump may leave beside the turn: a failed reading leaves
more, and stays as it is."""
_LEAST: Final = 0.02
"""Of a turn, where nothing else moves."""


def unwrap(angle: FloatArray) -> tuple[FloatArray, int]:
    """An angle that goes on where it began anew, and how often it did.

    Parameters
    ----------
    angle : ndarray, shape (rows,)
        rad; cells that are missing stay so.
    """
    known = np.flatnonzero(np.isfinite(angle))
    values = angle[known]
    if len(values) < 3 or np.ptp(values) > _TURN * (1.0 + _SLACK):
        return angle, 0
    steps = np.diff(values)
    jumps = np.abs(steps) >= _JUMPS * _TURN
    if not jumps.any():
        return angle, 0
    left = steps - _TURN * np.round(steps / _TURN)
    others = np.abs(steps[~jumps])
    usual = float(np.quantile(others, _USUAL)) if len(others) else 0.0
    if np.any(np.abs(left[jumps]) > max(_TIMES * usual, _LEAST * _TURN)):
        return angle, 0
    whole = angle.copy()
    turns = np.where(jumps, np.round(steps / _TURN), 0.0)
    whole[known[1:]] -= _TURN * np.cumsum(turns)
    return whole, int(np.count_nonzero(jumps))
