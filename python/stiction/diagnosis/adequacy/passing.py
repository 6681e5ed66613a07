"""What comes and goes with time inside a recording: offsets that wander, pushes that come once.

Rows held out that lie in recordings of their own say nothing of it: what wanders within seconds is
another thing in the next recording. So neighbours in time judge each other.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ...fitting.rows import Mask
from ..data.evidence import Cells
from .coordinates import Coordinate, Look
from .view import FEWEST_ROWS, View, limit, means, sums

__all__ = ["DRIFT", "MOMENTS", "drift_view", "moments_view", "steady_rows"]


DRIFT: Final = Coordinate(
    "session time", "session clock, s", False, lambda look: look.time, rows="while it slides"
)
"""Residual that is much the same as a second before and a second later."""
MOMENTS: Final = Coordinate(
    "single moments in time",
    "session clock, s",
    False,
    lambda look: look.time,
    upright="rms residual, {f}",
    rows="while it slides",
)
"""Residual that is large in a few short windows, while the machine slides."""
SPAN_S: Final = 1.0
"""Length of the stretches that neighbours predict."""
WHOLE: Final = 0.2
"""Of the rows of a full one, which a stretch needs to be asked and to answer."""
STRETCHES: Final = 24
"""Of the velocity: what goes with it is taken off, for a machine that goes on evenly for seconds
shows it as a drift."""
WINDOW_S: Final = 0.1
"""Length of the windows in which moments are looked for."""
SETTLED_S: Final = 0.15
"""Since the last reversal or rest: before that the curve of any law misses."""
CHANCES: Final = 3
"""The largest windows that are not counted: so few say nothing of what comes again."""
FEWEST_RECORDINGS: Final = 4
"""From so many on the one that shows most is not counted."""
FEW: Final = 0.25
"""Share of all windows in which moments are single ones."""
FEWEST_WINDOWS: Final = 10
"""Of a recording, for some of them to stand out."""


def steady_rows(look: Look) -> Mask:
    """Rows in which a machine has been sliding one way for some time; shape (n,)."""
    return look.slides.sliding & (look.elapsed >= SETTLED_S)


def drift_view(
    cells: Cells,
    clock: FloatArray,
    velocity: FloatArray,
    sliding: Mask,
    both: FloatArray,
    weights: FloatArray,
    friction: float,
) -> View | None:
    """What the seconds beside it tell of each second of a recording.

    Of rows in which the machine slides: a contact that holds an effort of which the model knows
    nothing holds it until it slides. None where there are too few of them.

    Parameters
    ----------
    cells : Cells
    clock : numpy.ndarray, shape (n,)
        Session clock of each row, s.
    velocity : numpy.ndarray, shape (n,)
    sliding : numpy.ndarray of bool, shape (n,)
    both : numpy.ndarray, shape (n, 1 + surrogates)
        Weighted residual, then those of the surrogates.
    weights : numpy.ndarray, shape (n,)
    friction : float
        Weighted rms of the friction.
    """
    if np.sum(sliding) < FEWEST_ROWS:
        return None
    cells, clock, velocity = cells.of(sliding), clock[sliding], velocity[sliding]
    both, weights = both[sliding], weights[sliding]
    place, starts = _windows(cells, clock, SPAN_S)
    recording = _of(cells.recording, place, len(starts))
    total = sums(place, both**2, len(starts))
    both = _less_velocity(velocity, both)
    rows = np.bincount(place, minlength=len(starts))
    own = sums(place, both, len(starts)) / rows[:, None]
    full = rows >= WHOLE * np.max(rows)
    # Of each pair of stretches that touch, within one recording.
    touch = full[:-1] & full[1:] & (np.diff(starts) < 1.5 * SPAN_S)
    touch &= np.diff(recording) == 0
    told = np.zeros_like(own)
    told[1:] += own[:-1] * touch[:, None]
    told[:-1] += own[1:] * touch[:, None]
    beside = np.zeros(len(starts))
    beside[1:] += touch
    beside[:-1] += touch
    told /= np.maximum(beside, 1.0)[:, None]
    removed = rows[:, None] * (2.0 * own - told) * told
    gained, whole = _by_recording(recording, removed), _by_recording(recording, total)
    usual = np.median(gained / np.maximum(whole, 1e-300), axis=0)
    shown = sums(place, both / weights[:, None], len(starts)) / rows[:, None]
    low, high = np.quantile(shown[:, 1:], [0.025, 0.975], axis=1)
    curve = (starts + 0.5 * SPAN_S, shown[:, 0], low, high)
    view = _view(DRIFT, curve, gained, whole, len(place), friction)
    # What wanders does so in most recordings; where few show it, the model has lost the machine.
    seen = usual[0] > limit(usual[1:])
    return view if seen else replace(view, share=min(view.share, float(usual[0])))


def moments_view(
    cells: Cells,
    clock: FloatArray,
    sliding: Mask,
    both: FloatArray,
    weights: FloatArray,
    friction: float,
) -> View | None:
    """What lies in windows that hold more than any window of any other surrogate.

    Shares are of windows in which the machine slides throughout, for where it rests or turns round
    the curve of any law misses; None where there are too few of them.

    Parameters
    ----------
    cells : Cells
    clock : numpy.ndarray, shape (n,)
        Session clock of each row, s.
    sliding : numpy.ndarray of bool, shape (n,)
        Rows in which the machine has been sliding one way for some time.
    both : numpy.ndarray, shape (n, 1 + surrogates)
        Weighted residual, then those of the surrogates.
    weights : numpy.ndarray, shape (n,)
    friction : float
        Weighted rms of the friction.
    """
    # What is the same for a second is no moment; nor does a moment change its median.
    place, starts = _windows(cells, clock, SPAN_S)
    order = np.argsort(place, kind="stable")
    within = np.split(both[order], np.flatnonzero(np.diff(place[order])) + 1)
    both = both - np.array([np.median(part, axis=0) for part in within])[place]
    place, starts = _windows(cells, clock, WINDOW_S)
    recording = _of(cells.recording, place, len(starts))
    whole = np.bincount(place, ~sliding, len(starts)) == 0.0
    if np.sum(whole) < FEWEST_WINDOWS:
        return None
    rows = np.bincount(place, minlength=len(starts))
    power = sums(place, both**2, len(starts)) * whole[:, None]
    beyond = np.zeros_like(power)
    for index in np.unique(recording):
        asked = np.flatnonzero(whole & (recording == index))
        if len(asked) < FEWEST_WINDOWS:
            continue
        largest = np.max(power[asked, 1:], axis=0)
        # Each surrogate is held against the others, the residual against all of them.
        others = [np.max(np.delete(largest, j)) for j in range(len(largest))]
        reach = np.array([np.max(largest), *others])
        more = power[asked] - np.mean(power[asked, 1:])
        beyond[asked] = np.where(power[asked] > reach, more, 0.0)
    # What stands out everywhere is no matter of moments.
    beyond *= np.sum(beyond > 0.0, axis=0) < FEW * np.sum(whole)
    few = np.sort(beyond, axis=0)[max(len(beyond) - CHANCES, 0)]
    beyond = np.where(beyond < few, beyond, 0.0)
    physical = sums(place, (both / weights[:, None]) ** 2, len(starts)) / rows[:, None]
    shown = np.sqrt(physical)[whole]
    low, high = np.quantile(shown[:, 1:], [0.025, 0.975], axis=1)
    curve = (starts[whole] + 0.5 * WINDOW_S, shown[:, 0], low, high)
    gained, total = _by_recording(recording, beyond), _by_recording(recording, power)
    return _view(MOMENTS, curve, gained, total, int(np.sum(rows[whole])), friction)


def _view(
    coordinate: Coordinate,
    curve: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    gained: FloatArray,
    whole: FloatArray,
    rows: int,
    friction: float,
) -> View:
    """The view of what is gained of the whole of each recording; shape (k, 1 + surrogates)."""
    if len(gained) >= FEWEST_RECORDINGS:
        # In a recording in which the model has lost the machine anything may come and go.
        best = np.argmax(gained, axis=0), np.arange(gained.shape[1])
        gained[best] = whole[best] = 0.0
    # Recordings may be listed in another order than that of the clock.
    order = np.argsort(curve[0], kind="stable")
    place, middle, low, high = (values[order] for values in curve)
    gain = np.sum(gained, axis=0)
    shares = gain / np.maximum(np.sum(whole, axis=0), 1e-300)
    size = float(np.sqrt(max(gain[0], 0.0) / max(rows, 1))) / max(friction, 1e-300)
    return View(coordinate, place, middle, low, high, float(shares[0]), limit(shares[1:]), size)


def _by_recording(recording: np.ndarray, columns: FloatArray) -> FloatArray:
    """Sums over the windows of each recording; shape (recordings, k)."""
    _, index = np.unique(recording, return_inverse=True)
    return sums(index, columns, int(index[-1]) + 1)


def _windows(cells: Cells, clock: FloatArray, length: float) -> tuple[np.ndarray, FloatArray]:
    """Window of each row, numbered through all recordings, and the clock where each begins."""
    place = np.zeros(len(clock), dtype=np.int64)
    starts: list[FloatArray] = []
    known = 0
    for index in np.unique(cells.recording):
        own = np.flatnonzero(cells.recording == index)
        first = float(clock[own[0]])
        number, local = np.unique(
            np.floor((clock[own] - first) / length + 1e-6), return_inverse=True
        )
        place[own] = known + local
        starts.append(first + number * length)
        known += len(number)
    return place, np.concatenate(starts)


def _of(values: np.ndarray, place: np.ndarray, number: int) -> np.ndarray:
    """What the rows of each window have in common; shape (number,)."""
    common = np.zeros(number, dtype=values.dtype)
    common[place] = values
    return common


def _less_velocity(velocity: FloatArray, both: FloatArray) -> FloatArray:
    """Residuals less their means over stretches of velocity."""
    edges = np.unique(np.quantile(velocity, np.linspace(0.0, 1.0, STRETCHES + 1)[1:-1]))
    index = np.searchsorted(edges, velocity)
    left: FloatArray = both - means(index, both, len(edges) + 1)[index]
    return left
