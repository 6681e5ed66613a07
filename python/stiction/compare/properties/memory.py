"""Branches between reverse points, and what the contact remembers of them."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..host import Host
from ..measured import Measured, Property
from ..subject import Subject

__all__ = ["BRANCHES", "LINEAR", "RECOVERED", "WIPED"]

_RAMP: Final = 0.5  # s a leg
_SAMPLES: Final = 200
_SETTLED: Final = 0.03  # s, many times what the damper needs
_TOP: Final = 0.7
_CONGRUENT: Final = 1e-3
_RECOVERED: Final = 1e-3
_WIPED: Final = 1e-3
_LINEAR: Final = 0.05


def _leg(host: Host, start: float, end: float) -> None:
    """From force to force, then until the host's damper has let the contact follow."""
    host.ramp(start, end, _RAMP, _SAMPLES)
    host.hold(end, _SETTLED, 20)


def _hardened(subject: Subject) -> Host:
    """A contact at 70 % of its level whose creep, if it has any, is over."""
    host = subject.host()
    top = _TOP * subject.scale.level
    _leg(host, 0.0, top)
    host.hold(top, 200.0, 400)
    return host


def _path(host: Host, subject: Subject, shares: list[float]) -> list[float]:
    """Positions at the ends of legs between shares of the level; starts at 70 %."""
    level, last, ends = subject.scale.level, _TOP, []
    for share in shares:
        _leg(host, last * level, share * level)
        ends.append(host.position)
        last = share
    return ends


def branches(subject: Subject) -> Measured:
    """Travel for the same change of force behind reverse points of different force."""
    if subject.rigid:
        return Measured(None, {}, "rigid before it slides")
    host = _hardened(subject)
    level, last, travels = subject.scale.level, _TOP, []
    # Each leg ends inside the last two: no reverse point is met again.
    for turn in (-0.6, 0.5, -0.4, 0.3, -0.2):
        side = np.sign(turn - last)
        start = host.position
        _leg(host, last * level, (last + 0.3 * side) * level)
        travels.append(abs(host.position - start))
        _leg(host, (last + 0.3 * side) * level, turn * level)
        last = turn
    spread = float(np.ptp(travels) / np.mean(travels))
    return Measured(
        spread < _CONGRUENT,
        {"spread of the travel for 30 % of the level, share": spread},
    )


def return_point_memory(subject: Subject) -> Measured:
    """A reverse point that is met again after a loop and after a loop within it."""
    if subject.rigid:
        return Measured(None, {}, "rigid before it slides")
    host = _hardened(subject)
    top = host.position
    low, inner, back, end = _path(host, subject, [-0.2, 0.4, -0.2, _TOP])
    width = max(top - low, inner - low)
    gaps = abs(end - top) / width, abs(back - low) / width
    return Measured(
        max(gaps) < _RECOVERED,
        {"gap at the outer point, share of the loop": gaps[0],
         "gap at the inner point, share of the loop": gaps[1]},
    )  # fmt: skip


def wipe_out(subject: Subject) -> Measured:
    """The way on after closed loops, beside the way of a contact that never made them."""
    if subject.rigid:
        return Measured(None, {}, "rigid before it slides")
    looped, plain = _hardened(subject), _hardened(subject)
    _path(looped, subject, [-0.2, 0.4, 0.0, 0.4])
    last, level = 0.4, subject.scale.level
    gaps = []
    _leg(plain, _TOP * level, -0.2 * level)
    low = plain.position
    _leg(plain, -0.2 * level, 0.4 * level)
    for share in (0.55, _TOP):
        for host in (looped, plain):
            _leg(host, last * level, share * level)
        last = share
        gaps.append(abs(looped.position - plain.position))
    width = plain.position - low
    gap = max(gaps) / width
    return Measured(gap < _WIPED, {"gap to a contact without the loop, share of the loop": gap})


def linear(subject: Subject) -> Measured:
    """Stiffness over the first parts of the way back from a reverse point."""
    if subject.rigid:
        return Measured(None, {}, "rigid before it slides")
    host = _hardened(subject)
    level, last = subject.scale.level, _TOP
    start = host.position
    stiffness = []
    for share in (1e-4, 1e-3, 1e-2):
        _leg(host, last * level, (_TOP - share) * level)
        last = _TOP - share
        travel = start - host.position
        stiffness.append(share * level / travel if travel > 0.0 else np.inf)
    change = abs(stiffness[1] / stiffness[2] - 1.0) if np.isfinite(stiffness).all() else np.inf
    # Linear where the change goes on falling towards the point.
    nearer = abs(stiffness[0] / stiffness[1] - 1.0) if np.isfinite(stiffness).all() else np.inf
    return Measured(
        bool(change < _LINEAR and nearer < _LINEAR),
        {"stiffness behind the reversal over level per span": stiffness[0] / subject.stiffness,
         "its change over the first 1 % of the level, share": change},
    )  # fmt: skip


BRANCHES: Final = Property(
    "congruent_branches",
    "branches congruent (i)",
    "Is every branch the same curve, turned and shifted, wherever it was reversed?",
    f"The travel for a change of force by 30 % of the level is the same to {_CONGRUENT:.1%} behind "
    "five reverse points between −60 and 70 % of it; one curve gives it to rounding, Dahl's law "
    "differs by tens of per cent, relays of uneven density by one.",
    branches,
)
RECOVERED: Final = Property(
    "reverse_points_recovered",
    "reverse points recovered",
    "Is a reverse point met again when the force comes back?",
    f"Gap below {_RECOVERED:g} of the width of the loop, for a loop and for one inside it: a law "
    "with memory meets the point to rounding, one without misses it by per cents.",
    return_point_memory,
)
WIPED: Final = Property(
    "loops_wiped_out",
    "loops wiped out (ii)",
    "Is a closed loop forgotten, as if it had never been?",
    f"After a closed inner loop the way on differs by less than {_WIPED:g} of the outer loop from "
    "that of a contact that never made it.",
    wipe_out,
)
LINEAR: Final = Property(
    "linear_near_reversal",
    "linear near a reversal",
    "Is the contact an elastic spring for small motion about a reverse point?",
    f"The stiffness over the first 0.01, 0.1 and 1 % of the level differs by less than "
    f"{_LINEAR:.0%}: a power of the distance other than 1 would change it many times.",
    linear,
)
