"""What law and body of a plant state already of an effect."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from .._support.wording import join_words
from ..catalogue import EffectRecord, effects

if TYPE_CHECKING:
    from .plant import Plant

REMEMBERS: Final = "law.remembers"
"""Of an effect that a law is by what it remembers, and not by a parameter."""
_BODY: Final = "body."


def terms_of(plant: Plant, record: EffectRecord) -> tuple[str, ...]:
    """Parameters of law and body that are the effect, as the plant states them.

    ``body.`` stands before those of the body; ``law.remembers`` is a law that remembers where it
    turned round.
    """
    stated = {*plant.friction.parameters, *(f"{_BODY}{name}" for name in plant.body)}
    if plant.friction.record.remembers:
        stated.add(REMEMBERS)
    return tuple(term for term in record.law_terms if term in stated)


def doubles(plant: Plant) -> Iterator[str]:
    """A sentence for each effect that the plant has twice, by its law or body and by its name."""
    records = {record.name: record for record in effects()}
    for number, effect in enumerate(plant.effects, 1):
        terms = terms_of(plant, records[effect.name])
        if terms:
            where = join_words([_place(plant, term) for term in terms])
            yield (
                f"{plant.source}: [[effects]] {number} ({effect.name}) is stated by {where} as "
                "well: both act, and no recording tells them apart; drop one"
            )


def _place(plant: Plant, term: str) -> str:
    if term == REMEMBERS:
        return f"the memory of law = '{plant.friction.law}'"
    if term.startswith(_BODY):
        return f"[body] {term.removeprefix(_BODY)}"
    return f"[friction] {term}"
