"""What the rows that test speak against is no cause."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from .gain import HeldOut, gain_of
from .rounds import Search

__all__ = ["confirmed"]

AGAINST: Final = "the rows that test speak against it"


def confirmed(selection: Search, test: HeldOut | None, seed: int) -> Search:
    """The selection without the last causes for which the whole interval of the gain is negative.

    Rows that test choose nothing. They may take a name away, though: a plant that simulates worse
    with an effect than without it must not come with it.
    """
    choices, rows = list(selection.choices), dict(selection.rows)
    while test is not None and choices:
        place = len(choices) - 1
        if gain_of(test, place, place + 1, seed).ci95[1] >= 0.0:
            break
        name = choices.pop().winner.name
        if name in rows:
            rows[name] = replace(rows[name], reason=AGAINST)
    models = selection.models[: len(choices) + 1]
    return replace(selection, models=models, choices=choices, rows=rows)
