"""Which column of a file plays which role, and in which unit.

A role is what a column means to a machine (``position``); a canonical name is a column name that
says role and unit together (``position_rad``) and so needs no mapping.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

from .._support import given as taken
from .._support.frozen import Frozen
from .._support.units import find_unit
from .._support.wording import did_you_mean
from ..errors import InputError

ROLES: Final[dict[str, tuple[str, ...]]] = {
    "time": ("time",),
    "input": ("current", "voltage", "torque", "force"),
    "position": ("angle", "length", "count"),
    "effort": ("torque", "force", "pressure", "ratio"),
    "velocity": ("angular velocity", "velocity"),
    "reference": ("angle", "length", "count"),
    "load": ("torque", "force"),
    "temperature": ("temperature",),
    "normal_force": ("force", "pressure"),
    "friction_coefficient": ("ratio",),
    "enabled": ("ratio",),
}
"""Every role a column can have, and the quantities it may be measured in."""

CANONICAL: Final[dict[str, tuple[str, str]]] = {
    "time_s": ("time", "s"),
    "current_a": ("input", "A"),
    "voltage_v": ("input", "V"),
    "torque_nm": ("input", "Nm"),
    "force_n": ("input", "N"),
    "goal_rad": ("input", "rad"),
    "goal_m": ("input", "m"),
    "position_rad": ("position", "rad"),
    "position_m": ("position", "m"),
    "velocity_rad_s": ("velocity", "rad/s"),
    "velocity_m_s": ("velocity", "m/s"),
    "reference_rad": ("reference", "rad"),
    "reference_m": ("reference", "m"),
    "load_nm": ("load", "Nm"),
    "load_n": ("load", "N"),
    "temperature_c": ("temperature", "degC"),
    "normal_force": ("normal_force", "N"),
    "friction_coefficient": ("friction_coefficient", "1"),
    "enabled": ("enabled", "1"),
}
"""Column names that need no mapping: their role and unit.

