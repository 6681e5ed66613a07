"""What a plant needs in steady motion: over the speed, and over where it stands."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from .._native import Motion
from .._support import given
from .._support.arrays import FloatArray
from ..errors import InputError
from ..motor import Motor

if TYPE_CHECKING:
    from .plant import Plant
    from .stated import Effect

__all__ = ["SEEN", "friction_curve", "in_curve", "in_position", "position_effort", "static_level"]

AT_CONTACT: Final = frozenset({"friction level", "added effort"})
"""Hooks of effects that act where friction acts."""
PASSING: Final = frozenset({"slow", "angle", "cogging", "temperature"})
"""Families that go with clock, path, place or warmth: a curve over speed has none of them."""
LENGTHS: Final = 40.0
"""Before a slide counts as steady: in lengths of law and effects, and in times of effects."""
RIGID: Final = 1e-6
"""Length of a law that has none, rad or m."""
SAMPLES: Final = 400
LONGEST_S: Final = 1e6
"""The longest sample that a motor takes, s: a slide of 400 of them, twelve years, is steady enough
where a length that data left open was fitted as kilometres."""
STAYS: Final = 4
"""Samples at each place: the velocity of a motion is that of the samples around."""
SLOW: Final = 1e-3
"""Share of the speed scale of a law at which it slides as slowly as counts."""
USUAL_SPEED: Final = 0.1
"""The same scale where a law states none, rad/s or m/s."""
SEEN: Final = 1e-3
"""Share of its greatest friction by which an effect must change a curve to be in it: one that
passes in a slide leaves a little at the end of any."""
RESTING_S: Final = 1.0
"""How long it stands at a place, s."""


def friction_curve(plant: Plant, speeds: npt.ArrayLike) -> FloatArray:
    """Effort that friction takes in steady motion at each of some speeds; see ``Plant``."""
    wanted = given.numbers(speeds, f"{plant.source}: speeds")
    if not np.all(np.isfinite(wanted)):
        raise InputError(f"{plant.source}: speeds: finite numbers are wanted, in rad/s or m/s")
    still = replace(plant, effects=tuple(e for e in plant.effects if _acts_by_speed(e)))
    slide = _Slide(still)
    found = [slide.friction(float(speed)) if speed else 0.0 for speed in wanted.ravel()]
    return np.array(found).reshape(wanted.shape)


def position_effort(plant: Plant, positions: npt.ArrayLike) -> FloatArray:
    """Effort that a plant needs to stand at each of some positions; see ``Plant``."""
    wanted = given.numbers(positions, f"{plant.source}: positions")
    flat = wanted.ravel()
    if not np.all(np.isfinite(flat)):
        raise InputError(f"{plant.source}: positions: finite numbers are wanted, in rad or m")
    if flat.size == 0:
        return np.zeros(wanted.shape)
    acting = tuple(e for e in plant.effects if _adds(e))
    motor = _follower(replace(plant, effects=acting))
    motor.reset(float(flat[0]), 0.0)
    # It moves to each place in one sample, and has come to rest there two samples later.
    places = np.append(flat[:1], np.repeat(flat, STAYS))
    ambient = motor.follow(Motion(places, np.zeros(STAYS * flat.size), RESTING_S))[1]
    needed: FloatArray = -ambient[2::STAYS].reshape(wanted.shape)
    return needed


def static_level(plant: Plant) -> float:
    """Effort, beside what its place asks for, that a plant slides under as slowly as it can."""
    scale = plant.friction.parameters.get("stribeck_velocity")
    slow = SLOW * (USUAL_SPEED if scale is None else scale.value)
    return float(np.max(np.abs(friction_curve(plant, [-slow, slow]))))


def in_curve(plant: Plant, effect: Effect) -> bool:
    """Whether a curve over the speed holds an effect of a plant."""
    if not _acts_by_speed(effect):
        return False
    speeds = np.outer([-1.0, 1.0], np.geomspace(1e-3, 1e2, 16)).ravel()
    without = replace(plant, effects=tuple(e for e in plant.effects if e.name != effect.name))
    with_it, other = friction_curve(plant, speeds), friction_curve(without, speeds)
    return bool(np.max(np.abs(with_it - other)) > SEEN * np.max(np.abs(other)))


def in_position(plant: Plant, effect: Effect) -> bool:
    """Whether an effort over the position holds an effect of a plant."""
    alone = replace(plant, effects=(effect,), body={})
    return _adds(effect) and bool(np.any(position_effort(alone, np.linspace(0.0, 6.0, 37))))


def _acts_by_speed(effect: Effect) -> bool:
    hooks, record = frozenset(effect.record.hooks), effect.record
    return hooks <= AT_CONTACT and record.family not in PASSING


def _length(plant: Plant) -> float:
    """The longest way, rad or m, over which a law changes its friction."""
    numbers = plant.friction.model().parameters
    units = {record.name: record.unit for record in plant.friction.record.parameters}
    own = [value for name, value in numbers.items() if units.get(name) == "rad"]
    stiffness = numbers.get("initial_stiffness", np.inf)
    own += [numbers.get(name, 0.0) / stiffness for name in ("coulomb", "breakaway")]
    return max([RIGID, *(value for value in own if np.isfinite(value))])


def _sizes(plant: Plant, unit: str) -> list[float]:
    """Lengths, or times, over which effects of a plant pass; 0 among them."""
    sizes = [0.0]
    for effect in plant.effects:
        for record in effect.record.parameters:
            stated = effect.parameters.get(record.name)
            value = record.default if stated is None else stated.value
            if record.unit == unit and value is not None and np.isfinite(value):
                sizes.append(float(value))
    return sizes


def _follower(plant: Plant) -> Motor:
    """A plant that is moved, whatever moves it and however heavy it is."""
    return replace(plant, drive={"kind": "prescribed_motion"}).follower()


def _adds(effect: Effect) -> bool:
    return tuple(effect.record.hooks) == ("added effort",)


class _Slide:
    """Steady slides of a plant, which end where it stands at 0."""

    def __init__(self, plant: Plant) -> None:
        self._motor = _follower(replace(plant, body={}))
        # What goes with the position is the same for every speed.
        self._places = np.linspace(-1.0, 0.0, SAMPLES + 1)
        self._way = LENGTHS * max(_length(plant), *_sizes(plant, "rad"))
        self._time = LENGTHS * max(_sizes(plant, "s"))
        self._still = np.zeros(SAMPLES)
        self._motor.reset(0.0, 0.0)
        rest = Motion(np.zeros(2), np.zeros(1), RESTING_S)
        self._at_rest = float(self._motor.follow(rest)[1][-1])

    def friction(self, speed: float) -> float:
        """Friction at a speed, less what the same place asks for at rest."""
        duration = min(max(self._way / abs(speed), self._time) / SAMPLES, LONGEST_S)
        places = duration * SAMPLES * speed * self._places
        self._motor.reset(float(places[0]), speed)
        _, ambient, found, _ = self._motor.follow(Motion(places, self._still, duration))
        return float(found[-1] - (ambient[-1] - self._at_rest))
