"""What is another one in each recording: an inertia where a payload was changed, a gain.

Such a machine lacks no effect: every recording by itself is explained, and no plant explains all of
them. What is left goes with the acceleration or the effort, and with another slope each time.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..data.evidence import Cells
from .coordinates import Coordinate
from .view import View, limit, sums

__all__ = ["BY_RECORDING", "GAIN", "INERTIA", "by_recording_view"]

INERTIA: Final = Coordinate(
    "acceleration, recording by recording",
    "number of the recording, 1",
    False,
    lambda look: look.acceleration,
    descriptive=True,
)
GAIN: Final = Coordinate(
    "effort, recording by recording",
    "number of the recording, 1",
    False,
    lambda look: look.effort,
    descriptive=True,
)
BY_RECORDING: Final = (INERTIA, GAIN)
"""Their values are what the residual grows with. What is left is not judged by them: the curve of
any law misses in another way in another kind of recording. They tell what it goes with."""
LITTLE: Final = 0.1
"""A half that holds less of the power than this share of the other one tells it little."""
FEWEST: Final = 4
"""Recordings from which on the one that shows most is not counted."""


def by_recording_view(
    coordinate: Coordinate,
    cells: Cells,
    values: FloatArray,
    both: FloatArray,
    weights: FloatArray,
    friction: float,
) -> View | None:
    """What odd blocks of a recording tell of its even ones by its own slope, and these of those.

    That is a share of all that is left, beyond the slope that all recordings have in common.

    Parameters
    ----------
    coordinate : Coordinate
    cells : Cells
    values : numpy.ndarray, shape (n,)
        Of the coordinate.
    both : numpy.ndarray, shape (n, 1 + surrogates)
        Weighted residual, then those of the surrogates.
    weights : numpy.ndarray, shape (n,)
    friction : float
        Weighted rms of the friction.

    Returns
    -------
    View or None
        Its places are numbers of recordings, its curve is what their slopes make of the rms of the
        coordinate. None for a single recording, and where the coordinate is 0.
    """
    recordings, place = np.unique(cells.recording, return_inverse=True)
    if len(recordings) < 2:
        return None
    half = 2 * place + cells.block % 2
    number = 2 * len(recordings)
    grows = values * weights
    whole = np.maximum(np.sum(both**2, axis=0), 1e-300)
    # What most recordings have in common is no matter of single ones, nor does one of them move it.
    power = np.bincount(place, grows**2)
    asked = power > LITTLE * np.median(power)
    if not np.any(asked):
        return None
    slopes = sums(place, both * grows[:, None], len(recordings))[asked] / power[asked, None]
    both = both - grows[:, None] * np.median(slopes, axis=0)
    square = np.bincount(half, grows**2, number)[:, None]
    product = sums(half, both * grows[:, None], number)
    # Each half is told by the other one.
    other = np.arange(number) ^ 1
    slope = product[other] / np.maximum(square[other] + LITTLE * square, 1e-300)
    removed = (
        (2.0 * slope * product - slope**2 * square).reshape(len(recordings), 2, -1).sum(axis=1)
    )
    if len(recordings) >= FEWEST:
        best = np.argmax(removed, axis=0), np.arange(removed.shape[1])
        removed[best] = 0.0
    gain = removed.sum(axis=0)
    shares = gain / whole
    own = power[:, None]
    usual = np.sqrt(np.bincount(place, values**2) / np.bincount(place))[:, None]
    shown = sums(place, both * grows[:, None], len(recordings)) / np.maximum(own, 1e-300) * usual
    low, high = np.quantile(shown[:, 1:], [0.025, 0.975], axis=1)
    size = float(np.sqrt(max(gain[0], 0.0) / len(values))) / max(friction, 1e-300)
    numbers = 1.0 + recordings
    return View(
        coordinate, numbers, shown[:, 0], low, high, float(shares[0]), limit(shares[1:]), size
    )
