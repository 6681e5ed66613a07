"""Creep under a held force, what it leaves behind, and whether it ever ends."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..host import Host
from ..measured import Measured, Property
from ..subject import Subject

__all__ = ["CREEP", "HARDENING", "HOLDS", "POSSIBLE_HARDENING"]

_RAMP: Final = 0.05  # s; short beside any creep, long beside the host's damper
_SETTLED: Final = 0.02  # s after a ramp, in which the damper lets the contact follow
_CREEPS: Final = 1e-3
_STOPS: Final = 0.05
_INFINITE: Final = 1.2
_HARDENED: Final = 0.05
_OTHER: Final = 0.2
_CHANCE: Final = 0.01
"""Share of the level by which friction may wander by chance and a yield still tell something."""
_STILL: Final = 1e-6


def _held(subject: Subject, share: float) -> tuple[float, float]:
    """Creep up to 100 s and from there to 1000 s under a share of the level, in spans."""
    host = subject.host()
    force = share * subject.scale.level
    host.ramp(0.0, force, _RAMP, 50)
    start = host.hold(force, _SETTLED, 20)[-1]
    early = host.hold(force, 100.0, 400)[-1]
    late = host.hold(force, 900.0, 200)[-1]
    return (early - start) / subject.length, (late - early) / subject.length


def creep(subject: Subject) -> Measured:
    """Force ramped to 60 % of the level and held for 1000 s."""
    early, late = _held(subject, 0.6)
    total = early + late
    numbers = {
        "creep in 1000 s, spans": total,
        "share of it after 100 s": late / total if total > _CREEPS else 0.0,
    }
    if total <= _CREEPS:
        return Measured(False, numbers, "does not creep")
    stops = abs(late) < _STOPS * total
    return Measured(stops, numbers, "" if stops else "creeps on")


def possible_hardening(subject: Subject) -> Measured:
    """Whole creep under 10, 20 and 40 % of the level."""
    if not creep(subject).holds:
        return Measured(None, {}, "no creep that stops")
    shares = np.array([0.1, 0.2, 0.4])
    amounts = np.array([sum(_held(subject, share)) for share in shares])
    if np.any(amounts <= 0.0):
        return Measured(None, {}, "no creep at small force")
    power = float(np.log(amounts[1] / amounts[0]) / np.log(2.0))
    return Measured(
        power > _INFINITE,
        {
            "creep under 10 %, spans": float(amounts[0]),
            "creep under 40 %, spans": float(amounts[2]),
            "power of force that creep follows": power,
        },
    )


def hardening(subject: Subject) -> Measured:
    """First loading of a fresh contact and of one that was cycled; half cycles of either sign."""
    if subject.rigid:
        return Measured(None, {}, "rigid before it slides")
    if subject.scatter > _CHANCE:
        return Measured(None, {}, "friction wanders by chance")
    top = 0.7 * subject.scale.level
    host = subject.host()
    _leg(host, 0.0, top, subject)
    fresh = host.position
    ends = [fresh]
    for index in range(4):
        turn = top if index % 2 else -top
        _leg(host, -turn, turn, subject)
        ends.append(host.position)
    # Against the same branch one cycle later: what the first turn of the other sign yielded.
    other = abs(abs(ends[1] - ends[0]) - abs(ends[3] - ends[2]))
    last = top
    for share in np.linspace(0.95, 0.05, 19):
        turn = -np.sign(last) * share * top
        host.ramp(last, turn, _RAMP, 20)
        last = float(turn)
    host.ramp(last, 0.0, _RAMP, 20)
    start = host.position
    _leg(host, 0.0, top, subject)
    hardened = 1.0 - (host.position - start) / fresh
    numbers = {
        "share of the first loading that is gone after cycles": hardened,
        "share of the first loading that the other direction yielded": other / fresh,
    }
    if hardened < _HARDENED:
        return Measured(False, numbers, "does not harden")
    isotropic = other < _OTHER * hardened * fresh
    return Measured(isotropic, numbers, "" if isotropic else "each direction for itself")


def _leg(host: Host, start: float, end: float, subject: Subject) -> None:
    host.ramp(start, end, _RAMP, 50)
    host.hold(end, 20.0, 40)


def holds(subject: Subject) -> Measured:
    """Half the level for 70 minutes; the last 60 count."""
    force = 0.5 * subject.scale.level
    host = subject.host()
    host.ramp(0.0, force, _RAMP, 50)
    start = host.hold(force, 600.0, 300)[-1]
    end = host.hold(force, 3600.0, 720)[-1]
    moved = abs(end - start)
    return Measured(
        bool(moved < _STILL * subject.length),
        {"moved within an hour, rad or m": moved, "in spans": moved / subject.length},
    )


CREEP: Final = Property(
    "creep_that_stops",
    "creep that stops",
    "Does it creep under a held force, ever more slowly, and stop?",
    f"Creeps by more than {_CREEPS:g} of the pre-sliding distance in 1000 s under 60 % of its "
    f"level, less than {_STOPS:.0%} of that after the first 100 s: creep that went by the "
    "logarithm of time would do a quarter or more there.",
    creep,
)
HARDENING: Final = Property(
    "isotropic_hardening",
    "isotropic hardening",
    "Does what one direction hardened count for the other?",
    f"Cycles of ±70 % take away more than {_HARDENED:.0%} of what a first loading yields, and the "
    f"first turn of the other sign yields less than {_OTHER:.0%} of that: hysteresis alone would "
    "leave a contact that was cycled down to rest as it was.",
    hardening,
)
POSSIBLE_HARDENING: Final = Property(
    "infinite_mpw_slope",
    "infinite MPW slope at 0",
    "Does the slope of force over greatest possible work hardening grow without limit at 0?",
    f"Between 10 and 20 % of the level creep follows a power of the force above {_INFINITE:g}: "
    "any power above 1 makes the slope infinite; the margin is that of two points.",
    possible_hardening,
)
HOLDS: Final = Property(
    "holds_still",
    "holds still for an hour",
    "Does it stay where it is under half its level, once creep that ends has ended?",
    f"Moves by less than {_STILL:g} of the pre-sliding distance within the hour that follows ten "
    "minutes under the force: what a machine at rest could be blamed for is thousands of times "
    "more.",
    holds,
)
