"""Which of several plants leave least, without seeing through those that leave more."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeVar

from ..plant import Plant
from ..workers import side_by_side

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
    totals: dict[int, float] = {}
    for place in sorted(range(len(plants)), key=lambda place: (begun[place], place)):
        least = sorted(totals.values())[:number]
        most = least[-1] if len(least) == number else math.inf
        total = begun[place]
        if len(items) > 1 and total <= most:
            for own in side_by_side(partial(left, plants[place]), items[1:]):
                total += own
                if total > most:
                    break
        if total <= most:
            totals[place] = total
    best = sorted(totals, key=lambda place: (totals[place], place))
    return [plants[place] for place in best[:number]]
