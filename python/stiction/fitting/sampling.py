"""How a log reads its input: held from its row on, or at some moment before the next one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, TypeVar

import numpy as np

from .._support.arrays import FloatArray
from ..plant import Plant
from ..recording import Recording

__all__ = ["fit_as_read", "reading_words"]

AHEAD: Final = 0.1
"""Samples by which a machine seems to answer its input before that is stamped, from which on the
row does not hold it: no cause comes ahead of its effect. Of 58 sessions with nothing hidden, whose
logs hold it, none came to .05; readings at an instant came to .43 and more in 26 of 32."""
LEFT: Final = 0.02
"""Samples that are left of that once the input is read as it was; with more it is read again."""
MOST_LEFT: Final = 0.1
"""Samples that may be left in the end: with more another thing is the matter."""
FITS: Final = 3
"""Times that an input is read otherwise."""

T = TypeVar("T")


def fit_as_read(
    plant: Plant,
    recordings: Sequence[Recording],
    found: T,
    fit: Callable[[list[Recording]], T],
    offset_of: Callable[[T], float],
) -> tuple[float, list[Recording], T] | None:
    """A fit of an input as it was read, where its rows do not hold it; None elsewhere.

    The offset of timing of a fit shifts the effort alone. The friction of a contact that sticks is
    that effort, and does not follow: what is left looks like a cause. Here the input itself is
    shifted, until a fit has next to no offset of its own.

    Parameters
    ----------
    plant : Plant
    recordings : sequence of Recording
    found : object
        The fit to them, each row holding its input to the next.
    fit : callable
        Fits other recordings.
    offset_of : callable
        By how much the input was taken to be stamped early, s: the offset of a fit.

    Returns
    -------
    (float, list of Recording, object) or None
        By how many samples each row was read ahead, the recordings with what acts on the mean from
        each row to the next, and the fit to them.
    """
    if plant.servo or plant.prescribed_motion:
        return None
    dt = min(each.dt for each in recordings)
    left = offset_of(found) / dt
    if left > -AHEAD:
        return None
    ahead = 0.0
    for _ in range(FITS):
        ahead = min(ahead - left, 1.0)
        read = [_read(each, ahead) for each in recordings]
        again = fit(read)
        left = offset_of(again) / dt
        if abs(left) <= LEFT:
            break
    return (ahead, read, again) if abs(left) <= MOST_LEFT else None


def _read(recording: Recording, ahead: float) -> Recording:
    """A recording with what acts on the mean from each row to the next."""
    values = recording.input
    return recording if values is None else recording.with_input(_mean(values, ahead))


def _mean(values: FloatArray, ahead: float) -> FloatArray:
    after = np.append(values[1:], values[-1])
    return (1.0 - ahead) * values + ahead * after


def reading_words(ahead: float) -> str:
    """What is said of an input that was read so many samples ahead; "" of one that rows hold."""
    if not ahead:
        return ""
    return (
        f"The input acts {ahead:.2g} samples before its rows say so, as one that is read at an "
        "instant does (half a sample) or one of the time before its row (one): it was taken so "
        "much ahead, in a straight line from row to row."
    )
