"""What a contact went through before it slides: how long it rested, how fast it was loaded."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Mask

__all__ = ["Slides", "slides_of"]

SHORTEST_REST_S: Final = 0.02
"""A shorter stop does not end a slide: a slow one trembles."""
LOADING_S: Final = 0.1
"""Time over which the rate of loading is taken; a difference quotient would be noise."""
CREPT: Final = 0.1
"""What moves on by less than this share of a window has not slid: it rounds, or it creeps."""
ROUNDING: Final = 1e-9
"""Share of a window below which a move is rounding of numbers."""
REACH: Final = 5.0
"""A slide remembers what was before it over this many windows."""


@dataclass(frozen=True)
class Slides:
    """What the rows of a recording know of the slides of its contact.

    Attributes
    ----------
    slid : numpy.ndarray, shape (n,)
        Distance slid since the last rest, 0 at rest.
    sliding : numpy.ndarray of bool, shape (n,)
        Slid by more than a window since the last rest: the spring of the contact is stretched.
    rest : numpy.ndarray, shape (n,)
        Time that the contact rested before the slide that a row begins, s; NaN where it begins
        none.
    loading : numpy.ndarray, shape (n,)
        Magnitude of the rate of the force when it broke away, N·m/s or N/s; NaN likewise.
    """

    slid: FloatArray
    sliding: Mask
    rest: FloatArray
    loading: FloatArray


def slides_of(position: FloatArray, force: FloatArray, spacing: float, window: float) -> Slides:
    """Slides of a contact, and what was before each.

    An anchor is dragged behind the position with a play of ± window: while it stands the contact
    rests, however it gives inside the window.

    Parameters
    ----------
    position, force : numpy.ndarray, shape (n,)
        Of the contact.
    spacing : float
        Of the rows, s.
    window : float
        rad or m.
    """
    number = len(position)
    found = Slides(
        np.zeros(number),
        np.zeros(number, dtype=bool),
        np.full(number, np.nan),
        np.full(number, np.nan),
    )
    share = -np.expm1(-spacing / LOADING_S)
    places, forces = position.tolist(), force.tolist()
    anchor, filtered = (places[0], forces[0]) if places else (0.0, 0.0)
    rested = still = crept = 0.0
    slid, stood = np.inf, np.nan
    loading = loaded = np.nan
    for k, (place, pulled) in enumerate(zip(places, forces, strict=True)):
        moved = abs(place - anchor) - window
        # An anchor at the end of its play stands, however its place rounds.
        moved = moved if moved > ROUNDING * window else 0.0
        anchor += math.copysign(moved, place - anchor)
        still = 0.0 if moved > 0.0 else still + spacing
        crept = 0.0 if still >= SHORTEST_REST_S else crept + moved
        if moved > 0.0 and crept > CREPT * window:
            if rested >= SHORTEST_REST_S:
                stood, loaded, slid = rested, loading, 0.0
            rested = 0.0
            slid += moved
            found.slid[k] = slid
            found.sliding[k] = slid > window
            if slid <= REACH * window:
                found.rest[k], found.loading[k] = stood, loaded
        else:
            rested += spacing
        loading = abs(pulled - filtered) / LOADING_S
        filtered += share * (pulled - filtered)
    return found
