"""How far readings pull a fit from the numbers of the machine, and intervals that reach as far.

Slopes along a measured motion hold the noise of its readings: an acceleration through a narrow
kernel the most. Errors in the regressors pull a fit one way, whatever the number of rows (Fuller,
"Measurement Error Models", 1987), and neither blocks nor recordings that are left out show it.
Recordings that the fitted plant made itself do: its numbers are known there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...errors import InputError
from ...fitting.result import FitParameter
from ...fitting.rows import Rows
from ...fitting.slopes import Block, slope_block
from ...residual.finite import finite
from ..data.evidence import Plan
from ..data.replay import NoReplayError, rereads
from ..screening.model import Model
from ..screening.regression import project

__all__ = ["pulls_of_readings", "widened"]

REPLAYS: Final = 4
"""Recordings of each that are made: the mean of what they show is known to half of its scatter."""
SEED: Final = 37
"""Of their noise: always the same."""
TOLD: Final = 2.0
"""Standard errors of that mean from which on it is told from 0."""


def pulls_of_readings(model: Model) -> dict[str, float]:
    """Fitted number less that of the machine, in the mean over recordings that a model made itself.

    One Gauss-Newton step from the numbers with which they were made. Numbers of which that is not
    told from 0 are left out; none are in it where windows are simulated, whose slopes hold no
    readings, or where no recording can be made (see ``reread``).
    """
    if model.evidence.simulated:
        return {}
    try:
        steps = _steps(model)
    except (NoReplayError, InputError):
        return {}
    mean, error = np.mean(steps, axis=0), np.std(steps, axis=0, ddof=1) / np.sqrt(REPLAYS)
    paths = model.solution.variables.paths
    return {
        path: float(pull)
        for path, pull, doubt in zip(paths, mean, error, strict=True)
        if abs(pull) > TOLD * doubt
    }


def widened(
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


def _steps(model: Model) -> FloatArray:
    """Where fits to recordings of the model's own would go, less its numbers.

    Shape (replays, p).
    """
    nuisances, paths = model.solution.nuisances, model.solution.variables.paths

    def replayed(rows: Rows) -> list[tuple[Block, FloatArray]]:
        seeds = [[SEED, number, rows.index] for number in range(REPLAYS)]
        found = []
        for again in rereads(rows, model.plant, nuisances, seeds):
            left = again.weight * again.residual(model.plant, nuisances)[again.mask]
            found.append((slope_block(again, model.plant, paths, nuisances), finite(left)))
        return found

    steps = []
    for own in zip(*model.evidence.each(replayed, model.evidence.train), strict=True):
        columns, left = model.angular([block for block, _ in own]), [rows for _, rows in own]
        every = np.ones(sum(map(len, left)), dtype=bool)
        gains = project(columns, Plan(every, ~every)).gains(np.concatenate(left))
        steps.append(-gains[: len(paths)])
    return np.array(steps)
