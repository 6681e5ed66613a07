"""Means over stretches of a coordinate: drawn, and judged on rows held out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..._support.arrays import FloatArray
from ...fitting.rows import Mask
from ..data.evidence import Evidence
from .coordinates import Coordinate, Look
from .view import FEWEST_ROWS, View, limit, means, sums

__all__ = ["BINS", "SLOW_BINS", "smoother", "stack_rows"]

BINS: Final = 24
"""Stretches of a coordinate, each with as many rows."""
FINE_BINS: Final = 72
"""And of one in which a narrow place may matter: a patch of a turn is some tenths of a radian."""
TAILS: Final = (0.25, 0.5)
"""Shares of the first and of the last stretch at which they are parted where what lies far out
matters: inertia takes up what goes with most accelerations, and the rare ones tell."""
SLOW_BINS: Final = 6
"""Stretches of the session clock where recordings have roles of their own: each stretch must hold
some that are fitted and some that are not."""

TURNS: Final = 40
"""Times that recordings are turned round for the threshold of a slow coordinate."""
TURNED_QUANTILE: Final = 0.95
"""Of the shares that this gives: a drift that is there keeps its share in few of them."""
AT_ONCE: Final = 8
"""Columns that are looked at together: of many rows more would take memory by the hundred MB."""
ROWS: Final = 150
"""A stretch holds about this many rows at least, where few have a place in a coordinate..."""
FEWEST_BINS: Final = 6
"""... but so many stretches there are."""

_Value = TypeVar("_Value", np.float64, np.bool_)


def stack_rows(evidence: Evidence, values: Sequence[NDArray[_Value]]) -> NDArray[_Value]:
    """Values of each recording shown, one under the other, without the rows that do not count."""
    masks = [rows.mask for rows in evidence.shown]
    return np.concatenate([v[m] for v, m in zip(values, masks, strict=True)])


def smoother(
    coordinate: Coordinate,
    evidence: Evidence,
    seen: Sequence[Look],
    both: FloatArray,
    friction: float,
    edges: FloatArray | None = None,
    *,
    within: bool = False,
) -> View:
    """The residual over one coordinate.

    Parameters
    ----------
    coordinate : Coordinate
    evidence : Evidence
    seen : sequence of Look
        Of each recording in ``evidence.shown``.
    both : numpy.ndarray, shape (n, 1 + surrogates)
        Weighted residual, then those of the surrogates.
    friction : float
        Weighted rms of the friction.
    edges : numpy.ndarray, optional
        Where stretches end; without it each holds as many rows, but for those in long tails.
    within : bool
        The share is that of the power in rows that have a place in the coordinate.
    """
    values = stack_rows(evidence, [coordinate.values(look) for look in seen])
    parts = [both[:, k : k + AT_ONCE] for k in range(0, both.shape[1], AT_ONCE)]
    sign = None
    if coordinate.odd:
        sign = stack_rows(evidence, [look.direction for look in seen])[:, None]
    factor = np.ones(len(values))
    if coordinate.factor is not None:
        factor = stack_rows(evidence, [coordinate.factor(look) for look in seen])
    # Rows that have no place in this coordinate lie in a last stretch, of which nothing is taken.
    placed = np.isfinite(values)
    index, bins = _stretches(coordinate, evidence, values, placed, edges)
    shown = np.zeros(len(index), dtype=bool)
    for plan in evidence.plans:
        shown |= plan.held
    rows = sum(int(plan.held.sum()) for plan in evidence.plans)
    powers, curves = [], []
    for part in parts:
        own = part if sign is None else part * sign
        powers.append(_removed(own, index, bins, factor, evidence, placed if within else None))
        # In units of effort for the eye: what was weighted is put back.
        own = own[shown]
        own /= evidence.weights[shown, None]
        curves.append(_slopes(index[shown], own, factor[shown], bins))
    removed, total = (np.concatenate(each) for each in zip(*powers, strict=True))
    shares = removed / np.maximum(total, 1e-300)
    threshold = limit(shares[1:])
    if _is_slow(coordinate, evidence):
        residual = both[:, 0] if sign is None else both[:, 0] * sign[:, 0]
        turned = [
            _removed(own, index, bins, factor, evidence, placed if within else None)
            for own in _turned(evidence, residual)
        ]
        reached = np.concatenate([taken / np.maximum(of, 1e-300) for taken, of in turned])
        threshold = max(threshold, float(np.quantile(reached, TURNED_QUANTILE)))
    full = np.flatnonzero(np.bincount(index[shown], minlength=bins + 1)[:bins] >= FEWEST_ROWS)
    curve = np.hstack(curves)[full]
    low, high = np.quantile(curve[:, 1:], [0.025, 0.975], axis=1)
    centres = [float(np.median(values[index == k])) for k in full]
    return View(
        coordinate,
        np.array(centres),
        curve[:, 0],
        low,
        high,
        float(shares[0]),
        threshold,
        float(np.sqrt(max(removed[0], 0.0) / max(rows, 1))) / max(friction, 1e-300),
    )


def _removed(
    columns: FloatArray,
    index: np.ndarray,
    bins: int,
    factor: FloatArray,
    evidence: Evidence,
    within: Mask | None,
) -> tuple[FloatArray, FloatArray]:
    """Power that means over stretches take off held rows, of each column, and what there was.

    There was as much as in rows ``within``; in all of them without it.
    """
    removed, total = np.zeros(columns.shape[1]), np.zeros(columns.shape[1])
    for plan in evidence.plans:
        curve = _slopes(index[plan.fit], columns[plan.fit], factor[plan.fit], bins)
        held = columns[plan.held]
        counted = held if within is None else held[within[plan.held]]
        total += np.sum(counted**2, axis=0)
        # Σr² − Σ(r − f·c)² from sums over stretches alone.
        own, place = factor[plan.held], index[plan.held]
        held *= own[:, None]
        pushed = sums(place, held, bins + 1)[:bins]
        power = np.bincount(place, own**2, bins + 1)[:bins, None]
        removed += np.sum(curve[:bins] * (2.0 * pushed - curve[:bins] * power), axis=0)
    return removed, total


def _is_slow(coordinate: Coordinate, evidence: Evidence) -> bool:
    return coordinate.slow and len(evidence.shown) > 1


def _turned(evidence: Evidence, residual: FloatArray) -> Iterator[FloatArray]:
    """The residual with the sign of each recording drawn anew, a number of times; some at a time.

    A stretch of the session holds a few recordings. What a law's curve misses pulls one way through
    each of them, and by chance the same way in neighbours: no drift, and no surrogate has it.
    """
    signs = np.random.default_rng(TURNS).choice([-1.0, 1.0], (len(evidence.recordings), TURNS))
    for k in range(0, TURNS, AT_ONCE):
        yield residual[:, None] * signs[evidence.cells.recording, k : k + AT_ONCE]


def _stretches(
    coordinate: Coordinate,
    evidence: Evidence,
    values: FloatArray,
    placed: np.ndarray,
    edges: FloatArray | None,
) -> tuple[np.ndarray, int]:
    """Stretch of each row, ``bins`` where it has no place, and how many stretches there are."""
    known = values[placed]
    if edges is None:
        slow = _is_slow(coordinate, evidence)
        most = FINE_BINS if coordinate.fine else BINS
        number = SLOW_BINS if slow else min(most, max(len(known) // ROWS, FEWEST_BINS))
        inner = np.linspace(0.0, 1.0, number + 1)[1:-1]
        if coordinate.tails:
            ends = inner[0] * np.array(TAILS)
            inner = np.concatenate([ends, inner, 1.0 - ends[::-1]])
        edges = np.unique(np.quantile(known, inner)) if len(known) else np.zeros(0)
    # Stretches that hold nothing, between equal values, are left out.
    full, place = np.unique(np.searchsorted(edges, known), return_inverse=True)
    index = np.full(len(values), len(full), dtype=np.int64)
    index[placed] = place
    return index, len(full)


def _slopes(index: np.ndarray, columns: FloatArray, factor: FloatArray, bins: int) -> FloatArray:
    """What each column is of the factor in each stretch; the mean where the factor is 1.

    The row behind the last stretch, of what has no place, is 0.
    """
    if np.all(factor == 1.0):
        found = means(index, columns, bins + 1)
    else:
        power = np.bincount(index, factor**2, bins + 1)
        counts = np.bincount(index, minlength=bins + 1)
        pushed = means(index, columns * factor[:, None], bins + 1) * counts[:, None]
        found = np.where(counts[:, None] >= FEWEST_ROWS, pushed, 0.0)
        found = found / np.maximum(power, 1e-300)[:, None]
    found[bins] = 0.0
    return found
