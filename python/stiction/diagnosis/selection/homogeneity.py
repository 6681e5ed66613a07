"""Whether an effect is as strong in one kind of recording as in another."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..data.evidence import Evidence, Plan
from ..screening.model import Model
from ..screening.regression import project

__all__ = ["unevenness"]

SEEN: Final = 0.02
"""Kinds of recording in which an effect shows less than this share of itself say nothing of it."""
COMMON: Final = 1e-2
"""Directions below this share of the strongest one are the strength that all kinds have in common,
which is fitted already."""


def unevenness(base: Model, model: Model, contributed: FloatArray) -> float:
    """What a strength of its own in each kind of recording would add to an effect's gain.

    The cause of a residual has one strength everywhere; what only resembles it is stronger in one
    experiment and weaker, or of the other sign, in the next. The effect's contribution, kind by
    kind, is put beside everything that was fitted. From the power that this takes off the fitted
    rows is subtracted what residuals correlated within blocks of 1 s let expect of a true cause.

    Parameters
    ----------
    base, model : Model
        Without and with the effect.
    contributed : numpy.ndarray, shape (n,)
        What the effect explains of each row that may be looked at, weighted.

    Returns
    -------
    float
        As a share of what the effect itself takes off; 0 where there is one kind alone.
    """
    evidence = base.evidence
    fit = evidence.fitted
    gained = base.power - model.power
    parts = _by_kind(evidence, contributed)
    if parts.shape[1] < 2 or gained <= 0.0:
        return 0.0
    beside = project(model.columns, Plan(fit, fit))
    left, sizes, _ = np.linalg.svd(beside.off(parts[fit]), full_matrices=False)
    directions = left[:, sizes > COMMON * sizes[0]] if sizes[0] > 0.0 else left[:, :0]
    residual = beside.off(model.residual[fit])
    pushed = directions.T @ residual
    # Twice what is expected by chance: the sum is of few squares and scatters as much.
    return float(pushed @ pushed - 2.0 * _by_chance(evidence, directions, residual)) / gained


def _by_kind(evidence: Evidence, contributed: FloatArray) -> FloatArray:
    """The contribution in each kind in which it shows; shape (n, kinds)."""
    kind, fit = evidence.cells.kind, evidence.fitted
    power = np.bincount(kind[fit], contributed[fit] ** 2, len(evidence.cells.kinds))
    shown = np.flatnonzero(power > SEEN * power.sum())
    parts: FloatArray = np.where(kind[:, None] == shown, contributed[:, None], 0.0)
    return parts


def _by_chance(evidence: Evidence, directions: FloatArray, residual: FloatArray) -> float:
    """Power in some directions that residuals of this size have, blocks being independent."""
    block = evidence.cells.block[evidence.fitted]
    pushes = np.zeros((int(block.max()) + 1, directions.shape[1]))
    np.add.at(pushes, block, directions * residual[:, None])
    return float(np.sum(pushes**2))
