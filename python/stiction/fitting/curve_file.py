"""Tables of speed and friction in files: which column is which, and in which unit."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.units import MOTION_OF_QUANTITY, SI_UNIT, Unit, find_unit, to_si
from .._support.wording import commas
from ..errors import InputError
from ..recording import Columns, Table, read_table
from ..recording.columns import Column, match_header
from ..recording.guess.evidence import columns_of
from ..recording.guess.kinds import kinds_of
from .curve import CurveFit, fit_curve

__all__ = ["curve_table", "fit_curve_file"]

_ROLES: Final = ("velocity", "effort")
_QUANTITIES: Final = {
    "velocity": ("angular velocity", "velocity"),
    "effort": ("torque", "force", "ratio"),
}
COEFFICIENT: Final = "friction_coefficient"
"""What tribologists record in place of a force."""


def curve_table(path: Path, stated: Mapping[str, Any] | None = None) -> Table | None:
    """The table of a file that holds speed and friction and no time, None for any other one.

    Parameters
    ----------
    path : Path
    stated : mapping, optional
        Columns by role, as under ``[columns]``: ``velocity`` and ``effort``.

    Raises
    ------
    InputError
        A file that cannot be read.
    """
    table = read_table(path)
    columns = columns_of([table])
    if any(kinds_of(column)[:1] == ("time",) and column.rises for column in columns):
        return None
    if stated and {"velocity", "effort"} <= set(stated):
        return table
    kinds = {kind for column in columns for kind in kinds_of(column)}
    motion = {"position", "reference"} & kinds
    fitting = "velocity" in kinds and not {"drive", COEFFICIENT}.isdisjoint(kinds)
    return table if fitting and not motion else None


def fit_curve_file(
    path: Path,
    law: str,
    stated: Mapping[str, Any] | None,
    table: Table,
) -> tuple[CurveFit, tuple[str, ...]]:
    """Fit a law to a table of a file; and what was assumed of its columns, in sentences.

    Raises
    ------
    InputError
        Columns that are not told, units of another kind, and all that ``fit_curve`` refuses.
    """
    given = Columns.parse(dict(stated) if stated else None, where="--columns")
    given = match_header(given, table.columns)
    chosen = {role: given.get(role) or _by_name(table, role) for role in _ROLES}
    units = {role: _unit(table, role, column) for role, column in chosen.items()}
    values = {role: _values(table, role, chosen[role], units[role]) for role in _ROLES}
    motions = {
        MOTION_OF_QUANTITY[unit.quantity]
        for unit in units.values()
        if unit is not None and unit.quantity in MOTION_OF_QUANTITY
    }
    if len(motions) > 1:
        told = commas(f"{role} in {unit.name}" for role, unit in units.items() if unit is not None)
        raise InputError(
            f"{path}: {told} do not go together; state units of one kind of motion with --columns"
        )
    ratio = _coefficient(table, chosen["effort"], units["effort"])
    motion = motions.pop() if motions else "linear" if ratio else "rotary"
    if ratio:
        units["effort"] = find_unit("1", str(path))
    assumed = [
        f"{role} = {chosen[role].name} [{SI_UNIT[_QUANTITIES[role][motion == 'linear']]}]"
        for role in _ROLES
        if units[role] is None
    ]
    notes = []
    if assumed:
        notes.append(
            f"units: none stands in the header, taken as {', '.join(assumed)} "
            '(--columns "velocity=NAME [rad/s], effort=NAME [Nm]" states them)'
        )
    if ratio:
        notes.append(
            f"{chosen['effort'].name} is a friction coefficient: every N is one per N of normal "
            "force, so coulomb and breakaway are the kinetic and the static coefficient; times "
            "your normal force they are those of your contact"
        )
    try:
        return fit_curve(values["velocity"], values["effort"], law, motion=motion), tuple(notes)
    except InputError as error:
        raise InputError(str(error).replace("fit_curve", str(path), 1)) from None


def _by_name(table: Table, role: str) -> Column:
    kinds = ("velocity",) if role == "velocity" else ("drive", COEFFICIENT)
    able = {column.name: kinds_of(column)[:1] for column in columns_of([table])}
    # A force beside a coefficient is what the coefficient was computed of.
    fitting = next((got for kind in kinds if (got := [c for c in able if kind in able[c]])), [])
    if len(fitting) != 1:
        why = "no column is known to be" if not fitting else f"{commas(fitting)} could each be"
        raise InputError(
            f"{table.path}: {why} the {role}; the columns here are {commas(table.columns)}; state "
            f'it with --columns "velocity=NAME [rad/s], effort=NAME [Nm]"'
        )
    return Column(fitting[0])


def _coefficient(table: Table, column: Column, unit: Unit | None) -> bool:
    """Whether an effort is a friction coefficient, by its unit or by its name."""
    if unit is not None:
        return unit.quantity == "ratio"
    return any(
        c.name == column.name and COEFFICIENT in kinds_of(c)[:1] for c in columns_of([table])
    )


def _unit(table: Table, role: str, column: Column) -> Unit | None:
    where = f"{table.path}: {role} = '{column.name}'"
    name = column.unit
    if name is None:
        said = next(c.said for c in columns_of([table]) if c.name == column.name)
        if said.strange_unit:
            raise InputError(
                f"{where}: the header gives the unit '{said.strange_unit}', which is not known; "
                f'state it with --columns "{role}={column.name} [UNIT]"'
            )
        if said.unit is None:
            return None
        name = said.unit.unit
    unit = find_unit(name, where)
    if unit.quantity not in _QUANTITIES[role]:
        raise InputError(
            f"{where} has the unit {unit.name}, which is no unit of {role}; give one of "
            f"{commas(SI_UNIT[each] for each in _QUANTITIES[role])}"
        )
    return unit


def _values(table: Table, role: str, column: Column, unit: Unit | None) -> FloatArray:
    raw = table.find(column.name, role)
    values = raw if unit is None else to_si(raw, unit, where=f"{table.path}: {role}")
    return np.asarray(column.scale * values + column.offset)
