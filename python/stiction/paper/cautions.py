"""What an estimate says that no interval tells."""

from __future__ import annotations

from typing import Final

import numpy as np

from .graphical import Recorded, Steps

__all__ = ["assumptions_of", "stairs"]

_STAIRS: Final = 0.85
"""Share of readings equal to the last; noise of an eighth of a count and more gives fewer."""
_LEVELS: Final = 3
"""Levels of torque from which on a power of it can be told from another curve."""


def stairs(records: list[Recorded]) -> tuple[str, ...]:
    """A sentence where readings hardly flicker: they tell where a stair ends, and little else."""
    same = max(float(np.mean(np.diff(record.position) == 0.0)) for record in records)
    if same < _STAIRS:
        return ()
    return (
        f"creep_rate may be off by a twentieth beyond its interval: {same:.0%} of the readings of "
        "a recording equal the one before, so that rounding makes stairs of slow creep; record "
        "with more noise, or with a finer encoder",
    )


def assumptions_of(steps: Steps, spring: tuple[str, ...]) -> dict[str, str]:
    """Parameters that no recording shows by themselves, and why."""
    why: dict[str, str] = {}
    if steps.branch is None:
        why |= dict.fromkeys(spring, "there is no loop below a level that was held before")
    if steps.levels < _LEVELS:
        levels = {0: "no level", 1: "one level"}.get(steps.levels, f"{steps.levels} levels")
        why["hardening_exponent"] = f"torque was held at {levels}"
    if steps.creep_rate is None:
        why["creep_rate"] = "no torque was held long enough"
    return why
