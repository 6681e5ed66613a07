"""Statistics of a fit whose residuals are correlated."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ..trajectory import FloatArray

__all__ = [
    "CORRELATED_S",
    "correlations",
    "covariance",
    "interval_width",
    "undetermined_directions",
]

CORRELATED_S: Final = 1.0
"""Residuals further apart than this are taken as independent."""
FLAT: Final = 1e-5
"""A direction with less than this share of the steepest one's slope is not determined."""


def covariance(
    jacobians: Sequence[FloatArray], residuals: Sequence[FloatArray], rows_per_block: Sequence[int]
) -> tuple[FloatArray, int]:
    """Covariance of the parameters that allows for residuals correlated within blocks, and B.

    C = (JᵀJ)⁻¹·(Σ_b g_b·g_bᵀ)·(JᵀJ)⁻¹·B/(B − 1), g_b = J_bᵀ·r_b over block b of B: the sandwich
    of White (1980) over blocks. White residuals would give the usual s²·(JᵀJ)⁻¹.

    Parameters
    ----------
    jacobians : sequence of numpy.ndarray, shape (n_i, p)
    residuals : sequence of numpy.ndarray, shape (n_i,)
        Of each recording, weighted alike.
    rows_per_block : sequence of int
        Rows that make a block of each recording.
    """
    matrix = np.vstack(jacobians)
    parameters = matrix.shape[1]
    scale = np.sqrt(np.sum(matrix**2, axis=0))
    scale[scale == 0.0] = 1.0
    bread = np.linalg.pinv((matrix / scale).T @ (matrix / scale), rcond=FLAT**2, hermitian=True)
    meat = np.zeros((parameters, parameters))
    blocks = 0
    for jacobian, residual, rows in zip(jacobians, residuals, rows_per_block, strict=True):
        for start in range(0, len(residual), rows):
            part = slice(start, start + rows)
            gradient = (jacobian[part] / scale).T @ residual[part]
            meat += np.outer(gradient, gradient)
            blocks += 1
    few = blocks / (blocks - 1) if blocks > 1 else np.inf
    return np.asarray(bread @ meat @ bread * few / np.outer(scale, scale)), blocks


def interval_width(blocks: int) -> float:
    """Half the width of a 95 % interval in standard errors: Student's t with B − 1 degrees.

    B blocks are B independent pieces of evidence, however many rows they hold.
    """
    from scipy.special import stdtrit

    return float(stdtrit(max(1, blocks - 1), 0.975))


def correlations(covariance: FloatArray) -> FloatArray:
    """Correlation matrix; 0 where a parameter has no variance, or one that nothing tells."""
    size = np.sqrt(np.diag(covariance))
    size[(size == 0.0) | ~np.isfinite(size)] = np.inf
    known = np.where(np.isfinite(covariance), covariance, 0.0)
    return np.asarray(known / np.outer(size, size))


def undetermined_directions(
    jacobians: Sequence[FloatArray], paths: Sequence[str]
) -> list[list[str]]:
    """Groups of parameters of which the data determine fewer combinations than there are."""
    matrix = np.vstack(jacobians)
    scale = np.sqrt(np.sum(matrix**2, axis=0))
    dead = [[path] for path, size in zip(paths, scale, strict=True) if size == 0.0]
    live = np.flatnonzero(scale > 0.0)
    if len(live) == 0:
        return dead
    _, slopes, directions = np.linalg.svd(matrix[:, live] / scale[live], full_matrices=False)
    groups = []
    for slope, direction in zip(slopes, directions, strict=True):
        if slope < FLAT * slopes[0]:
            largest = np.max(np.abs(direction))
            members = live[np.abs(direction) > 0.1 * largest]
            groups.append([paths[k] for k in members])
    return dead + groups
