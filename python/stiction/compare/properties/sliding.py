"""Break-away and sliding."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..host import Host
from ..measured import Measured, Property
from ..subject import Subject

__all__ = ["LAG", "RATE", "STRIBECK"]

_RATES: Final = (0.1, 1.0, 10.0, 100.0)
"""Loading rates, levels a second."""
_SOFT: Final = 0.02
"""Stiffness of the pulling spring over level per length."""
_PULL: Final = 800  # samples
_SETTLES: Final = 1e-5  # s, as the host of other experiments
_FALLS: Final = 0.01
_CHANCE: Final = 3.0
"""Deviations that friction wanders by itself, on top of each threshold; 0 for most laws."""
_FALL: Final = 0.02
_LAG: Final = 0.002
_SWING: Final = 0.8
_CYCLE: Final = 400  # samples


def rate(subject: Subject) -> Measured:
    """The greatest friction while a soft spring pulls the contact, at four rates of loading."""
    if not subject.scale.slides:
        return Measured(None, {}, "never slides")
    peaks = [greatest_friction(subject, rate) for rate in _RATES]
    fall = 1.0 - min(peaks[1:]) / peaks[0]
    return Measured(
        fall > _FALLS + _CHANCE * subject.scatter,
        {f"peak at {rate:g} levels/s over that at {_RATES[0]:g}": peak / peaks[0]
         for rate, peak in zip(_RATES[1:], peaks[1:], strict=True)},
    )  # fmt: skip


def greatest_friction(subject: Subject, rate: float) -> float:
    """Greatest friction while a soft spring pulls, at a rate of loading in levels a second."""
    """The greatest friction on 100 lengths of way, the far end moving at an even speed."""
    level = subject.scale.level
    stiffness = _SOFT * subject.stiffness
    dt = 2.0 / rate / _PULL
    # The spring yields within a step as well: beside the contact that is one more damper.
    damping = _SETTLES * subject.stiffness + stiffness * dt
    host = Host(subject.model(), level, damping)
    peak = 0.0
    for index in range(1, _PULL + 1):
        before = host.position
        pull = rate * level * index * dt - stiffness * before
        host.push([pull], dt)
        peak = max(peak, pull - damping * (host.position - before) / dt)
    return peak


def stribeck(subject: Subject) -> Measured:
    """Friction of steady sliding over five decades of speed."""
    if not subject.scale.slides:
        return Measured(None, {}, "never slides")
    force = np.array(subject.steady)
    highest = np.maximum.accumulate(force)
    fall = float(np.max((highest - force) / highest))
    return Measured(
        fall > _FALL + _CHANCE * subject.scatter,
        {"greatest fall of steady friction with speed, share": fall,
         "friction at 1e-5 over that at 3 rad/s or m/s": float(force[0] / force[-1])},
    )  # fmt: skip


def lag(subject: Subject) -> Measured:
    """Friction while the speed rises and while it falls, without ever turning round."""
    if not subject.scale.slides:
        return Measured(None, {}, "never slides")
    widest, where = 0.0, 0.0
    phase = 2.0 * np.pi * np.arange(_CYCLE) / _CYCLE
    for speed in np.geomspace(1e-4, 1.0, 9):
        for travel in (0.3, 1.0, 3.0, 15.0, 60.0):
            cycle = speed * (1.0 + _SWING * np.sin(phase))
            dt = travel * subject.length / speed / _CYCLE
            law = subject.model()
            law.simulate(np.full(_CYCLE, speed), 300.0 * subject.length / speed / _CYCLE)
            law.simulate(np.tile(cycle, 2), dt)
            force = law.simulate(cycle, dt)
            # Equal speeds lie at equal distances from the crest.
            rising = force[: _CYCLE // 4]
            falling = force[_CYCLE // 4 + 1 : _CYCLE // 2 + 1][::-1]
            gap = float(np.mean(rising - falling)) / subject.scale.level
            if abs(gap) > abs(widest):
                widest, where = gap, float(speed)
    return Measured(
        abs(widest) > _LAG + _CHANCE * subject.scatter,
        {"friction while speed rises less that while it falls, shares of the level": widest,
         "at a mean speed of, rad/s or m/s": where},
    )  # fmt: skip


RATE: Final = Property(
    "breakaway_falls_with_rate",
    "break-away falls with rate",
    "Does a contact that is loaded fast break away at less than one that is loaded slowly?",
    f"The greatest friction falls by more than {_FALLS:.0%} when the loading rate rises from 0.1 "
    "to up to 100 levels a second, pulled through a spring of 2 % of the contact's stiffness, "
    "without inertia.",
    rate,
)
LAG: Final = Property(
    "frictional_lag",
    "frictional lag",
    "Does friction follow a change of speed late?",
    f"At the same speed it differs between rising and falling speed by more than {_LAG:.1%} of the "
    "level (higher while rising where friction falls with speed, lower where it grows), "
    "somewhere in 1e-4 to 1 rad/s (m/s) with cycles 0.3 to 60 pre-sliding distances "
    "long: friction that knows the present speed only gives 0.",
    lag,
)
STRIBECK: Final = Property(
    "stribeck",
    "Stribeck",
    "Does steady friction fall with speed anywhere?",
    f"Falls by more than {_FALL:.0%} somewhere between 1e-5 and 3 rad/s (m/s).",
    stribeck,
)
