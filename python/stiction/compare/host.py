"""Drives a law alone, without inertia: by force, or along a motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Final

import numpy as np

from .._native import FrictionModel
from .._support.arrays import FloatArray

__all__ = ["Host"]

_FORCE: Final = 1e-12
"""Share of the level to which a force is met."""
_EVALUATIONS: Final = 200
_FASTEST: Final = 1e5
"""Greatest velocity that is tried, rad/s or m/s; the core refuses ten times as much."""


class Host:
    """A contact with a damper beside it and no inertia, so that any law can be driven by force.

    c·v + F = u is solved for the velocity of every sample. The damper is so weak that a spring of
    the contact follows a force within microseconds, and what the contact does before it slides
    does not show it; it only keeps a contact that slides from running away.

    Parameters
    ----------
    law : FrictionModel
        Driven from its present state, which changes.
    level : float
        Force that the accuracy goes by, N·m or N.
    damping : float
        c, N·m·s/rad or N·s/m.
    """

    def __init__(self, law: FrictionModel, level: float, damping: float) -> None:
        self.law = law
        self.position = 0.0
        self._damping = damping
        self._velocity = 0.0
        self._tolerance = _FORCE * level

    def push(self, efforts: Iterable[float], dt: float) -> FloatArray:
        """Apply one force a sample; the positions at the ends of the samples."""
        positions = []
        for effort in efforts:
            self._velocity = self._balance(float(effort), dt)
            self.law.commit()
            self.position += self._velocity * dt
            positions.append(self.position)
        return np.array(positions)

    def ramp(self, start: float, end: float, duration: float, samples: int) -> FloatArray:
        """Raise or lower the force evenly; the positions at the ends of the samples."""
        efforts = start + (end - start) * np.arange(1, samples + 1) / samples
        return self.push(efforts.tolist(), duration / samples)

    def hold(self, effort: float, duration: float, samples: int) -> FloatArray:
        """Hold a force; the positions at the ends of the samples."""
        return self.push([effort] * samples, duration / samples)

    def _balance(self, effort: float, dt: float) -> float:
        """The velocity at which the contact and the damper take up the force; the last trial."""

        def excess(velocity: float) -> float:
            return trial(velocity, dt, effort=effort)[0] + damping * velocity - effort

        trial, damping, tolerance = self.law.trial, self._damping, self._tolerance
        at_rest = excess(0.0)
        if abs(at_rest) <= tolerance:
            return 0.0
        side = -math.copysign(1.0, at_rest)
        # Newton's method from the last velocity, where that goes somewhere.
        velocity = self._velocity if self._velocity * side > 0.0 else 0.0
        low, high = 0.0, math.inf
        for _ in range(8):
            if velocity == 0.0:
                slope = trial(side * 1e-12, dt, effort=effort)[1] + damping
                error = at_rest
            else:
                force, slope = trial(velocity, dt, effort=effort)
                slope += damping
                error = force + damping * velocity - effort
            if abs(error) <= tolerance and velocity != 0.0:
                return velocity
            if error * side < 0.0:
                low = max(low, side * velocity)
            else:
                high = min(high, side * velocity)
            if not (slope > 0.0 and math.isfinite(slope)):
                break
            velocity -= error / slope
            if not (low < side * velocity < min(high, _FASTEST)):
                break
        return self._bisected(excess, side, low, high, tolerance)

    @staticmethod
    def _bisected(
        excess: Callable[[float], float], side: float, low: float, high: float, tolerance: float
    ) -> float:
        """Between a velocity that is too low and one that is too high, over many decades."""
        if math.isinf(high):
            high = max(4.0 * low, 1e-9)
            while side * excess(side * high) < 0.0 and high < _FASTEST:
                low, high = high, 4.0 * high
        middle = high
        for _ in range(_EVALUATIONS):
            if low == 0.0:
                middle = 1e-3 * high
                if middle < 1e-300:
                    break
            else:
                wide = high > 4.0 * low
                middle = math.sqrt(low * high) if wide else 0.5 * (low + high)
            error = excess(side * middle)
            if abs(error) <= tolerance or not low < middle < high:
                return side * middle
            if side * error < 0.0:
                low = middle
            else:
                high = middle
        return side * middle
