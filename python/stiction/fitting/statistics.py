"""Statistics of a fit whose residuals are correlated."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .quantiles import f_quantile, t_quantile

__all__ = [
    "CORRELATED_S",
    "correlations",
    "covariance",
    "differ",
    "echoes",
    "interval_width",
    "jackknife",
    "normal_inverse",
    "undetermined_directions",
]

CORRELATED_S: Final = 1.0
"""Residuals further apart than this are taken as independent."""
FEWEST_RECORDINGS: Final = 4
"""Fewer recordings say nothing of how parameters differ from one to the next."""
ALONE: Final = 1e-10
"""Directions with less than this share of the steepest curvature belong to one recording alone."""
ECHO: Final = 0.98
"""Derivatives that go with the size of the measured effort as closely as this repeat it."""
ECHO_TIMES: Final = 3.0
"""What of them no other parameter explains has to stand above the noise of the effort this far."""
SELF: Final = 0.05
"""What is less of the effort than this is nothing: the rest would be explained by the effort."""
PART: Final = 0.1
"""Share of a derivative, or of its own value, from which on a parameter has part in it."""
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
    bread, scale = normal_inverse(np.vstack(jacobians))
    parameters = len(scale)
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


def normal_inverse(matrix: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(JᵀJ)⁻¹ of columns divided by their norms, and these; without directions that are flat.

    Parameters
    ----------
    matrix : numpy.ndarray, shape (n, p)

    Returns
    -------
    numpy.ndarray, shape (p, p)
    numpy.ndarray, shape (p,)
        1 for a column that is 0.
    """
    scale = np.sqrt(np.sum(matrix**2, axis=0))
    scale[scale == 0.0] = 1.0
    scaled = matrix / scale
    return np.linalg.pinv(scaled.T @ scaled, rcond=FLAT**2, hermitian=True), scale


def jackknife(
    jacobians: Sequence[FloatArray], residuals: Sequence[FloatArray]
) -> FloatArray | None:
    """Covariance from how the parameters move when each recording is left out; shape (p, p).

    C = (R − 1)/R·Σ_r Δ_r·Δ_rᵀ, Δ_r = (JᵀJ − J_rᵀJ_r)⁻¹·J_rᵀ·r_r, one Gauss-Newton step (Miller,
    Biometrika 61 (1974)). What a law's curve misses is not noise that blocks of a second average
    out: it pulls one way through a whole experiment, and another way in the next. None where there
    are fewer than four recordings.

    Parameters
    ----------
    jacobians : sequence of numpy.ndarray, shape (n_i, p)
    residuals : sequence of numpy.ndarray, shape (n_i,)
        Of each recording, weighted alike.
    """
    number = len(jacobians)
    if number < FEWEST_RECORDINGS:
        return None
    scale = np.sqrt(sum(np.sum(j**2, axis=0) for j in jacobians))
    scale[scale == 0.0] = 1.0
    normals = [(j / scale).T @ (j / scale) for j in jacobians]
    whole = np.sum(normals, axis=0)
    moved = np.zeros((len(scale), len(scale)))
    for jacobian, residual, normal in zip(jacobians, residuals, normals, strict=True):
        bread = np.linalg.pinv(whole - normal, rcond=ALONE, hermitian=True)
        step = bread @ ((jacobian / scale).T @ residual)
        moved += np.outer(step, step)
    return np.asarray((number - 1) / number * moved / np.outer(scale, scale))


def interval_width(blocks: int) -> float:
    """Half the width of a 95 % interval in standard errors: Student's t with B − 1 degrees.

    B blocks are B independent pieces of evidence, however many rows they hold.
    """
    return t_quantile(max(1, blocks - 1), 0.975)


