"""Signals as they come out of a log: groups of columns, each group with a clock of its own."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.wording import commas
from ..errors import InputError
from .expansion import Expansion
from .table import Table

__all__ = ["Gathered", "damage_error", "missing_package"]

_CLOCK: Final = "time"


class Gathered:
    """Groups of signals on their way into a table.

    Parameters
    ----------
    path : Path
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._expansion = Expansion(path)
        self._rows: dict[str, list[array[float]]] = {}
        self._names: dict[str, list[str]] = {}
        self._kinds: dict[str, list[set[str]]] = {}
        self._whole: dict[str, tuple[FloatArray, dict[str, FloatArray]]] = {}
        self.units: dict[str, str] = {}
        self.unusable: dict[str, str] = {}
        self.begins: float | None = None

    def row(self, group: str, time: float, values: Mapping[str, float]) -> None:
        """Add a row to a group; one that holds other signals than its first is of a group apart.

        Raises
        ------
        InputError
            The file would expand beyond its ceiling.
        """
        told = self._names.get(group)
        if told is not None and told != list(values) and set(told) != set(values):
            # On one topic several may speak, an arm and its hand.
            kinds = self._kinds.setdefault(group, [])
            if set(values) not in kinds:
                kinds.append(set(values))
            group = f"{group}+{1 + kinds.index(set(values))}"
        if group not in self._rows:
            self._names[group] = list(values)
            self._rows[group] = [array("d") for _ in range(len(values) + 1)]
        columns = self._rows[group]
        self._expansion.numbers(f"the signals of '{group}'", len(columns))
        columns[0].append(time)
        for column, name in zip(columns[1:], self._names[group], strict=True):
            column.append(values.get(name, np.nan))

    def room(self, what: str, numbers: int) -> None:
        """Count what a group is going to take, before it is read.

        Raises
        ------
        InputError
            The file would expand beyond its ceiling.
        """
        self._expansion.numbers(what, numbers)

    def whole(self, group: str, time: FloatArray, signals: Mapping[str, FloatArray]) -> None:
        """Add a group that was read at once; what has another length than its time is left out."""
        fit = {}
        for name, values in signals.items():
            if len(values) == len(time):
                fit[name] = values
            else:
                self.unusable[f"{group}.{name}"] = f"has {len(values)} values for {len(time)} times"
        self._whole[group] = (time, fit)

    def table(self, what: str) -> Table:
        """All groups, each column called by group and signal.

        Raises
        ------
        InputError
            There is no signal.
        """
        for group, columns in self._rows.items():
            read = [np.frombuffer(column, dtype=np.float64) for column in columns]
            self._whole[group] = (read[0], dict(zip(self._names[group], read[1:], strict=True)))
        groups = {g: (t, s) for g, (t, s) in self._whole.items() if s and len(t)}
        if not groups:
            held = f" ({commas(f'{n} {why}' for n, why in self.unusable.items())})"
            raise InputError(
                f"{self._path}: no {what} of it holds a signal that is read"
                f"{held if self.unusable else ''}; record joint states, or numbers over time"
            )
        # Stamps that are no numbers are refused later, with their rows: no clock starts there.
        stamps = np.concatenate([time[np.isfinite(time)] for time, _ in groups.values()])
        start = float(stamps.min()) if stamps.size else 0.0
        columns_: dict[str, FloatArray] = {}
        clocks: dict[str, str] = {}
        units: dict[str, str] = {}
        for group, (time, signals) in groups.items():
            before = f"{group}." if group else ""
            clock = f"{before}{_CLOCK}"
            with np.errstate(invalid="ignore"):  # a damaged file may hold signalling NaN
                columns_[clock] = np.ascontiguousarray(time - start)
            units[clock] = "s"
            for name, values in signals.items():
                columns_[f"{before}{name}"] = np.ascontiguousarray(values, dtype=np.float64)
                if unit := self.units.get(f"{group}.{name}"):
                    units[f"{before}{name}"] = unit
            clocks |= {f"{before}{name}": clock for name in (_CLOCK, *signals)}
        several = clocks if len(groups) > 1 else {}
        own = sorted(set(clocks.values()))
        begins = {} if self.begins is None else dict.fromkeys(own, self.begins + start)
        return Table(
            self._path,
            columns_,
            unusable=self.unusable,
            units=units,
            begins=begins,
            clocks=several,
        )


def missing_package(
    path: Path, kind: str, package: str, extra: str, error: Exception
) -> InputError:
    """What is said where the library that reads a kind of file is not installed."""
    return InputError(
        f"{path}: {kind} is read through {package}; install it with "
        f"pip install 'stiction[{extra}]', or save the recording as CSV"
    )


def damage_error(path: Path, kind: str, error: Exception) -> Exception:
    """What to raise of an error that a library met in a file: its own where it is the disk's."""
    if isinstance(error, (InputError, MemoryError)) or (
        isinstance(error, OSError) and error.errno is not None
    ):
        return error
    # What the library looked up in itself says nothing of the file.
    inside = isinstance(error, (LookupError, TypeError, AttributeError))
    reason = "" if inside else " ".join(str(error).split()) or type(error).__name__
    told = f" ({reason[:120]})" if reason else ""
    return InputError(
        f"{path}: this cannot be read as {kind}{told}; was it cut off, or has the file another "
        "ending than it should?"
    )
