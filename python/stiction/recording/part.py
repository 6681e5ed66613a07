"""A part of a recording, from and to a time or a row of its file."""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.given import brief, number
from ..errors import InputError

__all__ = ["part_of"]

_ROW: Final = re.compile(r"row ([1-9]\d{0,14})")


def part_of(
    time: FloatArray, begin: float | str | None, end: float | str | None, source: str
) -> slice:
    """The rows from one end to the other, both of them included.

    Parameters
    ----------
    time : ndarray, shape (rows,)
        s.
    begin, end : float, str or None
        s on that clock, or a row as in ``"row 120"``, counted from 1; None for the file's own end.
    source : str
        What the error sentences begin with.

    Raises
    ------
    InputError
        No such row, no time, or nothing between the two.
    """
    first = 0 if begin is None else _row(time, begin, f"{source}: from", last=False)
    last = len(time) - 1 if end is None else _row(time, end, f"{source}: to", last=True)
    if last < first:
        known = time[np.isfinite(time)]
        span = f", from {known.min():.6g} s to {known.max():.6g} s" if len(known) else ""
        raise InputError(
            f"{source}: nothing lies from {_told(begin)} to {_told(end)}: the file has "
            f"{len(time)} rows{span}; give others"
        )
    return slice(first, last + 1)


def _row(time: FloatArray, given: float | str, where: str, *, last: bool) -> int:
    if isinstance(given, str):
        found = _ROW.fullmatch(given)
        if found is None or int(found[1]) > len(time):
            raise InputError(
                f"{where} = {brief(given)}: give a row from 'row 1' to 'row {len(time)}', or "
                "seconds as a number"
            )
        return int(found[1]) - 1
    seconds = number(given, where)
    inside = np.flatnonzero(time <= seconds if last else time >= seconds)
    if len(inside) == 0:
        return -1 if last else len(time)
    return int(inside[-1] if last else inside[0])


def _told(end: float | str | None) -> str:
    return "its end" if end is None else f"{end}" if isinstance(end, str) else f"{end:g} s"