def differ(values: FloatArray, covariance: FloatArray, blocks: int) -> bool:
    """Whether values, taken together, differ from 0: outside their 95 % region.

    Hotelling's T² = vᵀC⁻¹v against q·ν/(ν − q + 1)·F(q, ν − q + 1), ν = B − 1 (Annals of
    Mathematical Statistics 2 (1931)). Of two that exchange for each other neither may be known, and
    still there may be no doubt that one of them is there. One value alone differs where
    its interval of `interval_width` leaves 0 out.
    """
    number, degrees = len(values), max(1, blocks - 1)
    if number == 0 or degrees < number or not np.all(np.isfinite(covariance)):
        return False
    size = np.sqrt(np.diag(covariance))
    if not np.all(size > 0.0):
        return False
    scaled = values / size
    inverse = np.linalg.pinv(covariance / np.outer(size, size), rcond=FLAT, hermitian=True)
    rest = degrees - number + 1
    bound = number * degrees / rest * f_quantile(number, rest, 0.95)
    return float(scaled @ inverse @ scaled) > bound


def correlations(covariance: FloatArray) -> FloatArray:
    """Correlation matrix; 0 where a parameter has no variance, or one that nothing tells."""
    size = np.sqrt(np.maximum(np.diag(covariance), 0.0))
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


def echoes(
    jacobians: Sequence[FloatArray],
    measured: Sequence[FloatArray],
    residuals: Sequence[FloatArray],
    values: FloatArray,
    paths: Sequence[str],
    shares_of_effort: Sequence[bool],
) -> list[list[str]]:
    """Groups in which friction per measured effort is not told from what the effort balances.

    Where friction is a share K of the effort that is measured, (1 − K)·u = J·a + F: with K the
    inertia and all other friction may scale together, and what is left scales with them: down to
    nothing at K = 1. Only what of u they do not explain tells K, and where that is the noise of u,
    K is not told, however many rows there are.

    Parameters
    ----------
    jacobians : sequence of numpy.ndarray, shape (n_i, p)
    measured, residuals : sequence of numpy.ndarray, shape (n_i,)
        Measured effort and what is left of it, weighted as the derivatives.
    values : numpy.ndarray, shape (p,)
    paths : sequence of str, length p
    shares_of_effort : sequence of bool, length p
        Which may be a share of the effort: pure numbers. The derivative by viscous friction goes
        with the effort as well where there is little else, and is well told.
    """
    matrix, effort = np.vstack(jacobians), np.concatenate(measured)
    rest = np.concatenate(residuals)
    sizes = np.sqrt(np.sum(matrix**2, axis=0))
    live = np.flatnonzero(sizes > 0.0).tolist()
    groups = []
    for k in live:
        if not shares_of_effort[k]:
            continue
        column, others = matrix[:, k], [j for j in live if j != k]
        # A body at rest holds whatever effort there is: no share shows there.
        moves = np.abs(column) > 1e-6 * np.max(np.abs(column))
        level = float(np.linalg.norm(effort[moves]))
        likeness = float(np.abs(column[moves]) @ np.abs(effort[moves]))
        if not others or likeness <= ECHO * sizes[k] * level:
            continue
        noise = float(np.linalg.norm(rest[moves])) / level
        scaled = matrix[:, others] / sizes[others]
        shares, *_ = np.linalg.lstsq(scaled, column, rcond=FLAT)
        # What of the effort is not taken as a share of itself.
        kept = abs(1.0 - abs(float(values[k])) * sizes[k] / level)
        left = float(np.linalg.norm(column - scaled @ shares)) / sizes[k]
        if kept < SELF:
            groups.append([paths[j] for j in sorted([k, *others])])
        elif left < ECHO_TIMES * noise / kept:
            # Inertia may scale along and yet give a small part of the effort.
            own = np.abs(shares) / sizes[others] > PART * np.abs(values[others])
            large = (np.abs(shares) > PART * sizes[k]) | (own & (values[others] != 0.0))
            part = [j for j, belongs in zip(others, large, strict=True) if belongs]
            groups.append([paths[j] for j in sorted([k, *part])])
    return groups
