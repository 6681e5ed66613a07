"""What the rows that test speak against, or say as little of as the fit does, is no cause."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from .gain import HeldOut, gain_of
from .rounds import Search

__all__ = ["confirmed"]

AGAINST: Final = "the rows that test speak against it"
NOT_KNOWN: Final = (
    "neither its strength nor its gain on the rows that test can be told from nothing"
)


def confirmed(selection: Search, test: HeldOut | None, seed: int) -> Search:
    """The selection without the last causes that the rows that test do not bear out.

    Rows that test choose nothing. They may take a name away, though: a plant that simulates worse
    with an effect than without it must not come with it, and where the interval of the gain
    includes 0, the strength at least must be known.

    Parameters
    ----------
    selection : Search
    test : HeldOut or None
        Residuals of its models; without them nothing is taken away.
    seed : int
    """
    choices, rows = list(selection.choices), dict(selection.rows)
    while test is not None and choices:
        last = len(choices) - 1
        low, high = gain_of(test, last, last + 1, seed).ci95
        winner = choices[last].winner
        if high < 0.0:
            reason = AGAINST
        elif low <= 0.0 and not selection.models[last + 1].knows(winner.candidate):
            reason = NOT_KNOWN
        else:
            break
        choices.pop()
        if winner.name in rows:
            rows[winner.name] = replace(rows[winner.name], reason=reason)
    models = selection.models[: len(choices) + 1]
    return replace(selection, models=models, choices=choices, rows=rows)
