"""The base: the plant as it is stated, fitted to the rows of train."""

from __future__ import annotations

import logging
from dataclasses import replace
from typing import Final

import numpy as np

from ..errors import NotEnoughData
from ..fitting.minimise import MOST_EVALUATIONS, launch
from ..fitting.rows import primed
from ..fitting.solve import fit, reweighted
from ..fitting.start import complete, free_paths
from ..plant import Plant
from .evidence import Evidence
from .model import Model, fitted

__all__ = ["base_of", "calibrated"]

LOST: Final = 1e-3
"""An inertia that shrinks to this share of what the plant states, or of what the motion told at
first, is gone."""
SHOWS: Final = 0.3
"""Share of the residual that it would move, from which on it would have shown."""

_logger = logging.getLogger(__name__)


def calibrated(evidence: Evidence, plant: Plant) -> Plant:
    """A plant whose gain is to be fitted, with the gain that its closed loop has.

    The gain scales what is measured here: fitted to an effort residual it would shrink until little
    of that is left. A servo is simulated from its goal instead, over the recordings of train.
    """
    if not plant.servo or not any(path.startswith("drive.") for path in plant.parameters):
        return plant
    _logger.info("fitting the gain of the drive to its closed loop")
    train = sorted({part.recording for part in evidence.split.train})
    gauged = fit(plant, [evidence.recordings[index] for index in train]).plant
    return replace(gauged, drive={**gauged.drive, "torque_constant": gauged.gain})


def base_of(evidence: Evidence, plant: Plant) -> Model:
    """The plant fitted twice: the second time with recordings weighted by what is left in each."""
    starts = complete(plant, [rows.form for rows in evidence.train])
    paths = free_paths(starts[0])
    first = Model(evidence, launch(starts, paths, evidence.train, most=MOST_EVALUATIONS))
    if len(evidence.train) > 1:
        reweighted(evidence.train, first.plant, first.nuisances)
    else:
        evidence.train[0].weight = 1.0 / max(np.sqrt(np.mean(first.residual**2)), 1e-300)
    evidence.weigh()
    nuisances = primed(first.plant, evidence.train, first.nuisances)
    base = fitted(evidence, first.plant, nuisances, most=MOST_EVALUATIONS)
    _refuse_what_does_not_move(evidence, starts[0], base)
    return base


def _refuse_what_does_not_move(evidence: Evidence, begin: Plant, base: Model) -> None:
    """Refuses a base that lost its inertia although the motion would show it.

    What is left then is no machine, and every effect that makes the input vanish helps.
    """
    if "body.inertia" not in base.solution.variables.paths:
        return
    known, found = begin.inertia, base.plant.inertia
    accelerations = evidence.stack(lambda rows: rows.form.accelerations(rows.form.readings))
    moved = known * float(np.sqrt(np.mean(accelerations**2)))
    left = float(np.sqrt(np.mean(base.residual**2)))
    if found < LOST * known and moved > SHOWS * left:
        raise NotEnoughData(
            f"of an inertia of {known:.3g} the fit leaves {found:.2g}, though the accelerations "
            "would show it: input and motion do not belong together; check their columns, units, "
            "signs and clocks, or state [body] inertia as fixed"
        )
