"""Inputs that leave their neighbours for up to three samples: whether the machine got them.

What a logger makes up the machine never got: taken at its word a fit is torn towards it, and a
diagnosis finds a drive that holds large inputs back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from ..._support.arrays import FloatArray
from ..._support.wording import plural
from ..motion import FEWEST_SAMPLES, SUPPORTS_S, Kernel, evenly, zero_order_hold
from ..names import names_of
from ..recording import Recording
from .finding import Check
from .signal import SPIKE_TIMES, IntArray, is_goal, runs, without_spikes

__all__ = ["Impulses", "impulse_checks", "impulses", "without_failures"]

NAME: Final = "impulses of the input"
LONGEST: Final = 3
"""Samples that an impulse lasts at most: a telegram or three that were lost."""
AROUND: Final = 2 * LONGEST + 1
"""Samples whose median is what the input would be without it."""
STEP_TIMES: Final = 5.0
"""Both edges of an impulse are so many times the usual step about it."""
_AT_ONCE: Final = 2**16
BESIDE: Final = 0.1
"""Share of the height of an impulse that belongs to it."""
LEAST_SHARE: Final = 1e-3
"""And this share of the range of the input."""
LATE_S: Final = (
    *(0.0, 0.004, 0.008, 0.016, 0.024, 0.032, 0.048, 0.064, 0.08, 0.096, 0.12, 0.15),
    *(0.2, 0.25, 0.3, 0.4, 0.5),
)
"""By so much an impulse may come late, or spread, and still be one that the machine got."""
MOVING: Final = 0.2
"""Share of the rms speed above which friction does not hold an impulse back."""
HALF: Final = 0.5
"""Share of an impulse that a machine shows at least that got it."""
NOTHING: Final = 1e-12
"""Share of what impulses do that must not go with the rest."""
SURE: Final = 4.0
"""Standard errors by which it shows more or less than that."""


@dataclass(frozen=True)
class Impulses:
    """Rows in which the input leaves its neighbours and comes back.

    Attributes
    ----------
    rows : numpy.ndarray of int, shape (impulses,)
    got : bool or None
        Whether the machine got them; None where its motion does not tell.
    answers : bool
        It answers to them, be it to a part of them, or late.
    """

    rows: IntArray
    got: bool | None
    answers: bool = False


def impulses(recordings: Sequence[Recording]) -> list[Impulses]:
    """Rows of each input that stand apart, and whether the machine got them.

    An input may go there and back within a sample where it is commanded to; a reading that failed
    does so as well. A machine that got an impulse is faster by its area over the inertia after it.
    While it moves

        K''∗x = c·K∗u + c′·K∗d + friction,

    u the input without impulses and d these alone: c′ is c where the machine got them and 0 where
    it did not, whatever its inertia. Friction is taken to be that of sliding, Coulomb and viscous,
    beside a part that goes with the position. Where c′ is above 0 by any delay the machine got
    something, be it what a limit left of it. Where the motion of one recording tells nothing, that
    of the others does, if they agree.

    Parameters
    ----------
    recordings : sequence of Recording
        Of one session. An input that is a goal has no impulses.

    Returns
    -------
    list of Impulses
        One for each recording.
    """
    found = [_impulses(recording) for recording in recordings]
    told = {each.got for each in found if each.got is not None}
    if len(told) != 1:
        return found
    (got,) = told
    open_ = [len(each.rows) > 0 and (got or not each.answers) for each in found]
    return [replace(each, got=got) if o else each for each, o in zip(found, open_, strict=True)]


def without_failures(recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings, with what no machine got replaced by what the input was before and after."""
    return [
        recording.with_input(_without(recording.input, each.rows))
        if each.got is False and recording.input is not None
        else recording
        for recording, each in zip(recordings, impulses(recordings), strict=True)
    ]


