"""Fitted parameters as rows of a table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

from ...catalogue import effects, laws
from ..numbers import between

if TYPE_CHECKING:
    from ...fitting.result import FitParameter
    from ...plant import Plant

__all__ = ["meanings_of", "row"]

BODY: Final = {
    "inertia": "moving inertia or mass",
    "gravity_amplitude": "greatest effort of the weight over a turn",
    "gravity_zero_rad": "position at which the weight pulls nowhere",
    "weight_n": "weight along the motion",
}


def row(
    path: str, parameter: FitParameter, meaning: str, remarks: Sequence[str] = ()
) -> dict[str, Any]:
    """A parameter: name, meaning, value, interval, unit and what is odd about it."""
    value, interval = between(parameter.value, *parameter.ci95)
    low, high = parameter.ci95
    notes = []
    if parameter.at_bound:
        notes.append(f"at its {parameter.at_bound} bound")
    if any(remark.startswith(f"{path} is not determined") for remark in remarks):
        notes.append("not determined by these data")
    elif low <= 0.0 <= high and not parameter.at_bound:
        notes.append("not told from 0")
    return {
        "path": path,
        "name": path.rsplit(".", 1)[-1],
        "meaning": meaning,
        "value": value,
        "interval": interval,
        "unit": "" if parameter.unit == "1" else parameter.unit,
        "notes": notes,
    }


def meanings_of(plant: Plant) -> dict[str, str]:
    """What each parameter of a plant is, by path."""
    found = {f"body.{name}": meaning for name, meaning in BODY.items()}
    for law in laws():
        if law.name == plant.friction.law:
            found |= {f"friction.{p.name}": p.meaning for p in law.parameters}
    for effect in effects():
        found |= {f"effects.{effect.name}.{p.name}": p.meaning for p in effect.parameters}
    return found
