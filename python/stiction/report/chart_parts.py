"""What the charts of a report share: widths, the axis of time, lines over it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ..plot import WIDTH, thinned
from .axis import Axis
from .chart import Line

__all__ = ["INCH", "extent", "time_axis", "trace_line", "width_of"]

INCH: Final = 72.0
"""Points: lengths of charts are in these."""
WIDE, NARROW = WIDTH * INCH, 3.9 * INCH
"""Widths of a figure for a page and for a phone: there text keeps its size on 360 pixels."""


def width_of(narrow: bool) -> float:
    """Width of a figure, points."""
    return NARROW if narrow else WIDE


def time_axis(time: np.ndarray, narrow: bool) -> Axis:
    """The axis over the time of a recording."""
    return Axis(min(0.0, float(time[0])), float(time[-1]), most=5 if narrow else 9)


def trace_line(
    time: np.ndarray, values: np.ndarray, colour: str, width: float, narrow: bool
) -> Line:
    """A line over time, of as many points as can be seen."""
    return Line(*thinned(time, values, 350 if narrow else 700), colour, width)


def extent(parts: Sequence[np.ndarray]) -> float:
    """Greatest magnitude of all that is finite, 1 where there is nothing."""
    greatest = [float(np.max(np.abs(p[np.isfinite(p)]))) for p in parts if np.isfinite(p).any()]
    return max(greatest, default=0.0) or 1.0
