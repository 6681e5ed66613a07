"""What averaging takes of the noise of a logged input, which is no delay of the machine."""

from __future__ import annotations

import logging
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...catalogue import effects
from ...fitting.noise import input_noise
from ...fitting.rows import Rows
from .model import Model
from .screen import NULL_TIMES

__all__ = ["doubt_by_input_noise"]

DRAWS: Final = 3
"""Of the noise: their mean scattered by some hundredths of itself."""

_logger = logging.getLogger(__name__)


def doubt_by_input_noise(base: Model, model: Model, name: str, gain: float) -> str:
    """Why a held-out gain of what comes late may be one of noise, "" where it is more.

    An input that comes late by a part of a sample is in each sample a mean of two that were logged,
    and a lag is a mean of more: white noise of the log, which the machine did not get, is less
    afterwards, on rows held out as on those that were fitted. So noise of the size that the log
    shows is put on the input once more, and what it does to the residual is compared without the
    effect and with it. Of rows that are simulated, moved machines and what does not come before the
    drive nothing is asked.

    Parameters
    ----------
    base, model : Model
        Without the effect and with it.
    name : str
        Of the effect.
    gain : float
        Held out, of the second over the first.
    """
    evidence = base.evidence
    record = next(each for each in effects() if each.name == name)
    moved = any(form.prescribed for form in evidence.forms)
    if not record.before_drive or evidence.simulated or moved or gain <= 0.0:
        return ""
    held = np.any([plan.held for plan in evidence.plans], axis=0)
    before, after = (_power(base, model, held), _power(model, model, held))
    left = float(np.sum(base.residual[held] ** 2))
    averaged = NULL_TIMES * (before - after) / left if left > 0.0 else 0.0
    _logger.info("averaging of noise of the input gains %.3g", averaged / NULL_TIMES)
    if gain > averaged:
        return ""
    return (
        f"gains {100 * gain:.1f} % on rows held out, below the limit of {100 * averaged:.1f} % "
        "that averaging of the noise of the input sets"
    )


def _power(model: Model, judge: Model, held: np.ndarray) -> float:
    """Mean power that noise of the input has in the residual of a model, on rows held out.

    How noisy the log is, the model with the effect tells: beside the other one an input that does
    come late looks like noise of its log.
    """

    def added(rows: Rows) -> FloatArray:
        size = input_noise(rows, judge.plant, judge.nuisances) / abs(judge.plant.gain)
        source = np.random.default_rng(rows.index)
        quiet = rows.residual(model.plant, model.nuisances)
        columns = []
        for _ in range(DRAWS):
            white = size * source.standard_normal(len(rows.form.input))
            noisy = rows.with_input(rows.form.input + white)
            columns.append(noisy.residual(model.plant, model.nuisances) - quiet)
        return np.stack(columns, axis=1)

    return float(np.sum(model.evidence.stack(added)[held] ** 2)) / DRAWS
