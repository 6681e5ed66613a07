"""Which of several plants leave least, without seeing through those that leave more."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeVar

from .._support.workers import side_by_side
from ..plant import Plant

__all__ = ["likeliest"]

Item = TypeVar("Item")


def likeliest(
    plants: Sequence[Plant],
    items: Sequence[Item],
    power: Callable[[Plant, Item], float],
    number: int = 1,
) -> list[Plant]:
    """The plants that leave the least power over all items, the best first.

    A power only grows with each item: a plant that has left more in some of them than ``number``
    others in all is not asked about the rest. All plants see the first item; those that leave
    little there go first through the others.

    Parameters
    ----------
    plants : sequence of Plant
    items : sequence
        Such as recordings.
    power : callable
        What a plant leaves in an item, at least 0; what is not finite counts as infinite.
    number : int
        How many of the plants are wanted.

    Returns
    -------
    list of Plant
        Of plants that leave the same the earlier one first.
    """

    def left(plant: Plant, item: Item) -> float:
        found = power(plant, item)
        return found if math.isfinite(found) else math.inf

    begun = list(side_by_side(lambda plant: left(plant, items[0]), plants))
    totals: list[tuple[float, int]] = []
    for total, place in sorted(zip(begun, range(len(plants)), strict=True)):
        most = totals[number - 1][0] if len(totals) >= number else math.inf
        if len(items) > 1 and total <= most:
            for own in side_by_side(partial(left, plants[place]), items[1:]):
                total += own
                if total > most:
                    break
        if total <= most:
            totals = sorted([*totals, (total, place)])
    return [plants[place] for _, place in totals[:number]]
