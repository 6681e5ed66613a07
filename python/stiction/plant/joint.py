"""A plant as the joint that most simulators have: armature, damping and dry friction."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.json_text import json_of
from . import steady

if TYPE_CHECKING:
    from . import Plant
    from .stated import Effect

__all__ = [
    "Joint",
    "acts",
    "beside",
    "body_losses",
    "head_of",
    "joint_of",
    "loop_losses",
    "losses_of",
    "sidecar",
    "speeds_up_to",
]

SPEEDS: Final = 200
PROBED: Final = 10.0
"""Greatest speed for asking whether an effect changes a joint at all, rad/s or m/s."""
SLOWEST: Final = 1e-3
"""Share of the greatest speed from which on a curve is looked at."""
WORTH_SAYING: Final = 0.01
"""Share of the dry friction by which something may be off and nobody needs to be told."""


@dataclass(frozen=True)
class Joint:
    """Dry friction and damping that are nearest to a friction curve.

    Attributes
    ----------
    friction : float
        N·m or N.
    damping : float
        N·m·s/rad or N·s/m.
    forward, backward : float
        Dry friction of each direction by itself, N·m or N.
    off : float
        Greatest distance from the curve, N·m or N.
    at : float
        Speed of that, rad/s or m/s.
    static : float
        Friction of the slowest slide, N·m or N.
    one_sided : float
        By how much friction differs between the directions, at most, N·m or N.
    """

    friction: float
    damping: float
    forward: float
    backward: float
    off: float
    at: float
    static: float
    one_sided: float


def speeds_up_to(speed: float) -> FloatArray:
    """Speeds of both directions up to a greatest one, rising, without 0."""
    one_way = speed * np.geomspace(SLOWEST, 1.0, SPEEDS)
    return np.concatenate([-one_way[::-1], one_way])


def joint_of(plant: Plant, speed: float) -> Joint:
    """Least squares over the curve, all speeds alike, neither number below 0."""
    one_way = np.linspace(speed * SLOWEST, speed, SPEEDS)
    forth = steady.friction_curve(plant, one_way)
    back = -steady.friction_curve(plant, -one_way)
    mean = 0.5 * (forth + back)
    friction, damping = _line(one_way, mean)
    off = np.abs(mean - friction - damping * one_way)
    worst = int(np.argmax(off))
    return Joint(
        friction,
        damping,
        _line(one_way, forth)[0],
        _line(one_way, back)[0],
        float(off[worst]),
        float(one_way[worst]),
        steady.static_level(plant),
        float(np.max(np.abs(forth - back))),
    )


def _line(speeds: FloatArray, friction: FloatArray) -> tuple[float, float]:
    """Dry friction and damping nearest to the friction of one direction, neither below 0."""
    columns = np.column_stack([np.ones(len(speeds)), speeds])
    dry, damping = np.linalg.lstsq(columns, friction, rcond=None)[0]
    if damping < 0.0:
        dry, damping = np.mean(friction), 0.0
    if dry < 0.0:
        dry, damping = 0.0, max(speeds @ friction / (speeds @ speeds), 0.0)
    return float(dry), float(damping)


def losses_of(
    plant: Plant,
    joint: Joint,
    *,
    limited: bool = False,
    directed: bool = False,
    own: Collection[str] = (),
) -> tuple[str, ...]:
    """What a joint of these numbers cannot hold, a sentence each.

    ``limited`` says whether the target has the limit of the drive, ``directed`` whether it has the
    dry friction of each direction; ``own`` names effects that it has beside these numbers.
    """
    unit, lost = plant.effort_unit, []
    per = f"{plant.position_unit}/s"
    worth = WORTH_SAYING * max(joint.friction, 1e-300)
    if joint.off > worth:
        lost.append(
            f"the curve of friction over speed is off by {joint.off:.3g} {unit} at most, at "
            f"{joint.at:.3g} {per}"
        )
    if joint.static - joint.friction > worth:
        lost.append(
            f"break-away: {joint.static:.3g} {unit} at the slowest speed, where it has "
            f"{joint.friction:.3g} {unit}"
        )
    if joint.one_sided > worth and not directed:
        lost.append(f"friction of the two directions differs by {joint.one_sided:.3g} {unit}")

    def held(effect: Effect) -> bool:
        return effect.name in own or _changes(plant, effect, directed=directed)

    return (*lost, *beside(plant, held, limited=limited))


def beside(
    plant: Plant, held: Callable[[Effect], bool], *, limited: bool, yielding: bool = False
) -> tuple[str, ...]:
    """What a target cannot hold beside friction over the speed, a sentence each.

    ``held`` says whether it has an effect, ``limited`` whether it has the limit of the drive,
    ``yielding`` whether it has contacts that yield.
    """
    lost = []
    if plant.friction.springy and not yielding:
        lost.append(f"pre-sliding: a contact of {plant.friction.law} yields before it slides")
    acting = [each for each in plant.effects if acts(each)]
    lost += [f"{each.name}: {each.record.summary}" for each in acting if not held(each)]
    limit = float(plant.drive.get("limit", np.inf))
    if np.isfinite(limit) and not limited:
        lost.append(f"the limit of the drive: {limit:.6g} of its input")
    return tuple(lost)


def body_losses(plant: Plant, *, armature: bool = False) -> tuple[str, ...]:
    """What of a plant the bodies of a simulator have to have, a sentence each.

    ``armature`` says whether the target has its whole inertia already, a payload's with it.
    """
    unit, told = plant.effort_unit, []
    inertia = "kg·m²" if plant.motion == "rotary" else "kg"
    if plant.gravity:
        told.append(f"a pendulum of {plant.gravity:.6g} {unit}: give the body its mass")
    if plant.weight:
        told.append(f"a weight of {plant.weight:.6g} {unit}: give the body its mass")
    if told and armature:
        carried = plant.payload[0]
        share = f"{carried:.3g} {inertia} of the payload" if carried else "what of it is the body's"
        told.append(f"armature beside a body that has its mass: take off {share}")
    return tuple(told)


def loop_losses(plant: Plant) -> tuple[str, ...]:
    """What of a servo a joint without a drive has not, a sentence each."""
    if not plant.servo:
        return ()
    unit = f"{plant.effort_unit}·s/{plant.position_unit}"
    damping = plant.gain**2 / float(plant.drive["resistance_ohm"])
    return (
        "the position loop of the servo: give the joint a controller",
        f"damping of {damping:.3g} {unit} by the motor's own voltage: add it to the controller's",
    )


def acts(effect: Effect) -> bool:
    """Whether an effect does anything: one of its gains is not 0, or it has none."""
    gains = [effect.parameters[name] for name in effect.record.gains if name in effect.parameters]
    return not gains or any(each.value != 0.0 for each in gains)


def _changes(plant: Plant, effect: Effect, *, directed: bool) -> bool:
    """Whether an effect changes the numbers of a joint, those of each direction where it is."""
    without = replace(plant, effects=tuple(e for e in plant.effects if e.name != effect.name))
    one, other = (joint_of(each, PROBED) for each in (plant, without))
    changed = abs(one.friction - other.friction) + PROBED * abs(one.damping - other.damping)
    if directed:
        changed += abs(one.forward - other.forward) + abs(one.backward - other.backward)
    return changed > steady.SEEN * (other.friction + PROBED * other.damping)


def sidecar(plant: Plant, numbers: dict[str, float], lost: tuple[str, ...]) -> str:
    """The whole plant beside what the target holds of it, as JSON."""
    return (
        json_of({"schema": 1, "plant": plant.to_dict(), "numbers": numbers, "lost": list(lost)})
        + "\n"
    )


def head_of(tool: str, plant: Plant, lost: Sequence[str]) -> str:
    """Head of a file of Python for a tool: units, and what it cannot hold."""
    rows = "".join(f"# - {each}\n" for each in lost)
    return (
        f"# A joint of {tool}, made from a plant file by stiction. Efforts in\n"
        f"# {plant.effort_unit}, speeds in {plant.position_unit}/s. What it cannot hold:\n{rows}"
    )
