"""Smoothing of a measured motion: as far as noise makes it necessary and the motion allows it."""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np

from .trajectory import FloatArray

__all__ = ["adaptively_smoothed"]

WIDEST_S: Final = 0.016
"""Half the width of the widest window, s: what a machine does on the way to a stop takes longer."""
TRUSTED: Final = 2.0
"""Standard deviations by which estimates from narrow and wide windows may differ."""
BLENDED: Final = 9
"""Samples over which one width goes over into the next: a jump would turn the motion round."""
NOISELESS: Final = 1e-9
"""Noise below this share of the range of motion is none."""


def adaptively_smoothed(readings: FloatArray, dt: float, noise: float) -> FloatArray:
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
    from scipy.ndimage import minimum_filter1d, uniform_filter1d

    widest = WIDEST_S / dt
    if noise <= NOISELESS * float(np.ptp(readings)) or widest < 1.0 or len(readings) < BLENDED:
        return readings
    halves = [0]
    while (half := max(1, 2 * halves[-1])) <= min(widest, (len(readings) - 1) // 2):
        halves.append(half)
    if len(halves) == 1:
        return readings
    estimates = np.empty((len(halves), len(readings)))
    low = np.full(len(readings), -np.inf)
    high = np.full(len(readings), np.inf)
    level = np.zeros(len(readings))
    agrees = np.ones(len(readings), dtype=bool)
    edge = halves[-1]
    padded = np.pad(readings, edge, "edge")
    for k, half in enumerate(halves):
        weights, size = _parabola(half)
        reached = padded[edge - half : len(padded) - edge + half]
        estimates[k] = np.convolve(reached, weights, "valid")
        error = TRUSTED * noise * size
        np.maximum(low, estimates[k] - error, out=low)
        np.minimum(high, estimates[k] + error, out=high)
        agrees &= low <= high
        if k > 0:
            level += agrees
    level = uniform_filter1d(minimum_filter1d(level, BLENDED), BLENDED)
    below = np.minimum(level.astype(np.int64), len(halves) - 2)
    share, each = level - below, np.arange(len(readings)) + below * len(readings)
    narrow, wide = estimates.take(each), estimates.take(each + len(readings))
    smoothed: FloatArray = narrow + share * (wide - narrow)
    return smoothed


@cache
def _parabola(half: int) -> tuple[FloatArray, float]:
    """Weights that give the value in the middle of a parabola through 2·half + 1 samples, and their
    2-norm.

    Narrower than three samples it goes through all of them: there is nothing to smooth by.
    """
    if half == 0:
        return np.ones(1), 1.0
    steps = np.arange(-half, half + 1)
    weights: FloatArray = np.linalg.pinv(np.vander(steps, 3, increasing=True))[0]
    return weights, float(np.linalg.norm(weights))
