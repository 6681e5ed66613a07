"""How far, how fast and how hard a machine may be moved, and what its plant says of its size."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .._support.given import number
from .._support.wording import commas
from ..errors import InputError
from ..plant import Plant
from ..plant.parameter import Parameter
from ..plant.presliding import presliding

__all__ = ["Limits", "Sizes", "sizes_of", "with_inertia"]

MARGIN: Final = 0.85
"""Share of every limit that is planned for: a controller overshoots."""
EFFORT_TIMES: Final = 4.0
"""Greatest effort over the friction where neither limit nor plant states one."""
LEAST_EFFORT: Final = 1.3
"""And the least one in which anything can be moved with purpose."""
SHARE_TO_ACCELERATE: Final = 0.5
"""Of the effort beyond friction: the rest is the controller's."""
BLEND_S: Final = 0.15
"""Least time to full speed: what a position loop of some 10 Hz follows without overshoot."""
OF_NO_LOAD: Final = 0.5
"""Share of a servo's speed without load that is asked for: the rest of its voltage makes effort."""
SLOW_S: Final = 100.0
"""Time in which the range is crossed to measure friction without its viscous part."""
STEPS: Final = 400


@dataclass(frozen=True)
class Limits:
    """Bounds of a machine, about the position in which it stands.

    Attributes
    ----------
    position : float or None
        Greatest distance from there, rad or m; one turn where a rotary plant states none.
    speed : float or None
        rad/s or m/s.
    effort : float or None
        Of the drive, N·m or N; that of the plant's drive where none is given.
    """

    position: float | None = None
    speed: float | None = None
    effort: float | None = None

    def __post_init__(self) -> None:
        for name in ("position", "speed", "effort"):
            value = getattr(self, name)
            if value is None:
                continue
            value = number(value, f"plan: {name}")
            if not (math.isfinite(value) and value > 0.0):
                raise InputError(f"{name} = {value:g} is out of bounds: give a number above 0")


@dataclass(frozen=True)
class Sizes:
    """What signals are sized by; margins are taken off already.

    Attributes
    ----------
    reach, speed, acceleration : float
        Greatest distance from the start, speed and acceleration of a reference.
    effort : float
        Greatest effort of an input.
    friction : float
        Level of the sliding friction.
    presliding : float
        Displacement in which a contact comes to a slide, 0 where it does not yield.
    inertia : float
    """

    reach: float
    speed: float
    acceleration: float
    effort: float
    friction: float
    presliding: float
    inertia: float


@dataclass(frozen=True)
class _Efforts:
    """What the drive gives and what friction and gravity take of it, without any inertia."""

    reach: float
    most: float
    friction: float
    weight: float

    @property
    def spare(self) -> float:
        """Share of the effort beyond friction that is planned for."""
        return SHARE_TO_ACCELERATE * (self.most - self.friction - self.weight)

    @property
    def to_accelerate(self) -> float:
        """Effort that accelerates, however little is spare."""
        return max(self.spare, 0.05 * self.most)


def with_inertia(plant: Plant, limits: Limits) -> tuple[Plant, str]:
    """A plant that can be planned for, and what had to be assumed of its inertia, "" for nothing.

    Before anything was recorded nobody may know it. Assumed is one with which the effort beyond
    friction reaches the greatest speed (without a limit a usual one) in the least time that is
    planned for: references are as fast then as such a machine would be moved. Of what the drive
    alone does to a lighter one nothing is known.

    Parameters
    ----------
    plant : Plant
    limits : Limits

    Raises
    ------
    InputError
        As for ``sizes_of``.
    """
    if "inertia" in plant.body or plant.prescribed_motion:
        return plant, ""
    usual = float(plant.curve_speeds().max())
    speed = MARGIN * limits.speed if limits.speed is not None else usual
    inertia = _efforts(plant, limits).to_accelerate * BLEND_S / (0.5 * math.pi * speed)
    unit = f"{plant.effort_unit} per {plant.position_unit}/s²"
    assumed = replace(plant, body={**plant.body, "inertia": Parameter(inertia)})
    return assumed, (
        f"{plant.source} states no inertia: signals are sized as if it were {inertia:.2g} {unit}; "
        "record one of them, fit the plant to it, and plan again with the inertia that comes out"
    )


