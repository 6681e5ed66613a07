"""Motion from a measured position: smoothing without a numerical derivative."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from ..errors import InputError

__all__ = [
    "GAUSSIAN",
    "Kernel",
    "count_of",
    "evenly",
    "hold_at_rest",
    "narrowest",
    "noise_of",
    "smooth",
    "stirs",
    "zero_order_hold",
]

GAUSSIAN: Final = 1.4826
"""Standard deviation over the median magnitude of a normal distribution."""
WIDEST: Final = 1e6
"""Samples; a wider kernel is a slip of the units."""
SUPPORTS_S: Final = (0.030, 0.300)
"""Narrowest and widest kernel that is chosen; 28 to 50 ms suit machines sampled at 1 kHz."""
FEWEST_SAMPLES: Final = 8
"""Fewer samples than this do not average anything."""
ALIKE: Final = 1e-3
"""Share of a step within which stamps of a timer are even, but for the digits of a number."""
NOT_CHANCE: Final = 5.0
"""Standard errors by which readings of a machine at rest do not differ from white noise."""
CROWDED: Final = 4
"""Results under one kernel from which on they are made at every sample, which takes no longer."""
STILL: Final = 20
"""Samples for which a reading that has noise does not stay the same to the last digit."""


class Kernel:
    """B-spline kernel of order 4 with its exact second difference.

    The same kernel goes over input, inertia term and friction, so that what it removes it removes
    from all of them: no derivative of a measured signal is ever formed. (Weak form: the inertia
    term is the position times the second difference of the kernel.)

    Parameters
    ----------
    support : float
        Full width in s.
    dt : float
        Sample time in s.

    Attributes
    ----------
    weights : numpy.ndarray, shape (samples,)
        Sum 1; an odd number of samples.

    Raises
    ------
    InputError
        A support below one sample, or not finite.
    """

    def __init__(self, support: float, dt: float) -> None:
        if not (math.isfinite(support) and dt <= support <= WIDEST * dt):
            raise InputError(
                f"support = {support:g} s is out of bounds: allowed is {dt:g} s (one sample) to "
                f"{WIDEST * dt:g} s"
            )
        # Four box filters convolved make the cubic B-spline. Their lengths are as equal as an
        # odd number of samples allows, so that the kernel has a centre and the width asked for.
        samples = 2 * ((round(support / dt) - 1) // 2) + 1
        weights = np.ones(1)
        for k in range(4):
            length = (samples + 3 + k) // 4
            weights = np.convolve(weights, np.ones(length) / length)
        self.weights: FloatArray = weights
        self.dt = dt
        self.support = len(weights) * dt
        self._second = np.convolve(weights, [1.0, -2.0, 1.0]) / dt**2

    @property
    def roughness(self) -> float:
        """2-norm of the second difference: what it makes of white noise of size 1."""
        return float(np.linalg.norm(self._second))

    @property
    def second(self) -> FloatArray:
        """Weights of the second difference, in the order of the samples; shape (2·half + 1,)."""
        return self._second[::-1].copy()

    @property
    def half(self) -> int:
        """Samples that a result has on either side of its centre, second difference included."""
        return len(self.weights) // 2 + 1

    def mean(self, values: FloatArray, *, every: int = 1) -> FloatArray:
        """Weighted mean about samples that have the support; shape (…, n − 2·half) for all of them.

        ``values`` has the shape (…, n); ``every`` is the spacing of the results in samples.
        """
        if every == 1 and values.ndim == 1:
            return np.convolve(values, self.weights, "valid")[1:-1]
        windows = np.lib.stride_tricks.sliding_window_view(values, len(self.weights), axis=-1)
        mean: FloatArray = windows[..., 1:-1:every, :] @ self.weights[::-1]
        return mean

    def second_derivative(self, values: FloatArray, *, every: int = 1) -> FloatArray:
        """Second difference of the weighted mean over dt²; aligned and spaced as ``mean``."""
        if len(self._second) > CROWDED * every:
            return np.convolve(values, self._second, "valid")[::every]
        windows = np.lib.stride_tricks.sliding_window_view(values, len(self._second))
        bent: FloatArray = windows[::every] @ self._second[::-1]
        return bent


def narrowest(dt: float, quiet: Callable[[Kernel], bool]) -> Kernel:
    """The narrowest kernel that is quiet enough, or the widest allowed."""
    support, widest = max(SUPPORTS_S[0], FEWEST_SAMPLES * dt), SUPPORTS_S[1]
    while True:
        kernel = Kernel(support, dt)
        if support >= widest or quiet(kernel):
            return kernel
        support = min(1.25 * support, widest)


def smooth(values: FloatArray, dt: float, support: float, *, drifts: bool = False) -> FloatArray:
    """Weighted mean over a short support; the ends are continued, so the length stays.

    They go on as they are, or, if the values drift, as they have come.
    """
    weights = Kernel(support, dt).weights
    half = len(weights) // 2
    if drifts and half < len(values):
        return np.convolve(np.pad(values, half, "reflect", reflect_type="odd"), weights, "valid")
    return np.convolve(np.pad(values, half, "edge"), weights, "valid")


def noise_of(position: FloatArray, count: float | None = None) -> float:
    """Size of the white noise on a position: what its third differences hold.

    A motion that a machine can make hardly shows there: jerk·dt³ is far below a count. Readings
    without counts that repeat to the last digit while the machine rests have no noise; what their
    third differences hold are the jumps of its acceleration. ``count`` is their step where it is
    known: positions between readings, on even stamps, do not show it any more.
    """
    moved = np.flatnonzero(np.diff(position))
    rests = len(moved) > 1 and np.max(np.diff(moved)) > STILL
    if rests and (count_of(position) if count is None else count) == 0.0:
        return 0.0
    third = np.diff(position, 3)
    return float(np.sqrt(np.mean(third**2) / 20.0)) if len(third) else 0.0


def stirs(readings: FloatArray) -> bool:
    """Whether readings hold more than white noise: those of a motion hang on the ones before.

    Of white ones the mean square of their steps is twice their variance, within 1/√n of itself (von
    Neumann, Ann. Math. Stat. 12, 1941, 367-395).
    """
    about = readings - np.mean(readings)
    steps = np.diff(readings)
    white = 2.0 * float(about @ about)
    return abs(float(steps @ steps) - white) > NOT_CHANCE / math.sqrt(len(readings)) * white


def count_of(position: FloatArray) -> float:
    """Size of the steps that the readings are made of, 0 where they have no common step."""
    scale = float(np.max(np.abs(position), initial=0.0))
    steps = np.diff(position)
    np.abs(steps, out=steps)
    steps = steps[steps > 1e-12 * max(scale, 1e-300)]
    if len(steps) == 0:
        return 0.0
    count = float(np.min(steps))
    # Steps above some tens of counts fit anything: only the small ones tell.
    steps /= count
    whole = steps[steps < 20.0]
    fits = np.abs(whole - np.round(whole)) < 0.02 * np.maximum(1.0, np.minimum(whole, 10.0))
    return count if len(whole) > 20 and fits.mean() > 0.95 else 0.0


def hold_at_rest(
    values: FloatArray, readings: FloatArray, window: int, width: float, *, to_and_fro: bool = False
) -> FloatArray:
    """Values that stay as they are as long as readings rest; same shape.

    Readings rest where they keep within ``width`` over ``window`` samples, with ``to_and_fro``
    where they go both ways in it. Noise at a stop exceeds what it reached before, ever more seldom:
    each time a follower with a backlash moves a little, and dry friction would take that for a
    machine that still slides.
    """
    if len(readings) <= window:
        return values
    highest, lowest = (_over(readings, window + 1, pick) for pick in (np.maximum, np.minimum))
    still = highest - lowest < width
    if to_and_fro:
        steps = np.diff(readings)
        still &= (_over(steps, window, np.maximum) > 0.0) & (_over(steps, window, np.minimum) < 0.0)
    # A sample rests if any window in which it lies does.
    resting = np.convolve(still, np.ones(window)) > 0.5
    since = np.where(np.concatenate([[True], ~resting]), np.arange(len(values)), 0)
    kept: FloatArray = values[np.maximum.accumulate(since)]
    return kept


def _over(values: FloatArray, size: int, pick: np.ufunc) -> FloatArray:
    """The greatest or least of each ``size`` neighbours, by halves; shape (n − size + 1,)."""
    found, done = values, 1
    while 2 * done <= size:
        found, done = pick(found[:-done], found[done:]), 2 * done
    if rest := size - done:
        found = pick(found[:-rest], found[rest:])
    return found


def evenly(time: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Stamps as they were meant, even ones over the same span at the usual step, and that step.

    Steps of 5 and 6 ms are those of a timer of 190 Hz if no stamp is further from an even one than
    rounding to 1 ms takes it; rows that are missing change nothing. Taken to the letter such stamps
    would make the input late by a part of a sample, now here, now there. Others stay as they are.

    The step divides the span exactly: a step wrong by 1e-5 is half a sample late after a minute.
    """
    span, steps = float(time[-1] - time[0]), np.diff(time)
    usual = float(np.median(steps))
    for _ in range(2):
        taken = np.maximum(np.round(steps / usual), 1.0)
        usual = span / float(np.sum(taken))
    place = np.concatenate([[0.0], np.cumsum(taken)])
    slope, first = np.polyfit(place, time - time[0], 1)
    timer = first + slope * place
    beside = float(np.ptp((time - time[0]) - timer))
    # What all stamps are multiples of shows in the differences of their steps.
    known = np.unique(np.round(steps[taken == 1.0] / (ALIKE * usual)))
    rounding = float(np.min(np.diff(known))) * ALIKE * usual if len(known) > 1 else 0.0
    if beside <= rounding + ALIKE * usual:
        even = np.linspace(time[0] + timer[0], time[0] + timer[-1], int(place[-1]) + 1)
        # To the last digit: a reading between two that differ by its count is no reading.
        return even[place.astype(np.int64)], even, float(timer[-1] - timer[0]) / place[-1]
    count = max(1, round(span / float(np.median(steps))))
    return time, np.linspace(time[0], time[-1], count + 1), span / count


def zero_order_hold(stamps: FloatArray, time: FloatArray, values: FloatArray) -> FloatArray:
    """Values at ``stamps`` of a signal that holds from each of ``time`` to the next."""
    # A stamp that falls short of a sample by a little jitter belongs to it: taken to the letter,
    # half of an even recording would be one sample late.
    tolerance = 0.1 * float(np.median(np.diff(time)))
    index = np.searchsorted(time, stamps + tolerance, side="right") - 1
    return values[np.clip(index, 0, len(values) - 1)]
