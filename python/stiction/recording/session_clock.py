"""The session clock: when recordings of one machine begin, and what begins anew with a cold one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from ..errors import InputError
from .names import names_of, places_in_session
from .recording import Recording

__all__ = ["ages_of", "origin_of", "starts_of", "subset"]


def starts_of(recordings: Sequence[Recording]) -> tuple[float, ...]:
    """Starts on the session clock, s: as stated, or one recording after the other.

    Raises
    ------
    InputError
        Two recordings at the same time.
    """
    if not any(recording.start_s != 0.0 for recording in recordings):
        starts, at = [], 0.0
        for recording in recordings:
            starts.append(at)
            at += recording.duration + recording.dt
        return tuple(starts)
    stated = tuple(recording.start_s for recording in recordings)
    order = sorted(range(len(recordings)), key=lambda index: stated[index])
    for before, after in pairwise(order):
        end = stated[before] + recordings[before].duration
        if stated[after] < end:
            names = names_of(recordings)
            cold = ", also of one that begins cold" if recordings[after].cold else ""
            raise InputError(
                f"session: {names[after]} starts at "
                f"{stated[after]:g} s, before {names[before]} ends at "
                f"{end:.6g} s; one machine makes one recording at a time: state start_s of each, "
                f"on one clock{cold}, or of none"
            )
    return stated


def origin_of(recordings: Sequence[Recording]) -> float:
    """Where on the session clock the machine was switched on, s, if nobody says that it was cold.

    At 0, unless that lies further from the first recording than the session is long, up to the
    first start from cold: a clock that counts from midnight, or from 1970, tells nothing of it.
    Then where the first one begins.

    Raises
    ------
    InputError
        As `starts_of`.
    """
    starts = starts_of(recordings)
    first = min(starts, default=0.0)
    anew = (s for s, each in zip(starts, recordings, strict=True) if each.cold and s > first)
    until = min(anew, default=math.inf)
    ends = (s + each.duration for s, each in zip(starts, recordings, strict=True) if s < until)
    return 0.0 if 0.0 <= first <= max(ends, default=0.0) - first else first


def ages_of(recordings: Sequence[Recording]) -> tuple[float, ...]:
    """How long the machine has been on when each recording begins, s.

    That is the session clock, which a recording from cold sets back to 0.

    Raises
    ------
    InputError
        As `starts_of`.
    """
    starts, origin = starts_of(recordings), origin_of(recordings)
    cold = [start for start, each in zip(starts, recordings, strict=True) if each.cold]
    return tuple(
        start - max((on for on in cold if on <= start), default=origin) for start in starts
    )


def subset(recordings: Sequence[Recording], places: Sequence[int]) -> list[Recording]:
    """Some of the recordings, each called as among all of them.

    What follows one from cold that is not among them begins cold itself.

    Raises
    ------
    InputError
        As `starts_of`.
    """
    starts, kept = starts_of(recordings), {}
    names, own = names_of(recordings), places_in_session(recordings)
    lost = False
    for k in sorted(range(len(recordings)), key=lambda k: starts[k]):
        cold = recordings[k].cold or lost
        if k in places:
            kept[k] = recordings[k].from_cold() if cold else recordings[k]
            if len(places) < len(recordings):
                kept[k] = kept[k].entered(own[k], names[k])
        lost = cold and k not in places
    return [kept[k] for k in places]
