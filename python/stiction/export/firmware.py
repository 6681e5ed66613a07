"""C99 of a plant: a step of its contact, its feed-forward and an observer of what is left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .contact_source import ContactSource, collapse_blank_lines, plant_numbers, prologue
from .fragments import Fragments, names_of

if TYPE_CHECKING:
    from ..plant import Plant

__all__ = ["Firmware"]


@dataclass(frozen=True)
class Firmware:
    """C of a plant.

    Attributes
    ----------
    source : str
        What comes after the head of the file.
    header : str
    steps : bool
        Whether the law has C, so that there is a step.
    held : tuple of str
        Effects of the plant that the step holds.
    """

    source: str
    header: str
    steps: bool
    held: tuple[str, ...]

    @classmethod
    def of(cls, plant: Plant, curves: Mapping[str, Any]) -> Firmware:
        """Of a plant and the constants of its feed-forward."""
        fragments = Fragments({**plant_numbers(plant), **curves})
        there = plant.friction.law in names_of("laws")
        step, types = "", ""
        held: tuple[str, ...] = ()
        if there:
            contact = ContactSource.of(plant, fragments)
            steps = "".join(map(fragments.expand, ("init", "step")))
            step = contact.source + "\n" + steps + "\n"
            types, held = contact.types, contact.effects
        text = step + "\n".join(map(fragments.expand, ("feedforward", "gravity", "observer")))
        header = fragments.expand("header").replace("@types@\n", types)
        source = prologue(text) + fragments.constants(text) + "\n" + text
        return cls(collapse_blank_lines(source), collapse_blank_lines(header), there, held)
