"""What noise of the effort does to a view over the effort: it is in the residual as well."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ..._support.arrays import FloatArray
from ..data.evidence import Evidence
from .coordinates import Coordinate, Look
from .response import RESPONSE
from .view import View, limit

__all__ = ["Noisy"]

_Made = Callable[[Sequence[Look], FloatArray], View]


class Noisy:
    """Views over coordinates that hang on the effort, told apart from its noise.

    Noise of the measured effort is in what is left of it, and sorts rows over that effort; noise of
    the readings does so over the effort of the model. What a machine lacks shows over both. So
    where something shows over the measured effort it has to show over the model's too, and beside
    replays in which that effort has the noise that is left of it.

    Parameters
    ----------
    evidence : Evidence
    seen : sequence of Look
        Of each recording in ``evidence.shown``.
    spacings : sequence of float
        Of the rows of each of them, s.
    both : numpy.ndarray, shape (n, 1 + surrogates)
        Weighted residual, then those of the surrogates.
    """

    def __init__(
        self,
        evidence: Evidence,
        seen: Sequence[Look],
        spacings: Sequence[float],
        both: FloatArray,
    ) -> None:
        self._evidence, self._seen, self._spacings, self._both = evidence, seen, spacings, both
        self._left = both[:, 0] / evidence.weights
        self._modelled = self._with_effort(-self._left)

    def view(self, coordinate: Coordinate, made: _Made) -> View:
        """The view over a coordinate, of which ``made`` makes one from looks and residuals.

        Of two that something shows in, the one in which it shows less beside its threshold.
        """
        first = made(self._seen, self._both)
        if first.share <= first.threshold or not self._hangs(coordinate):
            return first
        second = made(self._modelled, self._both)
        if second.share <= second.threshold:
            return second
        views = [
            replace(view, threshold=max(view.threshold, self._reached(made, sign)))
            for view, sign in ((first, 1.0), (second, -1.0))
        ]
        return min(views, key=lambda view: view.share / view.threshold)

    def _hangs(self, coordinate: Coordinate) -> bool:
        """Whether the coordinate is another one with another effort."""
        return coordinate is RESPONSE or any(
            not np.array_equal(coordinate.values(one), coordinate.values(other), equal_nan=True)
            for one, other in zip(self._seen, self._modelled, strict=True)
        )

    def _reached(self, made: _Made, sign: float) -> float:
        """What noise reaches where the effort of each replay has its own, to one side or other."""
        shares = []
        for noise in self._both[:, 1:].T:
            more = sign * noise / self._evidence.weights - self._left
            shares.append(made(self._with_effort(more), np.column_stack([noise, noise])).share)
        return limit(np.array(shares))

    def _with_effort(self, more: FloatArray) -> list[Look]:
        """The looks with something added to the measured effort."""
        found, first = [], 0
        shown = zip(self._seen, self._evidence.shown, self._spacings, strict=True)
        for look, rows, spacing in shown:
            effort, last = look.effort.copy(), first + int(rows.mask.sum())
            effort[rows.mask] += more[first:last]
            first = last
            # In a loop it is the rate of what the controller was asked for, which has no noise.
            own = np.array_equal(look.rate, np.gradient(look.effort, spacing))
            rate = np.gradient(effort, spacing) if own else look.rate
            found.append(replace(look, effort=effort, rate=rate))
        return found
