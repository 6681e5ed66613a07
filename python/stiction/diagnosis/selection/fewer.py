"""Fewer causes than were found: what is not needed, or is one with another."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from ...catalogue import effects
from ..data.evidence import Evidence
from ..screening.block_gains import heldout_gain
from ..screening.candidates import FALL
from ..screening.model import Model, without_effect
from . import listing
from .choose import Choice
from .decide import LEAST_GAIN, LEAST_STRENGTH
from .search import Search
from .trials import Screening, compared_fit, whole_fit

__all__ = ["MIMIC", "join", "rebuild_models", "remove_redundant", "without"]

MIMIC: Final = 5.0
"""What keeps less than one part in so many of its gain beside a later effect was its mimic; what
explains less than that of a relative that was found may be the rest of it."""
FALLS: Final = tuple(record.name for record in effects() if record.falls)
LAGS: Final = tuple(record.name for record in effects() if record.friction_lags)
"""A fall of friction with speed, and what comes late of it."""
AS_MUCH: Final = 0.02
"""What one cause leaves more than two, as a share, where it is both of them."""

_logger = logging.getLogger(__name__)


def remove_redundant(evidence: Evidence, found: Search) -> set[str]:
    """Takes out earlier effects that are not needed beside the latest one.

    What explains a part of the residual first may be a mimic of what explains the whole of it.
    """
    dropped = set()
    for choice in found.choices[:-1]:
        whole = found.models[-1]
        name = choice.winner.name
        weak = whole.strength(choice.winner.candidate) < LEAST_STRENGTH
        if not weak and choice.winner.gain <= MIMIC * LEAST_GAIN:
            continue
        less = without(evidence, found, name)
        left = heldout_gain(less, whole)[0]
        # Of what it was taken for, a mimic keeps next to nothing beside its cause.
        if left > LEAST_GAIN or not (weak or left < choice.winner.gain / MIMIC):
            continue
        latest = found.choices[-1].winner.name
        _logger.info("%s is not needed beside %s", name, latest)
        row = found.rows[name]
        found.rows[name] = replace(row, reason=f"not needed beside {latest}")
        kept = [each for each in found.choices if each is not choice]
        found.models[:] = rebuild_models(evidence, found.models[0], kept, less)
        found.choices[:] = kept
        dropped.add(name)
    return dropped


def without(evidence: Evidence, found: Search, name: str) -> Model:
    """The last model fitted without one of its effects; kept, for drops and swaps ask for it."""
    whole = found.models[-1]
    for model, left_out, less in found.lesser:
        if model is whole and left_out == name:
            return less
    plant = without_effect(whole.plant, name)
    less = compared_fit(evidence, plant, whole.nuisances)
    found.lesser.append((whole, name, less))
    return less


def rebuild_models(
    evidence: Evidence, base: Model, choices: Sequence[Choice], last: Model
) -> list[Model]:
    """The models behind some choices, made anew: each entry is measured beside those before it."""
    plants = [last.plant]
    for later in reversed(choices[1:]):
        plants.append(without_effect(plants[-1], later.winner.name))
    between = [whole_fit(evidence, plant, last.nuisances) for plant in reversed(plants[1:])]
    return [base, *between, last]


def join(screening: Screening, found: Search) -> set[str]:
    """Puts one cause in the place of two that it is: a fall of friction and its lag.

    Where the fall was found first, and the lag beside it, a fall that comes late explains with one
    strength and one speed what the two need two of each for. What it takes the place of need not be
    looked for again.
    """
    pair = [c for c in found.choices if c.winner.name in FALLS + LAGS]
    if len(pair) < 2:
        return set()
    evidence, whole = screening.evidence, found.models[-1]
    plant = whole.plant
    for choice in pair:
        plant = without_effect(plant, choice.winner.name)
    less = compared_fit(evidence, plant, whole.nuisances)
    score = next(s for s in screening.scores(less) if s.candidate.name in LAGS)
    if score.score <= score.threshold:
        return set()
    trial = screening.trial(less, score)
    if (
        trial.reason
        or trial.candidate.shape[FALL] == 0.0
        or trial.model.power > (1.0 + AS_MUCH) * whole.power
        or heldout_gain(trial.model, whole)[0] > LEAST_GAIN
    ):
        return set()
    _logger.info("%s is both", trial.name)
    single = Choice(trial, ())
    kept = [each for each in found.choices if each not in pair]
    settled = whole_fit(evidence, trial.model.plant, trial.model.nuisances)
    choices = [single, *kept]
    found.models[:] = rebuild_models(evidence, found.models[0], choices, settled)
    found.choices[:] = choices
    found.rows[trial.name] = listing.row_of_trial(trial, single)
    replaced = set(FALLS)
    for name in replaced:
        row = found.rows[name]
        found.rows[name] = replace(row, reason=f"{trial.name} explains it, and what is late of it")
    return replaced
