"""What noise of a measured motion gains by itself, where it moves friction or hides its turns."""

from __future__ import annotations

import logging
from typing import Final

import numpy as np

from ...catalogue import effects
from ...fitting.replay import hangs_on_load
from ..screening.block_gains import heldout_gain
from ..screening.model import Model, fit_model
from ..screening.screen import NULL_TIMES

__all__ = ["doubt_by_noise"]

SMALL: Final = 0.25
"""Gain up to which readings that flicker may be all there is to a cause: with nothing hidden they
came to .14."""
LATE_SHARE: Final = 0.5
"""Of the kernel's support: by less than that may a turn be wrong that noise hides."""
LATE: Final = "lies within what noise of the position makes friction late by"

_logger = logging.getLogger(__name__)


def doubt_by_noise(base: Model, model: Model, name: str, gain: float) -> str:
    """Why a held-out gain may be one of noise, "" where it is none or noise is no matter.

    Surrogates are screened along the measured motion: its noise is in the signatures, theirs is
    in their residuals. In the data both are the same noise, and it is not left out by holding rows
    out: what only smooths a speed again helps a law that hangs on the speed everywhere (errors in
    variables; Fuller, Measurement Error Models (1987)). So where readings had to be smoothed to
    move a machine at all, where they flicker and the gain is small, or where noise may put a turn
    as far off as the effect is late, base and effect are fitted to replays as they were to the
    data, each along readings of its own. Where no replay can be made such a delay is refused, and
    nothing else.

    Parameters
    ----------
    base, model : Model
        Without the effect and with it.
    name : str
        Of the effect.
    gain : float
        Held out, of the second over the first.
    """
    forms = base.evidence.forms
    steadied = any(form.smoothing_support > 0.0 for form in forms)
    flickers = any(form.flickers and form.count > 0.0 for form in forms)
    late = _late_by_noise(model, name)
    if not steadied and not (flickers and gain < SMALL) and not late:
        return ""
    # What keeps a simulation near the measured motion stands in for a load that friction reads.
    simulated = not all(form.prescribed for form in forms)
    hangs = simulated and any(hangs_on_load(model.plant, form) for form in forms)
    replays = [] if hangs else base.replays
    if not replays:
        return LATE if late else ""
    reached = NULL_TIMES * max(_gained(replay, model) for replay in replays)
    _logger.info("noise of the motion gains %.3g at most", reached)
    if gain > reached:
        return ""
    return (
        f"gains {100 * gain:.1f} % on rows held out, below the limit of {100 * reached:.1f} % "
        "that noise of the measured motion sets"
    )


def _late_by_noise(model: Model, name: str) -> bool:
    """Whether an effect is a delay no longer than noise may put a turn of the motion off by.

    Where noise is kept from friction nobody knows a turn to the sample, and an input that seems
    late, or a friction that follows speed late, may be what is left of that.
    """
    effect = next(each for each in model.plant.effects if each.name == name)
    evidence = model.evidence
    record = next(each for each in effects() if each.name == effect.name)
    if record.late and any(form.flickers for form in evidence.forms):
        (gain,) = record.gains
        return bool(effect.parameters[gain].value <= LATE_SHARE * evidence.support)
    if record.friction_lags:
        # Noise does it in most recordings; counts flicker where a machine rests, and there alone.
        late = float(np.median([form.lateness for form in evidence.forms]))
        return bool(effect.parameters["time"].value <= late)
    return False


def _gained(replay: Model, model: Model) -> float:
    """Held-out gain of an effect on a replay of the base, in which nothing is missing."""
    with_it = fit_model(replay.evidence, model.plant, replay.nuisances)
    if with_it.solution.interrupted:
        raise KeyboardInterrupt
    return heldout_gain(replay, with_it)[0]
