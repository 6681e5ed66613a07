"""Delimited text: CSV and its relatives.

Where the delimiter is not the comma, numbers may have a decimal comma.  The line below the header
may hold units in place of numbers.  Columns of dates and times of day become seconds since the
first of them.

A file is read in blocks: those that hold plain numbers alone the fast way, all others with care.
"""

from __future__ import annotations

from pathlib import Path

from ..._support.wording import plural
from ...errors import InputError
from ..table import Table
from ..text.head import find_head
from ..text.lines import blocks
from ..text.rows import Head, Rows
from .format import Format


def read(path: Path) -> Table:
    """Read a delimited text file (see the module's text)."""
    head = find_head(path)
    return rows_below(path, head, commas=head.delimiter != ",")


FORMAT = Format("CSV", (".csv", ".txt", ".tsv", ".dat"), read)


def rows_below(path: Path, head: Head, *, commas: bool) -> Table:
    """The table below the header of a text file.

    Parameters
    ----------
    path : Path
    head : Head
    commas : bool
        A comma in a number may be a decimal one.

    Raises
    ------
    InputError
        There are no columns, no rows, or one that has too many cells.
    """
    if not head.names:
        raise InputError(
            f"{path}: the first line has no column; write a line of names, or of numbers, "
            "separated by commas, semicolons, tabs or blanks"
        )
    rows = _rows(path, head, commas=commas)
    if rows.mixed:
        rows = _rows(path, head, commas=False)
    if not len(rows.lines):
        raise InputError(
            f"{path}: the file has a header ({plural(len(head.names), 'column')}) and no rows "
            "under it; record it again or name another"
        )
    begins = rows.begins
    columns, cells = rows.columns()
    units = {**head.units, **{head.names[k]: "s" for k in head.stamps}}
    return Table(path, columns, cells, lines=rows.lines, units=units, begins=begins)


def _rows(path: Path, head: Head, *, commas: bool) -> Rows:
    rows = Rows(path, head, commas=commas)
    for block in blocks(path):
        if (below := block.after(head.last)) is not None:
            rows.add(below)
        if rows.mixed:
            break
    return rows
