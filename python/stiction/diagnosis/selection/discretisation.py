"""What following the readings leaves of a plant that is right, which an effect may mend."""

from __future__ import annotations

import logging
from typing import Final

import numpy as np

from ...residual.finite import finite
from ..data.evidence import Evidence
from ..screening.block_gains import heldout_reduction
from ..screening.model import Model
from ..screening.screen import NULL_TIMES
from .trials import compared_fit

__all__ = ["doubt_by_discretisation"]

NO_MORE: Final = (
    "removes no more than it does of what following the readings leaves of a plant that lacks "
    "nothing"
)

FAR_MORE: Final = 10.0
"""What removes so many times as much as the base leaves of what it made is no error of that: its
fit to that left 2.4 times as much on rows held out, bent by the errors."""

_logger = logging.getLogger(__name__)


def doubt_by_discretisation(base: Model, model: Model) -> str:
    """Why what an effect removes may be an error of the method, "" where it is more.

    Between two stamps nobody read the motion: where the machine stopped or turned, and how fast it
    went in between, is interpolated, and the error has the shape of the friction that acts there.
    Surrogates are followed as the data are, so that it cancels in them. So the base makes the
    session by itself, simulated near the measured motion and read without noise, and base and
    effect are fitted to that as they were to the data: nothing is missing there, and of the rows
    that decide the effect has to remove more from the data, by the usual factor.

    Parameters
    ----------
    base, model : Model
        Without the effect and with it.
    """
    alone = base.alone
    if alone is None:
        return ""
    removed = heldout_reduction(base, model)
    if removed > FAR_MORE * _left_by(base, alone):
        return ""
    fitted = compared_fit(alone, base.plant, base.nuisances)
    by_itself = heldout_reduction(fitted, compared_fit(alone, model.plant, fitted.nuisances))
    _logger.info("following the readings makes %.3g of %.3g by itself", by_itself, removed)
    return "" if removed > NULL_TIMES * by_itself else NO_MORE


def _left_by(base: Model, alone: Evidence) -> float:
    """Power that the plant leaves of what it made itself, on the rows that decide."""
    held = np.any([plan.held for plan in alone.plans], axis=0)
    return float(np.sum(finite(alone.residual(base.plant, base.nuisances))[held] ** 2))