def impulse_checks(recordings: Sequence[Recording]) -> list[tuple[str, Check]]:
    """What is told of inputs that stand apart for a few rows, by recording."""
    found = []
    for name, recording, each in zip(
        names_of(recordings), recordings, impulses(recordings), strict=True
    ):
        if not len(each.rows) or recording.input is None:
            continue
        row = each.rows[0]
        what = (
            f"input leaves its neighbours and comes back within {LONGEST} samples, in "
            f"{plural(len(each.rows), 'row')}, first at {recording.time[row]:.6g} s to "
            f"{recording.input[row]:.4g}"
        )
        if each.got:
            found.append((name, Check(NAME, "fine", f"{what}; the machine answers")))
            continue
        means = "whether the machine got that, its motion does not tell; these samples are kept"
        if each.answers:
            means = "the machine answers to a part of that, or late; these samples are kept"
        if each.got is False:
            means = (
                "the machine does not answer, so a reading failed; fits and diagnoses take a "
                "line between its neighbours"
            )
        remedy = "check how the input is logged"
        found.append((name, Check(NAME, "note", what, means, remedy)))
    return found


def _impulses(recording: Recording) -> Impulses:
    """Those of one recording, by its own motion."""
    values = recording.input
    none = np.zeros(0, dtype=np.int64)
    if values is None or is_goal(recording) or not np.all(np.isfinite(values)):
        return Impulses(none, None)
    rows = _apart(values)
    position = recording.position
    if not len(rows) or position is None or not np.all(np.isfinite(position)):
        return Impulses(rows, None)
    return Impulses(rows, *_got(recording, values, rows, position))


def _apart(values: FloatArray) -> IntArray:
    """Rows where values leave their neighbours for a few samples, as ``spike_rows`` for one."""
    none = np.zeros(0, dtype=np.int64)
    steps = np.diff(values)
    bend = np.abs(np.diff(steps))
    least = SPIKE_TIMES * _most(bend)
    if len(values) < AROUND or float(np.max(bend)) <= least:
        return none
    span = float(np.ptp(np.quantile(values, (0.01, 0.99))))
    least = max(least, LEAST_SHARE * span)

    def jumps(first: int, last: int) -> bool:
        edges = min(abs(steps[first - 1]), abs(steps[last - 1]))
        about = np.abs(steps[max(first - 1 - AROUND, 0) : last + AROUND])
        return bool(edges > max(least, STEP_TIMES * float(np.median(about))))

    away = np.abs(values - _medians(values))
    # Beside an impulse the median is off by a little, and a corner is off its own, but nothing
    # jumps there.
    far = away > np.maximum(least, BESIDE * np.max(_windows(away), axis=1))
    found = [
        np.arange(first, last)
        for first, last in runs(far)
        if first > 0 and last < len(values) and jumps(first, last)
    ]
    return np.concatenate(found) if found else none


