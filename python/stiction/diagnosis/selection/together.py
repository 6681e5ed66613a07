"""Two causes that hide each other: each is asked again beside the other one."""

from __future__ import annotations

import logging
from collections.abc import Sequence, Set
from dataclasses import replace
from typing import Final

from ..screening.model import Model, without_effect
from .beside import stands_out
from .choose import Choice, choose, strangers
from .decide import Trial
from .trials import Screening, promises

__all__ = ["pass_together", "passes_beside"]

FEW: Final = 5
"""Candidates that are asked beside the first one."""

_logger = logging.getLogger(__name__)


def passes_beside(screening: Screening, trials: Sequence[Trial]) -> Choice | None:
    """What would pass, had not another trial looked like the cause that it imitates.

    Two causes at once make each other's strength uneven: the one that was refused for that is asked
    again beside the one that passed, and a relative that was refused with it. If it passes there,
    both are causes.
    """
    passed = sorted((t for t in trials if not t.reason), key=lambda t: -t.worth)
    found = [t for w in passed[:1] for t in strangers(trials, w) if t.imitates]
    kin = [t for t in found if t.candidate.record.family == found[0].candidate.record.family]
    if not kin:
        return None
    left = [trial for trial in trials if not any(trial is each for each in kin)]
    choice = choose(left, screening.encompasses)
    if choice is None:
        return None
    model = choice.winner.model
    families = {choice.winner.candidate.record.family}
    scores = {score.candidate.name: score for score in screening.scores(model)}
    for other in kin:
        score = scores[other.name]
        if not promises(score) or not stands_out(screening.evidence, score, families):
            continue
        if not screening.trial(model, score).reason:
            _logger.info("%s passes beside %s", other.name, choice.winner.name)
            return choice
    return None


def pass_together(
    screening: Screening, base: Model, trials: Sequence[Trial], families: Set[str] = frozenset()
) -> Choice | None:
    """The best of what is refused for how uneven it is, where it passes beside another.

    Over blocks or by kind of recording: each of two causes is left in the residual that judges the
    other one. If the second passes beside the first, and the first beside the second, both are
    causes. ``families`` are those of causes that are named already.
    """
    evidence = screening.evidence
    refused = [trial for trial in trials if trial.by_blocks or trial.is_uneven]
    seen = [trial for trial in refused if not trial.unseen]
    first = max(seen, key=lambda t: t.worth, default=None)
    if first is None or any(trial.worth > first.worth for trial in trials):
        return None
    if not stands_out(evidence, first.score, families):
        return None
    own = {first.candidate.record.family}
    others = [
        score
        for score in screening.scores(first.model)
        if score.candidate.name != first.name and promises(score)
        if screening.may_count(score) and stands_out(evidence, score, families | own)
    ]
    for score in others[:FEW]:
        second = screening.trial(first.model, score)
        if second.reason:
            continue
        alone = screening.fit(without_effect(second.model.plant, first.name), base.nuisances)
        again = next(s for s in screening.scores(alone) if s.candidate.name == first.name)
        beside = screening.trial(alone, again) if promises(again) else None
        if beside is not None and not beside.reason:
            _logger.info("%s and %s pass together", first.name, second.name)
            passed = replace(first, reason="", by_blocks=False, uneven=beside.uneven)
            asked = [passed if trial is first else trial for trial in trials]
            return choose(asked, screening.encompasses)
        break
    return None
