"""Signals with clocks of their own, brought to the rows of one of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from ..errors import InputError
from .column_words import what_it_says
from .columns import CANONICAL
from .table import Table

__all__ = ["Aligned", "align", "on_main_clock", "time_of"]

HELD: Final = ("input", "enabled")
"""Channels that hold from one row of theirs to the next; all others are interpolated."""
_RISING: Final = 0.95


def time_of(table: Table) -> str | None:
    """The column of a file that is its time, by its name or, without one, for it alone rises."""
    named = [
        name
        for name in table.columns
        if CANONICAL.get(name, ("",))[0] == "time" or what_it_says(name).kinds[:1] == ("time",)
    ]
    rising = [name for name, values in table.columns.items() if _rises(values)]
    both = [name for name in named if name in rising]
    if both or named:
        return (both or named)[0]
    return rising[0] if rising and not what_it_says(rising[0]).kinds else None


def _rises(values: FloatArray) -> bool:
    steps = np.diff(values)
    return len(steps) > 0 and float(np.mean(steps > 0.0)) >= _RISING


@dataclass(frozen=True)
class Aligned:
    """Channels on the rows of one clock.

    Attributes
    ----------
    values : dict of str to ndarray, shape (rows,)
    first : int
        Row of the file that became row 0: what lies before all signals began is left out.
    notes : tuple of str
    """

    values: dict[str, FloatArray]
    first: int
    notes: tuple[str, ...]


def align(
    table: Table,
    values: Mapping[str, FloatArray],
    names: Mapping[str, str],
    factor: float,
) -> Aligned:
    """Bring channels to the rows of the channel time.

    Parameters
    ----------
    table : Table
    values : mapping of str to ndarray
        SI values by role, time among them; lengths differ where clocks do.
    names : mapping of str to str
        Columns by role.
    factor : float
        s per unit of the time column, for the clocks of the others.

    Raises
    ------
    InputError
        Signals that were not recorded at the same time.
    """
    own = names["time"]
    foreign = {
        role: clock
        for role, name in names.items()
        if role != "time" and (clock := table.clocks.get(name)) not in (None, own)
    }
    if not foreign:
        return Aligned(dict(values), 0, ())
    time = values["time"]
    clocks = {
        clock: factor * table.find(clock, "the time of a column") + _shift(table, own, clock)
        for clock in set(foreign.values())
        if clock is not None
    }
    low, high = _common(table, [time, *clocks.values()])
    inside = np.flatnonzero((time >= low) & (time <= high))
    rows = slice(int(inside[0]), int(inside[-1]) + 1)
    found: dict[str, FloatArray] = {}
    notes = []
    for role, array in values.items():
        clock = foreign.get(role)
        if clock is None:
            found[role] = array[rows]
            continue
        how = "held" if role in HELD else "interpolated"
        found[role] = _read_at(time[rows], clocks[clock], array, held=role in HELD)
        notes.append(
            f"{role}: column '{names[role]}' has a clock of its own, '{clock}', and was {how} "
            f"from it at the rows of '{own}'"
        )
    return Aligned(found, rows.start, tuple(notes))


def on_main_clock(table: Table) -> Table:
    """A table for the eye: every column on the rows of the clock that the position has.

    Of several the first; where no name tells a position, the clock of most columns.

    Parameters
    ----------
    table : Table
        Unchanged where its columns have one clock.
    """
    clocks = {name: table.clocks[name] for name in table.columns if name in table.clocks}
    if len(set(clocks.values())) < 2:
        return table
    placed = [clock for name, clock in clocks.items() if _is_position(name)]
    usual = max(clocks.values(), key=list(clocks.values()).count)
    own = placed[0] if placed else usual
    time = table.columns[own]
    columns: dict[str, FloatArray] = {}
    unusable = dict(table.unusable)
    for name, values in table.columns.items():
        clock = clocks.get(name, own)
        if clock == own:
            columns[name] = values
        elif name == clock:
            unusable[name] = f"is a clock of other signals, and '{own}' that of the position"
        else:
            at = table.columns[clock] + _shift(table, own, clock)
            columns[name] = _read_at(time, at, values, held=False)
    return replace(table, columns=columns, unusable=unusable)


def _is_position(name: str) -> bool:
    return what_it_says(name).kinds[:1] == ("position",)


def _shift(table: Table, own: str, clock: str) -> float:
    """What is to be added to a clock whose first row was at another moment, s."""
    begins = table.begins
    return begins[clock] - begins[own] if own in begins and clock in begins else 0.0


def _common(table: Table, clocks: list[FloatArray]) -> tuple[float, float]:
    known = [clock[np.isfinite(clock)] for clock in clocks]
    if any(len(clock) == 0 for clock in known):
        raise InputError(f"{table.path}: a clock of its signals holds no number; record it again")
    low = max(float(clock.min()) for clock in known)
    high = min(float(clock.max()) for clock in known)
    if low >= high or not np.any((clocks[0] >= low) & (clocks[0] <= high)):
        raise InputError(
            f"{table.path}: its signals were not recorded at the same time: one begins at "
            f"{low:.6g} s, after another ends at {high:.6g} s; take them from one run"
        )
    return low, high


def _read_at(rows: FloatArray, clock: FloatArray, values: FloatArray, *, held: bool) -> FloatArray:
    known = np.isfinite(clock)
    order = np.argsort(clock[known], kind="stable")
    at, cells = clock[known][order], values[known][order]
    if held:
        last = np.searchsorted(at, rows, side="right") - 1
        return cells[np.clip(last, 0, len(cells) - 1)]
    # Between a cell that is missing and its neighbour nothing is known.
    read: FloatArray = np.interp(rows, at, cells)
    return read
