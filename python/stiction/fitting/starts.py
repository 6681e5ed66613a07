"""What a contact brings along into each recording."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import Final

import numpy as np

from ..plant import Plant
from ..trajectory import FloatArray
from .minimise import alone
from .rows import TURNS, Nuisances, Rows, Start, primed, start_quantities

__all__ = ["started", "turned"]

EVALUATIONS: Final = 6
"""A force alone is a number on which rows depend nearly in a straight line."""
TURN_EVALUATIONS: Final = 12
"""Where a contact turned round is none."""
FIRST: Final = (0.9, -0.9, 0.5, -0.5)
"""Shares of the sliding friction from which a turn is looked for. At 0 no row tells of it."""
SECOND: Final = (-0.8, -0.4)
"""Shares of the first turn from which a second one is: what is let go swings back, and rings."""
TELLS: Final = 0.1
"""Of the power that is left in the recording, by which a turn must change its rows to be looked
for: a contact that soon slides forgets all of it."""
WORTH: Final = 0.9
"""Of the power that a force alone leaves in the recording, below which there was a turn."""


def started(plant: Plant, rows: Sequence[Rows], nuisances: Nuisances) -> Nuisances:
    """Nuisances with the start of each of these recordings, fitted to its own rows alone.

    What a contact brings along belongs to a recording and not to the machine: where a recording was
    held out of the fit nothing else tells it. That it was never moved is a guess, of whose error a
    spring with memory keeps a part for as long as it does not slide.

    Parameters
    ----------
    plant : Plant
        Stays as it is.
    rows : sequence of Rows
        One of each recording.
    nuisances : Nuisances
        Where the starts are looked for from; those of other recordings and the timing stay.

    Returns
    -------
    Nuisances
        Empty starts where the rows tell of none.

    Raises
    ------
    KeyboardInterrupt
    """
    found = dict(nuisances.starts)
    for each in rows if start_quantities(plant) else ():
        known = found.get(each.index)
        own = primed(plant, [each]).starts.get(each.index, {}) if known is None else known
        if own:
            most = TURN_EVALUATIONS if TURNS[0] in own else EVALUATIONS
            begin = Nuisances(nuisances.timing, {each.index: own})
            own = alone(plant, each, begin, most=most).nuisances.starts[each.index]
        found[each.index] = _turned(plant, each, own, nuisances) if known is None else own
    return Nuisances(nuisances.timing, found)


def turned(plant: Plant, rows: Sequence[Rows], nuisances: Nuisances) -> Nuisances:
    """Nuisances with the turn of contacts that were bent further before their recording began.

    Where the machine stood still between two recordings its contact remembers the first one: it
    slid, came back from there, and begins the second one on another branch than a contact that was
    never moved. Only in a recording that does not slide does that last.

    Parameters
    ----------
    plant : Plant
        Stays as it is.
    rows : sequence of Rows
    nuisances : Nuisances
        With the starts that are fitted.

    Raises
    ------
    KeyboardInterrupt
    """
    found = dict(nuisances.starts)
    for each in rows:
        own = found.get(each.index)
        if own:
            found[each.index] = _turned(plant, each, own, nuisances)
    return Nuisances(nuisances.timing, found)


def _turned(plant: Plant, rows: Rows, own: Start, nuisances: Nuisances) -> Start:
    """The start of one recording with the turns that explain its rows; as it is without any."""
    first, second = TURNS
    if first not in start_quantities(plant) or first in own or "force" not in own:
        return own

    def nuisances_of(start: Start) -> Nuisances:
        return Nuisances(nuisances.timing, {rows.index: start})

    def left(start: Start) -> FloatArray:
        return rows.residual(plant, nuisances_of(start))[rows.mask]

    def power(start: Start) -> float:
        return float(np.sum(left(start) ** 2))

    def fitted(start: Start) -> Start:
        found = alone(plant, rows, nuisances_of(start), most=TURN_EVALUATIONS)
        return found.nuisances.starts[rows.index]

    # From a force of 0, for one beyond the turn would forget it.
    let_go = {**own, "force": 0.0}
    never, least = left(let_go), TELLS * power(own)
    begun = [{**let_go, first: share} for share in FIRST]
    telling = [start for start in begun if np.sum((left(start) - never) ** 2) > least]
    once = _better(own, [fitted(start) for start in telling], power)
    if once is None:
        return own
    forces = (0.0, own["force"])
    begun = [
        {**once, "force": force, second: share * once[first]}
        for force, share in product(forces, SECOND)
    ]
    return _better(once, [fitted(start) for start in begun], power) or once


def _better(known: Start, others: Sequence[Start], power: Callable[[Start], float]) -> Start | None:
    """The best of others where it explains clearly more than what is known."""
    best = min(others, key=power, default=known)
    return best if power(best) < WORTH * power(known) else None
