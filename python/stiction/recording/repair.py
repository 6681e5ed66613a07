"""Small faults of a recording: found, mended where that is safe, and always reported.

Cells that are missing or infinite are interpolated between their neighbours, and isolated time
stamps that repeat or step back are spaced anew.  Beyond a few of either the recording would be
our invention, so it is refused.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from .._support.arrays import FloatArray
from .._support.wording import plural
from ..errors import InputError

BAD_SHARE: Final = 0.05
"""Repairs stay under this share of a channel's cells."""

FEWEST_ROWS: Final = 200
"""Fewer rows than this carry no diagnosis."""

ISOLATED_ROWS: Final = 5
"""More bad stamps in a row than this are a step of the clock, not a slip of the logger."""

STEPS_S: Final = (1e-9, 1e6)
"""The usual time step lies between these; beyond them the unit of time is wrong."""

PAUSES: Final = (50.0, 1e6)
"""Steps that a recording spans: at most this many times its rows, where it is more than the second
number. Beyond, the clock jumps, or its stamps come in bursts."""

LARGEST: Final = 1e30
"""No SI value of a machine is beyond this; squares and sums of larger ones leave the floats."""

Place = Callable[[int], str]
_Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Repair:
    """One kind of repair made to one channel.

    Attributes
    ----------
    channel : str
        Role of the channel, or ``"time"``.
    what : str
        ``"interpolated"`` (cells that were missing or infinite) or ``"respaced"`` (time stamps).
    count : int
        How many cells.
    first_row : int
        0-based row of the first of them.
    sentence : str
        The same in words.
    """

    channel: str
    what: str
    count: int
    first_row: int
    sentence: str

    def __str__(self) -> str:
        return self.sentence


@dataclass(frozen=True)
class Mended:
    """Channels after repair, the repairs, and the faults that were let pass."""

    values: dict[str, FloatArray]
    repairs: tuple[Repair, ...]
    faults: tuple[str, ...]


def check_lengths(source: str, lengths: Mapping[str, int]) -> None:
    """Raise `InputError` unless all lengths equal the first."""
    (first, expected), *others = lengths.items()
    for name, length in others:
        if length != expected:
            raise InputError(
                f"{source}: {name} has {plural(length, 'row')}, and {first} has {expected}; "
                "give channels of one recording, of equal length"
            )


def mend(
    values: Mapping[str, FloatArray], *, source: str, place: Place, keep_faulty: bool = False
) -> Mended:
    """Check the channels of a recording and repair what may be repaired.

    Parameters
    ----------
    values : dict of str to ndarray, shape (rows,)
        SI values by role, ``time`` among them, of equal lengths.  Not changed.
    source : str
        The file, for error sentences.
    place : callable
        Words for a 0-based row: ``"line 19"``.
    keep_faulty : bool
        Keep a channel with too many missing or infinite cells, and list it under ``faults``.
        Where no finite cell is left the channel stays NaN.

    Raises
    ------
    InputError
        For fewer than 200 rows, a clock that cannot be mended, or too many missing cells.
    """
    rows = len(values["time"])
    if rows < FEWEST_ROWS:
        raise InputError(
            f"{source}: the recording has {plural(rows, 'row')}, and at least {FEWEST_ROWS} are "
            "needed; record longer or sample faster"
        )
    repairs: list[Repair] = []
    faults: list[str] = []
    time = _mend_time(values["time"], source, place, repairs)
    _check_steps(time, source, place)
    mended = {"time": time}
    for name, channel in values.items():
        if name == "time":
            continue
        bad = ~np.isfinite(channel)
        absurd = np.isfinite(channel) & (np.abs(channel) > LARGEST)
        if absurd.any():
            row = int(absurd.argmax())
            raise InputError(
                f"{source}: {name} is {channel[row]:.6g} at {place(row)}, beyond what any machine "
                "can do; correct the cell, or empty it to have it filled from its neighbours"
            )
        number = int(bad.sum())
        if number >= BAD_SHARE * rows:
            fault = (
                f"{source}: {name} has {number} missing or infinite cells in {rows}, the first at "
                f"{place(int(bad.argmax()))}, and only under 5 % can be repaired; "
                f"record it again, or leave {name} out if it is optional"
            )
            if not keep_faulty:
                raise InputError(fault)
            faults.append(fault)
        mended[name] = channel
        if 0 < number < rows:
            mended[name] = channel.copy()
            mended[name][bad] = np.interp(time[bad], time[~bad], channel[~bad])
            repairs.append(_interpolated(name, bad, rows, place))
    return Mended(mended, tuple(repairs), tuple(faults))


def _interpolated(name: str, bad: _Mask, rows: int, place: Place) -> Repair:
    number, first = int(bad.sum()), int(bad.argmax())
    verb = "was" if number == 1 else "were"
    return Repair(
        name,
        "interpolated",
        number,
        first,
        f"{name}: {number} of {rows} cells {verb} missing or infinite and {verb} interpolated, "
        f"the first at {place(first)}",
    )


