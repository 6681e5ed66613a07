"""The residual in one coordinate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from .coordinates import Coordinate

__all__ = ["FLAG_ABOVE", "LEAST_SIZE", "View", "limit", "means", "sums"]

FEWEST_ROWS: Final = 8
"""Rows that a stretch needs to have a mean."""
FLAG_TIMES, FLAG_ABOVE = 1.3, 0.02
"""A share is flagged above 1.3 times the surrogates' 99 % quantile and .02 above it."""
LEAST_SIZE: Final = 0.003
"""What is left in a coordinate matters from this share of the friction on: no law's curve is an
image of a contact to better than that."""
CLEARLY: Final = 2.8
"""So many times what noise reaches: sessions in which nothing was hidden came to 2.4."""


@dataclass(frozen=True)
class View:
    """The residual over one coordinate.

    Attributes
    ----------
    coordinate : Coordinate
    at, mean, low, high : numpy.ndarray, shape (bins,)
        Centre of each stretch, mean residual over the rows that decide, and the band of 95 % that
        the surrogates stay in.
    share : float
        Held-out share of the power that a smoother over the coordinate removes.
    threshold : float
        What noise alone may reach.
    size : float
        rms of what the smoother removes, as a share of the friction's.
    """

    coordinate: Coordinate
    at: FloatArray
    mean: FloatArray
    low: FloatArray
    high: FloatArray
    share: float
    threshold: float
    size: float

    def is_flagged(self, least: float = LEAST_SIZE) -> bool:
        """Whether something is left that noise does not explain and that matters from a size on.

        What stands far above noise matters from half that size on.
        """
        clear = self.share > CLEARLY * self.threshold and self.size > 0.5 * LEAST_SIZE
        return self.share > self.threshold and (self.size > least or clear)


def limit(at_null: FloatArray) -> float:
    """What a share must exceed, from those of the surrogates."""
    usual = float(np.quantile(at_null, 0.99)) if len(at_null) else 0.0
    return max(FLAG_TIMES * usual, usual + FLAG_ABOVE, FLAG_ABOVE)


def sums(index: np.ndarray, columns: FloatArray, bins: int) -> FloatArray:
    """Sum of each column in each stretch; shape (bins, k)."""
    # Each in one piece: what lies apart is waited for.
    lying = np.ascontiguousarray(columns.T)
    return np.column_stack([np.bincount(index, column, bins) for column in lying])


def means(index: np.ndarray, columns: FloatArray, bins: int) -> FloatArray:
    """Mean of each column in each stretch, 0 where there are too few rows; shape (bins, k)."""
    counts = np.bincount(index, minlength=bins)
    found: FloatArray = np.where(
        counts[:, None] >= FEWEST_ROWS,
        sums(index, columns, bins) / np.maximum(counts, 1)[:, None],
        0.0,
    )
    return found