def _windows(values: FloatArray) -> FloatArray:
    """What lies about each value; shape (n, 7)."""
    padded = np.pad(values, AROUND // 2, "edge")
    return np.lib.stride_tricks.sliding_window_view(padded, AROUND)


def _medians(values: FloatArray) -> FloatArray:
    """The median of what lies about each value."""
    windows = _windows(values)
    # A part at a time, for it copies them.
    parts = [np.median(windows[k : k + _AT_ONCE], axis=1) for k in range(0, len(values), _AT_ONCE)]
    return np.concatenate(parts)


def _most(values: FloatArray) -> float:
    """What four of five values stay below."""
    place = (4 * len(values)) // 5
    return float(np.partition(values, place)[place])


def _without(values: FloatArray, rows: IntArray) -> FloatArray:
    """Values with a line through these rows between what comes before and after them."""
    kept = np.ones(len(values), dtype=np.bool_)
    kept[rows] = False
    places = np.arange(len(values))
    return np.interp(places, places[kept], values[kept])


def _got(
    recording: Recording, values: FloatArray, rows: IntArray, position: FloatArray
) -> tuple[bool | None, bool]:
    """Whether the machine got these rows of the input, and whether it answers to them at all."""
    stamps, time, dt = evenly(recording.time)
    support = max(SUPPORTS_S[0], FEWEST_SAMPLES * dt)
    if len(time) * dt < 4.0 * support:
        return None, False
    kernel = Kernel(support, dt)
    x = np.interp(time, stamps, without_spikes(position))
    usual = zero_order_hold(time, stamps, _without(values, rows))
    apart = zero_order_hold(time, stamps, values) - usual
    speed = kernel.mean(np.gradient(x, dt)[1:])
    moving = np.abs(speed) > MOVING * float(np.sqrt(np.mean(speed**2)))
    if np.count_nonzero(moving) < len(kernel.weights):
        return None, False
    columns = [kernel.mean(_in_between(usual)), np.ones_like(speed), np.sign(speed), speed]
    columns.append(kernel.mean(x[1:]))
    usually = _Usually(np.column_stack(columns), kernel.second_derivative(x[1:]), moving)
    # A kernel that goes over what comes late is one that went over it before.
    impulse = kernel.mean(_in_between(apart))
    lates = (round(late / dt) for late in LATE_S)
    told = [
        usually.answer(_late(impulse, late), len(kernel.weights))
        for late in lates
        if late < len(impulse)
    ]
    answers = any(each.answers for each in told)
    if any(each.share - SURE * each.error > HALF for each in told):
        return True, True
    quiet = not answers and all(each.share + SURE * each.error < HALF for each in told)
    return (False if quiet else None), answers


@dataclass(frozen=True)
class _Answer:
    """Share of impulses that a motion shows, its standard error, and whether it shows any."""

    share: float = 0.0
    error: float = np.inf
    answers: bool = False


class _Usually:
    """Accelerations while a machine moves, and what they depend on beside impulses.

    Parameters
    ----------
    columns : numpy.ndarray, shape (n, k)
        The first one is the usual input.
    acceleration : numpy.ndarray, shape (n,)
    moving : numpy.ndarray of bool, shape (n,)
    """

    def __init__(
        self, columns: FloatArray, acceleration: FloatArray, moving: npt.NDArray[np.bool_]
    ) -> None:
        self._moving, self._acceleration = moving, acceleration[moving]
        self._size = np.maximum(np.linalg.norm(columns[moving], axis=0), 1e-300)
        # Once for all delays: only the impulses come later each time.
        span, sizes, ways = np.linalg.svd(columns[moving] / self._size, full_matrices=False)
        told = sizes > NOTHING**0.5 * sizes[0]
        self._span = span[:, told]
        self._first = ways[told, 0] / sizes[told]
        self._left = self._off(self._acceleration)

    def _off(self, values: FloatArray) -> FloatArray:
        """Values less what goes with the columns; shape (moving,)."""
        left: FloatArray = values - self._span @ (self._span.T @ values)
        return left

    def answer(self, impulse: FloatArray, together: int) -> _Answer:
        """What the motion shows of impulses, shape (n,); ``together`` rows share their noise."""
        whole = impulse[self._moving]
        own = self._off(whole)
        square = float(own @ own)
        if square <= NOTHING * float(whole @ whole):
            return _Answer()
        by_impulse = float(own @ self._left) / square
        left = self._left - by_impulse * own
        beside = self._span.T @ (self._acceleration - by_impulse * whole)
        by_input = float(self._first @ beside) / self._size[0]
        noise = np.sqrt(together * np.mean(left**2))
        # One impulse, one piece of evidence: what rows under it leave adds up.
        group = np.cumsum(np.diff((impulse != 0.0).astype(np.int8), prepend=0) == 1)[self._moving]
        error = float(np.linalg.norm(np.bincount(group, own * left))) / square
        error = max(error, float(noise / np.sqrt(square)))
        answers = by_impulse > SURE * error
        if by_input <= SURE * float(noise) / self._size[0]:
            return _Answer(answers=answers)
        return _Answer(by_impulse / by_input, error / by_input, answers)


def _late(values: FloatArray, samples: int) -> FloatArray:
    """Values that come so many samples later."""
    if samples == 0:
        return values
    return np.concatenate([np.zeros(samples), values[:-samples]])


def _in_between(values: FloatArray) -> FloatArray:
    """What held about each stamp but the first: half of it before, half after."""
    return 0.5 * (values[:-1] + values[1:])
