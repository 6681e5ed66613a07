"""Checks of the clock: jitter, gaps, changes of rate, and whether it is fast enough."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.wording import plural
from ..recording import Recording
from .finding import Check

LOST: Final = 1.8
"""Times the usual step from which on a step is a gap: one lost sample doubles it."""
EVEN: Final = 1e-6
"""Steps that differ by less than this share of themselves are equal but for rounding."""
COUNTED_IN_MS: Final = 0.1
"""A step, s, that is rather one of a clock that counts milliseconds."""


def jitter(
    recording: Recording, *, share: float = 0.01, single: float = 0.05, lost: float = 1.8
) -> Check:
    """How even the time steps are, gaps left out.

    Parameters
    ----------
    recording : Recording
    share : float
        Standard deviation of the step over the usual step that is noted: the rows are laid on an
        even grid, and a clock uneven by more than 1 % blurs fast motion visibly.
    single : float
        Deviation of one step that is noted: 0.05 ms at 1 kHz already reads as a delay.
    lost : float
        As for `gaps`.
    """
    steps = np.diff(recording.time)
    ratio = steps / usual_steps(steps)
    ratio = ratio[ratio < lost]
    spread = float(np.std(ratio))
    worst = float(np.max(np.abs(ratio - 1.0)))
    what = (
        f"the time steps scatter by {100 * spread:.2g} % about {recording.dt:.4g} s, and the worst "
        f"is off by {100 * worst:.2g} %"
    )
    if spread <= share and worst <= single:
        return Check("clock jitter", "fine", what)
    return Check(
        "clock jitter",
        "note",
        what,
        "fast motion is blurred, and a delay or a lag of the drive shorter than the scatter "
        "cannot be told",
        "stamp rows where they are sampled, not where they are written, or sample from a timer",
    )


def gaps(recording: Recording, *, lost: float = LOST, share: float = 0.05) -> Check:
    """Samples that are missing between two rows.

    Parameters
    ----------
    recording : Recording
    lost : float
        A step this many times the usual one is a gap: one lost sample doubles the step.
    share : float
        More than this share of the time missing is a fault, as for missing cells.
    """
    steps = np.diff(recording.time)
    usual = usual_steps(steps)
    wide = steps > lost * usual
    number = int(wide.sum())
    if not number:
        return Check("gaps", "fine", "no sample is missing between rows")
    missing = float(np.sum(steps[wide] - usual[wide]))
    at = float(recording.time[int(np.argmax(steps * wide))])
    what = (
        f"{plural(number, 'gap')} of together {missing:.3g} s, the longest of "
        f"{float(steps[wide].max()):.3g} s at {at:.6g} s"
    )
    if missing > share * recording.duration:
        return Check(
            "gaps",
            "fault",
            what,
            "more of the motion is missing than can be bridged",
            "record again with a logger that keeps up, or split the file at its gaps",
        )
    return Check(
        "gaps",
        "note",
        what,
        "the motion across a gap is a straight line that never was; rows that see a long one are "
        "not fitted",
        "record again with a logger that keeps up where it matters what happened there",
    )


def rate(recording: Recording, *, times: float = 1.5) -> Check:
    """Whether the rate stays the same.

    Parameters
    ----------
    recording : Recording
    times : float
        The longest usual step over the shortest that is noted; less than that is jitter.
    """
    usual = usual_steps(np.diff(recording.time), 101)
    low, high = float(usual.min()), float(usual.max())
    if high <= times * low:
        return Check("sampling rate", "fine", f"one row every {recording.dt:.4g} s throughout")
    return Check(
        "sampling rate",
        "note",
        f"the usual step changes between {low:.4g} s and {high:.4g} s",
        "the slow stretches tell less of fast motion, and weigh less by their rows",
        "record at one rate, or make a recording of each stretch",
    )


def sampling(recording: Recording, *, kernel_s: float = 0.050, fewest: int = 8) -> Check:
    """Whether the rows are close enough for the kernel that residuals are formed with.

    Parameters
    ----------
    recording : Recording
    kernel_s : float
        Widest kernel that does not smooth friction itself away, s.
    fewest : int
        Rows under a kernel; fewer do not average anything.
    """
    needed = fewest * recording.dt
    what = f"{fewest} rows, the fewest under a kernel, last {1e3 * needed:.3g} ms"
    if needed <= kernel_s:
        return Check("sampling speed", "fine", what)
    remedy = f"sample every {1e3 * kernel_s / fewest:.2g} ms or faster"
    if recording.dt >= COUNTED_IN_MS:
        remedy = f'state the unit of the time if it is not in s (unit = "ms"); else {remedy}'
    return Check(
        "sampling speed",
        "note",
        what,
        f"the kernel is wider than {1e3 * kernel_s:.3g} ms, so pre-sliding, delays and what "
        "happens at a reversal are smoothed",
        remedy,
    )


def usual_steps(steps: FloatArray, width: int = 21) -> FloatArray:
    """Running median of the time steps; shape (n,) as these."""
    middle = float(np.median(steps))
    if float(np.ptp(steps)) <= EVEN * middle:
        # An even clock has one median, and most clocks are even.
        return np.full(len(steps), middle)
    from scipy.ndimage import median_filter

    filtered: FloatArray = median_filter(steps, size=min(width, len(steps)), mode="reflect")
    return filtered
