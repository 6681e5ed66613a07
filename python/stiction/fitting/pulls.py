"""How far readings pull a fit from the numbers of the machine, and intervals that reach as far.

Slopes along a measured motion hold the noise of its readings: an acceleration through a narrow
kernel the most. Errors in the regressors pull a fit one way, whatever the number of rows (Fuller,
"Measurement Error Models", 1987), and neither blocks nor recordings that are left out show it.
Recordings that the fitted plant made itself do: its numbers are known there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.workers import side_by_side
from ..errors import InputError
from ..residual.finite import finite
from .angular import Angular
from .minimise import Solution
from .replay import NoReplayError, rereads
from .result import FitParameter
from .rows import Rows, timing_bound
from .slopes import Block, places_of, slope_block

__all__ = ["pulls_of_readings", "widen"]

REPLAYS: Final = 4
"""Recordings of each that are made: the mean of what they show is known to half of its scatter."""
SEED: Final = 37
"""Of their noise: always the same."""
TOLD: Final = 2.0
"""Standard errors of that mean from which on it is told from 0."""


def pulls_of_readings(solution: Solution, rows: Sequence[Rows]) -> dict[str, float]:
    """Fitted number less that of the machine, in the mean over recordings of the fitted plant.

    One Gauss-Newton step from the numbers with which they were made. Numbers of which that is not
    told from 0 are left out; none are in it where windows are simulated, whose slopes hold no
    readings, or where no recording can be made (see ``rereads``).

    Parameters
    ----------
    solution : Solution
    rows : sequence of Rows
        That were fitted, with their weights.
    """
    if any(each.form.simulated for each in rows):
        return {}
    try:
        steps = _steps(solution, rows)
    except (NoReplayError, InputError):
        return {}
    mean, error = np.mean(steps, axis=0), np.std(steps, axis=0, ddof=1) / np.sqrt(REPLAYS)
    return {
        path: float(pull)
        for path, pull, doubt in zip(solution.variables.paths, mean, error, strict=True)
        if abs(pull) > TOLD * doubt
    }


def widen(
    parameters: Mapping[str, FitParameter], pulls: Mapping[str, float]
) -> dict[str, FitParameter]:
    """Intervals that reach to where the numbers would be without the pull of the readings."""
    found = dict(parameters)
    for path, pull in pulls.items():
        if path in found:
            low, high = found[path].ci95
            reach = min(low, low - pull), max(high, high - pull)
            found[path] = replace(found[path], ci95=reach)
    return found


def _steps(solution: Solution, rows: Sequence[Rows]) -> FloatArray:
    """Where fits to recordings of the plant's own would go, less its numbers; (replays, p)."""
    plant, paths = solution.plant, solution.variables.paths
    # Its own recordings have no offset of timing.
    nuisances = replace(solution.nuisances, timing=0.0)

    def replayed(each: Rows) -> list[tuple[Block, FloatArray]]:
        seeds = [[SEED, number, each.index] for number in range(REPLAYS)]
        found = []
        for again in rereads(each, plant, nuisances, seeds):
            left = again.weight * again.residual(plant, nuisances)[again.mask]
            found.append((slope_block(again, plant, paths, nuisances), finite(left)))
        return found

    shared = len(paths) + 1
    size, steps = shared + len(places_of(nuisances)), []
    bound = timing_bound(plant, rows)
    for own in zip(*side_by_side(replayed, rows), strict=True):
        columns = Angular.of_blocks([block for block, _ in own], shared, size)
        left = np.concatenate([rows_left for _, rows_left in own])
        gains = columns.gains(left)
        if abs(gains[shared - 1]) > bound:
            # The offset of timing is pulled to its bound, and the others go on without it.
            held = bound * np.sign(gains[shared - 1]) * columns.shared[:, shared - 1]
            gains = columns.with_column(shared - 1, 0.0).gains(left - held)
        steps.append(-gains[: len(paths)])
    return np.array(steps)
