"""What was guessed about the columns of a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from ..._support.units import Motion
from ..columns import Column
from ..mapping import PRESCRIBED

DRIVE_OF: Final = {
    "current": "current_a",
    "voltage": "voltage_v",
    "torque": "torque_nm",
    "force": "force_n",
}
"""``[drive] input`` by quantity."""


@dataclass(frozen=True)
class ColumnGuess:
    """One column of the file.

    Attributes
    ----------
    column : str
        As it stands in the file.
    role : str or None
        None where it was given none.
    unit : str or None
        As it is written in session.toml.
    scale : float
        Factor on top of the unit; -1 flips a sensor.
    reason : str
        Why this role and unit, or why none.
    alternatives : tuple of str
        What it could be instead, or which column could stand in its place.
    candidate : str or None
        The role that it would have, were it not for ``reason``; then ``unit`` is for that.
    """

    column: str
    role: str | None
    unit: str | None = None
    scale: float = 1.0
    reason: str = ""
    alternatives: tuple[str, ...] = ()
    candidate: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """As an entry of what ``stiction init --json`` prints."""
        return {
            "column": self.column,
            "role": self.role,
            "unit": self.unit,
            "scale": self.scale,
            "reason": self.reason,
            "alternatives": list(self.alternatives),
        }


@dataclass(frozen=True)
class Guess:
    """What was guessed about files that have the same columns.

    Attributes
    ----------
    columns : tuple of ColumnGuess
        Every column, in the order of the file.
    motion, motion_reason
        Rotary or linear, and why.
    drive : str or None
        One of ``mapping.DRIVES``; None where no input was found.
    drive_reason : str
    missing : mapping of str to str
        Roles that a fit needs and no column was given, and what to do about each.
    counts_per_rev : int
        Sensor counts in a turn, 0 where the readings do not tell.
    counts_needed : bool
        A column is in counts, so the size of a count has to be stated.
    input_unknown : bool
        Nothing tells what the input is measured in, and its unit is none.
    """

    columns: tuple[ColumnGuess, ...]
    motion: Motion
    motion_reason: str
    drive: str | None
    drive_reason: str
    missing: Mapping[str, str] = field(default_factory=dict)
    counts_per_rev: int = 0
    counts_needed: bool = False
    input_unknown: bool = False

    @property
    def complete(self) -> bool:
        """Whether a fit can run on what was guessed."""
        return not self.missing and not (self.counts_needed and not self.counts_per_rev)

    @property
    def prescribed(self) -> bool:
        """Whether the machine is moved and the effort measured."""
        return self.drive == PRESCRIBED

    @property
    def by_role(self) -> dict[str, ColumnGuess]:
        """The columns that were given a role."""
        return {guess.role: guess for guess in self.columns if guess.role is not None}

    @property
    def mapping(self) -> dict[str, Column]:
        """The same as ``Recording.load`` takes it."""
        return {
            role: Column(guess.column, guess.unit, guess.scale)
            for role, guess in self.by_role.items()
        }

    def to_dict(self) -> dict[str, Any]:
        """As ``stiction init --json`` prints it."""
        return {
            "columns": [guess.to_dict() for guess in self.columns],
            "motion": {"kind": self.motion, "reason": self.motion_reason},
            "drive": {"kind": self.drive, "reason": self.drive_reason},
            "missing": dict(self.missing),
            "complete": self.complete,
        }