def _mend_time(time: FloatArray, source: str, place: Place, repairs: list[Repair]) -> FloatArray:
    if bool(np.all(np.diff(time) > 0.0)) and bool(np.all(np.isfinite(time))):
        return time
    good = _increasing(time)
    bad = ~good
    number, first = int(bad.sum()), int(bad.argmax())
    if number >= BAD_SHARE * len(time) or _longest_run(bad) > ISOLATED_ROWS:
        raise InputError(f"{source}: {_clock_fault(time, good, place)}")
    rows = np.arange(len(time), dtype=np.float64)
    mended = time.copy()
    mended[bad] = np.interp(rows[bad], rows[good], time[good])
    step = float(np.median(np.diff(time[good])))
    start, end = int(good.argmax()), len(time) - 1 - int(good[::-1].argmax())
    mended[:start] = time[start] + step * (rows[:start] - start)
    mended[end + 1 :] = time[end] + step * (rows[end + 1 :] - end)
    if not np.all(np.diff(mended) > 0.0):
        raise InputError(
            f"{source}: the time stamps around {place(first)} lie too close together to be "
            "spaced anew; record time from the start of the recording, with more digits"
        )
    verb = "was" if number == 1 else "were"
    what = "stamp that was missing, repeated or stepped back"
    repairs.append(
        Repair(
            "time",
            "respaced",
            number,
            first,
            f"time: {plural(number, what, what.replace('stamp that was', 'stamps that were'))} "
            f"{verb} spaced anew between their neighbours, the first at {place(first)}",
        )
    )
    return mended


def _check_steps(time: FloatArray, source: str, place: Place) -> None:
    """Refuse steps that no machine is sampled in, and pauses that hold no data to speak of."""
    steps = np.diff(time)
    usual = float(np.median(steps))
    if not STEPS_S[0] <= usual <= STEPS_S[1]:
        raise InputError(
            f"{source}: the usual time step is {usual:.6g} s, and {STEPS_S[0]:g} s to "
            f"{STEPS_S[1]:g} s are allowed; check the unit of time"
        )
    span = float(time[-1] - time[0])
    if span > usual * max(PAUSES[0] * len(time), PAUSES[1]):
        row = int(steps.argmax())
        raise InputError(
            f"{source}: time jumps by {steps[row]:.6g} s at {place(row + 1)}, where the usual "
            f"step is {usual:.6g} s; split the file there, or correct the clock"
        )


def _increasing(time: FloatArray) -> _Mask:
    """The longest strictly increasing selection of stamps: all others are bad.

    One stamp thrown far ahead is dropped alone, where a running maximum would drop all that
    follow it.  Of equal stamps the first stays.
    """
    tails: list[float] = []  # smallest last stamp of a selection, by its length
    tail_rows: list[int] = []
    before = np.full(len(time), -1, dtype=np.int64)
    for row, stamp in enumerate(time.tolist()):
        if not np.isfinite(stamp):
            continue
        length = bisect_left(tails, stamp)
        if length < len(tails) and tails[length] == stamp:
            continue
        before[row] = tail_rows[length - 1] if length else -1
        tails[length : length + 1] = [stamp]
        tail_rows[length : length + 1] = [row]
    good = np.zeros(len(time), dtype=np.bool_)
    row = tail_rows[-1] if tail_rows else -1
    while row >= 0:
        good[row] = True
        row = int(before[row])
    for row in np.flatnonzero(~good & np.isfinite(time)).tolist():
        _exchange(time, good, row)
    return good


def _exchange(time: FloatArray, good: _Mask, row: int) -> None:
    """Keeps a dropped stamp in place of the one beside it where that fits the clock better.

    A stamp that falls between two earlier ones leaves two selections of the same length: itself
    without its neighbour, or the neighbour without it.
    """
    for other in (row - 1, row + 1):
        if not 0 <= other < len(time) or not good[other]:
            continue
        low, high = min(row, other) - 1, max(row, other) + 1
        while low >= 0 and not good[low]:
            low -= 1
        while high < len(time) and not good[high]:
            high += 1
        if low < 0 or high >= len(time) or not time[low] < time[row] < time[high]:
            continue
        step = (time[high] - time[low]) / (high - low)
        off = [abs(time[k] - time[low] - step * (k - low)) for k in (row, other)]
        if off[0] < off[1]:
            good[row], good[other] = True, False
            return


def _longest_run(bad: _Mask) -> int:
    edges = np.flatnonzero(np.diff(np.concatenate(([0], bad.astype(np.int8), [0]))))
    return int(np.max(edges[1::2] - edges[::2], initial=0))


def _clock_fault(time: FloatArray, good: _Mask, place: Place) -> str:
    """Why a clock cannot be mended, and what to do."""
    missing = ~np.isfinite(time)
    if missing.sum() >= BAD_SHARE * len(time) or _longest_run(missing) > ISOLATED_ROWS:
        return (
            f"{plural(int(missing.sum()), 'time stamp is', 'time stamps are')} missing or "
            f"infinite in {len(time)}, the first at {place(int(missing.argmax()))}; "
            "time must be stamped on every row"
        )
    steps = np.diff(time)
    if np.sum(steps < 0.0) > 0.5 * len(steps):
        return (
            f"time decreases over the file (from {time[0]:g} s to {time[-1]:g} s); "
            "sort the rows by time"
        )
    repeated = steps == 0.0
    if np.sum(repeated) >= np.sum(~good & ~missing) * 0.5:
        return (
            f"{int(repeated.sum())} of {len(time)} time stamps repeat the one before, the first "
            f"at {place(int(repeated.argmax()) + 1)}; "
            "record time with more digits, for only isolated repeats are repaired"
        )
    back = int(np.argmin(np.where(np.isfinite(steps), steps, np.inf)))
    return (
        f"time decreases at {place(back + 1)} (from {time[back]:g} s to {time[back + 1]:g} s), "
        "and more than isolated stamps are out of order; sort the rows, or split the file where "
        "the clock starts again"
    )
