"""Inertial parameters of links that can exist, by the log-Cholesky form of their pseudo-inertia.

Rucker & Wensing, Smooth parameterization of rigid-body inertia, IEEE RA-L 7 (2022), 2771-2778: any
ten numbers are a body with a mass above 0 and a density that is nowhere below 0.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from .._support.arrays import FloatArray

__all__ = ["consistent", "exist", "feasible"]

PER_LINK: Final = 10
LEAST: Final = 1e-9
"""Share of its trace that each eigenvalue of a pseudo-inertia is given at least: a link that the
description states as a point has no logarithm."""
TOLERANCE: Final = 1e-8
MOST_EVALUATIONS: Final = 60
PRIOR: Final = 1e-3
"""Weight of the description beside the data, in units of the noise: it settles what these leave
open and moves nothing else."""


def pseudo_inertia(link: FloatArray) -> FloatArray:
    """The pseudo-inertia of a link, shape (4, 4), from its ten parameters."""
    m, cx, cy, cz, xx, xy, yy, xz, yz, zz = link
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    second = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    first = np.array([cx, cy, cz])
    return np.block([[second, first[:, None]], [first[None, :], np.array([[m]])]])


def exist(parameters: FloatArray) -> list[bool]:
    """Whether each link can exist: a mass above 0, and a density nowhere below 0.

    Parameters
    ----------
    parameters : numpy.ndarray, shape (links · 10,)
    """
    return [
        bool(np.linalg.eigvalsh(pseudo_inertia(link)).min() > 0.0)
        for link in parameters.reshape(-1, PER_LINK)
    ]


def feasible(parameters: FloatArray) -> FloatArray:
    """The nearest links that can exist: eigenvalues that are too small are raised."""
    found = []
    for link in parameters.reshape(-1, PER_LINK):
        values, vectors = np.linalg.eigh(pseudo_inertia(link))
        least = max(LEAST * float(np.abs(values).sum()), LEAST)
        found.append(_parameters((vectors * np.maximum(values, least)) @ vectors.T))
    return np.concatenate(found)


def consistent(
    left: FloatArray, right: FloatArray, begin: FloatArray, squares: int
) -> tuple[FloatArray, float]:
    """The links that can exist with the least squares of left·x − right.

    Parameters
    ----------
    left : numpy.ndarray, shape (n, p)
        Weighted by the noise, the columns of the links first, then those of ``squares`` numbers
        from 0, then any others.
    right : numpy.ndarray, shape (n,)
    begin : numpy.ndarray, shape (p,)
        Where to begin: feasible.
    squares : int
        Numbers that are not below 0 (inertias of rotors).

    Returns
    -------
    numpy.ndarray, shape (p,)
    float
        Sum of squares.
    """
    from scipy.optimize import least_squares

    links = (len(begin) - squares) // PER_LINK * PER_LINK
    at = np.concatenate([_logarithms(begin[:links]), np.sqrt(begin[links:])])
    prior = PRIOR * np.ones(links)

    def value(point: FloatArray) -> FloatArray:
        missed = left @ _at(point, links)[0] - right
        held: FloatArray = np.concatenate([missed, prior * (point - at)[:links]])
        return held

    def slope(point: FloatArray) -> FloatArray:
        own = left @ _at(point, links)[1]
        held: FloatArray = np.vstack([own, np.eye(links, len(point)) * PRIOR])
        return held

    # A step too far is refused by its cost, infinite as it may be.
    with np.errstate(over="ignore", invalid="ignore"):
        found = least_squares(value, at, slope, max_nfev=MOST_EVALUATIONS, x_scale="jac")
    best = _at(found.x, links)[0]
    missed = left @ best - right
    return best, float(missed @ missed)


def _at(point: FloatArray, links: int) -> tuple[FloatArray, FloatArray]:
    """Parameters at a point, and their Jacobian."""
    values, jacobian = [], np.zeros((len(point), len(point)))
    for k in range(0, links, PER_LINK):
        own, slopes = _link(point[k : k + PER_LINK])
        values.append(own)
        jacobian[k : k + PER_LINK, k : k + PER_LINK] = slopes
    rest = point[links:]
    jacobian[links:, links:] = np.diag(2.0 * rest)
    return np.concatenate([*values, rest**2]), jacobian


_PLACES: Final = tuple((i, j) for i in range(4) for j in range(i + 1))


def _link(point: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A link from its ten numbers: L·Lᵀ with exp on the diagonal of L; and the slopes."""
    lower = np.zeros((4, 4))
    for value, (i, j) in zip(point, _PLACES, strict=True):
        lower[i, j] = np.exp(value) if i == j else value
    slopes = np.empty((PER_LINK, PER_LINK))
    for k, (i, j) in enumerate(_PLACES):
        moved = np.zeros((4, 4))
        moved[i, j] = lower[i, j] if i == j else 1.0
        changed = moved @ lower.T
        slopes[:, k] = _parameters(changed + changed.T)
    return _parameters(lower @ lower.T), slopes


def _logarithms(parameters: FloatArray) -> FloatArray:
    found = []
    for link in parameters.reshape(-1, PER_LINK):
        lower = np.linalg.cholesky(pseudo_inertia(link))
        found.append([np.log(lower[i, j]) if i == j else lower[i, j] for i, j in _PLACES])
    return np.concatenate(found)


def _parameters(pseudo: Any) -> FloatArray:
    """Ten parameters from a pseudo-inertia."""
    second, first, mass = pseudo[:3, :3], pseudo[:3, 3], pseudo[3, 3]
    inertia = np.trace(second) * np.eye(3) - second
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia
    return np.array([mass, *first, xx, xy, yy, xz, yz, zz])
