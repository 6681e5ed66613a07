"""What is left: smoothers over each coordinate, judged on rows held out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..trajectory import FloatArray
from .coordinates import COORDINATES, Coordinate, Look
from .evidence import Evidence, Plan

__all__ = ["Rest", "View", "rest"]

BINS: Final = 24
"""Stretches of a coordinate, each with as many rows."""
FEWEST_ROWS: Final = 8
"""Rows that a stretch needs to have a mean."""
FLAG_TIMES, FLAG_ABOVE = 1.3, 0.02
"""A smoother is flagged above 1.3 times the surrogates' 99 % quantile and .02 above it."""
LEAST_SIZE: Final = 0.003
"""What is left in a coordinate matters from this share of the friction on: no law's curve is an
image of a contact to better than that."""


@dataclass(frozen=True)
class View:
    """The residual over one coordinate.

    Attributes
    ----------
    coordinate : Coordinate
    at, mean, low, high : numpy.ndarray, shape (bins,)
        Centre of each stretch, mean residual held out, and the band of 95 % that the
        surrogates stay in.
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

    @property
    def flagged(self) -> bool:
        """Whether something is left that noise does not explain and that matters."""
        return self.share > self.threshold and self.size > LEAST_SIZE


@dataclass(frozen=True)
class Rest:
    """What a model leaves, in every coordinate, largest share first."""

    views: tuple[View, ...]

    @property
    def flagged(self) -> tuple[View, ...]:
        """Coordinates in which more is left than noise explains."""
        return tuple(view for view in self.views if view.flagged)


def rest(
    evidence: Evidence,
    seen: Sequence[Look],
    residual: FloatArray,
    null: FloatArray,
    friction: float,
) -> Rest:
    """Looks at a residual in every coordinate.

    A smoother is the mean over stretches of a coordinate, taken from the fitted rows of each plan
    and judged on those held out.

    Parameters
    ----------
    evidence : Evidence
    seen : sequence of Look
        Of each recording in ``evidence.shown``.
    residual : numpy.ndarray, shape (n,)
    null : numpy.ndarray, shape (n, surrogates)
    friction : float
        Weighted rms of the friction, against which sizes are measured.
    """
    masks = [rows.mask for rows in evidence.shown]

    def stacked(values: Sequence[FloatArray]) -> FloatArray:
        return np.concatenate([v[m] for v, m in zip(values, masks, strict=True)])

    direction = stacked([look.direction for look in seen])
    views = []
    for coordinate in COORDINATES:
        values = stacked([coordinate.values(look) for look in seen])
        side = direction if coordinate.odd else np.ones_like(direction)
        views.append(
            _view(
                coordinate,
                evidence.plans,
                values,
                residual * side,
                null * side[:, None],
                evidence.weights,
                friction,
            )
        )
    return Rest(tuple(sorted(views, key=lambda view: -view.share)))


def _view(
    coordinate: Coordinate,
    plans: Sequence[Plan],
    values: FloatArray,
    residual: FloatArray,
    null: FloatArray,
    weights: FloatArray,
    friction: float,
) -> View:
    edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, BINS + 1)[1:-1]))
    index = np.searchsorted(edges, values)
    bins = len(edges) + 1
    both = np.column_stack([residual, null])
    removed, total = np.zeros(both.shape[1]), np.zeros(both.shape[1])
    rows = 0
    for plan in plans:
        curve = _means(index[plan.fit], both[plan.fit], bins)
        held = both[plan.held]
        rows += len(held)
        total += np.sum(held**2, axis=0)
        removed += np.sum(held**2 - (held - curve[index[plan.held]]) ** 2, axis=0)
    shares = removed / np.maximum(total, 1e-300)
    at_null = shares[1:]
    usual = float(np.quantile(at_null, 0.99)) if len(at_null) else 0.0
    # In units of effort for the eye: what was weighted is put back.
    physical = both / weights[:, None]
    shown = np.zeros(len(index), dtype=bool)
    for plan in plans:
        shown |= plan.held
    curves = _means(index[shown], physical[shown], bins)
    low, high = np.quantile(curves[:, 1:], [0.025, 0.975], axis=1)
    return View(
        coordinate,
        np.array([float(np.median(values[index == k])) for k in range(bins)]),
        curves[:, 0],
        low,
        high,
        float(shares[0]),
        max(FLAG_TIMES * usual, usual + FLAG_ABOVE, FLAG_ABOVE),
        float(np.sqrt(max(removed[0], 0.0) / rows)) / max(friction, 1e-300),
    )


def _means(index: np.ndarray, columns: FloatArray, bins: int) -> FloatArray:
    """Mean of each column in each stretch, 0 where there are too few rows; shape (bins, k)."""
    counts = np.bincount(index, minlength=bins)
    sums = np.zeros((bins, columns.shape[1]))
    np.add.at(sums, index, columns)
    means: FloatArray = np.where(
        counts[:, None] >= FEWEST_ROWS, sums / np.maximum(counts, 1)[:, None], 0.0
    )
    return means
