"""What an effect is beyond the form in which it is looked for: a second wave, shapes of its own."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Final

from ...catalogue import EffectRecord
from ...plant import Plant
from ...plant.parameter import Parameter
from ...plant.stated import Effect
from ..screening.block_gains import heldout_gain, log_gain
from ..screening.model import Model, likeliest_of
from .choose import Choice
from .decide import LEAST_GAIN, LEAST_Z, PENALTY, Trial
from .trials import MUCH, Screening, promises

__all__ = ["beside_a_second", "free_shapes", "has_free_shapes"]

PURE: Final = "one"
"""Scale of shapes that are numbers of their own, as an exponent is: what is measured in a length
or an input of the session may exchange for a gain."""

FROM_NOTHING: Final = (0.3, 1.0, 3.0)
"""Shares of what is typical from which a shape starts that is held at 0: no slope leads away."""
WIDER: Final = 20.0
"""Factor by which such a shape may leave what is typical."""

_logger = logging.getLogger(__name__)


def free_shapes(screening: Screening, choice: Choice) -> Choice:
    """A choice with a second wave, and with shapes of its own, where these pass like an effect.

    What repeats with position is seldom a sine, and a shape that the screening holds is seldom
    right: the rest of either would be taken for another effect.
    """
    winner = choice.winner
    for further in (_second_wave, _freed):
        model = further(screening, winner)
        if model is not None:
            winner = replace(winner, model=model)
    return replace(choice, winner=winner)


def has_free_shapes(effect: Effect, record: EffectRecord) -> bool:
    """Whether an effect has a second wave or shapes that the screening holds."""
    if any(name in effect.parameters for name in record.second):
        return True
    return any(not effect.parameters[name].fixed for name in _held(record))


def beside_a_second(screening: Screening, base: Model, trial: Trial) -> Trial:
    """A trial that was refused, with a second wave where that passes together with the first.

    Where two waves are about as large, one alone does harm wherever they cancel.
    """
    score = trial.score
    if not trial.reason or score.score <= max(MUCH, score.threshold):
        return trial
    found = _second(screening, trial)
    if found is None:
        return trial
    second, other = found
    explained = screening.contribution(score, other.model) + second.contribution(
        other.score, other.model
    )
    both = screening.judge(base, score, other.model, explained)
    if both.reason:
        return trial
    _logger.info("%s passes with a second wave", trial.name)
    return replace(both, worth=both.worth - PENALTY * other.candidate.parameters)


def _second_wave(screening: Screening, winner: Trial) -> Model | None:
    """The winner with a second wave; None where that does not pass."""
    found = _second(screening, winner)
    if found is None or found[1].reason:
        return None
    _logger.info("%s has a second wave", winner.name)
    return found[1].model


def _second(screening: Screening, trial: Trial) -> tuple[Screening, Trial] | None:
    """A second wave refitted beside the first one, and what it was screened with."""
    record = trial.candidate.record
    if not record.second:
        return None
    effect = _effect(trial.model.plant, trial.name)
    if any(name in effect.parameters for name in record.second):
        return None
    own = screening.signatures.second_of(effect)
    if not own.candidates:
        return None
    second = screening.with_signatures(own)
    (score,) = second.scores(trial.model)
    return (second, second.trial(trial.model, score)) if promises(score) else None


def _freed(screening: Screening, winner: Trial) -> Model | None:
    """The winner with shapes that the screening holds fitted as well; None where nothing gains."""
    before, record = winner.model, winner.candidate.record
    held = _held(record)
    if not held:
        return None
    plants = _with_shapes_free(before.plant, record, held)
    several, nuisances = len(plants) > 1, before.nuisances
    start = likeliest_of(screening.evidence, plants, nuisances) if several else plants[0]
    model = screening.fit(start, nuisances)
    gain, z = heldout_gain(before, model)
    if gain <= LEAST_GAIN or z <= LEAST_Z or log_gain(before, model) <= PENALTY * len(held):
        return None
    # A shape that exchanges for a gain leaves neither known.
    if not model.knows(winner.candidate, whatever_shape=True):
        return None
    _logger.info("%s has %s of its own", record.name, " and ".join(held))
    return model


def _with_shapes_free(plant: Plant, record: EffectRecord, held: Sequence[str]) -> list[Plant]:
    """A plant whose effect has these shapes free, from every start that they have."""
    effect = _effect(plant, record.name)
    typical = {each.name: each.typical for each in record.parameters}
    starts = []
    for name in held:
        own, usual = effect.parameters[name], typical[name]
        if own.value == 0.0:
            low, high = usual / WIDER, usual * WIDER
            starts.append([Parameter(share * usual, low, high) for share in FROM_NOTHING])
        else:
            starts.append([replace(own, fixed=False)])
    plants = []
    for point in product(*starts):
        parameters = {**effect.parameters, **dict(zip(held, point, strict=True))}
        freed = Effect(effect.name, parameters)
        effects = tuple(freed if each is effect else each for each in plant.effects)
        plants.append(replace(plant, effects=effects))
    return plants


def _held(record: EffectRecord) -> tuple[str, ...]:
    """Shapes of an effect that its candidates hold at one value, and that a fit may well vary."""
    return tuple(
        s.parameter for s in record.shapes if not s.fitted and s.scale == PURE and len(s.grid) == 1
    )


def _effect(plant: Plant, name: str) -> Effect:
    return next(each for each in plant.effects if each.name == name)
