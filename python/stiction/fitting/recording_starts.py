"""What a contact brings along into each recording."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from ..plant import Plant
from .minimise import Solution, alone, minimise, with_interruption
from .rows import TURNS, Nuisances, Rows, Start, add_starts, start_quantities

__all__ = ["fit_starts", "fit_turns", "with_turns"]

EVALUATIONS: Final = 6
"""A force alone is a number on which rows depend nearly in a straight line."""
TURN_EVALUATIONS: Final = 12
"""On where a contact turned round they do not."""
FIRST: Final = (0.9, -0.9, 0.5, -0.5)
"""Shares of the sliding friction from which a turn is looked for. At 0 no row tells of it."""
SECOND: Final = (-0.8, -0.4)
"""Shares of the first turn from which a second one is: what is let go swings back, and rings."""
LIKELIEST: Final = 2
"""Second turns from which it is fitted, of those that are tried."""
TELLS: Final = 0.1
"""Of the power that is left in the recording, by which a turn must change its rows to be looked
for: a contact that soon slides forgets all of it."""
WORTH: Final = 0.9
"""Of the power that a force alone leaves in the recording beside a constant, below which there was
a turn."""


def fit_starts(plant: Plant, rows: Sequence[Rows], nuisances: Nuisances) -> Nuisances:
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
        own = add_starts(plant, [each]).starts.get(each.index, {}) if known is None else known
        if own:
            most = TURN_EVALUATIONS if TURNS[0] in own else EVALUATIONS
            begin = replace(nuisances, starts={each.index: own})
            own = alone(plant, each, begin, most=most).nuisances.starts[each.index]
        found[each.index] = _turned(plant, each, own, nuisances) if known is None else own
    return replace(nuisances, starts=found)


def fit_turns(plant: Plant, rows: Sequence[Rows], nuisances: Nuisances) -> Nuisances:
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
    return replace(nuisances, starts=found)


def with_turns(found: Solution, rows: Sequence[Rows], *, most: int) -> Solution:
    """A solution, fitted on from the turns of its contacts where there were any.

    Parameters
    ----------
    found : Solution
        That knows of none; one that was interrupted stays as it is.
    rows : sequence of Rows
    most : int
        Evaluations of the residual at most.
    """
    if found.interrupted:
        return found
    try:
        known = fit_turns(found.plant, rows, found.nuisances)
        if known.starts == found.nuisances.starts:
            return found
        begun = add_starts(found.plant, rows, known)
        return minimise(found.plant, found.variables.paths, rows, most=most, nuisances=begun)
    except KeyboardInterrupt:
        return with_interruption(found)


def _turned(plant: Plant, rows: Rows, known: Start, nuisances: Nuisances) -> Start:
    """The start of one recording with the turns that explain its rows; as it is without any."""
    first, second = TURNS
    if first not in start_quantities(plant) or first in known or "force" not in known:
        return known

    def nuisances_of(start: Start) -> Nuisances:
        return replace(nuisances, starts={rows.index: start})

    def left(start: Start) -> FloatArray:
        return rows.residual(plant, nuisances_of(start))[rows.mask]

    def power(start: Start) -> float:
        return _beside_constant(left(start))

    def fitted(start: Start) -> Start:
        found = alone(plant, rows, nuisances_of(start), most=TURN_EVALUATIONS)
        return found.nuisances.starts[rows.index]

    # What the force alone may do is no merit of a turn.
    own = fitted(known)
    forces = (0.0, own["force"])
    # A force that makes up for an offset may bend all the rest: beside that nothing would tell.
    least = TELLS * min(power({**own, "force": force}) for force in forces)
    begun: dict[float, list[Start]] = {}
    for force in forces:
        # A force beyond the turn forgets it; then nothing changes, and it is not looked for.
        let_go = {**own, "force": force}
        never = left(let_go)
        for share in FIRST:
            start = {**let_go, first: share}
            if _beside_constant(left(start) - never) > least:
                begun.setdefault(np.sign(share), []).append(start)
    if not begun:
        return known
    # Either way from the likeliest start: most of the others end in the same valley.
    once = _better(own, [fitted(min(each, key=power)) for each in begun.values()], power)
    # One turn alone may explain nothing where there were two.
    firsts = [{**own, first: share} for share in FIRST[:2]] if once is None else [once]
    again = [
        min(
            ({**start, "force": force, second: share * start[first]} for start in firsts),
            key=power,
        )
        for force, share in product(forces, SECOND)
    ]
    likeliest = sorted(again, key=power)[:LIKELIEST]
    twice = _better(once or own, [fitted(start) for start in likeliest], power)
    return twice or once or known


def _beside_constant(left: FloatArray) -> float:
    """Power of what is left beside a constant.

    A contact that keeps for long what it brought along would hide an offset, which is the
    machine's: the gas of a damper, of which recordings without a slide know nothing else.
    """
    return float(np.sum((left - np.mean(left)) ** 2))


def _better(known: Start, others: Sequence[Start], power: Callable[[Start], float]) -> Start | None:
    """The best of others where it explains clearly more than what is known."""
    best = min(others, key=power, default=known)
    return best if power(best) < WORTH * power(known) else None
