"""A single event in pieces: what a law that was fitted to some of them leaves in the others."""

from __future__ import annotations

from copy import copy
from typing import Final

import numpy as np

from ...fitting.rows import Mask, Rows
from ..screening.model import Model, fit_model
from .lone import Lone

__all__ = ["event_power_ratio"]

PIECES: Final = 4
"""Every other one is held out, then the others: the beginning of an event does not tell its end."""
FEWEST_KERNELS: Final = 2.0
"""Pieces shorter than so many kernels are not apart from one another."""


def event_power_ratio(model: Model, own: Model, event: Lone) -> float | None:
    """Power that a law leaves in pieces of an event held out, over what the plant's own leaves.

    What happens once cannot be confirmed by what happens again. That a law which saw one half of it
    follows the other one is no proof that it follows the next event, and more than that it was
    fitted to this one.

    Parameters
    ----------
    model, own : Model
        Of the other law and of the plant's.
    event : Lone
        In rows that are fitted.

    Returns
    -------
    float or None
        None where the event is too short to be cut, or where a fit was interrupted.
    """
    length = (event.end - event.start) / PIECES
    if length < FEWEST_KERNELS * own.evidence.support:
        return None
    powers = [_left(each, event, length) for each in (model, own)]
    if any(power is None for power in powers):
        return None
    one, two = (power or 0.0 for power in powers)
    return one / max(two, 1e-300)


def _left(model: Model, event: Lone, length: float) -> float | None:
    """Weighted power in all pieces, each held out once."""
    evidence, total = model.evidence, 0.0
    edge = 0.5 * evidence.support
    for first in (0, 1):
        seen = copy(evidence)
        held = [rows.of(_pieces(rows, model, event, length, first, 0.0)) for rows in evidence.train]
        near = [_pieces(rows, model, event, length, first, edge) for rows in evidence.train]
        seen.train = [
            rows.of(rows.mask & ~mask) for rows, mask in zip(evidence.train, near, strict=True)
        ]
        found = fit_model(seen, model.plant, model.nuisances)
        if found.solution.interrupted:
            return None
        for rows in held:
            left = rows.residual(found.plant, found.solution.nuisances)[rows.mask]
            total += rows.weight**2 * float(left @ left)
    return total


def _pieces(rows: Rows, model: Model, event: Lone, length: float, first: int, edge: float) -> Mask:
    """Rows in every other piece of the event, and as far beside it as ``edge`` says."""
    inside = np.zeros(len(rows.mask), dtype=bool)
    if model.evidence.names[rows.index] == event.recording:
        since = rows.form.time - event.begin - event.start
        for piece in range(first, PIECES, 2):
            inside |= (since >= piece * length - edge) & (since <= (piece + 1) * length + edge)
    return inside & rows.mask
