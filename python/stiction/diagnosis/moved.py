"""Whether causes that explain the effort do harm to the motion: it is simulated with them."""

from __future__ import annotations

import logging
from typing import Final, NamedTuple

import numpy as np

from ..errors import InputError
from ..finite import finite
from ..fitting.forms import HORIZONS_S, LEAST_WINDOWS, Through, as_stiff_as_shown
from ..trajectory import FloatArray
from .confirm import inertial_of
from .evidence import Evidence
from .influence import limited
from .model import Model
from .selection import Search

__all__ = ["borne_out_in_motion"]

AGAINST: Final = "passes, but the motion that is simulated with it comes no nearer"

_logger = logging.getLogger(__name__)


def borne_out_in_motion(selection: Search, evidence: Evidence) -> Search:
    """The selection without the last causes with which the simulated motion comes no nearer.

    What explains the effort along a measured motion may freeze the machine, or shake it, once it
    moves by itself, and to be simulated is what a plant is for. Both plants are simulated over
    windows of .3 s from the same states, on the rows that decide. With the cause the motion has to
    come nearer than without it, and nearer than one that goes on as it set out: below break-away a
    contact that was fitted to the effort breaks away, and nearly anything is better than that.
    Where rows are simulated anyway the held-out gain says the same; where nothing can be simulated
    nothing is asked.

    Parameters
    ----------
    selection : Search
    evidence : Evidence
        The rows that test stay sealed.
    """
    if not selection.choices or not _can_be_simulated(selection.models, evidence):
        return selection
    powers = _powers(selection.models, evidence)
    while powers is not None and selection.choices:
        last = len(selection.choices)
        gain = min(
            _gain(each, powers.left[last]) for each in (powers.left[last - 1], powers.steady)
        )
        _logger.info("in motion %s gains %.3f", selection.choices[-1].winner.name, gain)
        if gain > 0.0:
            break
        selection = selection.without_last(AGAINST)
    return selection


def _can_be_simulated(models: list[Model], evidence: Evidence) -> bool:
    plant, forms = models[0].plant, evidence.forms
    if evidence.simulated or plant.servo or any(form.prescribed for form in forms):
        return False
    shortest = min(form.dt * len(form.readings) for form in forms)
    if shortest < LEAST_WINDOWS * HORIZONS_S[1]:
        return False
    return all(model.plant.inertia > 0.0 for model in models)


def _gain(without: FloatArray, with_it: FloatArray) -> float:
    """Share of the power of the motion that is left with something less than without."""
    before, after = limited(without, with_it)
    return 1.0 - float(after.sum()) / max(float(before.sum()), 1e-300)


class _Powers(NamedTuple):
    """Power of the motion by block of the rows that decide; shapes (blocks,)."""

    left: list[FloatArray]
    """By each model."""
    steady: FloatArray
    """By a machine that goes on at the speed at which it set out."""


def _powers(models: list[Model], evidence: Evidence) -> _Powers | None:
    through = Through(horizon=HORIZONS_S[1])
    try:
        windows = Evidence(
            as_stiff_as_shown(models[0].plant, evidence.forms),
            evidence.recordings,
            through=through,
            watch=evidence.watch,
            joined=evidence.joined,
        )
    except InputError:
        return None
    held = np.any([plan.held for plan in windows.plans], axis=0)
    block = windows.cells.block
    number = int(block.max()) + 1

    def power(left: FloatArray) -> FloatArray:
        return np.bincount(block[held], left[held] ** 2, number).astype(np.float64)

    found = []
    for model in models:
        plant = as_stiff_as_shown(model.plant, windows.forms)
        found.append(power(finite(windows.residual(plant, model.nuisances))))
    return _Powers(found, power(windows.stack(inertial_of)))
