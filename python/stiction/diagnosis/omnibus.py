"""What is left: the residual in every coordinate, judged on rows held out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..trajectory import FloatArray
from .coordinates import COORDINATES, Coordinate, Look
from .evidence import Evidence, Plan
from .periodic import COUPLED, ORDERS, frequency_view, order_view, waves_of
from .response import response_columns, response_view
from .view import LEAST_SIZE, View, limit, means

__all__ = ["Rest", "View", "rest"]

BINS: Final = 24
"""Stretches of a coordinate, each with as many rows."""
SLOW_BINS: Final = 6
"""Stretches of the session clock where recordings have roles of their own: each stretch must hold
some that are fitted and some that are not."""


@dataclass(frozen=True)
class Rest:
    """What a model leaves, in every coordinate, largest share first."""

    views: tuple[View, ...]

    def flagged(self, least: float = LEAST_SIZE) -> tuple[View, ...]:
        """Coordinates in which more is left than noise explains, from a size on."""
        return tuple(view for view in self.views if view.flagged(least))


def rest(
    evidence: Evidence,
    seen: Sequence[Look],
    orders: Sequence[float],
    residual: FloatArray,
    null: FloatArray,
    friction: float,
) -> Rest:
    """Looks at a residual in every coordinate.

    A smoother is the mean over stretches of a coordinate, taken from the fitted rows of each plan
    and judged on those held out.

    Parameters
    ----------
    evidence : Evidence
    seen : sequence of Look
        Of each recording in ``evidence.shown``.
    orders : sequence of float
        Periods over position that the range of motion can show, 1/rad or 1/m.
    residual : numpy.ndarray, shape (n,)
    null : numpy.ndarray, shape (n, surrogates)
    friction : float
        Weighted rms of the friction, against which sizes are measured.
    """
    masks = [rows.mask for rows in evidence.shown]

    def stacked(values: Sequence[FloatArray]) -> FloatArray:
        return np.concatenate([v[m] for v, m in zip(values, masks, strict=True)])

    direction = stacked([look.direction for look in seen])
    position = stacked([look.position for look in seen])
    both = np.column_stack([residual, null])
    waves = waves_of(orders, position)
    views: list[View] = []
    for coordinate in COORDINATES:
        values = stacked([coordinate.values(look) for look in seen])
        slow = coordinate.slow and len(evidence.shown) > 1
        views.append(
            _view(
                coordinate,
                evidence,
                values,
                both * (direction[:, None] if coordinate.odd else 1.0),
                friction,
                SLOW_BINS if slow else BINS,
            )
        )
    views += [
        order_view(
            coordinate,
            orders,
            waves,
            evidence.plans,
            both * (direction[:, None] if coordinate.odd else 1.0),
            evidence.weights,
            friction,
        )
        for coordinate in ORDERS
    ]
    views += [
        order_view(
            coordinate,
            orders,
            waves,
            evidence.plans,
            both,
            evidence.weights,
            friction,
            stacked([coordinate.values(look) for look in seen]),
        )
        for coordinate in COUPLED
    ]
    form = evidence.shown[0].form
    spacing = form.dt * form.stride
    moved = np.concatenate(
        [response_columns(look)[mask] for look, mask in zip(seen, masks, strict=True)]
    )
    views.append(response_view(moved, spacing, evidence.plans, both, evidence.weights, friction))
    lines = frequency_view(evidence.cells, spacing, both, evidence.weights, friction)
    if lines is not None:
        views.append(lines)
    return Rest(tuple(sorted(views, key=lambda view: -view.share)))


def _view(
    coordinate: Coordinate,
    evidence: Evidence,
    values: FloatArray,
    both: FloatArray,
    friction: float,
    number: int,
) -> View:
    """A smoother over one coordinate."""
    plans: Sequence[Plan] = evidence.plans
    edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, number + 1)[1:-1]))
    # Stretches that hold nothing, between equal values, are left out.
    _, index = np.unique(np.searchsorted(edges, values), return_inverse=True)
    bins = int(index.max()) + 1
    removed, total = np.zeros(both.shape[1]), np.zeros(both.shape[1])
    rows = 0
    for plan in plans:
        curve = means(index[plan.fit], both[plan.fit], bins)
        held = both[plan.held]
        rows += len(held)
        total += np.sum(held**2, axis=0)
        removed += np.sum(held**2 - (held - curve[index[plan.held]]) ** 2, axis=0)
    shares = removed / np.maximum(total, 1e-300)
    # In units of effort for the eye: what was weighted is put back.
    physical = both / evidence.weights[:, None]
    shown = np.zeros(len(index), dtype=bool)
    for plan in plans:
        shown |= plan.held
    curves = means(index[shown], physical[shown], bins)
    low, high = np.quantile(curves[:, 1:], [0.025, 0.975], axis=1)
    return View(
        coordinate,
        np.array([float(np.median(values[index == k])) for k in range(bins)]),
        curves[:, 0],
        low,
        high,
        float(shares[0]),
        limit(shares[1:]),
        float(np.sqrt(max(removed[0], 0.0) / max(rows, 1))) / max(friction, 1e-300),
    )
