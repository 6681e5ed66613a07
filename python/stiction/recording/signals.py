"""Files of one signal each: one table, in which every signal keeps its own clock."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import takewhile
from pathlib import Path
from typing import Any, Final

from .._support.wording import commas, plural
from ..errors import InputError
from .clocks import time_of
from .column_words import what_it_says
from .columns import default_name
from .formats import read_table
from .table import Table

__all__ = ["read_signals", "runs_of_signals"]

_WORDS: Final = re.compile(r"[^\W_]+")
_MOST: Final = 100


def read_signals(paths: Sequence[str | os.PathLike[str]]) -> Table:
    """Read files that were written at once, a signal or a group of signals each.

    Parameters
    ----------
    paths : sequence of path
        Each with a column of time of its own. The first gives the table its path.

    Returns
    -------
    Table
        Columns are called as in their files where their names tell what they are, and no other file
        has the name; else as the file, without what the names of all files share.

    Raises
    ------
    InputError
        As for ``read_table``; a file without a time, or too many files.
    """
    if not 1 < len(paths) <= _MOST:
        raise InputError(
            f"a recording of several files has {plural(len(paths), 'file')}; give 2 to {_MOST}"
        )
    tables = [read_table(path) for path in paths]
    shorts = _short_names([table.path for table in tables])
    renamed = []
    for table, short in zip(tables, shorts, strict=True):
        time = time_of(table)
        if time is None:
            raise InputError(
                f"{table.path}: no column of it is known to be the time ({commas(table.columns)}), "
                "and of several files each needs its own; call one time_s"
            )
        others = [other for other in tables if other is not table]
        names = {
            name: name if _tells(name) and not any(name in o.columns for o in others)
            else short if len(table.columns) == 2 else f"{short}.{name}"
            for name in (*table.columns, *table.unusable)
            if name != time
        }  # fmt: skip
        names[time] = f"{short}.{time}"
        own = {name: table.clocks.get(name, time) for name in table.columns}
        renamed.append(replace(table, clocks=own).renamed(names))
    return _joined(renamed)


def _joined(tables: Sequence[Table]) -> Table:
    columns = {name: values for table in tables for name, values in table.columns.items()}
    number = sum(len(table.columns) for table in tables)
    if len(columns) < number:
        raise InputError(
            f"{tables[0].path}: two of the files of this recording have columns of one name "
            f"({commas(columns)}); rename the files, or the columns"
        )

    def merged(what: str) -> dict[str, Any]:
        return {k: v for table in tables for k, v in getattr(table, what).items()}

    return Table(
        tables[0].path,
        columns,
        tuple(cell for table in tables for cell in table.cells),
        unusable=merged("unusable"),
        units=merged("units"),
        begins=merged("begins"),
        clocks=merged("clocks"),
        header=merged("header"),
    )


def _tells(name: str) -> bool:
    return bool(what_it_says(name).kinds)


def _short_names(paths: Sequence[Path]) -> list[str]:
    """The words of each file's name that not all of them begin or end with."""
    names = [_WORDS.findall(path.stem) for path in paths]
    start = _shared(names)
    end = _shared([words[start:][::-1] for words in names])
    short = ["_".join(words[start : len(words) - end]) for words in names]
    if all(short) and len(set(short)) == len(short):
        return short
    return [f"{default_name(place)} of {path.stem}" for place, path in enumerate(paths, 1)]


def _shared(names: Sequence[Sequence[str]]) -> int:
    columns = zip(*names, strict=False)
    return sum(1 for _ in takewhile(lambda words: len(set(words)) == 1, columns))


def runs_of_signals(tables: Sequence[Table]) -> list[list[Path]] | None:
    """Files of one signal each, put together by what their names share; None of other files.

    Parameters
    ----------
    tables : sequence of Table
        Each has a time and one column more, or these are whole recordings.
    """
    if len(tables) < 2 or any(len(t.columns) != 2 or time_of(t) is None for t in tables):
        return None
    paths = [table.path for table in tables]
    own = [next(name for name in t.columns if name != time_of(t)) for t in tables]
    if all(map(_tells, own)) and len({what_it_says(name).word for name in own}) == len(own):
        return [paths]
    runs: dict[tuple[str, ...], dict[tuple[str, ...], Path]] = {}
    for path in paths:
        words = _WORDS.findall(path.stem)
        signal = tuple(word for word in words if _tells(word))
        run = tuple(word for word in words if not _tells(word))
        if not signal or signal in runs.setdefault(run, {}):
            return None
        runs[run][signal] = path
    signals = {frozenset(run) for run in runs.values()}
    if len(signals) > 1 or len(next(iter(signals))) < 2:
        return None
    return [list(run.values()) for run in runs.values()]
