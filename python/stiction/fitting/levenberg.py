"""Levenberg-Marquardt within bounds, for many rows and few columns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from .._support.arrays import FloatArray

__all__ = ["FIRST_DAMPING", "Minimum", "escape", "levenberg_marquardt"]

FIRST_DAMPING: Final = 0.1
"""Damping to start with, in units of the scaled normal matrix's diagonal."""
WORTH_ESCAPING: Final = 1e-3
"""Share of the sum of squares for which a start from beyond a kink is worth while."""
LEAST_DAMPING, MOST_DAMPING = 1e-12, 1e12
DEAD: Final = 1e-12
"""A variable whose slope is this share of the steepest one is left where it is."""
KEPT: Final = (0.25, 2.0)
"""Share of what a step promised that it must gain for its slopes to be corrected and used once
more: a residual costs a tenth of its slopes."""
MOST_USES: Final = 8
"""Steps that one set of slopes is used for."""


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
        Whether the Jacobian that was asked for last belongs to ``x``, or to the point before a last
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
    nothing: float = 0.0,
    straight: bool = False,
    damping: float = FIRST_DAMPING,
) -> Minimum:
    """Minimise Σr² within bounds.

    The normal matrix is formed at once (n·p² operations against the decomposition of all rows,
    which costs ten times that) with columns scaled by their norms; what stands at a bound and is
    pushed against it is held, the step of the others is cut at theirs.

    Parameters
    ----------
    residual, jacobian : callable
        Of x; shapes (n,) and (n, p).
    begin : numpy.ndarray, shape (p,)
    bounds : pair of numpy.ndarray, shape (p,)
    scale : numpy.ndarray, shape (p,)
        Typical size of each variable: a column without slope is measured by it.
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

    Notes
    -----
    Slopes are corrected by what each step shows of them and used again (Broyden, Math. Comp. 19
    (1965)) as long as steps keep what they promise; only where the residual is ``straight`` it ends
    on such a step. Damping after Nielsen, Damping parameter in Marquardt's method,
    IMM-REP-1999-05.
    """
    low, high = bounds
    x = np.clip(begin, low, high)
    left = residual(x)
    cost = float(left @ left)
    spent = 1
    growth = 2.0
    largest = np.zeros(len(x))
    slopes, normal, uses = np.empty(0), np.empty(0), MOST_USES
    while True:
        if uses >= MOST_USES:
            if spent >= most and cost > nothing:
                # Slopes of which no step may be tried.
                return Minimum(x, cost, False)
            slopes, uses = jacobian(x), 0
            normal = slopes.T @ slopes
        uses += 1
        gradient = slopes.T @ left
        # Scales only grow (Moré 1978): a slope that fades must not make a step run away.
        largest = np.maximum(largest, np.sqrt(np.maximum(np.diag(normal), 0.0)))
        telling = largest * scale
        dead = telling <= DEAD * np.max(telling)
        size = np.where(dead, 1.0 / scale, largest)
        held = dead | ((x <= low) & (gradient > 0.0)) | ((x >= high) & (gradient < 0.0))
        free = np.flatnonzero(~held)
        if cost <= nothing or (len(free) == 0 and uses == 1):
            return Minimum(x, cost, True, uses == 1)
        if len(free) == 0:
            uses = MOST_USES
            continue
        while True:
            if spent >= most:
                return Minimum(x, cost, False)
            step = _step(normal, gradient, size, free, damping)
            tried = np.clip(x + step, low, high)
            moved = tried - x
            promised = _promised(gradient, normal, moved)
            if np.all(np.abs(moved) <= tolerance * (np.abs(x) + tolerance * scale)):
                if uses > 1:
                    uses = MOST_USES
                    break
                return Minimum(x, cost, True, True)
            if uses > 1 and promised <= tolerance * cost:
                if straight:
                    return Minimum(x, cost, True)
                uses = MOST_USES
                break
            after = residual(tried)
            spent += 1
            power = float(after @ after)
            if power < cost:
                gained = (cost - power) / promised if promised > 0.0 else 0.0
                damping *= max(1.0 / 3.0, 1.0 - (2.0 * min(gained, 1.0) - 1.0) ** 3)
                damping, growth = max(damping, LEAST_DAMPING), 2.0
                flat = cost - power <= tolerance * cost
                change = after - left
                x, left, cost = tried, after, power
                if flat and (uses == 1 or straight):
                    return Minimum(x, cost, True, uses == 1)
                if flat or not KEPT[0] < gained < KEPT[1]:
                    uses = MOST_USES
                elif uses < MOST_USES:
                    slopes, normal = _corrected(slopes, normal, change, moved, size)
                break
            if uses > 1:
                # Slopes of another point: look again before the damping is raised.
                uses = MOST_USES
                break
            # What a step cut at a bound promises says nothing of how much there is to gain.
            if _promised(gradient, normal, step) <= tolerance * cost:
                return Minimum(x, cost, True, True)
            damping, growth = damping * growth, 2.0 * growth
            if damping > MOST_DAMPING:
                return Minimum(x, cost, True, True)


def _corrected(
    slopes: FloatArray, normal: FloatArray, change: FloatArray, moved: FloatArray, size: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Slopes and normal matrix that explain what the last step changed; else as they were.

    The least change that does so, steps measured in units of ``1/size``.
    """
    along = size**2 * moved
    missed = (change - slopes @ moved) / float(along @ moved)
    cross = np.outer(slopes.T @ missed, along)
    normal = normal + cross + cross.T + float(missed @ missed) * np.outer(along, along)
    return slopes + np.outer(missed, along), normal


def escape(
    residual: Callable[[FloatArray], FloatArray],
    jacobian: Callable[[FloatArray], FloatArray],
    found: Minimum,
    bounds: tuple[FloatArray, FloatArray],
) -> FloatArray | None:
    """A better point some way along the flattest directions, None where there is none.

    Samples that go over from stick to slip put a kink into the sum of squares, and an iteration
    that follows slopes ends at it. What lies beyond is looked at: steps along the directions in
    which the sum of squares rises least, as long as would raise it by a few per cent if there were
    no kink.
    """
    slopes = jacobian(found.x)
    size = np.sqrt(np.sum(slopes**2, axis=0))
    size[size == 0.0] = np.inf
    curves, directions = np.linalg.eigh((slopes / size).T @ (slopes / size))
    best, cost = None, found.cost * (1.0 - WORTH_ESCAPING)
    for curve, direction in zip(curves, directions.T, strict=True):
        if curve <= 0.0:
            continue
        for share in (0.003, 0.03, 0.3):
            step = float(np.sqrt(share * found.cost / curve)) * direction / size
            for sign in (-1.0, 1.0):
                tried = np.clip(found.x + sign * step, *bounds)
                left = residual(tried)
                power = float(left @ left)
                if power < cost:
                    best, cost = tried, power
    return best


def _promised(gradient: FloatArray, normal: FloatArray, step: FloatArray) -> float:
    """What a step would take off the sum of squares if the residual were linear."""
    return -float(2.0 * gradient @ step + step @ normal @ step)


def _step(
    normal: FloatArray, gradient: FloatArray, size: FloatArray, free: np.ndarray, damping: float
) -> FloatArray:
    """The damped step of the free variables; 0 for the others."""
    scaled = normal[np.ix_(free, free)] / np.outer(size[free], size[free])
    scaled[np.diag_indices(len(free))] += damping
    step = np.zeros(len(gradient))
    step[free] = -np.linalg.solve(scaled, gradient[free] / size[free]) / size[free]
    return step
