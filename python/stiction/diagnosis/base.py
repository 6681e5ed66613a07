"""The base: the plant as it is stated, fitted to the rows of train."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np

from ..fitting.minimise import MOST_EVALUATIONS, launch
from ..fitting.rows import primed
from ..fitting.solve import fit, reweighted
from ..fitting.start import complete, free_paths
from ..plant import Plant
from .evidence import Evidence
from .model import Model, fitted

__all__ = ["base_of", "calibrated"]

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
    return fitted(evidence, first.plant, nuisances, most=MOST_EVALUATIONS)
