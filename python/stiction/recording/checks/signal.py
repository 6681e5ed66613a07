"""What the checks ask of one channel."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
import numpy.typing as npt

from ..._support.arrays import FloatArray
from ..motion import count_of
from ..recording import Recording

IntArray = npt.NDArray[np.int64]

SPIKE_TIMES: Final = 15.0
"""A spike's second difference is this many times what 80 % of the rows stay below: white noise
reaches four times that, and a slip or an impact does not come back within one sample.  Up to one
row in twenty may be a spike, each of which disturbs three second differences."""

SPIKE_COUNTS: Final = 12.0
"""And this many sensor counts, for a machine at rest flickers by one."""

_GOALS: Final = ("rad", "m")
"""Units of an input that is a goal."""

BACK_SHARE: Final = 0.25
"""The rows beside a spike agree to this share of its height: it went out and came back."""


def is_goal(recording: Recording) -> bool:
    """Whether the input is a place to go to, and no effort: by its unit, or as a servo's gains."""
    return recording.units.get("input") in _GOALS or "proportional" in recording.settings


def channels_of(recording: Recording) -> Iterator[tuple[str, FloatArray]]:
    """Every channel besides time that holds values only, by name."""
    main = {"input": recording.input, "position": recording.position}
    for name, array in {**main, **recording.channels}.items():
        if array is not None and bool(np.all(np.isfinite(array))):
            yield name, array


def spike_rows(
    values: FloatArray, *, times: float = SPIKE_TIMES, counts: float = SPIKE_COUNTS
) -> IntArray:
    """Rows where a reading leaves its neighbours for one sample.

    Parameters
    ----------
    values : ndarray, shape (rows,)
    times, counts : float
        See ``SPIKE_TIMES`` and ``SPIKE_COUNTS``.

    Returns
    -------
    ndarray of int, shape (spikes,)
    """
    count = count_of(values)
    span = float(np.ptp(np.quantile(values, (0.01, 0.99))))
    # In place, and the rest of it only where it bends: a recording may be half of the memory.
    bend = values[1:-1] - values[:-2]
    bend += values[1:-1] - values[2:]
    np.abs(bend, out=bend)
    usual = float(np.quantile(bend, 0.8))
    rows = np.flatnonzero(bend > max(times * usual, counts * count, 1e-3 * span)) + 1
    out, back = values[rows] - values[rows - 1], values[rows] - values[rows + 1]
    height = np.minimum(np.abs(out), np.abs(back))
    returned = np.abs(out - back) <= BACK_SHARE * height
    return rows[(out * back > 0.0) & returned]


def without_spikes(values: FloatArray) -> FloatArray:
    """The same with each spike replaced by the mean of its neighbours; a copy if there is one."""
    rows = spike_rows(values)
    if not len(rows):
        return values
    mended = values.copy()
    mended[rows] = 0.5 * (values[rows - 1] + values[rows + 1])
    return mended


def runs(mask: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Start and stop of every stretch where ``mask`` holds."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], mask.astype(np.int8), [0]))))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
