"""An axis of a chart: its range, how values lie on it, and where its ticks are."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from .._support.arrays import FloatArray
from .._support.numbers import tick, tick_of_ten

__all__ = ["Axis", "around"]

Scaling = Literal["linear", "log", "symlog"]
MARGIN: Final = 0.05
"""Share of an axis that stays free on either side of what is drawn."""
LINEAR_PART: Final = 0.33
"""Decades that the linear part of a symmetric logarithm is as wide as."""
STEPS: Final = (1.0, 2.0, 5.0, 10.0)
LEAST_TICKS: Final = 2


@dataclass(frozen=True)
class Axis:
    """A range of values and how it is drawn.

    Attributes
    ----------
    low, high : float
        Values at its ends; a vertical axis of names has the first one on top.
    label : str
    most : int
        Intervals between ticks, at most.
    scaling : str
        "symlog" is linear up to ``linear_to`` and logarithmic beyond.
    linear_to : float
    names : tuple of str
        Of the places 0, 1, 2 …, in place of ticks.
    written : callable
        A tick as text.
    grid, numbered : bool
        Whether lines, and whether numbers, stand at its ticks.
    """

    low: float
    high: float
    label: str = ""
    most: int = 6
    scaling: Scaling = "linear"
    linear_to: float = 1.0
    names: tuple[str, ...] = ()
    written: Callable[[float], str] | None = None
    grid: bool = True
    numbered: bool = True

    def place(self, values: FloatArray) -> FloatArray:
        """Where values lie: 0 at the low end, 1 at the high one; what is beyond, at the end."""
        ends = self._straight(np.array([self.low, self.high]))
        share = (self._straight(values) - ends[0]) / (ends[1] - ends[0])
        # A value that is none stays none: it is a gap.
        clipped: FloatArray = np.clip(share, 0.0, 1.0)
        return clipped

    def values(self) -> FloatArray:
        """Where its ticks are."""
        at = range(len(self.names)) if self.names else self._round_values()
        return np.array(at, dtype=np.float64)

    def ticks(self) -> list[tuple[float, str]]:
        """Place of each tick from 0 to 1, and its text."""
        at = self.values()
        write = self.written or (tick if self.scaling == "linear" else tick_of_ten)
        texts = self.names or [write(value) for value in at.tolist()]
        return list(zip(self.place(at).tolist(), texts, strict=True))

    def _straight(self, values: FloatArray) -> FloatArray:
        if self.scaling == "linear":
            return values
        if self.scaling == "log":
            return np.log10(np.maximum(values, min(self.low, self.high)))
        share = np.abs(values) / self.linear_to
        beyond = LINEAR_PART + np.log10(np.maximum(share, 1.0))
        return np.sign(values) * np.where(share > 1.0, beyond, LINEAR_PART * share)

    def _round_values(self) -> list[float]:
        low, high = sorted((self.low, self.high))
        if self.scaling == "linear":
            return _multiples(low, high, _step(low, high, self.most))
        least = low if self.scaling == "log" else self.linear_to
        first, last = math.ceil(math.log10(least) - 1e-9), math.floor(math.log10(high) + 1e-9)
        powers = range(first, last + 1, max(-(-(last - first + 1) // max(self.most, 1)), 1))
        zero = [0.0] if low <= 0.0 else []
        if len(powers) > 1 or zero:
            return zero + [10.0**power for power in powers]
        between = [m * 10.0**p for p in range(first - 1, last + 1) for m in STEPS[:3]]
        return [value for value in between if low <= value <= high]


def around(parts: Sequence[FloatArray], axis: Axis) -> Axis:
    """The axis over all that is finite in these values, with a margin."""
    values = np.concatenate([part[np.isfinite(part)] for part in parts])
    if axis.scaling == "log":
        values = values[values > 0.0]
    low, high = (float(values.min()), float(values.max())) if values.size else (0.1, 1.0)
    if axis.scaling == "linear":
        room = MARGIN * (high - low) or MARGIN * abs(high) or 1.0
        return replace(axis, low=low - room, high=high + room)
    if axis.scaling == "log":
        room = (high / low) ** MARGIN if high > low else 10.0
        return replace(axis, low=low / room, high=high * room)
    return replace(axis, low=low - 0.5 * axis.linear_to, high=high * 1.5)


def _step(low: float, high: float, most: int) -> float:
    """The least round step of which at most so many fit, and two ticks where that shows none."""
    raw = max((high - low) / max(most, 1), 1e-300)
    ten = 10.0 ** math.floor(math.log10(raw))
    steps = [step * ten for step in STEPS]
    chosen = next(k for k, step in enumerate(steps) if step >= raw * (1.0 - 1e-9))
    while chosen and len(_multiples(low, high, steps[chosen])) < LEAST_TICKS:
        chosen -= 1
    return steps[chosen]


def _multiples(low: float, high: float, step: float) -> list[float]:
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]