def _efforts(plant: Plant, limits: Limits) -> _Efforts:
    """Efforts and the range of a plant.

    Raises
    ------
    InputError
        A linear plant without a limit of position; an effort that moves nothing.
    """
    reach = limits.position
    if reach is None and plant.motion == "linear":
        raise InputError(
            f"{plant.source}: how far the machine may go is not known; give position (--position), "
            "the distance in m on either side of where it stands"
        )
    reach = MARGIN * (2.0 * math.pi if reach is None else reach)
    friction = _level(plant, reach)
    own = _greatest(plant)
    weight = _steady(plant)
    given = math.inf if limits.effort is None else limits.effort
    most = min(own, given)
    if not math.isfinite(most):
        most = EFFORT_TIMES * (friction + weight)
    if most < LEAST_EFFORT * (friction + weight):
        taken = commas(
            [f"friction {friction:.3g}", *([f"gravity {weight:.3g}"] if weight > 0.0 else [])]
        )
        still, least = most <= friction + weight, LEAST_EFFORT * (friction + weight)
        moves = "moves nothing" if still else "hardly moves the machine"
        raise InputError(
            f"{plant.source}: an effort of {most:.3g} {plant.effort_unit} {moves}: {taken} "
            f"takes {'it' if still else 'most of it'}; give {least:.3g} or more"
        )
    return _Efforts(reach, MARGIN * most, friction, weight)


def sizes_of(plant: Plant, limits: Limits) -> Sizes:
    """Sizes of the signals for a plant.

    Raises
    ------
    InputError
        No inertia; a linear plant without a limit of position; an effort that moves nothing; a
        plant of prescribed motion.
    """
    if plant.prescribed_motion:
        raise InputError(
            f"{plant.source}: [drive] kind = 'prescribed_motion' has no input to plan; signals are "
            "planned for machines that are driven"
        )
    plant.motor()  # refuses a plant that cannot be simulated
    efforts = _efforts(plant, limits)
    most, friction, reach = efforts.most, efforts.friction, efforts.reach
    yields = presliding(plant.friction, friction) if plant.friction.springy else 0.0
    inertia = plant.inertia
    spare = efforts.spare
    acceleration = efforts.to_accelerate / inertia
    speed = math.sqrt(acceleration * reach)
    if plant.servo:
        speed = min(speed, OF_NO_LOAD * _no_load(plant))
    if limits.speed is not None:
        speed = min(speed, MARGIN * limits.speed)
    speed = _carried(plant, speed, friction + spare)
    acceleration = min(acceleration, 0.5 * math.pi * speed / BLEND_S)
    return Sizes(reach, speed, acceleration, most, friction, yields, inertia)


def _level(plant: Plant, reach: float) -> float:
    """Level of the sliding friction: that of the law loaded slowly."""
    places = np.concatenate([[0.0], reach * np.logspace(-9.0, 0.0, STEPS)])
    duration = SLOW_S / STEPS
    model = plant.friction.model()
    level = max(model.step(float(v), duration) for v in np.diff(places) / duration)
    if not (math.isfinite(level) and level > 0.0):
        raise InputError(
            f"{plant.source}: [friction] {plant.friction.law} holds nothing; state its level"
        )
    return level


def _greatest(plant: Plant) -> float:
    """Greatest effort that the drive gives: of a servo that of its supply at rest."""
    drive = plant.drive
    if not plant.servo:
        return abs(plant.gain) * float(drive.get("limit", math.inf))
    current = float(drive["supply_v"] * drive.get("duty_limit", 1.0) / drive["resistance_ohm"])
    return abs(plant.gain) * min(current, float(drive.get("current_limit_a", math.inf)))


def _no_load(plant: Plant) -> float:
    """Speed at which a servo generates all of its supply."""
    return float(plant.drive["supply_v"] * plant.drive.get("duty_limit", 1.0)) / abs(plant.gain)


def _steady(plant: Plant) -> float:
    """Greatest effort that gravity takes, payload included."""
    return abs(plant.gravity) + abs(plant.weight)


def _carried(plant: Plant, speed: float, effort: float) -> float:
    """The speed, or a lower one at which friction leaves something of the effort."""
    for _ in range(60):
        model = plant.friction.model()
        span = 10.0 / STEPS
        force = [model.step(speed, span) for _ in range(STEPS)][-1]
        if force <= effort:
            break
        speed *= 0.8
    return speed
