"""Several joints in one file: which columns belong to which of them.

Their names tell (``q1``, ``position[0]``, ``joint_2/effort``, ``elbow.position``), or, of a file
without names, blocks of as many columns of which the second is the rate of change of the first.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.units import bracketed_unit
from .._support.wording import commas, did_you_mean, plural
from ..errors import InputError
from .column_words import what_it_says
from .columns import default_name
from .guess.evidence import Column, columns_of, rate_of
from .table import Table

__all__ = ["Joints", "joints_of"]

FOLLOWS: Final = 0.9
"""Correlation of a column with the rate of change of another that makes it the velocity of that."""
MOST: Final = 40
"""Joints of a file without names."""

_SAMPLES: Final = 2000
_VALUES: Final = 50

_DIGITS: Final = re.compile(r"\d+")
_SIGNS: Final = re.compile(r"[/.]")
_MOTION: Final = (("position",), ("velocity",))
_MOVING: Final = ("position", "velocity", "reference")
_DRIVEN: Final = ("drive", "reference")


@dataclass(frozen=True)
class Joints:
    """The joints of a file.

    Attributes
    ----------
    of : mapping of str to str
        The joint that a column belongs to, by the name of the column.
    """

    of: Mapping[str, str]

    @property
    def labels(self) -> tuple[str, ...]:
        """What the joints are called, in the order of the file."""
        return tuple(dict.fromkeys(self.of.values()))

    def only(self, table: Table, joint: str) -> Table:
        """The table without the columns of the other joints.

        Parameters
        ----------
        table : Table
        joint : str
            One of `labels`.

        Raises
        ------
        InputError
            There is no such joint.
        """
        if joint not in self.labels:
            raise InputError(
                f"{table.path}: there is no joint '{joint}'{did_you_mean(joint, self.labels)}; "
                f"the file has {plural(len(self.labels), 'joint')}: {commas(self.labels)}"
            )
        kept = {
            name: values
            for name, values in table.columns.items()
            if self.of.get(name, joint) == joint
        }
        return replace(table, columns=kept, cells=tuple(c for c in table.cells if c.column in kept))

    def moving_joint(self, tables: Sequence[Table]) -> str:
        """The first joint that moves in most of the files.

        Parameters
        ----------
        tables : sequence of Table
        """
        moved = dict.fromkeys(self.labels, 0)
        for column in columns_of(tables):
            joint = self.of.get(column.name)
            # Of columns without names the first block holds the positions.
            moving = column.said.kinds[:1] in _MOTION or column.name in self._first
            if joint is not None and moving:
                moved[joint] = max(moved[joint], sum(map(_moves, column.arrays)))
        return max(self.labels, key=lambda joint: moved[joint])

    @property
    def _first(self) -> set[str]:
        return {next(name for name, own in self.of.items() if own == j) for j in self.labels}


def joints_of(tables: Sequence[Table]) -> Joints | None:
    """The joints of files that have the same columns; None where there is one, or none told.

    Parameters
    ----------
    tables : sequence of Table
    """
    names = list(tables[0].columns)
    if names == [default_name(place) for place in range(1, len(names) + 1)]:
        return _by_numbers(tables)
    families = _chosen(_families(names))
    if not families:
        return None
    kinds = {kind for pattern in families for kind in _kinds(families[pattern])}
    own = {name for family in families.values() for name in family.values()}
    shared = {kind for name in names if name not in own for kind in what_it_says(name).kinds[:1]}
    # Of two encoders of one axis with one current neither is a joint of its own.
    if not kinds & set(_MOVING) or ("drive" in shared and not kinds & set(_DRIVEN)):
        return None
    of = {name: label for family in families.values() for label, name in family.items()}
    return Joints({name: of[name] for name in names if name in of})


_Family = dict[str, str]


def _families(names: Sequence[str]) -> dict[tuple[str, str], _Family]:
    """Names that differ in one place alone, by what they share: label to name."""
    found: dict[tuple[str, str], _Family] = {}
    for name in names:
        for before, label, after in _places(name):
            found.setdefault((before, after), {})[label] = name
    return {pattern: family for pattern, family in found.items() if len(family) > 1}


def _places(name: str) -> Iterator[tuple[str, str, str]]:
    """A name cut where a joint may be named: each number, the last word of a path, that before."""
    unit = bracketed_unit(name)
    end = name.rindex(unit) if unit and not unit.isdigit() else len(name)
    for match in _DIGITS.finditer(name, 0, end):
        yield name[: match.start()], match[0], name[match.end() :]
    at = [0, *(match.end() for match in _SIGNS.finditer(name)), len(name) + 1]
    for k in range(max(1, len(at) - 3), len(at) - 1):
        word = name[at[k] : at[k + 1] - 1]
        if word and not word.isdigit():
            yield name[: at[k]], word, name[at[k + 1] - 1 :]


def _kinds(family: _Family) -> set[str]:
    return {kind for name in family.values() for kind in what_it_says(name).kinds[:1]}


def _chosen(families: Mapping[tuple[str, str], _Family]) -> dict[tuple[str, str], _Family]:
    """The families of one set of labels: two of them at least, and as many columns as there are."""
    by_labels: dict[frozenset[str], dict[tuple[str, str], _Family]] = {}
    for pattern, family in families.items():
        by_labels.setdefault(frozenset(family), {})[pattern] = family
    able = {
        labels: group
        for labels, group in by_labels.items()
        if len(group) > 1 and not any(_is_kind(label) for label in labels)
    }
    if not able:
        return {}

    def covered(labels: frozenset[str]) -> tuple[int, int]:
        return len({n for family in able[labels].values() for n in family.values()}), len(labels)

    return able[max(able, key=covered)]


def _is_kind(label: str) -> bool:
    """Whether a label is a quantity (``position``), and so no joint."""
    said = what_it_says(label)
    return said.strength == 2 and said.kinds[:1] in [(kind,) for kind in (*_MOVING, "drive")]


def _by_numbers(tables: Sequence[Table]) -> Joints | None:
    """Of a file without names: a time, then blocks of as many columns as there are joints."""
    columns = columns_of(tables)
    if len(columns) < 5 or any(c.trouble for c in columns) or not columns[0].rises:
        return None
    clock, rest = list(columns[0].arrays), columns[1:]
    for number in range(2, min(MOST, len(rest) // 2) + 1):
        if len(rest) % number == 0 and _are_rates(clock, rest[:number], rest[number : 2 * number]):
            return Joints({c.name: str(place % number + 1) for place, c in enumerate(rest)})
    return None


def _are_rates(
    clock: Sequence[FloatArray],
    positions: Sequence[Column],
    rates: Sequence[Column],
) -> bool:
    """Whether one moves, and each that does follows."""
    fits = []
    for position, rate in zip(positions, rates, strict=True):
        moving = [k for k, array in enumerate(position.arrays) if _moves(array)]
        if not moving:
            continue
        one, other = (
            replace(c, arrays=tuple(c.arrays[k] for k in moving)) for c in (position, rate)
        )
        fits.append(rate_of(one, [clock[k] for k in moving], other)[1])
    return bool(fits) and min(fits) > FOLLOWS


def _moves(values: FloatArray) -> bool:
    """Whether a column takes many values, as what only rests or flickers does not."""
    return len(np.unique(values[:: max(1, len(values) // _SAMPLES)])) > _VALUES
