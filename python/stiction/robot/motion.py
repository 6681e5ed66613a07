"""Velocities and accelerations of all joints of a recording, through one low pass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from ..recording import Recording
from ..recording.motion import evenly, noise_of

__all__ = ["JointMotion", "motion_of"]

ORDER: Final = 4
"""Of the Butterworth low pass, which runs forward and backward: no delay."""
SHARE: Final = 0.05
"""Of the acceleration that may be noise of the readings."""
CUTOFFS: Final = tuple(float(f) for f in np.geomspace(20.0, 2.0, 14))
"""Hz, tried from the widest: a joint of an arm moves at few hertz, its structure at tens."""
NYQUIST_SHARE: Final = 0.4
"""Of the rate of the rows that a cutoff may have."""
ENDS: Final = 2.0
"""Periods of the cutoff at either end of a recording in which the low pass knows but one side."""
PER_CUTOFF: Final = 5.0
"""Rows that are kept a period of the cutoff: fewer would fold what it lets pass."""


@dataclass(frozen=True)
class JointMotion:
    """The motion of all joints on even stamps.

    Attributes
    ----------
    time : numpy.ndarray, shape (n,)
        s; ``stamps``, where the readings were taken, shape (rows,), lie between them.
    position, velocity, acceleration : numpy.ndarray, shape (n, joints)
    input : numpy.ndarray, shape (n, joints)
        As read.
    cutoff : float
        Of the low pass, Hz.
    """

    time: FloatArray
    stamps: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    input: FloatArray
    cutoff: float

    @property
    def dt(self) -> float:
        """Time step, s."""
        return float(self.time[1] - self.time[0])

    @property
    def every(self) -> int:
        """Samples from one row that is kept to the next."""
        return max(1, int(1.0 / (PER_CUTOFF * self.cutoff * self.dt)))

    @property
    def ends(self) -> int:
        """Samples at either end that tell no acceleration."""
        return min(int(ENDS / (self.cutoff * self.dt)) + 1, len(self.time) // 4)

    def filter(self, values: FloatArray) -> FloatArray:
        """Values through the low pass along the first axis, and those that are kept of them."""
        return low_pass(values, self.cutoff, self.dt)[:: self.every]


def motion_of(joints: Sequence[Recording]) -> JointMotion:
    """The motion of an arm.

    Parameters
    ----------
    joints : sequence of Recording
        One for each joint, over the same clock.
    """
    stamps, time, dt = evenly(joints[0].time)

    def onto(values: FloatArray | None) -> FloatArray:
        return np.interp(time, stamps, np.zeros(len(stamps)) if values is None else values)

    read = np.stack([onto(one.position) for one in joints], axis=1)
    driven = np.stack([onto(one.input) for one in joints], axis=1)
    cutoff = _cutoff(read, dt)
    position = low_pass(read, cutoff, dt)
    velocity = np.gradient(position, dt, axis=0)
    acceleration = np.gradient(velocity, dt, axis=0)
    return JointMotion(time, stamps, position, velocity, acceleration, driven, cutoff)


def low_pass(values: FloatArray, cutoff: float, dt: float) -> FloatArray:
    """Values through the low pass, forward and backward, along the first axis."""
    from scipy.signal import butter, sosfiltfilt

    sections = butter(ORDER, cutoff, fs=1.0 / dt, output="sos")
    found: FloatArray = sosfiltfilt(
        sections, values, axis=0, padlen=min(len(values) - 1, int(3.0 / (cutoff * dt)))
    )
    return found


def _cutoff(read: FloatArray, dt: float) -> float:
    """The widest at which the acceleration of each joint that moves stands above its noise."""
    possible = [f for f in CUTOFFS if f <= NYQUIST_SHARE / dt] or [NYQUIST_SHARE / dt / 2.0]
    noise = np.array([noise_of(column) for column in read.T])
    for cutoff in possible:
        moved = low_pass(read, cutoff, dt)
        second = np.diff(moved, 2, axis=0) / dt**2
        size = np.sqrt(np.mean(second**2, axis=0))
        # White noise up to the cutoff, twice differentiated.
        left = noise * (2.0 * np.pi * cutoff) ** 2 * np.sqrt(2.0 * cutoff * dt / 5.0)
        moves = np.ptp(moved, axis=0) > 20.0 * noise
        if np.all(left[moves] <= SHARE * size[moves]):
            return cutoff
    return possible[-1]
