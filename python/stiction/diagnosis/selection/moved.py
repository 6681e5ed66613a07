"""Whether causes that explain the effort do harm to the motion: it is simulated with them."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from ..._support.arrays import FloatArray
from ...errors import InputError
from ...fitting.forms import (
    HORIZONS_S,
    Through,
    can_be_shot,
    followable,
    shows_its_ring,
    soften,
    stiffen,
)
from ...plant import Plant
from ...residual.finite import finite
from ...residual.weak_form import WeakForm
from ..data.evidence import Evidence
from ..data.influence import limit_influence
from ..screening.model import Model
from .confirm import inertial_of
from .search import Search

__all__ = ["borne_out_in_motion"]

AGAINST: Final = "passes, but the motion that is simulated with it comes no nearer"

RIGID_SHOWN: Final = 0.5
"""Share of the stiffness that samples can follow which stands for a contact that is rigid to them:
pre-sliding is over within less than coarse readings show."""

_logger = logging.getLogger(__name__)


def borne_out_in_motion(selection: Search, evidence: Evidence) -> Search:
    """The selection without the last causes with which the simulated motion comes no nearer.

    What explains the effort along a measured motion may freeze the machine, or shake it, once it
    moves by itself, and to be simulated is what a plant is for. The plants, with the causes one
    after the other, are simulated over windows of .3 s on the rows that decide, each from the
    states that it makes of the readings itself. With all causes the motion has to come nearer than
    with any fewer, and nearer than one that goes on as it set out: below break-away a contact that
    was fitted to the effort breaks away, and nearly anything is better than that.
    Where rows are simulated anyway the held-out gain says the same; where nothing can be simulated
    nothing is asked. What is refused so passed all else: as much as it gained has no name.

    Parameters
    ----------
    selection : Search
    evidence : Evidence
        The rows that test stay sealed.
    """
    models = selection.models
    able = all(can_be_shot(model.plant, evidence.forms) for model in models)
    if not selection.choices or not able:
        return selection
    powers = _powers(models, evidence)
    while powers is not None and selection.choices:
        last = len(selection.choices)
        # One that repairs what an earlier one broke is no better than neither.
        others = (*powers.left[:last], powers.steady)
        gain = min(_gain(each, powers.left[last]) for each in others)
        _logger.info("in motion %s gains %.3f", selection.choices[-1].winner.name, gain)
        if gain > 0.0:
            break
        # No machine that was simulated has this cause, and yet it explained something.
        worth = max(selection.imitated, selection.choices[-1].winner.gain)
        selection = replace(selection.without_last(AGAINST), imitated=worth)
    return selection


def _gain(without: FloatArray, with_it: FloatArray) -> float:
    """Share of the power of the motion that is left with something less than without."""
    before, after = limit_influence(without, with_it)
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
            _as_stiff_as_shown(models[0].plant, evidence.forms),
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
    judged = windows.rows_with(held)

    def power(left: FloatArray) -> FloatArray:
        return np.bincount(block[held], left**2, number).astype(np.float64)

    inertia = models[0].plant.inertia
    steady = power(windows.stack(inertial_of, judged))
    found = []
    for model in models:
        plant = _as_stiff_as_shown(model.plant, windows.forms)
        try:
            # What another plant lacks would be in the states from which this one sets out.
            stiffen([rows.form for rows in judged], plant)
            left = finite(windows.residual(plant, model.nuisances, judged))
        except InputError:
            # Too stiff or too damped for samples so far apart: nothing is asked.
            return None
        found.append(power(left * (inertia / plant.inertia)))
    return _Powers(found, steady)


def _as_stiff_as_shown(plant: Plant, forms: Sequence[WeakForm]) -> Plant:
    """The plant with a contact that its samples can follow, where it is rigid to them.

    One that rings slowly enough stays as it is.
    """
    if shows_its_ring(plant, forms):
        return followable(plant, forms)
    most = RIGID_SHOWN * plant.inertia * (np.pi / max(form.dt for form in forms)) ** 2
    own = plant.friction.parameters
    parameters = soften(own, 0.5 * most / own["initial_stiffness"].value)
    parameters["initial_stiffness"] = replace(parameters["initial_stiffness"], max=most)
    return replace(plant, friction=replace(plant.friction, parameters=parameters))
