"""The session clock: when recordings of one machine begin, and what begins anew with a cold one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from ..errors import InputError
from .recording import Recording
from .split import name_of

__all__ = ["ages_of", "starts_of"]


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
            raise InputError(
                f"session: {name_of(recordings[after], after)} starts at "
                f"{stated[after]:g} s, before {name_of(recordings[before], before)} ends at "
                f"{end:.6g} s; one machine makes one recording at a time: state start_s of each, "
                "on one clock, or of none"
            )
    return stated


def ages_of(recordings: Sequence[Recording]) -> tuple[float, ...]:
    """How long the machine has been on when each recording begins, s.

    That is the session clock, which a recording from cold sets back to 0.

    Raises
    ------
    InputError
        As `starts_of`.
    """
    starts = starts_of(recordings)
    switched_on = [start for start, each in zip(starts, recordings, strict=True) if each.cold]
    return tuple(
        start - max((on for on in switched_on if on <= start), default=0.0) for start in starts
    )
