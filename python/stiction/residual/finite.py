"""What a simulation that ran away leaves, made numbers again."""

from __future__ import annotations

import numpy as np

from .._support.arrays import FloatArray

__all__ = ["finite"]


def finite(values: FloatArray, runaway: float | None = None) -> FloatArray:
    """The same array, changed in place: 0 for what is not a number, large numbers for infinities.

    With ``runaway`` that number for all of them, −runaway for −∞. Arrays of numbers alone, which
    nearly all are, are looked through once and not copied.
    """
    if not np.all(np.isfinite(values)):
        least = None if runaway is None else -runaway
        np.nan_to_num(values, copy=False, nan=runaway or 0.0, posinf=runaway, neginf=least)
    return values
