"""Reading the files of a draft: the columns of one joint, those of a folder that go together."""

from __future__ import annotations

import logging
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from .._support.progress import phase, steps
from .._support.wording import commas, plural
from ..errors import InputError
from ..recording import Table, read_table
from ..recording.columns import default_name
from ..recording.formats import FORMATS
from ..recording.guess import Guess
from ..recording.joints import MOST, joints_of
from ..recording.repair import FEWEST_ROWS
from ..recording.signals import read_signals, runs_of_signals

__all__ = ["as_in_file", "name_tables", "one_joint", "read", "recordings_in"]

_logger = logging.getLogger(__name__)


def name_tables(tables: list[Table], header: str) -> tuple[list[Table], dict[str, str]]:
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
        if own != [default_name(place) for place in range(1, len(own) + 1)]:
            raise InputError(
                f"{table.path}: its columns have names ({commas(own)}), and --header is for files "
                "without; leave it out"
            )
        if len(own) != len(names):
            raise InputError(
                f"{table.path}: has {plural(len(own), 'column')}, and --header names {len(names)}"
            )
    calls = dict(zip(names, tables[0].columns, strict=True))
    back = {column: name for name, column in calls.items()}
    return [table.renamed(back) for table in tables], calls


def one_joint(
    tables: list[Table], wanted: str, columns: Sequence[str] = ()
) -> tuple[list[Table], list[str]]:
    """The columns of one joint, and what the joints are called, that one first.

    Without one that is ``wanted`` it is the one that has all of some ``columns``, else one that
    moves.

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
                f"joints ({commas(tables[0].columns)}); leave it out"
            )
        return tables, []
    having = [
        label
        for label in joints.labels
        if set(columns) <= joints.only(tables[0], label).columns.keys()
    ]
    told = having[0] if columns and len(having) == 1 else ""
    joint = wanted or told or joints.moving_joint(tables)
    others = [label for label in joints.labels if label != joint]
    return [joints.only(table, joint) for table in tables], [joint, *others]


def as_in_file(found: Guess, calls: Mapping[str, str]) -> Guess:
    """The guess with the columns called as they are in the file."""
    columns = tuple(
        replace(one, column=calls[one.column], reason=f"'{one.column}': {one.reason}")
        if one.column in calls
        else one
        for one in found.columns
    )
    return replace(found, columns=columns)


_Read = tuple[list[Table], list[tuple[Path, str]], dict[Path, list[Path]]]


def read(paths: Sequence[Path]) -> _Read:
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
        inside = recordings_in(path)
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
        faults = commas(why for _, why in left_out[:3])
        raise InputError(
            f"{commas(str(path) for path in paths)}: no file in it can be used: {faults}"
        )
    if runs := runs_of_signals(tables):
        tables = [read_signals(run) for run in runs]
    files = {t.path: run for t, run in zip(tables, runs or [[t.path] for t in tables], strict=True)}
    chosen = not any(map(os.path.isdir, paths))
    return (*_same_columns(tables, left_out, chosen=chosen), files)


def recordings_in(path: Path) -> list[Path]:
    """The files of a folder that are recordings by their endings, in order.

    Raises
    ------
    InputError
        There are none, or the folder cannot be read.
    """
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
            f"{path}: the recording has {plural(rows, 'row')}, and at least {FEWEST_ROWS} are "
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
        lacks, has = commas(sorted(usual - own)), commas(sorted(own - usual))
        why = f"other columns than the rest: it lacks {lacks}, and has {has} on top"
        if chosen:
            raise InputError(
                f"{table.path}: {why} (compared with {tables[0].path}); recordings of one session "
                "have the same columns, run init on each kind apart"
            )
        left_out.append((table.path, why))
    return same, left_out
