"""Clocks that stand in two columns, as those of ROS do: seconds and nanoseconds."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .table import Table

__all__ = ["one_clock"]

_NANO: Final = re.compile(r"(nano_?sec(ond)?s?|nsecs?|nanos)$", re.IGNORECASE)
_WHOLE: Final = ("sec", "secs", "second", "seconds", "s")
_NANOSECONDS: Final = 1e9
_LONG_AGO: Final = 1e8
"""s since 1970: what is later is no uptime."""


def one_clock(table: Table) -> Table:
    """The table with one column, of seconds since its first row, in place of each such pair.

    The names of a pair are alike but for the word at their end, and the second counts below 10⁹.
    """
    pairs = _pairs(table)
    if not pairs:
        return table
    columns = dict(table.columns)
    units, begins = dict(table.units), dict(table.begins)
    unusable, clocks = dict(table.unusable), dict(table.clocks)
    for name, (whole, nano) in pairs.items():
        seconds, parts = columns.pop(whole), columns.pop(nano)
        known = np.flatnonzero(np.isfinite(seconds) & np.isfinite(parts))
        first = int(known[0])
        # Of the sum itself the nanoseconds would be lost.
        columns = {name: (seconds - seconds[first]) + 1e-9 * (parts - parts[first]), **columns}
        units[name] = "s"
        if seconds[first] > _LONG_AGO:
            begins[name] = float(seconds[first] + 1e-9 * parts[first])
        reason = f"is a part of the clock '{name}'"
        unusable |= {whole: reason, nano: reason}
        clocks = {
            column: name if clock in (whole, nano) else clock for column, clock in clocks.items()
        }
    return replace(
        table, columns=columns, units=units, begins=begins, unusable=unusable, clocks=clocks
    )


def _pairs(table: Table) -> dict[str, tuple[str, str]]:
    """Names of seconds and nanoseconds, by the name of the clock that they are."""
    found: dict[str, tuple[str, str]] = {}
    for nano, parts in table.columns.items():
        word = _NANO.search(nano)
        if word is None:
            continue
        stem = nano[: word.start()]
        for whole, seconds in table.columns.items():
            same = whole.startswith(stem) and whole[len(stem) :].casefold() in _WHOLE
            if same and _fit(seconds, parts):
                found[f"{whole} + {word[0]}"] = (whole, nano)
                break
    return found


def _fit(seconds: FloatArray, parts: FloatArray) -> bool:
    if len(seconds) != len(parts):
        return False
    known = parts[np.isfinite(parts) & np.isfinite(seconds)]
    return bool(len(known)) and float(known.min()) >= 0.0 and float(known.max()) < _NANOSECONDS
