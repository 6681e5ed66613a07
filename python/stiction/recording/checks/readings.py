"""Checks of the readings: missing, constant, spikes, repeats, stuck, clipped, saturated, stale."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.wording import plural
from ..motion import count_of
from ..recording import Recording
from .finding import Check
from .signal import (
    SPIKE_COUNTS,
    SPIKE_TIMES,
    channels_of,
    is_goal,
    runs,
    spike_rows,
    without_spikes,
)

_MEASURED: Final = ("position", "velocity", "effort")
_BOUNDED: Final = ("position", "effort")
_NEEDED: Final = ("input", "position", "effort")
_REST: Final = 5
"""Rows; shorter ones are repeated readings."""


def missing_cells(recording: Recording) -> list[Check]:
    """Cells that were filled in on reading, and channels where too many are missing."""
    found = [
        Check(
            "missing cells",
            "fault",
            fault.partition(";")[0],
            "more is missing than can be filled from the neighbours",
            "record it again, or leave the channel out if it is optional",
        )
        for fault in recording.faults
    ]
    found += [
        Check(
            "missing cells",
            "note",
            repair.sentence,
            "these values are interpolated, few enough to do no harm",
            "look for the cause in the logger if there are many",
        )
        for repair in recording.quality
    ]
    return found or [Check("missing cells", "fine", "no cell and no stamp is missing")]


def stress(recording: Recording) -> list[Check]:
    """A note where what was measured is a stress and no force."""
    if recording.units.get("effort") != "Pa":
        return []
    return [
        Check(
            "unit of the effort",
            "note",
            "the effort is a stress, in Pa",
            "friction is told in Pa, and what multiplies a speed in Pa·s/m, where others have N",
            "multiply the stress by the area where forces are wanted",
        )
    ]


def constant(recording: Recording) -> list[Check]:
    """Channels that never change."""
    found = []
    for name, values in channels_of(recording):
        if np.ptp(values) > 0.0:
            continue
        if name == "enabled" and values[0] != 0.0:
            # A drive that is on throughout is the ordinary case.
            continue
        what = f"{name} is {values[0]:.6g} in every row"
        if name == "input" and values[0] == 0.0:
            means = "the machine was left to itself: friction shows, the gain of the drive does not"
            found.append(
                Check("constant channel", "note", what, means, "add a recording that is driven")
            )
        elif name in _NEEDED:
            means = "nothing can be learnt from a channel that does not change"
            remedy = f"check which column is {name}, and that it was connected and logged"
            if name == "position":
                # Below break-away a contact without a spring does not yield by a single count.
                remedy = f"unless it was held below break-away, {remedy}"
            found.append(Check("constant channel", "fault", what, means, remedy))
        else:
            means = "it tells nothing, and what depends on it cannot be tested"
            found.append(Check("constant channel", "note", what, means, "vary it, or leave it out"))
    return found or [Check("constant channel", "fine", "every channel changes")]


def spikes(
    recording: Recording,
    *,
    times: float = SPIKE_TIMES,
    counts: float = SPIKE_COUNTS,
    share: float = 0.05,
) -> list[Check]:
    """Measured readings that leave their neighbours for a single sample.

    Parameters
    ----------
    recording : Recording
    times, counts : float
        Least height; see ``SPIKE_TIMES`` and ``SPIKE_COUNTS`` in ``signal``.
    share : float
        More than this share of the rows is a fault, as for missing cells.
    """
    found = []
    for name, values in channels_of(recording):
        if name not in _MEASURED:
            continue
        rows = spike_rows(values, times=times, counts=counts)
        if not len(rows):
            continue
        at = recording.time[rows[0]]
        what = (
            f"{name} leaves its neighbours for one sample {plural(len(rows), 'time')}, "
            f"first at {at:.6g} s to {values[rows[0]]:.4g}"
        )
        means = "a reading failed: no machine goes there and back within one sample"
        remedy = "check the sensor's bus"
        if name in _BOUNDED:
            means += "; fits and diagnoses take the mean of its neighbours"
        else:
            remedy = f"replace the readings by the mean of their neighbours, and {remedy}"
        fault = len(rows) > share * len(values)
        found.append(Check("spikes", "fault" if fault else "note", what, means, remedy))
    return found or [Check("spikes", "fine", "no reading leaves its neighbours for one sample")]


def repeats(
    recording: Recording, *, share: float = 0.02, fewest: int = 5, longest: int = 5
) -> Check:
    """Position readings that repeat while the machine moves.

    Parameters
    ----------
    recording : Recording
    share : float
        Share of the moving rows that is noted; less is the logger's odd slip.
    fewest : int
        Repeats that are noted, for a share of few moving rows says little.
    longest : int
        Longer repeats are a machine that stopped, or a sensor that is stuck.
    """
    name = "repeated readings"
    if recording.position is None or not np.all(np.isfinite(recording.position)):
        return Check(name, "fine", "there is no position to look at")
    steps = np.diff(without_spikes(recording.position))
    size = np.abs(steps)
    least = max(5.0 * count_of(recording.position), 0.25 * float(np.sqrt(np.mean(size**2))))
    fast = np.flatnonzero(size)
    before, after = fast[:-1], fast[1:]
    apart = after - before
    held = (apart > 1) & (apart <= longest) & (size[before] > least) & (size[after] > least)
    held &= steps[before] * steps[after] > 0.0
    number = int(np.sum(apart[held] - 1))
    moving = int(np.sum(size > least)) + number
    if number < fewest or number <= share * moving:
        return Check(name, "fine", f"{plural(number, 'reading')} of position repeated in motion")
    return Check(
        name,
        "note",
        f"{number} of {moving} position readings in motion repeat the one before",
        "the position is refreshed more slowly than the rows are written, so speed comes in jerks",
        "write a row when the sensor is read, or keep only the rows with a fresh reading",
    )


def stuck_channels(
    recording: Recording,
    *,
    fewest: int = 5,
    jump: float = 3.0,
    at_end: int = 20,
    share: float = 0.05,
) -> list[Check]:
    """Measured channels that freeze while the machine goes on.

    A machine that sticks leaves its place from rest; a sensor that was stuck jumps to where the
    machine is by then, or stops dead from full speed and never changes again.

    Parameters
    ----------
    recording : Recording
    fewest : int
        Rows of a freeze; shorter ones are repeated readings.
    jump : float
        The jump at its end over the step that 99 % of the others stay below.
    at_end : int
        Rows of a freeze that lasts to the end of the recording.
    share : float
        More than this share of the rows is a fault, as for missing cells.
    """
    found = []
    for name, values in channels_of(recording):
        if name not in _BOUNDED or np.ptp(values) == 0.0:
            continue
        frozen, first = _frozen(without_spikes(values), fewest, jump, at_end)
        if not frozen:
            continue
        what = (
            f"{name} does not change over {plural(frozen, 'row')} and then jumps, or stops "
            f"dead, first at {recording.time[first]:.6g} s"
        )
        fault = frozen > share * len(values)
        means = "the sensor or its link was stuck while the machine went on"
        remedy = "check sensor and link, and record again, or cut these rows out"
        found.append(Check("stuck channel", "fault" if fault else "note", what, means, remedy))
    found += _held_against_efforts(recording, share)
    return found or [Check("stuck channel", "fine", "no channel freezes in motion")]


def _held_against_efforts(
    recording: Recording,
    share: float,
    *,
    fewest: int = 50,
    swing: float = 0.5,
    pushed: float = 0.1,
    moves: float = 0.98,
    stronger: float = 1.3,
) -> list[Check]:
    """A position that stays to the last digit under efforts that move the machine elsewhere.

    Efforts within a freeze go there, back and there again over a good part of their whole range,
    are stronger than any under which the position rests elsewhere, and as strong ones are hardly
    ever without motion. What holds a machine is steady; one that sticks while the effort turns
    round leaves when that has gone over once.

    Parameters
    ----------
    recording : Recording
    share : float
        More than this share of the rows is a fault.
    fewest : int
        Rows of a freeze, and of those elsewhere that are pushed as strongly.
    swing : float
        Least range of the effort within a freeze over its whole range.
    pushed : float
        Share of a freeze's rows under the efforts that are compared: the strongest ones.
    moves : float
        Share of such rows elsewhere that must move.
    stronger : float
        By how much efforts within a freeze exceed those under which the position rests elsewhere.
    """
    position = recording.position
    effort = recording.input if recording.effort is None else recording.effort
    goes_to = recording.effort is None and is_goal(recording)
    if position is None or effort is None or goes_to or np.ptp(effort) == 0.0:
        return []
    if not (np.all(np.isfinite(position)) and np.all(np.isfinite(effort))):
        return []
    moving = np.diff(position) != 0.0
    rests = [(first, last) for first, last in runs(~moving) if last - first >= _REST]
    strongest = [float(np.max(np.abs(effort[first:last]))) for first, last in rests]
    frozen: list[tuple[int, int]] = []
    for k, (first, last) in enumerate(rests):
        own = effort[first:last]
        if last - first < fewest or np.ptp(own) < swing * np.ptp(effort):
            continue
        strong = float(np.quantile(np.abs(own), 1.0 - pushed))
        signs = np.sign(own[np.abs(own) >= swing * strong])
        beside = max((each for j, each in enumerate(strongest) if j != k), default=0.0)
        if np.count_nonzero(np.diff(signs)) < 2 or strong < stronger * beside:
            continue
        alike = np.abs(effort[:-1]) >= strong
        alike[first:last] = False
        if alike.sum() >= fewest and float(np.mean(moving[alike])) >= moves:
            frozen.append((first, last))
    if not frozen:
        return []
    number = sum(last - first for first, last in frozen)
    what = (
        f"position does not change over {plural(number, 'row')} under efforts that move the "
        f"machine elsewhere, first at {recording.time[frozen[0][0]]:.6g} s"
    )
    fault = number > share * len(position)
    means = "the sensor or its link was stuck, or the machine stood against a stop"
    remedy = "check sensor and link, and record again, or cut these rows out"
    return [Check("stuck channel", "fault" if fault else "note", what, means, remedy)]


def _frozen(values: FloatArray, fewest: int, jump: float, at_end: int) -> tuple[int, int]:
    """Number of frozen rows, and the first of them."""
    steps = np.diff(values)
    size = np.abs(steps)
    fast = np.flatnonzero(size)
    # Where single readings alone differ nothing moved.
    if len(fast) == 0:
        return 0, 0
    usual = float(np.quantile(size[fast], 0.99))
    before, after = fast[:-1], fast[1:]
    least = max(jump * usual, 5.0 * count_of(values))
    hit = (after - before > fewest) & (size[after] > least)
    number = int(np.sum((after - before)[hit] - 1))
    first = int(before[hit][0]) + 1 if number else 0
    last = int(fast[-1])
    tail = len(values) - 1 - last
    if tail >= at_end and len(fast) > 3:
        # From full speed: the last three steps follow each other and are alike.
        ending = steps[last - 2 : last + 1]
        speed = np.abs(ending).min()
        alike = bool(np.all(ending > 0.0) or np.all(ending < 0.0))
        quick = speed >= max(float(np.median(size[fast])), 3.0 * count_of(values))
        if alike and quick and np.ptp(np.abs(ending)) <= 0.5 * speed:
            first = first or last + 1
            number += tail
    return number, first


def clipping(
    recording: Recording, *, fewest: int = 3, visits: int = 2, share: float = 0.05
) -> list[Check]:
    """Measured channels cut off at the end of their range.

    A channel is clipped where it reaches one and the same extreme at speed, several times, and
    stays exactly there; a machine that turns or rests slows down first.

    Parameters
    ----------
    recording : Recording
    fewest : int
        Rows at the extreme: a turning point may well hold two.
    visits : int
        Arrivals at speed; one may be a stop that was hit.
    share : float
        More than this share of the rows is a fault; below, the rest can still be used.
    """
    found = []
    for name, values in channels_of(recording):
        if name not in _BOUNDED or np.ptp(values) == 0.0:
            continue
        mended = without_spikes(values)
        for word, extreme in (("greatest", mended.max()), ("least", mended.min())):
            number = _clipped(mended, float(extreme), fewest, visits)
            if not number:
                continue
            what = f"{name} is cut off at its {word} value {extreme:.6g} in {plural(number, 'row')}"
            means = "the true value is beyond the range and unknown there"
            remedy = (
                "widen the range of the sensor or amplifier, or move less far, and record again"
            )
            fault = number > share * len(values)
            found.append(Check("clipping", "fault" if fault else "note", what, means, remedy))
    return found or [Check("clipping", "fine", "no channel is cut off at an extreme")]


def _clipped(values: FloatArray, extreme: float, fewest: int, visits: int) -> int:
    """Rows at an extreme that was reached, or left, at speed often enough."""
    size = np.abs(np.diff(values))
    least = max(3.0 * count_of(values), 0.25 * float(np.sqrt(np.mean(size**2))))
    rows = 0
    arrivals = 0
    for start, stop in runs(values == extreme):
        if stop - start < fewest:
            continue
        entered = start >= 2 and size[start - 2] > least
        left = stop + 1 < len(values) and size[stop] > least
        if entered and left:
            arrivals += 1
            rows += stop - start
    return rows if arrivals >= visits else 0


def saturation(
    recording: Recording, *, fewest: int = 3, share: float = 0.01, most: float = 0.5
) -> Check:
    """Whether the input rests at its limits.

    An input that moves in steps anyway is at an extreme by intent and passes; so is the goal of a
    servo. Nor is 0 a limit: an input that goes one way alone rests there where it asks for nothing.

    Parameters
    ----------
    recording : Recording
    fewest : int
        Rows in a row at the limit.
    share : float
        Share of the rows at a limit that is noted; less may be chance on a coarse scale.
    most : float
        More than this share is a fault: what the machine was given is mostly unknown.
    """
    name = "input saturation"
    values = recording.input
    if values is None or not np.all(np.isfinite(values)) or np.ptp(values) == 0.0:
        return Check(name, "fine", "there is no changing input to look at")
    if is_goal(recording):
        return Check(name, "fine", "the input is a goal, which has no limits of its own")
    resting = np.zeros(len(values), dtype=np.bool_)
    for extreme in (values.min(), values.max()):
        for start, stop in runs(values == extreme):
            if stop - start >= fewest:
                resting[start:stop] = True
    at_limit = resting & (values != 0.0)
    changes = np.diff(values) != 0.0
    free = ~resting[1:]
    number = int(at_limit.sum())
    stepped = not free.any() or changes[free].mean() < 0.5
    if stepped or number <= share * len(values):
        return Check(name, "fine", "the input does not rest at its limits")
    limits = [f"{extreme:.4g}" for extreme in np.unique(values[at_limit])]
    what = (
        f"the input rests at its limit{'s' * (len(limits) > 1)} {' and '.join(limits)} in "
        f"{100 * number / len(values):.3g} % of the rows"
    )
    return Check(
        name,
        "fault" if number > most * len(values) else "note",
        what,
        "the drive was at its limit; if the recorded input is the command, the machine got less",
        "record what the drive gave (measured current), or move more gently",
    )


def refresh(recording: Recording, *, rows: int = 10) -> Check:
    """Whether the input changes as often as rows are written.

    Parameters
    ----------
    recording : Recording
    rows : int
        Rows between changes that are noted: fewer is a controller slower than the logger.
    """
    name = "input refresh"
    values = recording.input
    if values is None or not np.all(np.isfinite(values)) or np.ptp(values) == 0.0:
        return Check(name, "fine", "there is no changing input to look at")
    changes = np.flatnonzero(np.diff(values)) + 1
    lengths = np.diff(np.concatenate(([0], changes, [len(values)])))
    usual = float(np.median(lengths))
    if usual < rows:
        return Check(name, "fine", "the input changes from row to row, or nearly so")
    return Check(
        name,
        "note",
        f"the input changes only every {usual:.4g} rows ({usual * recording.dt:.3g} s)",
        "either it was commanded in steps, which is fine, or it was read more slowly than the rows "
        "were written, and then the effort between readings is unknown",
        "if it is a reading, log it with every row, or use the command instead",
    )
