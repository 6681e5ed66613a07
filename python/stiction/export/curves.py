"""The two curves of a plant as points, with lines between them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from .._support.arrays import FloatArray
from ..plant import steady
from ..plant.joint import beside, speeds_up_to
from .points import few_points, lines_off

if TYPE_CHECKING:
    from ..plant import Plant
    from ..plant.stated import Effect

__all__ = ["Curves"]

PLACES: Final = 241
"""Of a turn, from which points are chosen."""
ROUNDING: Final = 1e-12
"""Share of the level by which lines are off a curve that is made of lines."""
LOOKED_AT: Final = 5401
"""Of three turns, at which lines are compared."""
PROBED: Final = np.linspace(0.0, 6.0, 37)
"""Places of a slide, rad or m, at which an effect is asked whether it differs."""


@dataclass(frozen=True)
class Curves:
    """Effort over speed, and over the position of a turn.

    Attributes
    ----------
    speeds, friction : numpy.ndarray, shape (n,)
    places, efforts : numpy.ndarray, shape (m,)
        One place alone where the same effort is needed everywhere.
    held, lost : tuple of str
    lines : tuple of str
        Of what is lost, how far lines are off.
    effects : frozenset of str
        Of the plant, that the curves hold.
    numbers : dict of str to float
        How far lines are off.
    """

    speeds: FloatArray
    friction: FloatArray
    places: FloatArray
    efforts: FloatArray
    held: tuple[str, ...]
    lost: tuple[str, ...]
    lines: tuple[str, ...]
    effects: frozenset[str]
    numbers: dict[str, float]

    @classmethod
    def of(cls, plant: Plant, speed: float, most: int) -> Curves:
        """Of a plant up to a greatest speed, in so many points each."""
        speeds = speeds_up_to(speed)
        curve = steady.friction_curve(plant, speeds)
        # Every other one, and both ends of both directions.
        middle = len(speeds) // 2
        own = np.unique([*range(0, len(speeds), 2), middle - 1, middle, len(speeds) - 1])
        chosen, _ = few_points(speeds[own], curve[own], most)
        x, y = speeds[own][chosen], curve[own][chosen]
        numbers = {"speed_off": lines_off(x, y, speeds, curve)}
        held = [f"friction over speed, up to {speed:.3g} {plant.position_unit}/s (--speed)"]
        places, efforts = np.zeros(1), np.zeros(1)
        if plant.motion == "rotary":
            turn = np.linspace(0.0, 2.0 * np.pi, PLACES)
            needed = steady.position_effort(plant, turn)
            if np.any(needed):
                at, _ = few_points(turn, needed, most)
                places, efforts = turn[at], needed[at]
                # Beyond the turn as well: a wave of no whole order does not come back.
                dense = np.linspace(-2.0 * np.pi, 4.0 * np.pi, LOOKED_AT)
                whole = steady.position_effort(plant, dense)
                lines = np.interp(np.mod(dense, 2.0 * np.pi), places, efforts)
                numbers["position_off"] = float(np.max(np.abs(lines - whole)))
                held.append("effort over the position, a turn of it")
        else:
            efforts = steady.position_effort(plant, [0.0])
        lines = (*cls._off(plant, numbers), *_through_zero(plant, x, y))
        effects = frozenset(
            effect.name
            for effect in plant.effects
            if steady.in_curve(plant, effect) or _at_every_place(plant, effect)
        )
        lost = (*beside(plant, lambda each: each.name in effects, limited=False), *lines)
        return cls(x, y, places, efforts, tuple(held), lost, lines, effects, numbers)

    @staticmethod
    def _off(plant: Plant, numbers: dict[str, float]) -> tuple[str, ...]:
        static = steady.static_level(plant)
        what = {"speed_off": "friction over speed", "position_off": "effort over position"}
        return tuple(
            f"{what[name]} is interpolated between points, off by {off:.3g} "
            f"{plant.effort_unit} at most"
            for name, off in numbers.items()
            if off > ROUNDING * static
        )


def _through_zero(plant: Plant, speeds: FloatArray, friction: FloatArray) -> tuple[str, ...]:
    """What the line between the slowest speeds of both directions leaves out, a sentence."""
    after = int(np.searchsorted(speeds, 0.0))
    jump = 0.5 * abs(float(friction[after] - friction[after - 1]))
    slow = float(speeds[after])
    if jump <= steady.SEEN * steady.static_level(plant):
        return ()
    return (
        f"friction below {slow:.3g} {plant.position_unit}/s: a line through 0 there, off by up to "
        f"{jump:.3g} {plant.effort_unit}",
    )


def _at_every_place(plant: Plant, effect: Effect) -> bool:
    """Whether the efforts of places hold an effect: of a slide, the same one everywhere."""
    if not steady.in_position(plant, effect):
        return False
    alone = replace(plant, effects=(effect,), body={})
    return plant.motion == "rotary" or not np.ptp(steady.position_effort(alone, PROBED))
