"""The fast way through blocks of text that hold plain numbers and nothing else.

A block that is not that simple is left to the careful way, which alone decides what a cell means:
here a block is read as it would read it, or not at all.  So it does not matter to the result
whether pyarrow is installed, only to the time it takes.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from io import BytesIO
from typing import Any, Final

import numpy as np

from ..._support.arrays import FloatArray

_ALPHABET: Final = b"0123456789+-.eEnaN\n"
_ARROW_BLOCK: Final = 2**20


def plain_numbers(data: bytes, width: int, delimiter: str) -> list[FloatArray] | None:
    """The columns of a block of lines, None where it has to be read with care.

    Parameters
    ----------
    data : bytes
        Whole lines with their ends, none of them empty.
    width : int
        Columns.
    delimiter : str
        A blank stands for any number of blanks and tabs.

    Returns
    -------
    list of ndarray, shape (lines,), or None
    """
    between = delimiter.encode()
    cleaned = _cleaned(data, between) if width else None
    if cleaned is None:
        return None
    columns = _parsed(cleaned, width, between)
    if columns is None and between != b" ":
        # Looking for empty cells takes as long as reading numbers, and most files have none.
        filled = _filled(cleaned, width, between)
        columns = None if filled == cleaned else _parsed(filled, width, between)
    return columns


def _parsed(data: bytes, width: int, between: bytes) -> list[FloatArray] | None:
    try:
        columns = _by_arrow(data, width, between) or _by_numpy(data, between.decode())
    except ValueError:  # also pyarrow's own errors are ones
        return None
    return columns if len(columns) == width and len(columns[0]) == data.count(b"\n") else None


def _cleaned(data: bytes, between: bytes) -> bytes | None:
    """The same cells in a spelling that both readers know, None where there is none."""
    # Deleting is the fastest question about all bytes there is.
    if data.translate(None, _ALPHABET + between + b" \t"):
        return None
    if between == b" ":
        data = data.replace(b"\t", b" ")
    elif between != b"\t" and b"\t" in data:
        return None
    if b" " not in data:
        return data
    data = _without_blanks(data, between)
    blank = between != b" " and b" " in data
    return None if blank or data.startswith(b"\n") or b"\n\n" in data else data


def _without_blanks(data: bytes, between: bytes) -> bytes:
    """Without blanks around cells; one blank stays between two where nothing else stands."""
    while b"  " in data:
        data = data.replace(b"  ", b" ")
    if between != b" ":
        data = data.replace(b" " + between, between).replace(between + b" ", between)
    return data.replace(b" \n", b"\n").replace(b"\n ", b"\n").removeprefix(b" ")


def _filled(data: bytes, width: int, between: bytes) -> bytes:
    """With nan in empty cells, and without a delimiter behind the last column."""
    if between + b"\n" in data:
        rows = data.count(b"\n")
        if data.count(between + b"\n") == rows and data.count(between) == rows * width:
            data = data.replace(between + b"\n", b"\n")
        data = data.replace(between + b"\n", between + b"nan\n")
    if between * 2 in data:
        # Twice, for every second of several in a row is passed over.
        for _ in range(2):
            data = data.replace(between * 2, between + b"nan" + between)
    if data.startswith(between) or b"\n" + between in data:
        if between == b"\t":  # a line of tabs alone is an empty one
            return data
        data = (b"\n" + data).replace(b"\n" + between, b"\nnan" + between)[1:]
    return data


def _by_numpy(data: bytes, delimiter: str) -> list[FloatArray]:
    table = np.loadtxt(BytesIO(data), delimiter=delimiter, comments=None, ndmin=2)
    return [np.ascontiguousarray(column) for column in table.T]


def _by_arrow(data: bytes, width: int, between: bytes) -> list[FloatArray] | None:
    """None without pyarrow, and for what it would not read."""
    arrow = _arrow()
    if arrow is None:
        return None
    if b"+" in data:
        # It knows no plus sign before a number, and what follows one has to be the number.
        if b"++" in data or b"+-" in data:
            return None
        for before in (between, b"\n"):
            data = data.replace(before + b"+", before)
        data = data.removeprefix(b"+")
    pyarrow, csv = arrow
    names = [str(column) for column in range(width)]
    table = csv.read_csv(
        pyarrow.py_buffer(data),
        read_options=csv.ReadOptions(column_names=names, block_size=_ARROW_BLOCK),
        parse_options=csv.ParseOptions(
            delimiter=between.decode(), quote_char=False, double_quote=False
        ),
        convert_options=csv.ConvertOptions(
            column_types=dict.fromkeys(names, pyarrow.float64()), null_values=[]
        ),
        # Its own pool keeps hold of what it has had.
        memory_pool=pyarrow.system_memory_pool(),
    )
    return [column.to_numpy() for column in table.columns]


@cache
def _arrow() -> tuple[Any, Any] | None:
    try:
        return import_module("pyarrow"), import_module("pyarrow.csv")
    except ImportError:
        return None
