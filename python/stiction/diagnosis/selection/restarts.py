"""Starts of refits beside those that slopes tell: where another cause or an earlier search led."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from ..screening.model import Model
from ..screening.screen import Score
from .decide import Trial
from .trials import KEPT, WORTH_MOVING, Screening

__all__ = ["from_before", "from_the_first"]

AS_MUCH: Final = 0.5
"""A candidate that promised this share of what the first one did, and came to less than it
promised or was refused, begins again where that has led the plant."""
MOST_AGAIN: Final = 3
"""So many of them."""
WAVE: Final = "order"
"""Scale of shapes that say how often an effect repeats."""


def from_the_first(
    screening: Screening,
    base: Model,
    scores: Sequence[Score],
    trials: Sequence[Trial],
    first: Trial,
) -> list[Trial]:
    """Trials, with what promised about as much as the first and came to less begun beside it.

    What passes with all that it promised was held by no valley of the base.
    """
    known = {trial.name: trial for trial in trials}
    enough = AS_MUCH * first.score.score

    def is_behind(score: Score) -> bool:
        trial = known.get(score.candidate.name)
        promised = score.testable and score.score >= max(score.threshold, enough)
        behind = trial is None or (
            trial.worth < first.worth and not trial.imitates and not _kept_its_promise(trial)
        )
        # A wave of any length bends itself to whatever is left; it needs no such help.
        wave = any(shape.scale == WAVE for shape in score.candidate.record.shapes)
        return promised and behind and not wave

    for score in list(filter(is_behind, scores))[:MOST_AGAIN]:
        _keep_the_better(known, screening.from_where(base, score, first))
    return list(known.values())


def from_before(
    screening: Screening, base: Model, scores: Sequence[Score], trials: Sequence[Trial]
) -> list[Trial]:
    """Trials, with what was fitted earlier begun from there."""
    known = {trial.name: trial for trial in trials}
    for score in scores if screening.earlier else ():
        if score.testable:
            _keep_the_better(known, screening.from_before(base, score))
    return list(known.values())


def _kept_its_promise(trial: Trial) -> bool:
    """Whether a trial passes, and explains what the screening promised."""
    return not trial.reason and trial.explained >= KEPT * trial.score.score


def _keep_the_better(known: dict[str, Trial], again: Trial | None) -> None:
    """Puts a trial in the place of one of the same effect that leaves more."""
    if again is None:
        return
    own = known.get(again.name)
    if own is None or again.model.power < (1.0 - WORTH_MOVING) * own.model.power:
        known[again.name] = again
