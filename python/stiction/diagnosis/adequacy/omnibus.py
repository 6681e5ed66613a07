"""What is left: the residual in every coordinate, judged on rows held out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.workers import side_by_side
from ..data.evidence import Evidence
from .by_recording import BY_RECORDING, by_recording_view
from .coordinates import COORDINATES, Coordinate, Look
from .noisy_effort import Noisy
from .passing import drift_view, moments_view, steady_rows
from .periodic import COUPLED, ORDERS, Asked, frequency_view, order_views
from .response import RESPONSE, response_columns, response_view
from .smoother import smoother, stack_rows
from .view import LEAST_SIZE, View

__all__ = ["Rest", "View", "rest"]

MUCH_MORE: Final = 1.25
"""A finer coordinate stands for the wider one where its share is larger by this factor."""


@dataclass(frozen=True)
class Rest:
    """What a model leaves, in every coordinate.

    Attributes
    ----------
    views : tuple of View
        Largest share first.
    """

    views: tuple[View, ...]

    def significant_views(self, least: float = LEAST_SIZE) -> tuple[View, ...]:
        """Coordinates in which more is left than noise explains, from a size on.

        Of a coordinate and one that refines it only one: the finer where it shows much more.
        """
        shown = {
            view.coordinate.name: view
            for view in self.views
            if view.is_flagged(least) and not view.coordinate.descriptive
        }
        for fine in list(shown.values()):
            wide = shown.get(fine.coordinate.refines)
            if wide is not None:
                lesser = wide if fine.share > MUCH_MORE * wide.share else fine
                del shown[lesser.coordinate.name]
        return tuple(shown.values())

    def with_view(self, view: View) -> Rest:
        """The same with a view in the place of the one over its coordinate."""
        others = (each for each in self.views if each.coordinate.name != view.coordinate.name)
        return Rest(tuple(sorted((*others, view), key=lambda each: -each.share)))

    @property
    def leading_views(self) -> tuple[View, ...]:
        """What it goes with where something is left, largest share first."""
        views = (view for view in self.views if view.coordinate.descriptive)
        return tuple(view for view in views if view.is_flagged())


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
    direction = stack_rows(evidence, [look.direction for look in seen])
    position = stack_rows(evidence, [look.position for look in seen])
    both = np.column_stack([residual, null])
    cells, weights = evidence.cells, evidence.weights
    spacings = [rows.form.dt * rows.form.stride for rows in evidence.shown]
    noisy = Noisy(evidence, seen, spacings, both)
    told = [
        coordinate
        for coordinate in COORDINATES
        if evidence.plant.motion == "rotary" or not coordinate.name.startswith("angle")
        if any(np.any(np.isfinite(coordinate.values(look))) for look in seen)
    ]

    def smoothed(coordinate: Coordinate) -> View:
        return noisy.view(coordinate, partial(smoother, coordinate, evidence, friction=friction))

    views = list(side_by_side(smoothed, told))
    along = both * direction[:, None]
    asked = [Asked(coordinate, along if coordinate.odd else both) for coordinate in ORDERS]
    asked += [
        Asked(coordinate, both, stack_rows(evidence, [coordinate.values(look) for look in seen]))
        for coordinate in COUPLED
    ]
    views += order_views(asked, orders, position, evidence.plans, weights, friction)

    def answered(looks: Sequence[Look], both: FloatArray) -> View:
        moved = stack_rows(
            evidence,
            [
                response_columns(look.effort, max(spacings) / spacing)
                for look, spacing in zip(looks, spacings, strict=True)
            ],
        )
        return response_view(moved, max(spacings), evidence.plans, both, weights, friction)

    views.append(noisy.view(RESPONSE, answered))
    clock = stack_rows(evidence, [look.time for look in seen])
    velocity = stack_rows(evidence, [look.velocity for look in seen])
    sliding = stack_rows(evidence, [look.slides.sliding for look in seen])
    steady = stack_rows(evidence, [steady_rows(look) for look in seen])
    of_rows = stack_rows(
        evidence,
        [np.full(len(look.time), each) for look, each in zip(seen, spacings, strict=True)],
    )
    # Numbers are those of the session, also where some of its recordings are left out.
    entered = replace(cells, recording=evidence.places[cells.recording])
    apart = (
        by_recording_view(
            coordinate,
            entered,
            stack_rows(evidence, [coordinate.values(look) for look in seen]),
            both,
            weights,
            friction,
        )
        for coordinate in BY_RECORDING
    )
    with_time = (
        drift_view(cells, clock, velocity, sliding, both, weights, friction),
        moments_view(cells, clock, steady, both, weights, friction),
        frequency_view(cells, of_rows, both, weights, friction),
    )
    views += [view for view in (*apart, *with_time) if view is not None]
    return Rest(tuple(sorted(views, key=lambda view: -view.share)))
