"""What became of each effect, a row each with its reason."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final

from ..records import CandidateRow, Cause
from ..screening.candidates import Candidate
from ..screening.screen import Score
from .choose import Choice
from .decide import Trial

__all__ = ["in_order", "row_at_interrupt", "row_of_candidate", "row_of_score", "row_of_trial"]

IMITATED: Final = 0.1
"""Share of a signature beside the base below which the base is what hides it."""
STOPPED: Final = "the diagnosis was interrupted"


def row_of_score(score: Score) -> CandidateRow:
    """What the screening says of one that is not refitted."""
    if not score.testable and score.left > IMITATED:
        reason = "not testable: 2 % of the friction would not show beside what else is left"
    elif not score.testable:
        few = f"{100 * score.left:.0f}" if score.left > 0.0095 else f"{100 * score.left:.1g}"
        share = "all" if score.left < 1e-4 else f"all but {few} %"
        reason = f"not testable: the base imitates {share} of it on these data"
    elif score.score <= score.threshold:
        reason = "explains less than the limit that noise and misfit set"
    else:
        reason = "does not help on rows held out"
    return CandidateRow(score.candidate.name, score.score, score.threshold, score.heldout, reason)


def row_of_trial(trial: Trial, choice: Choice | None) -> CandidateRow:
    """What a refit says, beside the one that was chosen."""
    score = trial.score
    if choice is not None and trial is choice.winner:
        reason = f"accepted beside a look-alike: {trial.reason}" if trial.reason else "accepted"
    elif choice is None:
        reason = trial.reason or "passes, but may imitate one that was refused and explains more"
    elif trial.reason:
        reason = trial.reason
    elif any(trial is each for each in choice.aside):
        reason = f"would resemble {choice.winner.name} by chance alone"
    elif trial in choice.rivals:
        reason = f"these data cannot tell it from {choice.winner.name}"
    else:
        reason = f"{choice.winner.name} explains more"
    return CandidateRow(trial.name, score.score, score.threshold, trial.gain, reason)


def row_of_candidate(candidate: Candidate) -> CandidateRow:
    """One that nobody got to look at."""
    return CandidateRow(candidate.name, None, None, None, f"not screened: {STOPPED}")


def row_at_interrupt(score: Score, trials: Sequence[Trial]) -> CandidateRow:
    """One that passed the screening, where Ctrl-C ended the round before its decision."""
    trial = next((each for each in trials if each.name == score.candidate.name), None)
    if trial is None:
        return replace(row_of_score(score), reason=f"not refitted: {STOPPED}")
    row = row_of_trial(trial, None)
    return row if trial.reason else replace(row, reason=f"passes, and not decided: {STOPPED}")


def in_order(rows: Iterable[CandidateRow], causes: Sequence[Cause]) -> tuple[CandidateRow, ...]:
    """Every effect: causes in their order, with what is in doubt, then the others by score."""
    accepted: Mapping[str, int] = {cause.name: k for k, cause in enumerate(causes)}
    doubts = {cause.name: cause.doubt for cause in causes if cause.doubt}
    told = (
        replace(row, reason=f"{row.reason}, but {doubts[row.name]}") if row.name in doubts else row
        for row in rows
    )
    return tuple(
        sorted(
            told,
            key=lambda row: (
                accepted.get(row.name, len(accepted)),
                -(row.score if row.score is not None else -1.0),
                row.name,
            ),
        )
    )
