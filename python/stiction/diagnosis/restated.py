"""The diagnosis made again with another law, at the end or as soon as that one is clearly right."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from .._support.best_effort import Failure, attempt
from .._support.progress import phase
from ..plant import Plant
from .findings.conclude import MESSAGE, Conclusion
from .findings.result import Diagnosis
from .records import LawRow, Unexplained
from .selection.laws import HOPELESS, THE_LAW, Rival, better_laws, rivals_of
from .selection.search import Search

__all__ = ["diagnose_again_at_the_end", "diagnose_again_early", "is_outdone", "outdo"]

_logger = logging.getLogger(__name__)


def is_outdone(found: Search) -> bool:
    """Whether another law leaves, held out, next to nothing of what the plant's own does.

    Asked once, beside the first cause: a law is given up by the same measure by which others are
    that nobody asked for. What would be added to it stands for the law, and is given up with it.

    Raises
    ------
    KeyboardInterrupt
    """
    rivals = rivals_of(found, (), lacking=True)
    if found.interrupted:
        raise KeyboardInterrupt
    return outdo(rivals)


def outdo(rivals: Sequence[Rival]) -> bool:
    """Whether one of these laws leaves next to nothing of what the plant's own does."""
    better = better_laws(rivals, 0, None, 0)
    return bool(better) and HOPELESS * (1.0 - better[0].beside) < 1.0


def diagnose_again_early(
    conclusion: Conclusion, again: Callable[[Plant], Diagnosis | None]
) -> Diagnosis | None:
    """The diagnosis with a law that outdoes the plant's own beside the first cause.

    None where the rows that test are against it, or where nothing comes of it. After Ctrl-C what
    is known of the plant as it was stated.

    Parameters
    ----------
    conclusion : Conclusion
        Of the search up to the first cause.
    again : callable
        The diagnosis of a plant; None where these data do not suffice for that.
    """
    try:
        if not conclusion.better:
            return None
        return _restated(conclusion, conclusion.law_rows, again)
    except KeyboardInterrupt:
        conclusion.interrupted = conclusion.brief = True
        return conclusion.diagnosis()


def diagnose_again_at_the_end(
    told: Diagnosis, conclusion: Conclusion, again: Callable[[Plant], Diagnosis | None]
) -> Diagnosis:
    """The diagnosis with the law that is the better one, where that can be told, or ``told``.

    What was told of the plant as it was stated stays after Ctrl-C as well.

    Parameters
    ----------
    told : Diagnosis
        Of the plant as it was stated.
    conclusion : Conclusion
        Where that comes from.
    again : callable
        The diagnosis of a plant; None where these data do not suffice for that.
    """
    try:
        return _restated(conclusion, told.laws, again) or told
    except KeyboardInterrupt:
        return replace(told, success=False, message=MESSAGE)


def _restated(
    conclusion: Conclusion,
    laws: Sequence[LawRow],
    again: Callable[[Plant], Diagnosis | None],
) -> Diagnosis | None:
    """The diagnosis with the better law; None where it comes to nothing.

    What is named beside a law that lacks something stands for that. Where the other law is outdone
    in its turn, neither is right.

    Raises
    ------
    KeyboardInterrupt
    """
    better = conclusion.better[0]
    phase(_logger, "diagnosing again, with law %s", better.law)
    plant = replace(conclusion.found.plant, friction=better.statement)
    beside = attempt(f"the diagnosis with {better.law}", partial(again, plant))
    if beside is None or isinstance(beside, Failure):
        return None
    if not beside.success:
        raise KeyboardInterrupt
    if beside.better_law or beside.verdict == "not_testable":
        return None
    nothing = beside.verdict == "nothing_missing"
    return replace(
        beside,
        verdict="unexplained" if nothing else beside.verdict,
        unexplained=(Unexplained(THE_LAW, better.beside),) if nothing else beside.unexplained,
        sentence=f"{conclusion.law_words} With {better.law}: {beside.sentence}",
        laws=tuple(laws),
        better_law=better.law,
        advice=(*beside.advice, better.advice(followed=True)),
    )
