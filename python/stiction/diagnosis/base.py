"""The base: the plant as it is stated, fitted to the rows of train."""

from __future__ import annotations

import numpy as np

from ..fitting.minimise import MOST_EVALUATIONS, launch
from ..fitting.rows import primed
from ..fitting.solve import reweighted
from ..fitting.start import complete, free_paths
from ..plant import Plant
from .evidence import Evidence
from .model import Model, fitted

__all__ = ["base_of"]


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
