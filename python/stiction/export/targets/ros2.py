"""ROS 2: parameters of the friction compensation of the controllers of ``crisp_controllers``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from ..._support.arrays import FloatArray
from ...errors import InputError
from ...plant.joint import Joint, body_losses, joint_of, losses_of
from ..made import Export
from ..runs import EffortRun, gravity_effort

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "friction parameters of a ros2_control controller (crisp_controllers), YAML"
RISES_OVER: Final = 0.1
"""Share of the greatest speed over which the curve of a direction rises."""
RISEN: Final = 0.95
"""Share of the dry friction that it has reached there."""
LEAST_SHARE: Final = 1e-3
"""Of the friction of both directions, in one: a curve without friction in it has no parameters."""

HEAD: Final = """\
# Friction compensation of crisp_controllers (CartesianController, TorqueFeedbackController), made
# from a plant file by stiction. Put these parameters to those of your controller, under its name.
# Efforts in N m at the joint; joints from the base on, as the controller has them.
#
#     effort = fp1/(1 + exp(-fp2*(velocity + fp3))) - fp1/(1 + exp(-fp2*fp3))
#
# What it cannot hold:
{lost}
"""


def write(plant: Plant, speed: float) -> Export:
    """A controller of one joint, named "joint"."""
    return write_robot({"joint": plant}, {"joint": speed})


def write_robot(plants: Mapping[str, Plant], speeds: Mapping[str, float]) -> Export:
    """All joints of a robot in one file; plants and their greatest speeds by joint."""
    numbers: dict[str, float] = {}
    columns: dict[str, list[float]] = {"fp1": [], "fp2": [], "fp3": []}
    lost: list[str] = []
    for name, plant in plants.items():
        if plant.motion != "rotary":
            raise InputError(
                f"{plant.source}: the controllers of crisp_controllers take joints that turn, and "
                "this one is linear; export it to table or urdf"
            )
        joint = joint_of(plant, speeds[name])
        before = f"{name}: " if len(plants) > 1 else ""
        for parameter, value in _sigmoid(joint, speeds[name]).items():
            columns[parameter].append(value)
            numbers[f"{name}.{parameter}" if len(plants) > 1 else parameter] = value
        lost += [before + sentence for sentence in _losses(plant, joint, speeds[name])]
    rows = [
        f"      {name}: [{', '.join(map(_number, column))}]" for name, column in columns.items()
    ]
    text = HEAD.format(lost="\n".join(f"# - {each}" for each in lost))
    text += "\n".join(
        [
            "cartesian_impedance_controller:",
            "  ros__parameters:",
            f"    joints: [{', '.join(json.dumps(name) for name in plants)}]",
            "    use_friction: true",
            "    friction:",
            *rows,
        ]
    )
    held = ("dry friction of each direction",)
    return Export("ros2", {"friction.yaml": text + "\n"}, held, tuple(lost), numbers)


def runs(made: Export, plant: Plant) -> tuple[EffortRun]:
    """The curve that the controller makes of the parameters, under bodies of the plant's weight."""
    fp1, fp2, fp3 = (made.numbers[name] for name in ("fp1", "fp2", "fp3"))

    def effort(velocity: FloatArray, position: FloatArray) -> FloatArray:
        # As tanh, which does not overflow: 1/(1 + exp(-x)) = (1 + tanh(x/2))/2.
        found: FloatArray = 0.5 * fp1 * np.tanh(0.5 * fp2 * (velocity + fp3))
        found += gravity_effort(plant, position) - 0.5 * fp1 * np.tanh(0.5 * fp2 * fp3)
        return found

    return (EffortRun("", effort),)


def _sigmoid(joint: Joint, speed: float) -> dict[str, float]:
    """Parameters whose curve has the dry friction of each direction as its ends."""
    whole = joint.forward + joint.backward
    share = 0.5 if whole == 0.0 else joint.backward / whole
    share = min(max(share, LEAST_SHARE), 1.0 - LEAST_SHARE)
    # Both ends are reached as fast: of a middle that is 0 the slope is that of a tanh.
    steep = 2.0 * math.atanh(RISEN) / (RISES_OVER * speed)
    return {"fp1": whole, "fp2": steep, "fp3": math.log(share / (1.0 - share)) / steep}


def _losses(plant: Plant, joint: Joint, speed: float) -> tuple[str, ...]:
    """What is lost, a sentence each."""
    own = [*losses_of(plant, joint, directed=True), *body_losses(plant)]
    if joint.damping > 0.0:
        own.append(f"viscous friction: {joint.damping:.3g} {plant.effort_unit}·s/rad")
    own.append(
        f"rest: below {RISES_OVER * speed:.3g} rad/s it gives less than {100 * RISEN:.0f} % of the "
        "dry friction, in proportion to the measured velocity, and none at rest"
    )
    return tuple(own)


def _number(value: float) -> str:
    """A double of YAML: with a point, without which 1e-05 is a word."""
    text = repr(value)
    return text if "." in text or "e" not in text else text.replace("e", ".0e")
