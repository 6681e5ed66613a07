"""Columns of which no name tells anything: what their numbers say of each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import permutations
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from .evidence import Column, rate_of

FOLLOWS: Final = 0.95
"""Correlation of a column with the changes of another that makes the two velocity and position."""
MOST_COLUMNS: Final = 12
"""Beyond this many columns without a name there are too many pairs."""
_ROUNDED_S: Final = 0.05
"""Over this time an acceleration is taken, s: differences of single rows are noise."""


def motion_of(
    columns: Sequence[Column], clock: Sequence[FloatArray]
) -> tuple[Column, Column, float] | None:
    """A position and the velocity that is its rate of change, and their correlation.

    Parameters
    ----------
    columns : sequence of Column
    clock : sequence of ndarray
        s, of each file.
    """
    able = [c for c in columns if not c.constant][:MOST_COLUMNS]
    if not clock:
        return None
    best: tuple[float, Column, Column] | None = None
    for position, velocity in permutations(able, 2):
        ratio, fit = rate_of(position, clock, velocity)
        # In SI, or in one unit and seconds, the one is the rate of the other without a factor.
        own = fit - 0.05 * min(abs(math.log(abs(ratio))), 1.0) if ratio else 0.0
        if fit > FOLLOWS and (best is None or own > best[0]):
            best = (own, position, velocity)
    if best is None:
        return None
    return best[1], best[2], rate_of(best[1], clock, best[2])[1]


def explained_share(
    position: Column, velocity: Column | None, clock: Sequence[FloatArray], column: Column
) -> float:
    """Share of a column that acceleration, friction and gravity of the motion explain.

    The median over files of what least squares leave; 0 for a column that never changes.
    """
    shares = []
    for k, time in enumerate(clock):
        x, y = position.arrays[k], column.arrays[k]
        rows = max(1, round(_ROUNDED_S / max(float(np.median(np.diff(time))), 1e-9)))
        if np.ptp(y) == 0.0 or len(x) < 4 * rows:
            continue
        speed = velocity.arrays[k] if velocity is not None else np.gradient(_mean(x, rows))
        change = np.gradient(_mean(speed, rows))
        parts = [np.ones(len(x)), change, speed, np.sign(speed), np.sin(x), np.cos(x)]
        left = y - _fitted(np.column_stack(parts), y)
        shares.append(1.0 - float(np.var(left)) / float(np.var(y)))
    return float(np.median(shares)) if shares else 0.0


def _fitted(parts: FloatArray, values: FloatArray) -> FloatArray:
    fitted: FloatArray = parts @ np.linalg.lstsq(parts, values, rcond=None)[0]
    return fitted


def _mean(values: FloatArray, rows: int) -> FloatArray:
    """The moving mean over so many rows."""
    ends = np.pad(values, (rows // 2, rows - 1 - rows // 2), mode="edge")
    mean: FloatArray = np.convolve(ends, np.full(rows, 1.0 / rows), "valid")
    return mean
