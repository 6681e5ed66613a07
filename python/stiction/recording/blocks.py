"""Parts of recordings, and recordings cut into interleaved blocks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.given import number
from ..errors import InputError, NotEnoughData

FEWEST_BLOCKS: Final = 3
"""One each to train, select and test."""

SHORT_SHARE: Final = 0.05
"""Where only three blocks fit they may be this share shorter than asked: 600 rows at a nominal 10
ms last 5.96 s."""


@dataclass(frozen=True, order=True)
class Part:
    """Some rows of a recording.

    Attributes
    ----------
    recording : int
        Its index in the session.
    start, stop : int
        First row, and the row behind the last.
    """

    recording: int
    start: int
    stop: int

    @property
    def rows(self) -> slice:
        """The same as a slice."""
        return slice(self.start, self.stop)

    def __len__(self) -> int:
        return self.stop - self.start


def check_lengths_of(block_s: float, edge_s: float) -> None:
    """Refuse blocks of which the edges leave less than half.

    Raises
    ------
    InputError
    """
    block_s, edge_s = number(block_s, "split: block_s"), number(edge_s, "split: edge_s")
    if not (math.isfinite(block_s) and block_s > 0.0):
        raise InputError(f"split: block_s is {block_s!r}; give a length above 0 in seconds")
    if not 0.0 <= edge_s <= 0.25 * block_s:
        raise InputError(
            f"split: edge_s is {edge_s!r}, and blocks of {block_s:g} s can lose 0 to "
            f"{0.25 * block_s:g} s at an edge; give another, or longer blocks"
        )


def blocks(
    recording: int, time: FloatArray, name: str, block_s: float, edge_s: float
) -> list[Part]:
    """Cut a recording into blocks of equal duration, without their edges.

    Parameters
    ----------
    recording : int
        Index that the parts carry.
    time : ndarray, shape (rows,)
        s, increasing.
    name : str
        Of the recording, for the error sentence.
    block_s, edge_s : float
        Least length of a block, and what it loses at an edge to another block, s.  Nothing is
        lost at the two ends of the recording.

    Returns
    -------
    list of Part
        At least three, in order, none of them empty.

    Raises
    ------
    InputError
        A recording shorter than three blocks, or one with so wide a gap that a block is empty.
    """
    step = float(np.median(np.diff(time)))
    span = float(time[-1] - time[0]) + step
    number = math.floor(span / block_s + 1e-6)  # the last step of a clock is rounded too
    if span >= (1.0 - SHORT_SHARE) * FEWEST_BLOCKS * block_s:
        number = max(number, FEWEST_BLOCKS)
    if number < FEWEST_BLOCKS:
        raise NotEnoughData(
            f"session: {name} lasts {span:.3g} s and must be cut into at least {FEWEST_BLOCKS} "
            f"blocks of {block_s:g} s to train and to judge on; record "
            f"{FEWEST_BLOCKS * block_s:g} s or more, or give recordings the roles train, select "
            "and test"
        )
    length = span / number
    parts = []
    for block in range(number):
        low = time[0] + block * length + (edge_s if block > 0 else 0.0)
        high = time[0] + (block + 1) * length - (edge_s if block < number - 1 else 0.0)
        start, stop = (int(row) for row in np.searchsorted(time, (low, high)))
        stop = len(time) if block == number - 1 else stop
        if stop - start < 2 and 2.0 * step > high - low:
            raise InputError(
                f"session: {name} has a row every {step:.3g} s, too few for blocks of "
                f"{length:.3g} s to train and to judge on; check the unit of its time, and state "
                'it where it is not s, as in --columns "time=NAME [ms]" or under [columns]'
            )
        if stop - start < 2:
            raise InputError(
                f"session: {name} has no rows from {low - time[0]:.3g} s to {high - time[0]:.3g} s "
                "and must be cut into blocks; split the file at the gap into two recordings"
            )
        parts.append(Part(recording, start, stop))
    return parts
