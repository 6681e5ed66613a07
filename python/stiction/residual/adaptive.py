"""Smoothing of a measured motion: as far as noise makes it necessary and the motion allows it."""

from __future__ import annotations

from typing import Final

import numpy as np

from .. import _native
from .._support.arrays import FloatArray

__all__ = ["smooth_adaptively"]

WIDEST_S: Final = 0.016
"""Half the width of the widest window, s: what a machine does on the way to a stop takes longer."""
FEWEST: Final = 9
"""Samples over which one width goes over into the next: so many there must be."""
NOISELESS: Final = 1e-9
"""Noise below this share of the range of motion is none."""


def smooth_adaptively(readings: FloatArray, dt: float, noise: float) -> FloatArray:
    """Positions behind readings, each from the widest window that noise does not refute.

    Parabolas are fitted to windows of 1, 3, 5, 9, … samples. About every sample the widest one is
    taken whose estimate agrees with those of all narrower ones: near a stop a narrow one, in slow
    motion a wide one. Steps of a sensor, which a friction law takes for stops and starts, go.

    Parameters
    ----------
    readings : numpy.ndarray, shape (n,)
    dt : float
        Sample time, s.
    noise : float
        Standard deviation of the readings, steps included.

    Returns
    -------
    numpy.ndarray, shape (n,)

    Notes
    -----
    Lepski, Theory Probab. Appl. 35 (1990); intersection of intervals after Goldenshluger,
    Nemirovski, Math. Methods Statist. 6 (1997).
    """
    widest = WIDEST_S / dt
    if noise <= NOISELESS * float(np.ptp(readings)) or widest < 1.0 or len(readings) < FEWEST:
        return readings
    halves = [0]
    while (half := max(1, 2 * halves[-1])) <= min(widest, (len(readings) - 1) // 2):
        halves.append(half)
    if len(halves) == 1:
        return readings
    return _native.adaptively_smoothed(readings, noise, halves)
