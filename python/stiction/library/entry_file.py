"""Entries of the library: a TOML file each."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from .._support import given
from .._support.frozen import Frozen, freeze
from .._support.given import number
from .._support.keys import check_keys, choice
from .._support.wording import commas, did_you_mean, plural
from ..errors import InputError
from ..plant import Plant
from ..plant.plant_file import read_toml, section

__all__ = ["Entry", "EntryNumber", "entries", "entry", "read_entry"]

_FOLDER: Final = Path(__file__).parent / "entries"
_TABLES: Final = ("machine", "kind", "source", "made", "floor", "numbers", "notes", "plant")
_KINDS: Final = ("recordings", "published")
_SOURCE: Final = ("text", "url", "license")
_MADE: Final = ("version", "command", "seed", "units", "recordings", "seconds")
_FLOOR: Final = ("value", "unit", "text")
_NUMBER: Final = ("ci95", "unit", "units", "sessions")
COVERED: Final = 0.95
"""Share of units, or of sessions, that a band is to hold."""


@dataclass(frozen=True)
class EntryNumber:
    """A number of an entry.

    Attributes
    ----------
    value : float
        As in the plant; SI.
    ci95 : tuple of float or None
        Interval of the value by what was recorded; None where the source states none.
    unit : str
    units : tuple of float
        Values of single units, each recorded and fitted by itself; empty where there was one unit.
    sessions : tuple of float
        Values of single sessions of the same unit, of a minute or less each: what they differ by is
        what a plant lacks, of which an interval knows little. Empty where there was one.
    least : float
        Below which the number has no meaning, such as 0 for friction.
    """

    value: float
    ci95: tuple[float, float] | None
    unit: str
    units: tuple[float, ...] = ()
    sessions: tuple[float, ...] = ()
    least: float = -math.inf

    @property
    def band(self) -> tuple[float, float] | None:
        """Where 95 % of further units are expected; None where one unit was recorded."""
        return self._expected(self.units)

    @property
    def within(self) -> tuple[float, float] | None:
        """Where 95 % of further sessions of the same unit are expected; None of one session."""
        return self._expected(self.sessions)

    @property
    def expected(self) -> str:
        """The band that is known, of units before sessions, in words."""
        if self.band is not None:
            return f"{span(self.band)} ({len(self.units)} units)"
        if self.within is not None:
            return f"{span(self.within)} ({len(self.sessions)} sessions)"
        return "not known"

    def _expected(self, values: tuple[float, ...]) -> tuple[float, float] | None:
        """mean ± t·s·√(1 + 1/n), t of Student with n − 1 degrees: wide where n is small."""
        n = len(values)
        if n < 2:
            return None
        from scipy.stats import t

        width = float(t.ppf(0.5 + 0.5 * COVERED, n - 1)) * float(np.std(values, ddof=1))
        middle, width = float(np.mean(values)), width * math.sqrt(1.0 + 1.0 / n)
        return max(middle - width, self.least), middle + width

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        return {
            "value": self.value,
            "ci95": None if self.ci95 is None else list(self.ci95),
            "unit": self.unit,
            "units": list(self.units),
            "band": None if self.band is None else list(self.band),
            "sessions": list(self.sessions),
            "within": None if self.within is None else list(self.within),
        }


@dataclass(frozen=True)
class Entry:
    """A machine of the library.

    Attributes
    ----------
    name : str
        Of its file.
    machine : str
        What it is.
    kind : {"recordings", "published"}
        Whether its numbers were fitted to recordings, or stand in a publication.
    plant : Plant
        Ready to simulate, as far as the source states what that needs.
    numbers : mapping of str to EntryNumber
        By path.
    source : mapping of str to str
        ``text`` (who measured, where it stands), ``url``, ``license`` of the data.
    made : mapping
        Of recordings: ``version`` of the package, ``command`` and ``seed`` that give the same
        numbers again, how many ``units`` and ``recordings``, and their ``seconds``.
    floor : mapping
        ``value`` and ``unit`` of what no model of the machine gets below, and what it is in words,
        ``text``; empty where nobody knows.
    notes : tuple of str
        What else is to be known, in sentences.
    """

    name: str
    machine: str
    kind: str
    plant: Plant
    numbers: Mapping[str, EntryNumber]
    source: Mapping[str, str]
    made: Mapping[str, Any] = field(default_factory=dict)
    floor: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        freeze(self, Frozen, "numbers", "source", "made", "floor")

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the plant's effects."""
        return tuple(effect.name for effect in self.plant.effects)

    @property
    def units(self) -> int:
        """How many units were recorded; 0 where the source does not say."""
        return int(self.made.get("units", 0))

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        return {
            "schema": 1,
            "name": self.name,
            "machine": self.machine,
            "kind": self.kind,
            "law": self.plant.friction.law,
            "effects": list(self.effects),
            "source": dict(self.source),
            "made": dict(self.made),
            "floor": dict(self.floor),
            "numbers": {path: each.to_dict() for path, each in self.numbers.items()},
            "notes": list(self.notes),
            "plant": self.plant.to_dict(),
        }

    def __str__(self) -> str:
        effects = f" with {', '.join(self.effects)}" if self.effects else ""
        lines = [
            f"{self.name}: {self.machine}",
            f"law: {self.plant.friction.law}{effects}",
            f"source: {self.source['text']} ({self.source['url']})",
            f"data: {self.source['license']}",
        ]
        if self.made:
            lines.append(
                f"fitted to {plural(self.made['recordings'], 'recording')} of "
                f"{self.made['seconds']:.4g} s, {plural(self.units, 'unit')}, by stiction "
                f"{self.made['version']}: {self.made['command']} (seed {self.made['seed']})"
            )
        if self.floor:
            value, unit = self.floor["value"], self.floor["unit"]
            lines.append(f"floor: {value:.4g} {unit}, {self.floor['text']}")
        return "\n".join([*lines, "", *self._table(), *(f"  {each}" for each in self.notes)])

    def _table(self) -> list[str]:
        rows = [("number", "value", "95 % interval", "unit", "95 % are expected in")]
        for path, each in self.numbers.items():
            interval = "none stated" if each.ci95 is None else span(each.ci95)
            rows.append((path, f"{each.value:.5g}", interval, each.unit, each.expected))
        widths = [max(len(row[k]) for row in rows) for k in range(4)]
        return [
            "  ".join([*(f"{r[k]:<{widths[k]}}" for k in range(4)), r[4]]).rstrip() for r in rows
        ]


