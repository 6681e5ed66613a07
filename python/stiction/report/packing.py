"""Long columns of numbers as short text, which a page unpacks without a library."""

from __future__ import annotations

import zlib
from base64 import b64encode
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from .._support.arrays import FloatArray

__all__ = ["Packed", "pack"]

FINEST: Final = 2.0**-26
"""Steps of a column are no finer than this share of its range: differences of the second order of
whole numbers of steps still have 32 bits then."""
PLANES: Final = 4
"""Bytes of a whole number. Those of one weight stand together: the higher ones are 0 nearly all."""
ORDERS: Final = (0, 1, 2)
LEVEL: Final = 6
"""Of the compression: beyond it the time doubles and a hundredth of the size goes."""


@dataclass(frozen=True)
class Packed:
    """A column of n numbers.

    Value k is ``origin`` + ``step`` times a whole number. Of these the differences of an order are
    kept, 0 → 0, -1 → 1, 1 → 2, -2 → 3 …, as bytes of equal weight one column after the other,
    deflated (RFC 1950), in base 64.

    Attributes
    ----------
    origin, step : float
    order : int
        Of the differences: 0, 1 or 2; the first ones are those from 0.
    blank : list of [int, int]
        Stretches of rows without a value: the first row, and the one behind the last.
    text : str
    """

    origin: float
    step: float
    order: int
    blank: list[list[int]]
    text: str

    def to_dict(self) -> dict[str, Any]:
        """What a page needs beside the text."""
        return {"origin": self.origin, "step": self.step, "order": self.order, "blank": self.blank}


def pack(values: FloatArray, step: float) -> Packed:
    """A column of numbers, each rounded to a step.

    Parameters
    ----------
    values : numpy.ndarray, shape (n,)
        What is not finite stays blank.
    step : float
        Nobody looks closer than this. Where it is finer than what the range allows it is taken
        wider.
    """
    known = np.isfinite(values)
    # A blank row goes on at the value before it, which costs nothing.
    last = np.maximum.accumulate(np.where(known, np.arange(values.size), 0))
    values = np.where(known[last], values[last], 0.0) if values.size else values
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
    step = max(step, FINEST * (high - low)) or 1.0
    whole = np.round((values - low) / step).astype(np.int64)
    changes = {order: np.diff(whole, order, prepend=np.zeros(order, np.int64)) for order in ORDERS}
    order = min(ORDERS, key=lambda each: float(np.sum(np.log2(1.0 + np.abs(changes[each])))))
    chosen = changes[order]
    # Small numbers of either sign have high bytes of 0 so.
    zigzag = ((chosen << 1) ^ (chosen >> 63)).astype("<u4")
    planes = zigzag.view(np.uint8).reshape(-1, PLANES).T
    text = b64encode(zlib.compress(planes.tobytes(), LEVEL)).decode("ascii")
    return Packed(low, step, order, _stretches(~known), text)


def _stretches(rows: np.ndarray) -> list[list[int]]:
    """Where rows that are set begin and end, one behind the last."""
    edges = np.flatnonzero(np.diff(rows.astype(np.int8), prepend=0, append=0))
    return [[int(begin), int(end)] for begin, end in edges.reshape(-1, 2)]
