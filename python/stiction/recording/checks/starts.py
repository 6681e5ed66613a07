"""Checks of when recordings begin: what is called cold, and what is not."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

from ..names import names_of
from ..recording import Recording
from ..session_clock import origin_of, starts_of
from .finding import Check

__all__ = ["DOUBTED", "starts"]

DOUBTED: Final = "doubtful cold start"
"""Name of the check of a start that is called cold, or is not, against its pause."""

SOON_S: Final = 600.0
"""A machine that is called cold after a shorter pause is rather warm."""
LATE_S: Final = 3600.0
"""A machine that is not called cold after a longer pause is rather cold."""


def starts(recordings: Sequence[Recording]) -> list[tuple[str, Check]]:
    """Cold starts, long pauses and a clock that begins long before the session, by recording.

    Raises
    ------
    InputError
        As ``starts_of``.
    """
    begins = starts_of(recordings)
    order = sorted(range(len(recordings)), key=lambda k: begins[k])
    if not order:
        return []
    names = names_of(recordings)
    origin, first = origin_of(recordings), order[0]
    found = []
    if origin != 0.0 and not recordings[first].cold:
        found.append(
            (
                names[first],
                Check(
                    "clock",
                    "note",
                    f"the clock stands at {begins[first]:.6g} s when the first recording begins",
                    "it tells nothing of when the machine was switched on, so that time is counted "
                    "from this recording",
                    "count start_s from when the machine was switched on",
                ),
            )
        )
    for before, after in pairwise(order):
        pause = begins[after] - begins[before] - recordings[before].duration
        if check := _paused(pause, recordings[after].cold):
            found.append((names[after], check))
    return found


def _paused(pause: float, cold: bool) -> Check | None:
    said = f"it begins cold, {pause:.6g} s after the one before it ended"
    if cold and pause < SOON_S:
        return Check(
            DOUBTED,
            "note",
            said,
            "where the machine was still warm, what goes with time or with use is taken for gone",
            "leave cold out, or let the machine rest until it is as it was before",
        )
    if cold:
        return Check("cold start", "fine", said)
    if pause > LATE_S:
        return Check(
            DOUBTED,
            "note",
            f"it begins {pause:.6g} s after the one before it ended, and not cold",
            "the time since the machine was switched on is counted on through that pause",
            "write cold = true if it had cooled down",
        )
    return None
