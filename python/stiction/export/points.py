"""A curve as few points, joined by straight lines."""

from __future__ import annotations

from typing import Final

import numpy as np

from .._support.arrays import FloatArray

__all__ = ["few_points", "lines_off"]

EXACT: Final = 1e-12
"""Share of its range by which lines may be off a curve that is made of lines."""


def few_points(x: FloatArray, y: FloatArray, most: int) -> tuple[np.ndarray, float]:
    """Points of a curve that straight lines between them stay nearest to.

    Parameters
    ----------
    x : numpy.ndarray, shape (n,)
        Rising.
    y : numpy.ndarray, shape (n,)
    most : int
        Points at most, 2 or more; the first and the last one are among them. Fewer are taken where
        they leave nothing.

    Returns
    -------
    (numpy.ndarray of int, float)
        Their places, rising, and the greatest distance of the lines from the curve: the least that
        is possible with so many points of the curve (dynamic programming).
    """
    n = len(x)
    off = np.zeros((n, n))
    for first in range(n - 1):
        for last in range(first + 2, n):
            inside = slice(first + 1, last)
            slope = (y[last] - y[first]) / (x[last] - x[first])
            off[first, last] = np.max(np.abs(y[first] + slope * (x[inside] - x[first]) - y[inside]))
    best = off[0].copy()
    before = [np.zeros(n, dtype=np.int64)]
    nothing = EXACT * float(np.ptp(y))
    for _ in range(most - 2):
        if best[-1] <= nothing:
            break
        # Through one point more, which may be the last one before.
        through = np.maximum(best[:, None], off)
        through[np.tril_indices(n, -1)] = np.inf
        place = np.argmin(through, axis=0)
        before.append(place)
        best = through[place, np.arange(n)]
    places = [n - 1]
    for place in reversed(before):
        places.append(int(place[places[-1]]))
    return np.unique(places), float(best[-1])


def lines_off(x: FloatArray, y: FloatArray, at: FloatArray, curve: FloatArray) -> float:
    """Greatest distance of lines between points from a curve at places of its own."""
    return float(np.max(np.abs(np.interp(at, x, y) - curve), initial=0.0))
