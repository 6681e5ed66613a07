"""``stiction init``: drafts of plant.toml and session.toml from recordings."""

from __future__ import annotations

import logging
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .. import session as sessions
from ..atomic_files import create_text
from ..errors import InputError
from ..given import vacant
from ..progress import phase, steps
from ..recording import Table, read_table
from ..recording.columns import numbered
from ..recording.formats import FORMATS
from ..recording.guess import Guess, guess
from ..recording.joints import MOST, joints_of
from ..recording.repair import FEWEST_ROWS
from ..recording.signals import read_signals, runs_of_signals
from ..wording import counted, listed
from .answer import answer, folder, written
from .draft import plant_text, session_text
from .progress import progress

__all__ = ["init"]

_logger = logging.getLogger(__name__)

_FILES = ("plant.toml", "session.toml")


def init(
    data: Path,
    *more: Path,
    joint: str = "",
    header: str = "",
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path(),
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Guess columns and units of recordings; write a commented plant.toml and session.toml.

    Every guess is written with its reason and its alternatives. What could not be guessed is a
    line that is commented out and says what to do. Files that are there are not overwritten.

    Parameters
    ----------
    data
        Recording in any of the formats that are read, or a folder of them.
    more
        More files with the same columns.
    joint
        Of files of several joints the one that is wanted, as its columns call it.
    header
        Names for the columns of files that have none, separated by commas: "t,q*6,tau*6", where
        q*6 stands for q1 to q6.
    out
        Folder to write into, the present one without it.
    json
        Print JSON.
    """
    vacant(out, _FILES, "another folder with --out")
    with progress():
        tables, left_out, files_of = _read([data, *more])
        phase(_logger, "guessing what each column is")
        tables, calls = _named(tables, header)
        tables, joints = _one_joint(tables, joint)
        found = _as_in_file(guess(tables), calls)
    where = folder(out)
    files = [where / name for name in _FILES]
    paths = [files_of[table.path] for table in tables]
    headers = [table.header for table in tables]
    texts = (plant_text(found), session_text(found, paths, left_out, where, joints, headers))
    with written(where):
        for file, text in zip(files, texts, strict=True):
            create_text(file, text)
    todo = list(found.missing.values())
    if found.counts_needed and not found.counts_per_rev:
        todo.append("state the size of a sensor count under [sensor] of plant.toml")
    # What the guess does not see (too many empty cells, a clock that jumps) is said at once.
    if not todo:
        try:
            sessions.load(files[1])
        except InputError as error:
            todo.append(str(error))
    result = {
        **found.to_dict(),
        "joints": joints,
        "recordings": [str(table.path) for table in tables],
        "left_out": {str(path): why for path, why in left_out},
        "to_do": todo,
        "files": [str(file) for file in files],
    }
    answer(_text(found, tables, left_out, todo, files, joints), result, as_json=json)


def _named(tables: list[Table], header: str) -> tuple[list[Table], dict[str, str]]:
    """The tables under the names that were given, and what their columns are called in the file.

    Raises
    ------
    InputError
        Files that have names, or another number of columns.
    """
    if not header:
        return tables, {}
    names: list[str] = []
    for name in header.split(","):
        base, star, number = name.strip().partition("*")
        if star and not (number.isdigit() and 0 < int(number) <= MOST):
            raise InputError(f"--header: '{name.strip()}' ends in no number from 1 to {MOST}")
        names += [f"{base}{k}" for k in range(1, int(number) + 1)] if star else [base]
    if len(set(names)) < len(names) or not all(names):
        raise InputError("--header: a name is empty or there twice; give each column its own")
    for table in tables:
        own = list(table.columns)
        if own != [numbered(place) for place in range(1, len(own) + 1)]:
            raise InputError(
                f"{table.path}: its columns have names ({listed(own)}), and --header is for files "
                "without; leave it out"
            )
        if len(own) != len(names):
            raise InputError(
                f"{table.path}: has {counted(len(own), 'column')}, and --header names {len(names)}"
            )
    calls = dict(zip(names, tables[0].columns, strict=True))
    back = {column: name for name, column in calls.items()}
    return [table.renamed(back) for table in tables], calls


def _one_joint(tables: list[Table], wanted: str) -> tuple[list[Table], list[str]]:
    """The columns of one joint, and what the joints are called, that one first.

    Raises
    ------
    InputError
        There is no such joint, or nothing tells several.
    """
    joints = joints_of(tables)
    if joints is None:
        if wanted:
            raise InputError(
                f"{tables[0].path}: --joint is {wanted}, and the columns are not those of several "
                f"joints ({listed(tables[0].columns)}); leave it out"
            )
        return tables, []
    joint = wanted or joints.moving(tables)
    others = [label for label in joints.labels if label != joint]
    return [joints.only(table, joint) for table in tables], [joint, *others]


def _as_in_file(found: Guess, calls: Mapping[str, str]) -> Guess:
    """The guess with the columns called as they are in the file."""
    columns = tuple(
        replace(one, column=calls[one.column], reason=f"'{one.column}': {one.reason}")
        if one.column in calls
        else one
        for one in found.columns
    )
    return replace(found, columns=columns)


_Read = tuple[list[Table], list[tuple[Path, str]], dict[Path, list[Path]]]


def _read(paths: Sequence[Path]) -> _Read:
    """The tables that are guessed about, files of a folder that are left out, with reasons, and the
    files of each table."""
    tables: list[Table] = []
    left_out: list[tuple[Path, str]] = []
    alone = len(paths) == 1
    phase(_logger, "reading")
    for path in paths:
        # Not Path.is_dir, which fails on an overlong name.
        if not os.path.isdir(path):
            tables.append(_table(path))
            continue
        inside = _files_in(path)
        alone = alone and len(inside) == 1
        for file in steps(inside, "file"):
            try:
                tables.append(_table(file))
            except InputError as error:
                # One file and nothing else: its fault is the answer.
                if len(inside) == 1 and len(paths) == 1:
                    raise
                left_out.append((file, str(error)))
    if not tables:
        faults = listed(why for _, why in left_out[:3])
        raise InputError(
            f"{listed(str(path) for path in paths)}: no file in it can be used: {faults}"
        )
    if runs := runs_of_signals(tables):
        tables = [read_signals(run) for run in runs]
    files = {t.path: run for t, run in zip(tables, runs or [[t.path] for t in tables], strict=True)}
    chosen = not any(map(os.path.isdir, paths))
    return (*_same_columns(tables, left_out, chosen=chosen), files)


def _files_in(path: Path) -> list[Path]:
    endings = [suffix for known in FORMATS for suffix in known.suffixes]
    try:
        inside = sorted(
            file for file in path.iterdir() if file.is_file() and file.suffix.casefold() in endings
        )
    except OSError as error:
        raise InputError(
            f"{path}: the folder cannot be read ({error.strerror}); check its rights, or name "
            "the files in it"
        ) from None
    if not inside:
        raise InputError(
            f"{path}: there is no recording in this folder; the endings known are "
            f"{', '.join(endings)}"
        )
    return inside


def _table(path: Path) -> Table:
    table = read_table(path)
    rows = max(len(column) for column in table.columns.values())
    if rows < FEWEST_ROWS:
        raise InputError(
            f"{path}: the recording has {counted(rows, 'row')}, and at least {FEWEST_ROWS} are "
            "needed; record longer or sample faster"
        )
    return table


def _same_columns(
    tables: list[Table], left_out: list[tuple[Path, str]], *, chosen: bool
) -> tuple[list[Table], list[tuple[Path, str]]]:
    """Those with the commonest columns; other columns are refused where each file was named."""
    names = [frozenset(table.columns) for table in tables]
    usual = names[0] if chosen else Counter(names).most_common(1)[0][0]
    same = []
    for table, own in zip(tables, names, strict=True):
        if own == usual:
            same.append(table)
            continue
        lacks, has = listed(sorted(usual - own)), listed(sorted(own - usual))
        why = f"other columns than the rest: it lacks {lacks}, and has {has} on top"
        if chosen:
            raise InputError(
                f"{table.path}: {why} (compared with {tables[0].path}); recordings of one session "
                "have the same columns, run init on each kind apart"
            )
        left_out.append((table.path, why))
    return same, left_out


def _text(
    found: Guess,
    tables: Sequence[Table],
    left_out: Sequence[tuple[Path, str]],
    todo: Sequence[str],
    files: Sequence[Path],
    joints: Sequence[str],
) -> str:
    rows: list[tuple[Any, ...]] = [("column", "role", "unit", "why")]
    for one in found.columns:
        unit = "" if one.role is None else f"{one.scale:g}·{one.unit}".removeprefix("1·")
        rows.append((one.column, one.role or "-", unit, one.reason))
    widths = [max(len(row[k]) for row in rows) for k in range(3)]
    lines = [f"guessed from {counted(len(tables), 'recording')}:", ""]
    lines += ["  ".join([*(f"{row[k]:<{widths[k]}}" for k in range(3)), row[3]]) for row in rows]
    if joints:
        lines += ["", f"joint: {joints[0]} (others: {listed(joints[1:])}; --joint takes them)"]
    lines += ["", f"motion: {found.motion} ({found.motion_reason})"]
    lines += [f"drive: {found.drive or 'not known'} ({found.drive_reason})"]
    lines += [f"left out: {path}: {why.removeprefix(f'{path}: ')}" for path, why in left_out]
    lines += ["", *(f"wrote {file}" for file in files)]
    lines += [f"to do: {sentence}" for sentence in todo]
    if not todo:
        lines.append(f"next: read both files, then stiction fit {files[1]}")
    return "\n".join(lines)