def span(ends: tuple[float, float]) -> str:
    """An interval in words."""
    return f"{ends[0]:.4g} to {ends[1]:.4g}"


@cache
def entries() -> tuple[Entry, ...]:
    """All entries, by name."""
    return tuple(read_entry(path) for path in sorted(_FOLDER.glob("*.toml")))


def entry(name: str) -> Entry:
    """The entry of a name.

    Parameters
    ----------
    name : str
        As ``stiction library`` lists it.

    Returns
    -------
    Entry

    Raises
    ------
    InputError
        There is none.
    """
    wanted = given.word(name, "library: name")
    for each in entries():
        if each.name == wanted:
            return each
    names = [each.name for each in entries()]
    near = did_you_mean(wanted, names)
    raise InputError(f"library: there is no entry '{wanted}'{near}; there are {commas(names)}")


def read_entry(path: Path) -> Entry:
    """Read the file of an entry.

    Raises
    ------
    InputError
        It is not what an entry has to be.
    """
    table, source = read_toml(path, least="machine and [plant]"), str(path)
    check_keys(table, _TABLES, source)
    for name in ("machine", "kind", "source", "numbers", "plant"):
        if name not in table:
            raise InputError(f"{source}: {name} is missing; an entry has {commas(_TABLES)}")
    plant = Plant.from_dict(section(table, "plant", source), source=f"{source}: [plant]")
    told = section(table, "source", source)
    check_keys(told, _SOURCE, f"{source}: [source]")
    kind = choice(table["kind"], _KINDS, f"{source}: kind")
    made = section(table, "made", source)
    check_keys(made, _MADE, f"{source}: [made]")
    missing = [name for name in _SOURCE if not told.get(name)]
    missing += [name for name in _MADE if kind == "recordings" and name not in made]
    if missing:
        raise InputError(f"{source}: {commas(missing)} is missing; state where numbers come from")
    floor = section(table, "floor", source)
    check_keys(floor, _FLOOR, f"{source}: [floor]")
    notes = table.get("notes", [])
    if not isinstance(notes, list) or not all(isinstance(each, str) for each in notes):
        raise InputError(f"{source}: notes is not a list of sentences; write one")
    numbers = section(table, "numbers", source)
    return Entry(
        path.stem,
        given.word(table["machine"], f"{source}: machine"),
        kind,
        plant,
        {name: _number(plant, name, each, source) for name, each in numbers.items()},
        dict(told),
        dict(made),
        dict(floor),
        tuple(notes),
    )


def _number(plant: Plant, path: str, table: Any, source: str) -> EntryNumber:
    where = f"{source}: [numbers.'{path}']"
    if not isinstance(table, Mapping):
        raise InputError(f"{where} is not a table; write ci95 and unit")
    check_keys(table, _NUMBER, where)
    stated = plant.parameters
    if path in stated:
        value = stated[path].value
    elif path == "drive.torque_constant" and plant.servo:
        value = plant.gain
    else:
        raise InputError(f"{where}: the plant states no such number; state it under [plant]")
    ends = table.get("ci95")
    lists = {name: table.get(name, []) for name in ("ci95", "units", "sessions")}
    for name, each in lists.items():
        if not isinstance(each, list):
            raise InputError(f"{where} {name} = {each!r} is not a list; write numbers in brackets")
    interval = None
    if ends is not None:
        if len(ends) != 2:
            raise InputError(f"{where} ci95 = {ends!r} is no interval; write its two ends")
        low, high = (number(end, f"{where} ci95") for end in ends)
        if not low <= value <= high:
            raise InputError(f"{where}: {value:g} is not in its interval {low:g} to {high:g}")
        interval = (low, high)
    units, sessions = (
        tuple(number(each, f"{where} {name}") for each in lists[name])
        for name in ("units", "sessions")
    )
    unit = given.word(table.get("unit", ""), f"{where} unit")
    return EntryNumber(value, interval, unit, units, sessions, _least(plant, path))


def _least(plant: Plant, path: str) -> float:
    part, _, name = path.partition(".")
    if part != "friction":
        return 0.0 if path == "body.inertia" else -math.inf
    return next(each.bounds[0] for each in plant.friction.record.parameters if each.name == name)
