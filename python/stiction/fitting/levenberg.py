"""Levenberg-Marquardt within bounds, for many rows and few columns: that of the core."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from .._native import least_squares
from .._support.arrays import FloatArray
from .._support.workers import thread_count
from .slopes import Block

__all__ = [
    "FIRST_DAMPING",
    "Minimum",
    "Pull",
    "descend",
    "escape",
    "levenberg_marquardt",
    "normal_matrix",
]

FIRST_DAMPING: Final = 0.1
"""Damping to start with, in units of the scaled normal matrix's diagonal."""
WORTH_ESCAPING: Final = 1e-3
"""Share of the sum of squares for which a start from beyond a kink is worth while."""

Pull = tuple[int, float, float]
"""One more row, weight·(x − centre), that keeps a variable near a centre: place, centre, weight."""
Slopes = tuple[Sequence[Block], FloatArray | None]
"""Of each part of the residual, by what a model is stated in, and the derivative of that by the
variables, shape (p, p); None where both are the same."""


@dataclass(frozen=True)
class Minimum:
    """Where the iteration ended.

    Attributes
    ----------
    x : numpy.ndarray, shape (p,)
    cost : float
        Sum of squares.
    converged : bool
    fresh : bool
        Whether the slopes that were asked for last belong to ``x``, or to the point before a last
        step that gained less than the tolerance.
    """

    x: FloatArray
    cost: float
    converged: bool
    fresh: bool = False


def levenberg_marquardt(
    residual: Callable[[FloatArray], FloatArray],
    jacobian: Callable[[FloatArray], FloatArray],
    begin: FloatArray,
    bounds: tuple[FloatArray, FloatArray],
    scale: FloatArray,
    *,
    most: int,
    tolerance: float,
) -> Minimum:
    """Minimise Σr² within bounds, all rows in one part; see ``descend``.

    Parameters
    ----------
    residual, jacobian : callable
        Of x; shapes (n,) and (n, p).
    """
    every = list(range(len(begin)))

    def slopes(x: FloatArray) -> Slopes:
        return [(every, np.ascontiguousarray(jacobian(x).T))], None

    return descend(
        lambda x: [residual(x)], slopes, begin, bounds, scale, most=most, tolerance=tolerance
    )


def descend(
    residual: Callable[[FloatArray], Sequence[FloatArray]],
    slopes: Callable[[FloatArray], Slopes],
    begin: FloatArray,
    bounds: tuple[FloatArray, FloatArray],
    scale: FloatArray,
    *,
    pulls: Sequence[Pull] = (),
    most: int,
    tolerance: float,
    nothing: float = 0.0,
    straight: bool = False,
    damping: float = FIRST_DAMPING,
) -> Minimum:
    """Minimise Σr² within bounds.

    Parameters
    ----------
    residual, slopes : callable
        Of x: rows of each part, and their slopes.
    begin : numpy.ndarray, shape (p,)
    bounds : pair of numpy.ndarray, shape (p,)
    scale : numpy.ndarray, shape (p,)
        Typical size of each variable: a column without slope is measured by it.
    pulls : sequence of Pull
    most : int
        Evaluations of the residual at most.
    tolerance : float
        Relative change of cost, and of the step, below which nothing more is gained.
    nothing : float
        Sum of squares that rounding may leave: from there on it changes at random.
    straight : bool
        Whether the residual depends on x nearly in a straight line: then it may end on corrected
        slopes, too.
    damping : float
        To start with, in units of the scaled normal matrix's diagonal.
    """
    found = least_squares(
        residual,
        slopes,
        begin,
        *bounds,
        scale,
        pulls=list(pulls),
        most=most,
        tolerance=tolerance,
        nothing=nothing,
        straight=straight,
        damping=damping,
        threads=thread_count(),
    )
    return Minimum(*found)


def normal_matrix(slopes: Slopes, pulls: Sequence[Pull], size: int) -> FloatArray:
    """JᵀJ by so many variables, shape (size, size)."""
    blocks, chain = slopes
    found = np.zeros((size, size))
    for places, columns in blocks:
        found[np.ix_(places, places)] += columns @ columns.T
    if chain is not None:
        found = chain.T @ found @ chain
    for place, _, weight in pulls:
        found[place, place] += weight**2
    return found


def escape(
    power: Callable[[FloatArray], float],
    normal: FloatArray,
    found: Minimum,
    bounds: tuple[FloatArray, FloatArray],
) -> FloatArray | None:
    """A better point some way along the flattest directions, None where there is none.

    Samples that go over from stick to slip put a kink into the sum of squares, and an iteration
    that follows slopes ends at it. What lies beyond is looked at: steps along the directions in
    which the sum of squares rises least, as long as would raise it by a few per cent if there were
    no kink.

    Parameters
    ----------
    power : callable
        Sum of squares, of x.
    normal : numpy.ndarray, shape (p, p)
        JᵀJ at the minimum.
    found : Minimum
    bounds : pair of numpy.ndarray, shape (p,)
    """
    size = np.sqrt(np.diag(normal))
    size[size == 0.0] = np.inf
    curves, directions = np.linalg.eigh(normal / np.outer(size, size))
    best, cost = None, found.cost * (1.0 - WORTH_ESCAPING)
    for curve, direction in zip(curves, directions.T, strict=True):
        if curve <= 0.0:
            continue
        for share in (0.003, 0.03, 0.3):
            step = float(np.sqrt(share * found.cost / curve)) * direction / size
            for sign in (-1.0, 1.0):
                tried = np.clip(found.x + sign * step, *bounds)
                left = power(tried)
                if left < cost:
                    best, cost = tried, left
    return best
