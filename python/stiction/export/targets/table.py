"""Tables for drives and controllers: effort over speed, effort over position, kS kV kA kG."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.json_text import json_of
from ...plant.joint import WORTH_SAYING, Joint, joint_of
from ..curves import Curves
from ..made import Export
from ..runs import EffortRun

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "effort over speed and over position in at most 20 points (CSV, JSON), and kS kV kA kG"
MOST: Final = 20
"""Points: what drives and controllers have room for."""


def write(plant: Plant, speed: float) -> Export:
    """Points of the curves; lines between them are off by as little as they can be."""
    curves, joint = Curves.of(plant, speed, MOST), joint_of(plant, speed)
    gains = {
        "kS": joint.friction / plant.gain,
        "kV": joint.damping / plant.gain,
        "kA": (0.0 if plant.prescribed_motion else plant.inertia) / plant.gain,
    }
    if plant.gravity:
        zero = plant.body.get("gravity_zero_rad")
        # Of a cosine, whose angle is counted from where the arm is level.
        gains["kG"] = plant.gravity / plant.gain
        gains["level_rad"] = (0.0 if zero is None else zero.value) + 0.5 * math.pi
    elif plant.weight:
        gains["kG"] = plant.weight / plant.gain
    lost = (*curves.lost, *_one_line(plant, joint))
    table = {
        "schema": 1,
        "speed": {"velocity": curves.speeds.tolist(), "effort": curves.friction.tolist()},
        "position": {"position": curves.places.tolist(), "effort": curves.efforts.tolist()},
        "gains": gains,
        # People read this file, and not what was printed.
        "lost": list(lost),
    }
    files = {
        "speed.csv": _csv(("velocity", "effort"), curves.speeds, curves.friction),
        "position.csv": _csv(("position", "effort"), curves.places, curves.efforts),
        "table.json": json_of(table) + "\n",
    }
    unit = "A" if plant.servo else "units of the input"
    held = (*curves.held, f"kS, kV, kA and, where it hangs, kG, in {unit}")
    return Export("table", files, held, lost, curves.numbers | gains)


def runs(made: Export, plant: Plant) -> tuple[EffortRun]:
    """Lines between the points that were written."""
    table = json.loads(made.files["table.json"])
    speed, place = table["speed"], table["position"]

    def effort(velocity: FloatArray, position: FloatArray) -> FloatArray:
        at = np.mod(position, place["position"][-1]) if place["position"][-1] else position
        found: FloatArray = np.interp(velocity, speed["velocity"], speed["effort"])
        found += np.interp(at, place["position"], place["effort"])
        return found

    return (EffortRun("", effort),)


def _one_line(plant: Plant, joint: Joint) -> tuple[str, ...]:
    """What kS and kV, one line for both directions, leave out of friction, a sentence each."""
    unit, lost = plant.effort_unit, []
    worth = WORTH_SAYING * max(joint.friction, 1e-300)
    if joint.one_sided > worth:
        lost.append(f"kS: friction of the two directions differs by {joint.one_sided:.3g} {unit}")
    if joint.off > worth:
        lost.append(f"kS and kV: off by up to {joint.off:.3g} {unit}, at {joint.at:.3g} per s")
    return tuple(lost)


def _csv(names: tuple[str, str], first: np.ndarray, second: np.ndarray) -> str:
    rows = (f"{x!r},{y!r}" for x, y in zip(first.tolist(), second.tolist(), strict=True))
    return "\n".join([",".join(names), *rows]) + "\n"
