"""Beside names: whether a further cause is more than what the forms of those before it leave.

What noise reaches is known for a model that is right. The form of an effect is its author's: a
machine's own leaves a rest of it, which something else follows a little.
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import replace
from typing import Final

from ..data.evidence import Evidence
from ..screening.block_gains import heldout_gain
from ..screening.screen import Score
from .decide import LEAST_GAIN, LEAST_STRENGTH, Trial
from .search import Search
from .trials import compared_fit

__all__ = ["doubt_by_forms", "doubt_by_rests", "stands_out"]

BESIDE_NAMES: Final = 2.0
"""So many times its threshold a further cause scores: second ones that were hidden came to 2.2 and
more, what followed the rest of a first one's form to 1.1, 2.1 and 3.2."""
CARRIED_OVER: Final = 0.3
"""A cause beside others that gains more than this on rows held out..."""
SURELY: Final = 4.0
"""... by so many standard errors is no rest of their forms: what followed these came to .2 and
3.5."""


def stands_out(evidence: Evidence, score: Score, families: Set[str]) -> bool:
    """Whether a candidate beside causes of these families explains more than their forms may leave.

    Relatives pass all the same: what one of several waves leaves speaks against it. Of what is late
    a slope tells too little, and so it does of all causes where a loop is simulated, which bends
    itself far.
    """
    record = score.candidate.record
    if not families or record.family in families or record.late or evidence.loop:
        return True
    return score.score > BESIDE_NAMES * score.threshold


def doubt_by_forms(evidence: Evidence, trial: Trial, families: Set[str]) -> str:
    """Why a trial that passed may be what the forms of these families leave, "" where it is not.

    What a refit gains held out tells as much as a score does.
    """
    score = trial.score
    if trial.reason or stands_out(evidence, score, families):
        return ""
    if trial.gain > CARRIED_OVER and trial.z > SURELY:
        return ""
    return (
        f"scores {100 * score.score:.1f} % of what the causes before it leave; below "
        f"{100 * BESIDE_NAMES * score.threshold:.1f} % their forms may leave that"
    )


def doubt_by_rests(evidence: Evidence, found: Search) -> str:
    """Why the last cause may be what the form of an earlier one leaves, "" where it is not.

    A relative that was taken back as that rest explains it: what comes after it has to explain
    something beside it, or it follows the same rest less well.
    """
    choice, (before, whole) = found.choices[-1], found.models[-2:]
    (own,) = (each for each in whole.plant.effects if each.name == choice.winner.name)
    for name, model in found.rests:
        (rest,) = (each for each in model.plant.effects if each.name == name)
        plant = replace(before.plant, effects=(*before.plant.effects, rest))
        less = compared_fit(evidence, plant, model.nuisances)
        plant = replace(less.plant, effects=(*less.plant.effects, own))
        both = compared_fit(evidence, plant, less.nuisances)
        weak = both.strength(choice.winner.candidate) < LEAST_STRENGTH
        if weak or heldout_gain(less, both)[0] <= LEAST_GAIN:
            return f"explains nothing beside {name}, which may be what the form before it leaves"
    return ""
