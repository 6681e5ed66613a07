"""Which recordings of a session can be used: the one rule of fits and diagnoses."""

from __future__ import annotations

from collections.abc import Sequence

from .checks import Check, check, impulse_checks, starts
from .names import names_of
from .recording import Recording

__all__ = ["checks_of", "usable"]


def checks_of(recordings: Sequence[Recording]) -> list[tuple[str, Check]]:
    """What was found in each recording, by its name."""
    named = zip(names_of(recordings), recordings, strict=True)
    own = [(name, c) for name, recording in named for c in check(recording)]
    return own + impulse_checks(recordings) + starts(recordings)


def usable(
    recordings: Sequence[Recording], checks: Sequence[tuple[str, Check]]
) -> tuple[list[int] | None, str]:
    """Places of the recordings without a fault, and in words what is wrong with the others.

    Parameters
    ----------
    recordings : sequence of Recording
    checks : sequence of (str, Check)
        From ``checks_of``.

    Returns
    -------
    list of int or None
        None where less than half of them are left, or none of those that train.
    str
        "" where nothing is wrong.
    """
    names = names_of(recordings)
    # What could not be mended on reading is a whole sentence, which names file and remedy itself.
    told = {
        name: sentence
        for name, recording in zip(names, recordings, strict=True)
        for sentence in recording.faults
    }
    for name, c in checks:
        if c.verdict == "fault":
            told.setdefault(name, f"{name}: {c.what}; {c.try_}")
    kept = [k for k, name in enumerate(names) if name not in told]
    if not told:
        return kept, ""
    first = next(iter(told.values())).rstrip(".")
    more = f" ({len(told) - 1} more stand among the data checks)" if len(told) > 1 else ""
    roles = {recording.role for recording in recordings}
    lost = {role for role in roles if role and role not in {recordings[k].role for k in kept}}
    if 2 * len(kept) < len(names) or "train" in lost:
        return None, f"The data cannot be used: {first}.{more}"
    left_out = "1 recording is" if len(told) == 1 else f"{len(told)} recordings are"
    return kept, f"{left_out} left out: {first}.{more}"
