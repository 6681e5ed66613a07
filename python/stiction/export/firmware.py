"""C99 of a plant: a step of its contact, its feed-forward and an observer of what is left."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from ..plant.joint import acts, beside
from .contact_source import ContactSource, collapse_blank_lines, plant_numbers, prologue
from .curves import Curves
from .fragments import Fragments, names_of

if TYPE_CHECKING:
    from ..plant import Plant
    from ..plant.stated import Effect

__all__ = ["Firmware"]

MOST: Final = 48
"""Points of each curve of a feed-forward."""


@dataclass(frozen=True)
class Firmware:
    """C of a plant.

    Attributes
    ----------
    source : str
        What comes after the head of the file.
    header : str
    body : str
        Of the source, what comes after the number type and the functions of math.h.
    steps : bool
        Whether the law has C, so that there is a step.
    held, lost : tuple of str
        What of the plant it holds and what not, a sentence each.
    numbers : dict of str to float
        How far lines between points of the feed-forward are off.
    """

    source: str
    header: str
    body: str
    steps: bool
    held: tuple[str, ...]
    lost: tuple[str, ...]
    numbers: dict[str, float]

    @classmethod
    def of(cls, plant: Plant, speed: float) -> Firmware:
        """Of a plant; its feed-forward ends at a greatest speed."""
        curves = Curves.of(plant, speed, MOST)
        constants = {
            "SPEEDS": str(len(curves.speeds)),
            "PLACES": str(len(curves.places)),
            "SPEED_AT": curves.speeds.tolist(),
            "FRICTION_AT": curves.friction.tolist(),
            "PLACE_AT": curves.places.tolist(),
            "EFFORT_AT": curves.efforts.tolist(),
        }
        fragments = Fragments({**plant_numbers(plant), **constants})
        there = plant.friction.law in names_of("laws")
        step, types = "", ""
        effects: tuple[str, ...] = ()
        if there:
            contact = ContactSource.of(plant, fragments)
            steps = "".join(map(fragments.expand, ("init", "step")))
            step = contact.source + "\n" + steps + "\n"
            types, effects = contact.types, contact.effects
        text = step + "\n".join(map(fragments.expand, ("feedforward", "gravity", "observer")))
        header = fragments.expand("header").replace("@types@\n", types)
        body = fragments.constants(text) + "\n" + text
        source = prologue(text) + body
        return cls(
            collapse_blank_lines(source),
            collapse_blank_lines(header),
            body,
            there,
            _held(plant, curves, effects, steps=there),
            _lost(plant, curves, effects, steps=there),
            curves.numbers,
        )


def _held(
    plant: Plant, curves: Curves, effects: tuple[str, ...], *, steps: bool
) -> tuple[str, ...]:
    step = "friction step by step: " + " + ".join((plant.friction.law, *effects))
    moves = not plant.prescribed_motion and plant.inertia > 0.0
    inertia = ("inertia",) if moves else ()
    return (*((step,) if steps else ()), *curves.held, *inertia, "a disturbance observer")


def _lost(
    plant: Plant, curves: Curves, effects: tuple[str, ...], *, steps: bool
) -> tuple[str, ...]:
    if not steps:
        law = plant.friction.law
        return (f"friction step by step: {law} has no C, its feed-forward alone", *curves.lost)

    def held(effect: Effect) -> bool:
        return effect.name in effects or effect.name in curves.effects

    idle = {effect.name for effect in plant.effects if not acts(effect)}
    ahead = tuple(
        f"{name}: in the step, not in the feed-forward"
        for name in effects
        if name not in curves.effects and name not in idle
    )
    return (*beside(plant, held, limited=False, yielding=True), *ahead, *curves.lines)
