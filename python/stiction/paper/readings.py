"""What an encoder's readings say of the position: it lies within half a count of one of them.

Where noise is small against a count, slow motion reads as stairs, and least squares take the stairs
for motion. Taken as intervals readings have no such bias: the likelihood of one is that the
position, with the noise before rounding, lies within its count.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from .._support.arrays import FloatArray

__all__ = ["Evidence", "count_of", "evidence", "noise_of"]

_WHOLE: Final = 1e-6
"""How far readings may be from whole counts, in counts."""
_FEWEST: Final = 3  # different readings from which on a count is told
_LEAST_NOISE: Final = 0.05
"""Noise is taken as no less, in counts: no simulation is right to the last digit."""
_FAR: Final = 1e3  # standard deviations
_MOST_NOISE: Final = 100.0  # counts


@dataclass(frozen=True)
class Evidence:
    """Readings against simulated positions.

    Attributes
    ----------
    cost : float
        −2 times the logarithm of the likelihood, up to a constant.
    pull : numpy.ndarray
        Derivatives of half the cost by the simulated positions over the roots of `weight`.
    root_weight : numpy.ndarray
        Roots of the second derivatives of half the cost.
    """

    cost: float
    pull: FloatArray
    root_weight: FloatArray


def count_of(position: FloatArray) -> float:
    """The count that all readings are whole numbers of; 0 where there is none."""
    levels = np.unique(position)
    if not _FEWEST <= levels.size < position.size:
        return 0.0
    steps = np.diff(levels)
    # Readings that differ by round-off are the same.
    steps = steps[steps > _WHOLE * np.max(steps)]
    count = float(np.min(steps))
    whole = steps / count
    # Of many steps the count is known better than of one.
    if np.max(np.abs(whole - np.round(whole))) < 1e-3:
        count = float(np.sum(steps) / np.sum(np.round(whole)))
    places = position / count
    off = places - places[0]
    return count if np.max(np.abs(off - np.round(off))) < _WHOLE * max(1, levels.size) else 0.0


def evidence(missed: FloatArray, counts: FloatArray, noise: float) -> Evidence:
    """What readings say of simulated positions that miss them by so much.

    Parameters
    ----------
    missed : numpy.ndarray, shape (n,)
        Simulated position less reading.
    counts : numpy.ndarray, shape (n,)
        Count of each reading, 0 where it is not rounded.
    noise : float
        Standard deviation of what is added before rounding.

    Returns
    -------
    Evidence
    """
    pull, root = missed / noise, np.full(missed.shape, 1.0 / noise)
    rounded = counts > 0.0
    cost = float(np.sum(pull[~rounded] ** 2)) + 2.0 * missed.size * math.log(noise)
    if not rounded.any():
        return Evidence(cost, pull, root)
    own = np.asarray(np.abs(pull[rounded]), dtype=np.float64)
    half = 0.5 * counts[rounded] / noise
    # By symmetry the position lies at or above the middle of its count: the near edge is `low`.
    low, high = own - half, own + half
    log_share = _log_between(low, high)
    at_low, at_high = (np.exp(_log_density(edge) - log_share) for edge in (low, high))
    score = at_low - at_high
    curved = score**2 + high * at_high - low * at_low
    # Round-off where the position lies deep inside of its count, or far outside of it.
    curved = np.where(low > _FAR, 1.0, np.clip(curved, 1e-12, 1.0))
    pull[rounded] = np.sign(missed[rounded]) * score / np.sqrt(curved)
    root[rounded] = np.sqrt(curved) / noise
    # Of a rounded reading the share within its count is the likelihood itself.
    cost += float(-2.0 * np.sum(log_share)) - 2.0 * int(rounded.sum()) * math.log(noise)
    return Evidence(cost, pull, root)


def noise_of(missed: FloatArray, counts: FloatArray) -> float:
    """The noise before rounding under which these misses are likeliest."""
    from scipy.optimize import minimize_scalar

    plain = float(np.sqrt(np.mean(missed**2))) or 1.0
    count = float(np.max(counts))
    if count == 0.0:
        return plain
    found = minimize_scalar(
        lambda x: evidence(missed, counts, math.exp(x)).cost,
        bounds=(math.log(_LEAST_NOISE * count), math.log(max(_MOST_NOISE * count, plain))),
        method="bounded",
        options={"xatol": 1e-3},
    )
    return math.exp(float(found.x))


def _log_density(z: FloatArray) -> FloatArray:
    return np.asarray(-0.5 * z * z - 0.5 * math.log(2.0 * math.pi))


def _log_between(low: FloatArray, high: FloatArray) -> FloatArray:
    """Logarithm of what of a normal distribution lies between two numbers."""
    from scipy.special import log_ndtr

    # From the side on which the tails are small.
    upper, lower = log_ndtr(-low), log_ndtr(-high)
    gap = np.minimum(lower - upper, -1e-300)
    return np.asarray(upper + np.log(-np.expm1(gap)))
