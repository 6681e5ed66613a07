"""From recordings to the drafts of plant.toml and session.toml."""

from __future__ import annotations

import logging
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .._support.progress import phase
from ..errors import InputError
from ..recording import Columns, Table
from ..recording.guess import Guess, guess, overrule
from .tables import as_in_file, name_tables, one_joint, read
from .text import plant_text, session_text

__all__ = ["FILES", "Draft", "draft"]

FILES = ("plant.toml", "session.toml")

_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Draft:
    """What recordings are, as far as they tell it.

    Attributes
    ----------
    found : Guess
        Roles and units of the columns.
    tables : tuple of Table
        One a recording.
    files : tuple of tuple of Path
        Of each recording; several where each signal has its own.
    left_out : tuple of (Path, str)
        Files of a folder that are left out, with the reason.
    joints : tuple of str
        What the joints of the files are called, the one that was taken first.
    law : str
        Friction law of the plant.
    gain : float or None
        Effort per SI unit of the input, None where nobody states it.
    """

    found: Guess
    tables: tuple[Table, ...]
    files: tuple[tuple[Path, ...], ...]
    left_out: tuple[tuple[Path, str], ...]
    joints: tuple[str, ...]
    law: str = "coulomb"
    gain: float | None = None

    def texts(self, where: Path) -> tuple[str, str]:
        """plant.toml and session.toml, to stand in the folder ``where``.

        Raises
        ------
        InputError
            A path that cannot be written in a TOML file.
        """
        plant = plant_text(self.found, law=self.law, gain=self.gain)
        headers = [table.header for table in self.tables]
        return plant, session_text(
            self.found, self.files, self.left_out, where, self.joints, headers
        )

    @property
    def to_do(self) -> list[str]:
        """What has to be stated before anything can be fitted, in sentences."""
        todo = list(self.found.missing.values())
        if self.found.counts_needed and not self.found.counts_per_rev:
            todo.append("state the size of a sensor count under [sensor] of plant.toml")
        return todo


def draft(
    paths: Sequence[Path],
    *,
    joint: str = "",
    header: str = "",
    columns: Mapping[str, Any] | None = None,
    where: str = "columns",
    law: str = "coulomb",
    gain: float | None = None,
) -> Draft:
    """Read recordings and guess what their columns are.

    Parameters
    ----------
    paths : sequence of Path
        Files with the same columns, or folders.
    joint : str
        Of several joints the one that is wanted.
    header : str
        Names of the columns of files without any.
    columns : mapping, optional
        What somebody states of columns, as under ``[columns]``: it stands before every guess.
    where : str
        What ``columns`` is called in messages.
    law : str
    gain : float, optional
        Effort per SI unit of the input.

    Raises
    ------
    InputError
        Files that cannot be read, a joint or columns that they do not have, an unknown law, a gain
        that is no finite number other than 0, or one that belongs to no input.
    """
    _check_law(law)
    tables, left_out, files_of = read(paths)
    phase(_logger, "guessing what each column is")
    tables, calls = name_tables(tables, header)
    stated = Columns.parse(columns, where=where)
    wanted = [column.name for column in stated.values()]
    tables, joints = one_joint(tables, joint, wanted)
    found = as_in_file(guess(tables), calls)
    if stated:
        found = overrule(found, stated)
    _check_gain(gain, found)
    return Draft(
        found,
        tuple(tables),
        tuple(tuple(files_of[table.path]) for table in tables),
        tuple(left_out),
        tuple(joints),
        law,
        gain,
    )


def _check_law(law: str) -> None:
    from .._support.wording import commas, did_you_mean
    from ..catalogue import effects, laws

    names = [record.name for record in laws()]
    if law in (record.name for record in effects()):
        raise InputError(
            f"'{law}' is an effect and no law: a diagnosis tries every effect by itself, and a "
            f"plant file states it under [[effects]]; the laws are {commas(names)}"
        )
    several = [part for part in re.split(r"[,+ ]+", law) if part in names or part in effects()]
    if len(several) > 1:
        raise InputError(
            f"law = '{law}' names several, and a plant has one; give --law {several[0]}: a "
            "diagnosis tries every effect by itself, and with --laws other laws as well"
        )
    if law not in names:
        raise InputError(
            f"there is no law '{law}'{did_you_mean(law, names)}; there are {commas(names)}"
        )


def _check_gain(gain: float | None, found: Guess) -> None:
    if gain is None:
        return
    if not abs(gain) > 0.0 or not abs(gain) < float("inf"):
        raise InputError(
            f"gain = {gain} is no effort per unit of the input; give a finite number other than 0"
        )
    if found.prescribed:
        raise InputError(
            f"gain = {gain} is stated, and no input drives this machine ({found.drive_reason}); "
            "leave it out, or name the input among the columns"
        )
