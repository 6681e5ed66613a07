"""Each cause in its own coordinate: the picture that its owner should be convinced by."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...plant.stated import Effect
from ..adequacy.coordinates import COORDINATES, UNJUDGED, Coordinate, Look
from ..adequacy.smoother import smoother
from ..adequacy.view import View
from ..data.evidence import Evidence
from .presentation import PRESENTATIONS, SLIDING, Wave, contact_slides

__all__ = ["own_coordinate", "own_view"]

PHASES: Final = 24
"""Stretches of the longest period that is drawn, for each period of its shortest one."""
MOST_PHASES: Final = 72
"""So many at most."""
MOST_PERIODS: Final = 6
"""Periods of the first wave that are drawn side by side at most, where a second one asks for it."""
NEAR_WHOLE: Final = 0.03
"""A ratio of periods nearer than this to a whole number is taken for it."""
ELSEWHERE: Final = "velocity"
"""Where an effect is drawn that has no entry."""
_DRAWN: Final = {each.name: each for each in (*COORDINATES, *UNJUDGED)}
# Over its logarithm, what grows with the square of speed would be pressed to the edge.
_DRAWN["high speed"] = replace(_DRAWN["speed"], logarithmic=False)


def _in_slides(name: str) -> Coordinate:
    whole = _DRAWN[name]
    return replace(
        whole,
        values=lambda look: np.where(contact_slides(look), whole.values(look), np.nan),
        rows=SLIDING,
    )


_DRAWN["time switched on, in slides"] = _in_slides("time since it was switched on")
_DRAWN["path, in slides"] = _in_slides("path along the motion")


def _where(name: str) -> str | Wave:
    entry = PRESENTATIONS.get(name)
    return ELSEWHERE if entry is None else entry.over


def own_coordinate(effect: Effect, motion: str) -> Coordinate:
    """The coordinate that an effect is drawn over.

    Parameters
    ----------
    effect : Effect
        With its fitted parameters.
    motion : str
        "rotary" or "linear".
    """
    own = _where(effect.name)
    if isinstance(own, str):
        return _DRAWN[own]
    order, _ = _periods(effect)

    def place(look: Look) -> FloatArray:
        phase = np.mod(look.position, 2.0 * math.pi / order)
        return phase if own.where is None else np.where(own.where(look), phase, np.nan)

    name = "position in the period"
    axis = f"position in a period of {2.0 * math.pi / order:.3g} {{x}}, {{x}}"
    if motion == "rotary" and abs(order - round(order)) < 1e-9:
        name = "angle in the turn" if order == 1.0 else f"angle in 1/{order:.0f} of a turn"
        axis = f"{name}, rad"
    return Coordinate(
        name, axis, own.odd, place, factor=own.factor, upright=own.upright, rows=own.rows
    )


def own_view(
    evidence: Evidence,
    seen: Sequence[Look],
    effect: Effect,
    residual: FloatArray,
    null: FloatArray,
    friction: float,
) -> View:
    """What a model leaves, in the coordinate of an effect.

    Parameters
    ----------
    evidence : Evidence
    seen : sequence of Look
        Of each recording in ``evidence.shown``.
    effect : Effect
        With its fitted parameters.
    residual : numpy.ndarray, shape (n,)
    null : numpy.ndarray, shape (n, surrogates)
    friction : float
        Weighted rms of the friction, against which sizes are measured.
    """
    coordinate = own_coordinate(effect, evidence.plant.motion)
    edges = None
    if isinstance(_where(effect.name), Wave):
        order, finest = _periods(effect)
        number = min(round(PHASES * max(finest / order, 1.0)), MOST_PHASES)
        edges = np.linspace(0.0, 2.0 * math.pi / order, number + 1)[1:-1]
    both = np.column_stack([residual, null])
    return smoother(coordinate, evidence, seen, both, friction, edges, within=True)


def _periods(effect: Effect) -> tuple[float, float]:
    """Order whose period is drawn, and the highest order that has to show in it, 1/rad or 1/m."""
    given = {name: parameter.value for name, parameter in effect.parameters.items()}
    first = given.get("order", 1.0)
    second = given.get("order_2", first) if _has_second(given) else first
    for periods in range(1, MOST_PERIODS + 1):
        ratio = second / first * periods
        if abs(ratio - round(ratio)) < NEAR_WHOLE and round(ratio) > 0:
            return first / periods, max(first, second)
    return first, first


def _has_second(given: dict[str, float]) -> bool:
    return any(given.get(name, 0.0) != 0.0 for name in ("cosine_2", "sine_2"))
