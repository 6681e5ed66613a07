"""From the columns of a file to the channels of a recording, in SI values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.given import brief
from .._support.units import (
    MOTION_OF_QUANTITY,
    SI_UNIT,
    Motion,
    Unit,
    bracketed_unit,
    ending_unit,
    find_unit,
    known_unit,
    to_si,
    unit_names,
)
from .._support.wording import commas, plural
from ..errors import InputError
from .clocks import align
from .columns import CANONICAL, ROLES, Column, Columns, default_name
from .repair import check_lengths
from .table import Table
from .turns import unwrap

PRESCRIBED: Final = "prescribed_motion"
DRIVES: Final = (
    "current_a",
    "voltage_v",
    "torque_nm",
    "force_n",
    "goal_rad",
    "goal_m",
    PRESCRIBED,
)

# A motor's torque may drive a screw, so the quantity of the input does not tell the motion.
_TELLS_MOTION: Final = ("position", "effort", "velocity", "reference", "load")
_QUANTITIES_OF_MOTION: Final[dict[Motion, tuple[str, ...]]] = {
    "rotary": ("angle", "angular velocity", "torque"),
    "linear": ("length", "velocity", "force"),
}


_WHOLE_NAME: Final = 2
"""Strength of a word that is the whole name of a column."""


@dataclass(frozen=True)
class Channels:
    """SI values by role, the units they have, what was decided, and the row of the file that
    became the first."""

    values: dict[str, FloatArray]
    units: dict[str, str]
    names: dict[str, str]
    motion: Motion | None
    notes: tuple[str, ...]
    first: int = 0


@dataclass(frozen=True)
class _Chosen:
    """A column that plays a role, with its unit as far as it is known."""

    column: Column
    unit: Unit | None
    where: str


def read_channels(
    table: Table,
    columns: Columns,
    *,
    drive: str | None = None,
    motion: Motion | None = None,
    count_size: float | None = None,
) -> Channels:
    """Find the columns of a recording in a table and convert them to SI values.

    Parameters
    ----------
    table : Table
    columns : Columns
        Roles named by the user; canonical names fill the others.
    drive : str, optional
        What drives the machine: one of `DRIVES`.  Decides between several possible inputs, and
        whether ``torque_nm`` and ``force_n`` are an input or a measured effort.
    motion : {"rotary", "linear"}, optional
        Without it the units tell.
    count_size : float, optional
        Size of a sensor count in rad or m.

    Raises
    ------
    InputError
        If a column is missing, ambiguous, holds text, or has a unit its role cannot have.
    """
    _check_choice("motion", motion, ("rotary", "linear"))
    _check_choice("drive", drive, DRIVES)
    notes: list[str] = []
    columns = _by_name(table, columns)
    chosen = {
        role: _choose(table, role, column, f"{columns.where}: {role}", drive, motion, notes)
        for role, column in columns.items()
    }
    known = motion or _motion_of(chosen, None)
    for role, name in _canonical(table, columns, drive, known, notes).items():
        chosen[role] = _choose(table, role, Column(name), role, drive, motion, notes)
    motion = _motion_of(chosen, motion)
    if "time" not in chosen and (clock := _clock(table, chosen, notes)) is not None:
        chosen["time"] = _choose(table, "time", clock, "time", drive, motion, notes)
    _check_complete(table, chosen, drive)
    values: dict[str, FloatArray] = {}
    units: dict[str, str] = {}
    for role in ROLES:
        if role in chosen:
            values[role] = _converted(table, role, chosen[role], count_size)
            units[role] = _si_unit(role, chosen[role].unit, drive, motion)
    names = {role: choice.column.name for role, choice in chosen.items()}
    if motion == "rotary":
        _go_on(values, names, notes)
    unit = chosen["time"].unit
    factor = (1.0 if unit is None else unit.factor or 1.0) * chosen["time"].column.scale
    placed = align(table, values, names, factor)
    values, first = placed.values, placed.first
    notes += placed.notes
    check_lengths(
        str(table.path),
        {f"{role} (column '{names[role]}')": len(array) for role, array in values.items()},
    )
    if "input" not in values and "effort" not in values:
        values["effort"], units["effort"] = _effort_of_friction(values, units, notes)
    if "position" not in values and "velocity" in values and "input" in values:
        values["position"] = _integrated(values["time"], values["velocity"])
        units["position"] = {"rad/s": "rad", "m/s": "m"}.get(units["velocity"], "")
        notes.append(
            f"position: none is recorded, and it is the integral of column '{names['velocity']}', "
            "from 0"
        )
    return Channels(values, units, names, motion, tuple(notes), first)


def _go_on(values: dict[str, FloatArray], names: Mapping[str, str], notes: list[str]) -> None:
    """Angles that begin anew after a turn go on; the reference keeps to the position."""
    for role in ("position", "reference"):
        if role not in values:
            continue
        values[role], number = unwrap(values[role])
        if number:
            notes.append(
                f"{role}: column '{names[role]}' begins anew after a turn "
                f"({plural(number, 'time')}), and was made to go on"
            )
        if number and role == "reference" and len(values[role]) == len(values["position"]):
            apart = np.nanmedian(values["position"] - values[role]) / (2.0 * np.pi)
            if np.isfinite(apart):
                values[role] += 2.0 * np.pi * np.round(apart)


def _integrated(time: FloatArray, velocity: FloatArray) -> FloatArray:
    """What a velocity adds up to; cells that are missing lie between their neighbours."""
    known = np.isfinite(velocity)
    if not known.any():
        return np.full(len(velocity), np.nan)
    rows = np.arange(len(velocity))
    v = np.interp(rows, rows[known], velocity[known])
    with np.errstate(over="ignore", invalid="ignore"):
        # A stamp that steps back is mended later, and takes no way back with it.
        steps = np.nan_to_num(np.maximum(np.diff(time), 0.0), posinf=0.0)
        way: FloatArray = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * steps)])
    return way


def _by_name(table: Table, columns: Columns) -> Columns:
    """The same columns, of which those that go by their number have the name in the header."""
    names = [*table.columns]
    numbers = {default_name(place): name for place, name in enumerate(names, start=1)}
    named = {
        role: replace(column, name=numbers[column.name])
        for role, column in columns.items()
        if column.name not in table.columns and column.name in numbers
    }
    return Columns({**columns, **named}, where=columns.where) if named else columns


def _check_choice(name: str, value: str | None, allowed: tuple[str, ...]) -> None:
    if value is not None and not (isinstance(value, str) and value in allowed):
        raise InputError(f"{name} is {brief(value)}; give one of {', '.join(allowed)}")


def _choose(
    table: Table,
    role: str,
    column: Column,
    where: str,
    drive: str | None,
    motion: Motion | None,
    notes: list[str],
) -> _Chosen:
    where = f"{table.path}: {where} = '{column.name}'"
    quantities = ROLES[role]
    if role == "input" and drive in CANONICAL:
        quantities = (find_unit(CANONICAL[drive][1], where).quantity,)
    unit = _stated_unit(table, role, column, where)
    if unit is not None and unit.quantity not in quantities:
        raise InputError(
            f"{where} has the unit {unit.name}, which is no unit of {role}"
            f"{f' where {drive} drives' if quantities != ROLES[role] else ''}; "
            f"{role} takes {unit_names(quantities)}"
        )
    if unit is None:
        unit = ending_unit(column.name, quantities)
        # A bare ending may mean something else (m = measured), so it never contradicts.
        if (
            unit is not None
            and motion is not None
            and _motion_told(role, unit)
            not in (
                None,
                motion,
            )
        ):
            unit = None
        if unit is not None and unit.name != SI_UNIT.get(unit.quantity):
            notes.append(f"{role}: column '{column.name}' was read in {unit.name}, by its ending")
    elif _told_below(table, column):
        notes.append(f"{role}: column '{column.name}' is in {unit.name}, by the line of units")
    return _Chosen(column, unit, where)


def _told_below(table: Table, column: Column) -> bool:
    """Whether the unit is taken from a line of units below the header."""
    by_name = column.unit is not None or column.name in CANONICAL
    return not by_name and table.heading(column.name) != column.name


def _stated_unit(table: Table, role: str, column: Column, where: str) -> Unit | None:
    """The unit from the mapping, the canonical name, or the header: in brackets, or below it."""
    if column.unit is not None:
        return find_unit(column.unit, where)
    if column.name in CANONICAL:
        unit = find_unit(CANONICAL[column.name][1], where)
        _check_below(table, role, column, unit, where)
        return unit
    bracketed = bracketed_unit(table.heading(column.name))
    # Digits in brackets number a joint: q[0], tau(1).
    if not bracketed or bracketed.isdigit():
        return None
    try:
        unit = find_unit(bracketed, where)
    except InputError as error:
        # Taking an unknown unit for SI could be wrong by a factor of a million.
        raise InputError(
            f"{where}: the header gives the unit '{bracketed}', which is not known; "
            f'write {role} = {{ name = "{column.name}", unit = "..." }} with one of '
            f"{unit_names(ROLES[role])}"
        ) from error
    _check_below(table, role, column, unit, where)
    return unit


def _check_below(table: Table, role: str, column: Column, unit: Unit, where: str) -> None:
    """Refuse a name that says another unit than the line below it."""
    below = known_unit(table.units.get(column.name, ""))
    if below is not None and replace(below, name=unit.name) != unit:
        raise InputError(
            f"{where}: the name says {unit.name}, and the line of units below it {below.name}; "
            f'write {role} = {{ name = "{column.name}", unit = "..." }} with the one that holds'
        )


def _motion_told(role: str, unit: Unit | None) -> Motion | None:
    if unit is None or role not in _TELLS_MOTION:
        return None
    return MOTION_OF_QUANTITY.get(unit.quantity)


def _motion_of(chosen: Mapping[str, _Chosen], motion: Motion | None) -> Motion | None:
    """The kind of motion all units agree on."""
    told_by = None
    for role, choice in chosen.items():
        told = _motion_told(role, choice.unit)
        if told is None:
            continue
        if motion is None:
            motion, told_by = told, role
        elif told != motion:
            assert choice.unit is not None
            against = f"by its {told_by}" if told_by else "as stated"
            raise InputError(
                f"{choice.where} is in {choice.unit.name}, and the motion is {motion} {against}; "
                f"give {role} in {unit_names(_of_motion(role, motion))}, or correct the kind of "
                "motion"
            )
    return motion


def _of_motion(role: str, motion: Motion) -> tuple[str, ...]:
    return tuple(name for name in ROLES[role] if name in _QUANTITIES_OF_MOTION[motion])


def _canonical(
    table: Table, columns: Columns, drive: str | None, motion: Motion | None, notes: list[str]
) -> dict[str, str]:
    """Canonical names in the table for the roles that nobody named."""
    named = {column.name for column in columns.values()}
    found: dict[str, list[str]] = {}
    for name in CANONICAL:
        role = _canonical_role(name, drive)
        if name in table.columns and name not in named and role and not _is_taken(role, columns):
            found.setdefault(role, []).append(name)
    position = found.get("position", [])
    if motion is None and len(position) == 1:
        motion = _told_by_name("position", position[0])
    for role, names in found.items():
        fitting = [name for name in names if _told_by_name(role, name) in (None, motion)]
        if motion is None or (role == "position" and not fitting):
            continue
        notes += [
            f"column '{name}' was not used, for the motion is {motion}"
            for name in names
            if name not in fitting
        ]
        names[:] = fitting
    for role, names in found.items():
        if len(names) > 1:
            raise InputError(
                f"{table.path}: the columns {commas(names)} could each be the {role}; "
                f'name one, as in {role} = "{names[0]}" under [columns]'
            )
    return {role: names[0] for role, names in found.items() if names}


def _canonical_role(name: str, drive: str | None) -> str | None:
    role = CANONICAL[name][0]
    if role != "input" or drive is None or drive == name:
        return role
    return "effort" if drive == PRESCRIBED and name in ("torque_nm", "force_n") else None


def _is_taken(role: str, columns: Columns) -> bool:
    if role in ("input", "effort"):
        return "input" in columns or "effort" in columns
    return role in columns


def _told_by_name(role: str, name: str) -> Motion | None:
    return _motion_told(role, find_unit(CANONICAL[name][1], name))


def _clock(table: Table, chosen: Mapping[str, _Chosen], notes: list[str]) -> Column | None:
    """The one column that is called as a clock is (``time``, ``t``) and goes as one does."""
    from .guess.evidence import columns_of
    from .guess.kinds import kinds_of
    from .guess.units import time_unit, unit_in_name

    taken = {choice.column.name for choice in chosen.values()}
    clocks = [
        column
        for column in columns_of([table])
        if column.name not in taken
        and not column.trouble
        and column.said.strength >= _WHOLE_NAME
        and kinds_of(column)[:1] == ("time",)
        and column.rises
    ]
    if len(clocks) != 1:
        return None
    (clock,) = clocks
    unit = unit_in_name(clock, ROLES["time"]) or time_unit(clock)
    notes.append(f"time: column '{clock.name}' was taken by its name ({unit.reason})")
    return Column(clock.name, unit.unit, unit.scale)


def _check_complete(table: Table, chosen: Mapping[str, _Chosen], drive: str | None) -> None:
    if "time" not in chosen:
        raise InputError(_lacks(table, "time", "time_s"))
    if drive == PRESCRIBED and "input" in chosen:
        raise InputError(
            f"{chosen['input'].where} is named as input, and a machine with prescribed motion has "
            "none; name the measured effort instead"
        )
    if drive in CANONICAL and "input" not in chosen:
        raise InputError(_lacks(table, "input", drive or ""))
    measured = {"effort", "friction_coefficient"}
    if drive == PRESCRIBED and not measured & set(chosen):
        raise InputError(_lacks(table, "effort", "torque_nm or force_n"))
    if not {"input", *measured} & set(chosen):
        raise InputError(_lacks(table, "input", "current_a"))
    if "input" not in chosen and not {"position", "velocity"} & set(chosen):
        raise InputError(_lacks(table, "position", "position_rad"))


def _lacks(table: Table, role: str, canonical: str) -> str:
    return (
        f"{table.path}: no column is known to be the {role}; the columns here are "
        f'{commas(table.columns)}; name one under [columns], as in {role} = "...", or call it '
        f"{canonical}"
    )


def _converted(table: Table, role: str, choice: _Chosen, count_size: float | None) -> FloatArray:
    column = choice.column
    raw = table.find(column.name, role)
    # Infinite cells are dealt with later, as cells, not as warnings.
    with np.errstate(over="ignore", invalid="ignore"):
        if choice.unit is None:
            values = column.scale * raw
        else:
            values = to_si(raw, choice.unit, count_size=count_size, where=choice.where)
            values *= column.scale
        values += column.offset
    return values


def _si_unit(role: str, unit: Unit | None, drive: str | None, motion: Motion | None) -> str:
    """The unit of the converted values, or "" where nothing tells it."""
    if unit is not None and unit.quantity != "count":
        return SI_UNIT[unit.quantity]
    quantities = ROLES[role]
    if role == "input" and drive in CANONICAL:
        quantities = (find_unit(CANONICAL[drive][1], role).quantity,)
    elif motion is not None and role in _TELLS_MOTION:
        quantities = _of_motion(role, motion)
    return SI_UNIT[quantities[0]] if len(quantities) == 1 else ""


def _effort_of_friction(
    values: Mapping[str, FloatArray], units: Mapping[str, str], notes: list[str]
) -> tuple[FloatArray, str]:
    """The effort of a sliding test that records a friction coefficient."""
    coefficient = values["friction_coefficient"]
    normal = values.get("normal_force")
    if normal is None:
        notes.append("effort: the friction coefficient stands for it, per newton of normal force")
        return coefficient.copy(), "1"
    notes.append("effort: friction coefficient times normal force")
    with np.errstate(over="ignore", invalid="ignore"):
        return coefficient * normal, units["normal_force"] or "N"
