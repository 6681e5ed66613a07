"""What a plant takes for granted that nobody has stated: a line in every output until it is."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from .._support.wording import commas, plural
from .drive import assumed_gain

if TYPE_CHECKING:
    from .plant import Plant

__all__ = ["LEVELS", "assumptions", "open_marks", "unstated_levels"]

TO_DO: Final = "TO DO"
"""By which a draft marks what nobody knew."""
LEVELS: Final = ("coulomb", "breakaway")
"""Parameters of laws that say how much friction there is."""


def unstated_levels(plant: Plant) -> list[str]:
    """Names of the levels of friction of a law none of which a plant states; none where it does."""
    levels = [each.name for each in plant.friction.record.parameters if each.name in LEVELS]
    stated = any(name in plant.friction.parameters for name in levels)
    return [] if stated else levels


def assumptions(plant: Plant, input_unit: str = "") -> tuple[str, ...]:
    """What is taken for granted of efforts and friction, a sentence each.

    Parameters
    ----------
    plant : Plant
    input_unit : str, optional
        Of a recorded input, which counts where the plant names none.
    """
    told = [assumed_gain(plant.drive, input_unit, plant.si_effort_unit)]
    levels = unstated_levels(plant)
    if levels:
        numbers = plant.friction.model().parameters
        sizes = commas([f"{name} {numbers[name]:.3g} {plant.effort_unit}" for name in levels])
        told.append(
            f"{plant.source} states no level of friction: it has the {sizes} of the catalogue, "
            "until you state one"
        )
    return tuple(sentence for sentence in told if sentence)


def open_marks(path: Path) -> str:
    """That a file still has marks of its draft, "" where it has none."""
    lines = path.read_text(encoding="utf-8").splitlines()
    marked = [str(k) for k, line in enumerate(lines, 1) if line.startswith("#") and TO_DO in line]
    if not marked:
        return ""
    say = "says" if len(marked) == 1 else "say"
    return (
        f"{path}: {plural(len(marked), 'line')} of the draft still {say} {TO_DO} "
        f"({commas(marked)}): what stands there is a guess, and so is what follows from it; state "
        "it and take the mark away"
    )
