"""Where each recording begins, in a file beside the plant: with it a fit can be simulated again.

What a contact brings along, the session clock and the path travelled belong to a recording and not
to the machine. A plant that was fitted far below break-away breaks away in a simulation that
forgets them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from .._support.atomic_files import write_text
from .._support.given import number
from .._support.wording import commas
from ..catalogue import laws
from ..errors import InputError
from .plant_file import read_toml

if TYPE_CHECKING:
    from ..fitting.rows import Nuisances, Rows
    from .plant import Plant

__all__ = ["FILE", "Begin", "begin_of", "begins", "load_begins", "save_begins"]

FILE: Final = "begins.toml"
"""In the folder of the plant."""
CLOCK: Final = "clock_s"
PATH: Final = "path"
_SPECIAL: Final = re.compile(r'["\\\x00-\x1f\x7f]')

Begin = Mapping[str, float]
"""``clock_s`` and ``path`` (in rad or m) at the first row, and the friction state there by
``LawRecord.start``."""


def begins(
    names: Sequence[str], rows: Sequence[Rows], nuisances: Nuisances
) -> dict[str, dict[str, float]]:
    """Where recordings begin for a fitted model.

    Parameters
    ----------
    names : sequence of str
        Of all recordings.
    rows : sequence of Rows
        Of those that are asked for.
    nuisances : Nuisances
        With the starts of the model.

    Returns
    -------
    dict of str to dict
        By name, in the order of the session.
    """
    found = {}
    for each in sorted(rows, key=lambda each: each.index):
        own = nuisances.start(each.index) or {}
        found[names[each.index]] = {CLOCK: each.form.clock, PATH: each.form.path, **own}
    return found


def begin_of(begin: Begin | None) -> dict[str, Any]:
    """Keywords of ``free_run`` and ``replay``: start, clock and path.

    Parameters
    ----------
    begin : Mapping or None
        None of a recording that no file tells of: it begins cold, with a contact never moved.
    """
    if begin is None:
        return {}
    start = {name: value for name, value in begin.items() if name not in (CLOCK, PATH)}
    return {"start": start or None, "clock": begin[CLOCK], "path": begin[PATH]}


def save_begins(folder: Path, found: Mapping[str, Begin]) -> Path:
    """Write the file beside the plant of a fit.

    Parameters
    ----------
    folder : Path
        Where plant.toml is.
    found : Mapping of str to Mapping
        By name of the recording.

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    OSError
        It cannot be written.
    """
    lines = [
        "# Where each recording begins: session clock in s, path travelled in rad or m, and what",
        "# the contact brings along. `stiction simulate` reads this beside plant.toml.",
    ]
    for name, begin in found.items():
        lines += ["", f"[{_quoted(name)}]"]
        lines += [f"{key} = {float(value)!r}" for key, value in begin.items()]
    path = folder / FILE
    write_text(path, "\n".join(lines) + "\n")
    return path


def load_begins(beside: Path, plant: Plant) -> dict[str, Begin]:
    """Read the file beside a plant file; empty where there is none.

    Parameters
    ----------
    beside : Path
        The plant file.
    plant : Plant
        What is in it.

    Raises
    ------
    InputError
        It is not what ``save_begins`` writes, or belongs to another law.
    """
    path = beside.parent / FILE
    if not path.exists():
        return {}
    law = plant.friction.law
    quantities = next([q.name for q in each.start] for each in laws() if each.name == law)
    told: dict[str, Begin] = {}
    for name, begin in read_toml(path, least="a table by recording").items():
        where = f"{path}: [{_quoted(name)}]"
        if not isinstance(begin, dict):
            raise InputError(f"{where}: is no table; write it as `stiction fit` does, or remove it")
        if foreign := begin.keys() - {CLOCK, PATH, *quantities}:
            raise InputError(
                f"{where}: {commas(sorted(foreign))} is nothing that {law} brings "
                f"along ({commas(quantities) or 'nothing'}); fit again, or remove the file"
            )
        if CLOCK not in begin or PATH not in begin:
            raise InputError(f"{where}: {commas((CLOCK, PATH))} are needed; state both")
        told[name] = {key: number(value, f"{where} {key}") for key, value in begin.items()}
    return told


def _quoted(text: str) -> str:
    """A key of TOML."""
    return '"' + _SPECIAL.sub(_escaped, text) + '"'


def _escaped(found: re.Match[str]) -> str:
    character = found[0]
    return f"\\{character}" if character in '"\\' else f"\\u{ord(character):04x}"
