"""Residual that follows the effort early or late: a drive that lags, a shaft that gives."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..data.evidence import Plan
from .coordinates import Coordinate, Look
from .view import View, limit

__all__ = ["RESPONSE", "response_columns", "response_view"]

LAGS: Final = 4
"""Rows by which the effort is moved to either side: 20 ms where they are 5 ms apart, about as far
as the narrowest kernel reaches."""


def _lag(_: Look) -> FloatArray:
    raise NotImplementedError("a response is over lags")


RESPONSE: Final = Coordinate("response to the effort", "time after the effort, s", False, _lag)
"""Residual that a filter of the effort explains: what is frequency response to a mechanic."""


def response_columns(effort: FloatArray, step: float = 1.0) -> FloatArray:
    """The effort of a recording moved by a few steps, less itself.

    Parameters
    ----------
    effort : numpy.ndarray, shape (n,)
    step : float
        In rows: where recordings have other rows than one another, they are moved by one time.

    Returns
    -------
    numpy.ndarray, shape (n, 2·LAGS)
    """
    at = np.arange(len(effort), dtype=np.float64)
    lags = [lag for lag in range(-LAGS, LAGS + 1) if lag != 0]
    moved = [np.interp(at - lag * step, at, effort) for lag in lags]
    return np.column_stack(moved) - effort[:, None]


def response_view(
    columns: FloatArray,
    spacing: float,
    plans: Sequence[Plan],
    both: FloatArray,
    weights: FloatArray,
    friction: float,
) -> View:
    """What a filter of the effort explains: fitted rows give it, those held out judge it.

    Parameters
    ----------
    columns : numpy.ndarray, shape (n, 2·LAGS)
    spacing : float
        Of the rows, s.
    plans : sequence of Plan
    both : numpy.ndarray, shape (n, 1 + surrogates)
        Weighted residual, then those of the surrogates.
    weights : numpy.ndarray, shape (n,)
    friction : float
        Weighted rms of the friction.
    """
    weighted = columns * weights[:, None]
    removed, total = np.zeros(both.shape[1]), np.zeros(both.shape[1])
    rows = 0
    shown = np.zeros(len(both), dtype=bool)
    for plan in plans:
        own, held = weighted[plan.fit], both[plan.held]
        taps = np.asarray(np.linalg.lstsq(own.T @ own, own.T @ both[plan.fit], rcond=1e-9)[0])
        rows += len(held)
        shown |= plan.held
        total += np.sum(held**2, axis=0)
        removed += np.sum(held**2 - (held - weighted[plan.held] @ taps) ** 2, axis=0)
    shares = removed / np.maximum(total, 1e-300)
    # In units of effort for the eye: what goes with each lag by itself. The filter's own weights
    # lean on one another and say nothing one by one.
    alone = columns[shown] / np.sqrt(np.mean(columns[shown] ** 2, axis=0) + 1e-300)
    curves = alone.T @ (both[shown] / weights[shown, None]) / max(int(shown.sum()), 1)
    low, high = np.quantile(curves[:, 1:], [0.025, 0.975], axis=1)
    lags = np.array([lag for lag in range(-LAGS, LAGS + 1) if lag != 0])
    size = float(np.sqrt(max(removed[0], 0.0) / max(rows, 1))) / max(friction, 1e-300)
    at = lags * spacing
    share = float(shares[0])
    return View(RESPONSE, at, curves[:, 0], low, high, share, limit(shares[1:]), size)
