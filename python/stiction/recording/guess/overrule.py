"""What somebody states of the columns, in place of what was guessed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from ..._support.units import MOTION_OF_QUANTITY, Motion, find_unit, known_unit, unit_names
from ..._support.wording import commas, did_you_mean
from ...errors import InputError
from ..columns import CANONICAL, ROLES, Column, Columns, match_header
from ..mapping import PRESCRIBED
from .result import DRIVE_OF, ColumnGuess, Guess

__all__ = ["overrule"]

_NEEDS_UNIT: Final = ("time", "position", "input", "effort")
"""Roles whose unit, where nothing tells it, would be an answer in a unit that nobody knows."""
_TELLS_MOTION: Final = ("position", "effort", "velocity", "reference", "load")
_STATED: Final = "stated"


def overrule(found: Guess, columns: Columns) -> Guess:
    """A guess in which stated columns have the roles, units and scales that were stated.

    Parameters
    ----------
    found : Guess
    columns : Columns
        By role; what is stated without a unit keeps the unit that was guessed for that column.

    Raises
    ------
    InputError
        A column that is not in the file, a role whose unit nothing tells, or a unit that is none
        of the role's.
    """
    known = [each.column for each in found.columns]
    columns = match_header(columns, known)
    taken = {column.name: role for role, column in columns.items()}
    for role, column in columns.items():
        if column.name not in known:
            bare, _, unit = column.name.rpartition(" ")
            near = did_you_mean(column.name, known)
            if bare in known and known_unit(unit):
                near = f" (a unit stands in brackets: {role}={bare} [{unit}])"
            raise InputError(
                f"{columns.where}: {role} = '{column.name}' is no column of the file{near}; it has "
                f"{commas(known)}"
            )
    told = []
    for each in found.columns:
        if each.column in taken:
            role = taken[each.column]
            told.append(_stated(each, role, columns[role], columns.where))
        elif each.role in columns or _instead(each.role, columns):
            reason = f"'{columns[_winner(each.role, columns)].name}' is stated in its place"
            told.append(replace(each, role=None, reason=reason, candidate=each.role))
        else:
            told.append(each)
    by_role = {each.role: each for each in told if each.role is not None}
    drive, why = _drive(found, by_role, columns)
    missing = {r: w for r, w in found.missing.items() if r not in columns and r not in by_role}
    if {"input", "effort"} & columns.keys():
        missing.pop("input", None)
    if "velocity" in by_role:  # which is integrated
        missing.pop("position", None)
    motion, motion_reason = _motion(found, by_role, columns)
    return replace(
        found,
        columns=tuple(told),
        motion=motion,
        motion_reason=motion_reason,
        drive=drive,
        drive_reason=why,
        missing=missing,
        counts_needed=any(each.unit == "count" for each in by_role.values()),
        input_unknown=found.input_unknown and not _told_unit(found, columns),
    )


def _told_unit(found: Guess, columns: Columns) -> bool:
    """Whether what is stated leaves no input whose unit was a guess."""
    if "effort" in columns:
        return True
    stated, guessed = columns.get("input"), found.by_role.get("input")
    if stated is None:
        return False
    return stated.unit is not None or guessed is None or stated.name != guessed.column


def _instead(role: str | None, columns: Mapping[str, Column]) -> bool:
    """Whether an input stands where an effort is stated, or the other way round."""
    return role in ("input", "effort") and bool({"input", "effort"} & columns.keys())


def _winner(role: str | None, columns: Mapping[str, Column]) -> str:
    if role in columns:
        return str(role)
    return "input" if "input" in columns else "effort"


def _stated(each: ColumnGuess, role: str, column: Column, where: str) -> ColumnGuess:
    unit, scale = column.unit, column.scale
    if unit is None and each.column in CANONICAL and CANONICAL[each.column][0] == role:
        unit = CANONICAL[each.column][1]
    if unit is None and role in (each.role, each.candidate):
        unit, scale = each.unit, scale * each.scale
    if unit is None and role in _NEEDS_UNIT:
        raise InputError(
            f"{where}: nothing tells the unit of '{column.name}'; write {role}={column.name} "
            f"[UNIT], one of {unit_names(ROLES[role])}"
        )
    if unit is not None and find_unit(unit, where).quantity not in ROLES[role]:
        raise InputError(
            f"{where}: {role} = '{column.name}' is stated in {unit}, which is no unit of it; "
            f"give one of {unit_names(ROLES[role])}"
        )
    return ColumnGuess(each.column, role, unit, scale, _STATED)


def _drive(
    found: Guess, by_role: Mapping[str, ColumnGuess], columns: Mapping[str, Column]
) -> tuple[str | None, str]:
    if "effort" in columns:
        return PRESCRIBED, f"'{columns['effort'].name}' is stated as the measured effort"
    if "input" not in columns:
        return found.drive, found.drive_reason
    quantity = find_unit(by_role["input"].unit or "", "input").quantity
    return DRIVE_OF[quantity], f"by column '{columns['input'].name}', which is stated"


def _motion(
    found: Guess, by_role: Mapping[str, ColumnGuess], columns: Mapping[str, Column]
) -> tuple[Motion, str]:
    """Rotary or linear, as stated units tell it."""
    for role in _TELLS_MOTION:
        if role in columns and (unit := by_role[role].unit):
            told = MOTION_OF_QUANTITY.get(find_unit(unit, role).quantity)
            if told is not None:
                return told, f"{role} is stated in {unit}"
    return found.motion, found.motion_reason
