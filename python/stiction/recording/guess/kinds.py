"""What the name of a column says it may be."""

from __future__ import annotations

from typing import Final

from .evidence import Column

_KIND_OF_QUANTITY: Final = {
    "time": "time",
    "angle": "position",
    "length": "position",
    "count": "position",
    "angular velocity": "velocity",
    "velocity": "velocity",
    "current": "drive",
    "voltage": "drive",
    "torque": "drive",
    "force": "drive",
    "temperature": "temperature",
}


def kinds_of(column: Column) -> tuple[str, ...]:
    """What a column may be, by its name and the unit in it, the likeliest first."""
    said = column.said
    if said.unit is None:
        return said.kinds
    kind = _KIND_OF_QUANTITY.get(said.unit.quantity, "")
    if said.kinds:
        return (kind,) if kind in said.kinds else said.kinds
    if kind == "position" and said.wanted:
        return ("reference",)
    return (kind,) if kind else ()


def stated_quantity(column: Column) -> str | None:
    """Of a drive or load: what it is measured in, by unit or word."""
    if column.said.unit is not None:
        return column.said.unit.quantity
    return column.said.quantity if column.said.kinds[:1] == ("drive",) else None


def by_name(column: Column) -> str:
    """How its name told what a column is."""
    if column.said.strength == 3:
        return "the name is a canonical one"
    if column.said.word:
        return f"by the word '{column.said.word}' in its name"
    return "by the unit in its name" if column.said.unit else "by its name"