``torque_nm`` and ``force_n`` are the effort, not the input, where the motion is prescribed.
"""

NOT_THE_POSITION: Final = ("time", "input", "effort")
"""Channels that are never the position: read from its column they would explain it all."""
_UNIT_BEHIND: Final = re.compile(r"\s*(\[[^\[\]]*\]|\([^()]*\))$")
_COLUMN_KEYS: Final = ("name", "unit", "scale", "offset")


@dataclass(frozen=True)
class Column:
    """A column of a file, and how its cells become SI values.

    SI value = ``scale`` · (the cell, converted from ``unit``) + ``offset``; a ``scale`` of -1
    flips a sensor.

    Attributes
    ----------
    name : str
        As it stands in the file; dotted for fields of a struct.
    unit : str, optional
        Without it the name's ending decides, and failing that the cells are SI values.
    scale, offset : float
        Without unit and in SI.
    """

    name: str
    unit: str | None = None
    scale: float = 1.0
    offset: float = 0.0

    @classmethod
    def parse(cls, value: object, where: str) -> Column:
        """Read a column as it stands in TOML: a name, or a table of name and conversion.

        Parameters
        ----------
        value : str, int, dict or Column
            In place of its name a column may have its number, from 1.
        where : str
            Start of the error sentences: the file and the field.

        Raises
        ------
        InputError
            If the value is of another type, has unknown keys, or an unknown unit.
        """
        if isinstance(value, Column):
            return value
        if isinstance(value, (str, int)):
            value = {"name": value}
        if not isinstance(value, Mapping):
            raise InputError(
                f"{where} is {value!r}; give the name of a column, or "
                '{ name = "...", unit = "..." }'
            )
        for key in value:
            if key not in _COLUMN_KEYS:
                raise InputError(
                    f"{where}: the key '{key}' is not known"
                    f"{did_you_mean(str(key), _COLUMN_KEYS)}; a column has "
                    f"{', '.join(_COLUMN_KEYS)}"
                )
        name = value.get("name")
        if isinstance(name, int) and not isinstance(name, bool) and name > 0:
            name = default_name(name)
        if not isinstance(name, str) or not name:
            raise InputError(
                f"{where}: the name of the column is {_given(name)}; "
                "give the text that stands in the header, or its number from 1"
            )
        unit = value.get("unit")
        if unit is not None:
            if not isinstance(unit, str):
                raise InputError(f"{where}: the unit is {unit!r}; write it as text, as in 'deg'")
            unit = find_unit(unit, where).name
        scale = _finite(value.get("scale", 1.0), "scale", where)
        if scale == 0.0:
            raise InputError(
                f"{where}: scale is 0, which leaves nothing of the column; "
                "give another number, or leave it out"
            )
        return cls(name, unit, scale, _finite(value.get("offset", 0.0), "offset", where))


def default_name(place: int) -> str:
    """What a column without a name is called.

    Parameters
    ----------
    place : int
        From 1.
    """
    return f"column {place}"


class Columns(Mapping[str, Column]):
    """The columns of a recording by role, as written under ``[columns]``.

    Roles that are left out are looked for under their canonical names.
    """

    def __init__(self, by_role: Mapping[str, Column] | None = None, *, where: str = "columns"):
        columns = taken.mapping(by_role, where, "a mapping of roles to columns")
        for role, column in columns.items():
            taken.instance(column, Column, f"{where}: {taken.brief(role)}", "a Column")
        self._by_role: Frozen[str, Column] = Frozen(columns)
        self.where = where

    @classmethod
    def parse(cls, given: Mapping[str, Any] | Columns | None, *, where: str = "columns") -> Columns:
        """Read ``[columns]`` as it stands in TOML.

        Parameters
        ----------
        given : mapping of role to name or table, Columns, or None
        where : str
            Start of the error sentences, for instance ``"session.toml: [columns]"``.

        Raises
        ------
        InputError
            For unknown roles, keys and units, wrong types, an input beside an effort, and a
            position that is another channel as well.
        """
        if isinstance(given, Columns):
            return given
        if given is None:
            return cls(where=where)
        if not isinstance(given, Mapping):
            raise InputError(
                f"{where} is {given!r}; give a table of roles and names, as in "
                '{ time = "t", position = "q" }'
            )
        by_role: dict[str, Column] = {}
        for role, value in given.items():
            if role not in ROLES and isinstance(value, str) and value in ROLES:
                raise InputError(
                    f"{where}: {role} = '{value}' is the wrong way round, for the role comes "
                    f'first; write {value} = "{role}"'
                )
            if role not in ROLES:
                raise InputError(
                    f"{where}: '{role}' is not known{_role_meant(str(role))}; "
                    f"a recording has {', '.join(ROLES)}"
                )
            by_role[role] = Column.parse(value, f"{where}: {role}")
        if "input" in by_role and "effort" in by_role:
            raise InputError(
                f"{where}: both input and effort are given; name the input of a driven machine, "
                "or the measured effort of one that is moved, and not both"
            )
        for role in NOT_THE_POSITION:
            if "position" in by_role and role in by_role:
                name = by_role["position"].name
                if by_role[role].name == name:
                    raise InputError(
                        f"{where}: {role} and position are both read from {name!r}; "
                        "name another column for one of them"
                    )
        return cls(by_role, where=where)

    def __getitem__(self, role: str) -> Column:
        return self._by_role[role]

    def __iter__(self) -> Any:
        return iter(self._by_role)

    def __len__(self) -> int:
        return len(self._by_role)

    def __repr__(self) -> str:
        return f"Columns({dict(self._by_role)!r})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt, (dict(self._by_role), self.where)


def match_header(columns: Columns, names: Iterable[str]) -> Columns:
    """The same columns under the names that stand in a header.

    A column goes by its number too, and by its name without the unit behind it, where that means
    one column alone: ``Iq`` for ``Iq [A]``.

    Parameters
    ----------
    columns : Columns
    names : iterable of str
        Of the header, in its order.
    """
    header = list(names)
    meant = {default_name(place): [name] for place, name in enumerate(header, start=1)}
    for name in header:
        bare = _UNIT_BEHIND.sub("", name)
        if bare != name:
            meant.setdefault(bare, []).append(name)
    found = {
        role: replace(column, name=meant[column.name][0])
        for role, column in columns.items()
        if column.name not in header and len(meant.get(column.name, ())) == 1
    }
    return Columns({**columns, **found}, where=columns.where) if found else columns


def _rebuilt(by_role: dict[str, Column], where: str) -> Columns:
    return Columns(by_role, where=where)


def _role_meant(key: str) -> str:
    if key in CANONICAL:
        return f" (did you mean '{CANONICAL[key][0]}'?)"
    from .column_words import what_it_says

    # A quantity in place of a role: what it is called as a column tells which.
    meant = {"drive": "input", "velocity": "velocity", "position": "position"}
    kinds = what_it_says(key).kinds
    role = meant.get(kinds[0], "") if kinds and len(key) > 1 else ""
    return f" (did you mean '{role}'?)" if role else did_you_mean(key, ROLES)


def _given(value: object) -> str:
    return "missing" if value is None else repr(value)


def _finite(value: object, key: str, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError(f"{where}: {key} is {value!r}; give a finite number")
    try:
        converted = float(value)
    except OverflowError:  # TOML has no largest integer
        converted = math.inf
    if not math.isfinite(converted):
        raise InputError(f"{where}: {key} is {converted!r}; give a finite number")
    return converted
