"""Motion put together from smooth pieces: speeds that a machine can follow."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from .._support.arrays import FloatArray

__all__ = ["LONGEST_S", "MOST_SAMPLES", "Motion", "TooLongError", "cosine_taper"]

LONGEST_S: Final = 1800.0
MOST_SAMPLES: Final = 10_000_000
"""Time and samples of a signal, at most: nobody records half an hour of one experiment."""


class TooLongError(Exception):
    """A machine that hardly moves: the signal would last longer than anybody records."""


class Motion:
    """A reference that starts at 0, as speeds of samples.

    Parameters
    ----------
    dt : float
        Sample time, s.
    acceleration : float
        Greatest one.

    Raises
    ------
    TooLongError
        From what adds to it: all pieces together take more than a signal may.
    """

    def __init__(self, dt: float, acceleration: float) -> None:
        self.dt, self.acceleration = dt, acceleration
        self._speeds: list[FloatArray] = [np.zeros(1)]
        self._left = min(LONGEST_S / dt, MOST_SAMPLES)
        self.at = 0.0

    def rest(self, seconds: float) -> None:
        """Stands still."""
        self._spend(seconds / self.dt)
        self._add(np.zeros(max(1, round(seconds / self.dt))))

    def ramp(self, distance: float, speed: float) -> None:
        """Covers a distance (signed) at constant speed, blended in and out by half cosines."""
        length, speed = abs(distance), min(speed, math.sqrt(self.acceleration * abs(distance)))
        blend = 0.5 * math.pi * speed / self.acceleration
        # A blend covers half of what its time would at full speed, and there are two of them.
        if speed * blend > length:
            speed *= length / (speed * blend)
            blend = 0.5 * math.pi * speed / self.acceleration
        self._spend((blend + length / speed) / self.dt)
        samples = max(2, math.ceil(blend / self.dt))
        middle = max(0, round((length / speed - blend) / self.dt))
        rise = 0.5 - 0.5 * np.cos(math.pi * (np.arange(samples) + 0.5) / samples)
        shape = np.concatenate([rise, np.ones(middle), rise[::-1]])
        # What rounding to samples takes away or adds is taken from the speed.
        self._add(shape * (distance / (float(shape.sum()) * self.dt)))

    def go(self, to: float, speed: float) -> None:
        """Goes to a place."""
        if to != self.at:
            self.ramp(to - self.at, speed)

    def add(self, path: FloatArray) -> None:
        """Appends a path that starts at 0, relative to where it stands; shape (n,)."""
        self._add(np.diff(path, prepend=0.0) / self.dt)

    def _spend(self, samples: float) -> None:
        """Counts samples that a piece is about to take.

        Raises
        ------
        TooLongError
            There are not as many left.
        """
        self._left -= samples
        if not self._left >= 0.0:
            raise TooLongError

    def _add(self, speeds: FloatArray) -> None:
        self._speeds.append(speeds)
        self.at += float(speeds.sum()) * self.dt

    def positions(self) -> FloatArray:
        """The reference, one position a sample."""
        path: FloatArray = np.cumsum(np.concatenate(self._speeds)) * self.dt
        return path


def cosine_taper(samples: int, share: float = 0.1) -> FloatArray:
    """A window that rises and falls by half cosines over a share of its length."""
    edge = max(2, round(share * samples))
    window = np.ones(samples)
    rise = 0.5 - 0.5 * np.cos(math.pi * (np.arange(edge) + 0.5) / edge)
    window[:edge], window[-edge:] = rise, rise[::-1]
    return window
