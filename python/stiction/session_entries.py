"""The [[recordings]] of a session file: which files each names, which part, and what it says."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from ._support.given import brief, number
from ._support.keys import check_keys, choice
from ._support.wording import commas, plural
from .errors import InputError
from .plant.plant_file import section
from .recording import SETTINGS
from .recording.recording import SPLIT_ROLES

__all__ = ["Entry", "all_faults", "beside", "entries_of"]

_KEYS: Final = (
    *("file", "from", "to", "role", "kind", "start_s", "cold", "replicate_of", "columns"),
    *SETTINGS,
)
_OTHERS: Final = {
    **dict.fromkeys(("path", "filename", "name", "recording", "csv"), "file"),
    **dict.fromkeys(("split", "use", "set"), "role"),
    **dict.fromkeys(("type", "label", "experiment"), "kind"),
}
"""What others call a key."""
_WILD: Final = re.compile(r"[*?]|\[[^\]]+\]")
_ROW: Final = re.compile(r"row ([1-9]\d{0,14})")
_MOST_FILES: Final = 10_000
_FAULTS_TOLD: Final = 8


@dataclass(frozen=True)
class Entry:
    """One recording of a session file.

    Attributes
    ----------
    place : int
        Of its table in the file, from 1.
    files : tuple of Path
        One; or one for each signal.
    found : bool
        Its file was found by a pattern, not named.
    labels : mapping
        What ``Recording.load`` takes of it.
    columns : mapping
        Its own columns.
    replicate_of : object
        As it stands there, None where it does not.
    named : str
        The file as it is written there.
    """

    place: int
    files: tuple[Path, ...]
    found: bool
    labels: Mapping[str, Any]
    columns: Mapping[str, Any]
    replicate_of: object = None
    named: str = ""

    @property
    def part(self) -> tuple[Any, Any]:
        """From where to where, None for an end that is not stated."""
        return self.labels["begin"], self.labels["end"]


def entries_of(path: Path, tables: Sequence[Mapping[str, Any]]) -> list[Entry]:
    """The recordings that a session file lists.

    Parameters
    ----------
    path : Path
        The session file.
    tables : sequence of mapping
        Its [[recordings]].

    Raises
    ------
    InputError
        An unknown key, a value of the wrong type, a pattern that fits no file, one file twice.
    """
    entries: list[Entry] = []
    for place, table in enumerate(tables, 1):
        entries += _entries(path, place, table)
    seen: dict[tuple[Path, ...], list[Entry]] = {}
    for entry in entries:
        for other in seen.get(entry.files, []):
            if _overlap(entry.part, other.part):
                where = f"{path}: [[recordings]] {entry.place}"
                raise InputError(
                    f"{where}: {entry.named} is already recording {other.place}; a file has one "
                    "role, drop one of the two, or state parts with from and to that do not overlap"
                )
        seen.setdefault(entry.files, []).append(entry)
    return entries


def _entries(path: Path, place: int, table: Mapping[str, Any]) -> list[Entry]:
    where = f"{path}: [[recordings]] {place}"
    check_keys(table, _KEYS, where, _OTHERS)
    if "file" not in table:
        raise InputError(f'{where}: file is missing; write file = "run.csv"')
    labels = _labels(table, where)
    columns = section(table, "columns", where)
    named = table["file"]
    several = isinstance(named, list) and bool(named)
    names = named if several else [named]
    if not all(isinstance(name, str) and name for name in names):
        raise InputError(
            f'{where}: file = {named!r} is not a path; write file = "run.csv", or a list of files '
            "of one signal each"
        )
    files = [beside(path, name, f"{where}: file") for name in names]
    replicate = table.get("replicate_of")
    if several:
        return [Entry(place, tuple(files), False, labels, columns, replicate, commas(names))]
    if not _WILD.search(named) or files[0].exists():
        return [Entry(place, (files[0],), False, labels, columns, replicate, named)]
    found = _matching(path, named, where)
    if len(found) > 1 and ("replicate_of" in table or "start_s" in table):
        key = "replicate_of" if "replicate_of" in table else "start_s"
        raise InputError(
            f"{where}: {key} is said of one recording, and '{named}' fits "
            f"{plural(len(found), 'file')}; list them one by one"
        )
    return [Entry(place, (file,), True, labels, columns, replicate, file.name) for file in found]


def _matching(path: Path, named: str, where: str) -> list[Path]:
    """The files that a pattern fits, in the order of their names.

    Raises
    ------
    InputError
        There is none, or more than a session has.
    """
    found: list[Path] = []
    try:
        start = Path(named).anchor
        inside = Path(start or path.parent).glob(str(Path(named).relative_to(start)))
        for file in inside:
            if file.is_file():
                found.append(file.resolve())
            if len(found) > _MOST_FILES:
                raise InputError(
                    f"{where}: '{named}' fits more than {_MOST_FILES} files; name fewer"
                )
    except (OSError, ValueError, NotImplementedError, RuntimeError) as error:
        raise InputError(f"{where}: file = {named!r} is no pattern ({error}); mend it") from None
    if not found:
        raise InputError(
            f"{where}: no file fits '{named}' (looked for beside {path}); mend the pattern"
        )
    return sorted(set(found))


_MEANT: Final = {
    "training": "train",
    "fit": "train",
    "validation": "select",
    "validate": "select",
    "val": "select",
    "testing": "test",
    "holdout": "test",
}
"""What others call the roles."""


def _labels(table: Mapping[str, Any], where: str) -> dict[str, Any]:
    stated = table.get("role")
    if isinstance(stated, str) and (meant := _MEANT.get(stated.casefold())):
        raise InputError(f"{where} role = '{stated}' is unknown; it is called '{meant}' here")
    role = choice(stated, SPLIT_ROLES, f"{where} role") if stated is not None else None
    kind = table.get("kind", "")
    if not isinstance(kind, str):
        raise InputError(f'{where} kind = {kind!r} is not text; write kind = "…"')
    start = number(table.get("start_s", 0.0), f"{where} start_s")
    if not math.isfinite(start):
        raise InputError(f"{where} start_s = {start} is not a finite number of seconds")
    cold = table.get("cold", False)
    if not isinstance(cold, bool):
        raise InputError(f"{where} cold = {cold!r} is not true or false")
    settings = {name: number(table[name], f"{where} {name}") for name in SETTINGS if name in table}
    ends = {name: _end(table[key], f"{where} {key}") if key in table else None
            for name, key in (("begin", "from"), ("end", "to"))}  # fmt: skip
    return {
        "role": role,
        "kind": kind,
        "start_s": start,
        "cold": cold,
        "settings": settings,
        **ends,
    }


def _end(given: Any, where: str) -> float | str:
    """An end of a part: seconds on the clock of the file, or a row from 1."""
    if isinstance(given, str):
        if _ROW.fullmatch(given) is None:
            raise InputError(
                f'{where} = {brief(given)} is no row; write a row as in "row 120", counted from 1, '
                "or seconds on the clock of the file, as a number"
            )
        return given
    seconds = number(given, where)
    if not math.isfinite(seconds):
        raise InputError(f"{where} = {seconds} is not a finite number of seconds")
    return seconds


def _overlap(one: tuple[Any, Any], other: tuple[Any, Any]) -> bool:
    """Whether two parts share a row, as far as this tells without the file."""
    spans = []
    for part in (one, other):
        rows = [isinstance(end, str) for end in part if end is not None]
        if not rows:
            return True
        low, high = (_at(end) for end in part)
        spans.append((rows, -math.inf if low is None else low, math.inf if high is None else high))
    (rows, low, high), (others, least, most) = spans
    if len({*rows, *others}) > 1:
        return False
    # Rows are counted with both ends; at one time there may be a row of either part.
    return max(low, least) <= min(high, most) if rows[0] else max(low, least) < min(high, most)


def _at(end: float | str | None) -> float | None:
    return float(end.removeprefix("row ")) if isinstance(end, str) else end


def beside(path: Path, named: str, where: str) -> Path:
    """The file that a session file names by a path relative to itself.

    Raises
    ------
    InputError
        No file can be there: the path holds a zero character, or its links lead in a circle.
    """
    try:
        return (path.parent / named).resolve()
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"{where} = {named!r} is not a path ({error}); mend it") from None


def all_faults(source: str, faults: Sequence[str]) -> str:
    """All that is wrong with the recordings of a session, in one sentence, each fault once."""
    told = list(dict.fromkeys(faults))
    if len(told) == 1:
        return told[0]
    shown = "; ".join(f"({k}) {fault}" for k, fault in enumerate(told[:_FAULTS_TOLD], 1))
    more = f"; and {len(told) - _FAULTS_TOLD} more" if len(told) > _FAULTS_TOLD else ""
    return f"{source}: {len(faults)} recordings cannot be read: {shown}{more}"
