"""Whether what explains a residual is as strong in one part of the rows as in another."""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.ndimage import uniform_filter1d

from ..._support.arrays import FloatArray
from ..data.evidence import Evidence
from .regression import Base

__all__ = ["MOST_UNEVEN", "added_power", "by_pace"]

MOST_UNEVEN: Final = 0.3
"""What strengths of their own by part may add, as a share of a gain: with more what is looked at
imitates something else."""
COMMON: Final = 1e-2
"""Directions below this share of the strongest one are the strength that all parts have in common,
which is fitted already."""


def added_power(evidence: Evidence, beside: Base, residual: FloatArray, parts: FloatArray) -> float:
    """Power that strengths of their own of some parts take off the fitted rows beyond chance.

    Parameters
    ----------
    evidence : Evidence
    beside : Base
        What was fitted beside them.
    residual : numpy.ndarray, shape (n,)
    parts : numpy.ndarray, shape (n, k)
    """
    fit = evidence.fitted
    if parts.shape[1] < 2:
        return 0.0
    left, sizes, _ = np.linalg.svd(beside.off(parts[fit]), full_matrices=False)
    directions = left[:, sizes > COMMON * sizes[0]] if sizes[0] > 0.0 else left[:, :0]
    fitted = beside.off(residual[fit])
    pushed = directions.T @ fitted
    # Twice what is expected by chance: the sum is of few squares and scatters as much.
    return float(pushed @ pushed - 2.0 * _by_chance(evidence, directions, fitted))


def by_pace(evidence: Evidence, contributed: FloatArray) -> FloatArray:
    """A contribution in the mean of a kernel's rows, and what that leaves; shape (n, 2)."""
    rows = round(evidence.overlap)
    if rows < 2:
        return contributed[:, None]
    slow, recording = np.empty_like(contributed), evidence.cells.recording
    for each in np.unique(recording):
        own = contributed[recording == each]
        slow[recording == each] = uniform_filter1d(own, min(rows, len(own)), mode="nearest")
    return np.stack([slow, contributed - slow], axis=1)


def _by_chance(evidence: Evidence, directions: FloatArray, residual: FloatArray) -> float:
    """Power in some directions that residuals of this size have, blocks being independent."""
    block = evidence.cells.block[evidence.fitted]
    pushes = np.zeros((int(block.max()) + 1, directions.shape[1]))
    np.add.at(pushes, block, directions * residual[:, None])
    return float(np.sum(pushes**2))
