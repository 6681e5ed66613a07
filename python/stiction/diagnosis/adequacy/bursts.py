"""Single moments in which far more is left than noise leaves, wherever a machine is in them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Rows
from ..data.evidence import Evidence
from ..records import Advice
from ..screening.model import Model
from .passing import MOMENTS
from .view import LEAST_SIZE, View

__all__ = ["Burst", "at_moments", "burst_of", "bursts", "recurs"]

WINDOW_S: Final = 0.2
"""Length of the windows in which single moments are looked for."""
FEW_WINDOWS: Final = 0.35
"""Share of all windows in which moments are single ones."""
MOST_OF_IT: Final = 0.75
"""Of what noise does not explain, from which on it lies in moments."""
TIMES: Final = 30.0
"""A window bursts where it holds so many times what any window of any surrogate of its recording
holds: where nothing was hidden it came to 19, and where a drive was out of voltage for a fifth of a
second to 74 and more."""
LEAST: Final = 0.08
"""Share of all that is left which bursts hold, from which on they are told; there it came to .04,
and to .13 and more. What is that far beyond noise matters from half of ``LEAST_SIZE`` on."""
SINGLE: Final = 0.1
BEYOND_NOISE: Final = 4.0
"""Share of the blocks, and one block at least, up to which those are single moments that hold so
many times the power that any surrogate has in the same block. Of 157 sessions with nothing hidden
one had more (.35), 138 none; eight with a gap or a shaft that rings had .16 to .95, and two had as
few as sessions with nothing."""
MOST_WINDOWS: Final = 0.01
"""Share of all windows up to which bursts are single moments."""


@dataclass(frozen=True)
class Burst:
    """Single moments that hold much of what is left.

    Attributes
    ----------
    share : float
        Of the power that is left.
    recording : str
        In which the largest of them lies.
    start : float
        Of that, s since the first row of the recording.
    view : View
        The rms of what is left in every short window, over the session clock.
    """

    share: float
    recording: str
    start: float
    view: View

    def advice(self) -> Advice:
        """What to look at, and to record."""
        return Advice(
            f"look at what happens {self.start:.1f} s into {self.recording}, and record it four "
            "times or more",
            f"{100 * self.share:.0f} % of what is left lies in single moments, most of it there",
            (),
        )


def at_moments(evidence: Evidence, model: Model, null: FloatArray) -> bool:
    """Whether most of what noise does not explain lies in few short windows.

    A window stands out where it holds more than any window of any surrogate of its recording.
    """
    outstanding, excess, windows = 0.0, 0.0, [0, 0]
    for _, _, power, noise in _windows(evidence, model, null):
        beyond = np.maximum(power - float(np.mean(noise)), 0.0)
        out = power > float(np.max(noise))
        outstanding += float(beyond[out].sum())
        excess += float(beyond.sum())
        windows[0] += int(out.sum())
        windows[1] += len(power)
    few = windows[0] < FEW_WINDOWS * windows[1]
    return few and outstanding > MOST_OF_IT * excess > 0.0


def recurs(residual: FloatArray, null: FloatArray, block: np.ndarray) -> bool:
    """Whether more than noise is left, and not in single moments alone.

    What readings make of a rigid contact they make of surrogates at the same moments.

    Parameters
    ----------
    residual : numpy.ndarray, shape (n,)
    null : numpy.ndarray, shape (n, surrogates)
        Residuals of the surrogates of the same model.
    block : numpy.ndarray of int, shape (n,)
        Block of each row.
    """

    def power(left: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(block, left**2), dtype=float)

    most = np.max([power(each) for each in null.T], axis=0)
    beyond = int(np.sum(power(residual) > BEYOND_NOISE * most))
    return beyond > max(1.0, SINGLE * len(np.unique(block)))


def burst_of(
    evidence: Evidence,
    model: Model,
    null: FloatArray,
    friction: float,
    starts: Sequence[float],
) -> Burst | None:
    """What lies in single moments far beyond noise, None where that is little or comes everywhere.

    Smoothers need what comes again, and so do causes. What comes once, or in one role alone, is
    something all the same.

    Parameters
    ----------
    evidence : Evidence
    model : Model
        What it leaves is looked at.
    null : numpy.ndarray, shape (n, surrogates)
        Residuals of the surrogates.
    friction : float
        Weighted rms of the friction, against which sizes are measured.
    starts : sequence of float
        When each recording starts on the session clock, s.
    """
    found = _largest(evidence, model, null, friction)
    if found is None:
        return None
    share, size, recording, start = found
    view = View(MOMENTS, *_curve(evidence, model, null, starts), share, LEAST, size)
    return Burst(share, recording, start, view)


def bursts(evidence: Evidence, model: Model, null: FloatArray, friction: float) -> bool:
    """Whether there is one (see ``burst_of``)."""
    return _largest(evidence, model, null, friction) is not None


def _largest(
    evidence: Evidence, model: Model, null: FloatArray, friction: float
) -> tuple[float, float, str, float] | None:
    """Share and size of what lies in moments; recording and start of the largest of them."""
    total = float(np.sum(model.residual**2))
    largest, there, sums, windows = 0.0, ("", 0.0), [0.0, 0], 0
    for rows, time, power, noise in _windows(evidence, model, null):
        out = power > TIMES * float(np.max(noise))
        sums = [sums[0] + float(power[out].sum()), sums[1] + int(out.sum())]
        windows += len(power)
        most = int(np.argmax(power))
        if out[most] and power[most] > largest:
            begin = float(evidence.recordings[rows.index].time[0])
            largest, there = float(power[most]), (evidence.names[rows.index], time[most] - begin)
    size = float(np.sqrt(sums[0] / len(model.residual))) / max(friction, 1e-300)
    little = sums[0] <= LEAST * total or size <= 0.5 * LEAST_SIZE
    if little or sums[1] > MOST_WINDOWS * windows:
        return None
    return sums[0] / total, size, there[0], float(there[1])


def _curve(
    evidence: Evidence, model: Model, null: FloatArray, starts: Sequence[float]
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Session clock, rms in each short window, and the band of 95 % of the surrogates."""
    at: list[FloatArray] = []
    shown: list[FloatArray] = []
    low: list[FloatArray] = []
    high: list[FloatArray] = []
    for rows, time, power, noise in _windows(evidence, model, null):
        begin = float(evidence.recordings[rows.index].time[0])
        at.append(starts[rows.index] + time - begin + 0.5 * WINDOW_S)
        scale = rows.weight * np.sqrt(_length(rows))
        shown.append(np.sqrt(power) / scale)
        for bound, share in ((low, 0.025), (high, 0.975)):
            bound.append(np.quantile(np.sqrt(noise), share, axis=1) / scale)
    order = np.argsort(np.concatenate(at), kind="stable")
    clock, mean, least, most = (np.concatenate(each)[order] for each in (at, shown, low, high))
    return clock, mean, least, most


def _length(rows: Rows) -> int:
    """Rows in a short window."""
    return max(1, round(WINDOW_S / (rows.form.dt * rows.form.stride)))


def _windows(
    evidence: Evidence, model: Model, null: FloatArray
) -> Iterator[tuple[Rows, FloatArray, FloatArray, FloatArray]]:
    """The short windows of each recording.

    Yields
    ------
    Rows
    numpy.ndarray, shape (k,)
        When each begins, s.
    numpy.ndarray, shape (k,)
        Power in each.
    numpy.ndarray, shape (k, surrogates)
        The same of each surrogate.
    """
    for rows in evidence.shown:
        own = evidence.cells.recording == rows.index
        length = _length(rows)
        number = int(own.sum()) // length
        if number > 0:
            first = np.flatnonzero(own)[: number * length].reshape(number, length)
            power = np.sum(model.residual[first] ** 2, axis=1)
            time = rows.form.time[rows.mask][: number * length : length]
            yield rows, time, power, np.sum(null[first] ** 2, axis=1)
