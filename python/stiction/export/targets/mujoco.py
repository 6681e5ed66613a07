"""MJCF: a joint with armature, damping and dry friction, its motor, and the plant beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..joint import joint_of, sidecar, told
from ..made import Export

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "MJCF of a joint (armature, damping, frictionloss) and of its motor (gear, limit)"
CREEPS = (
    "true stick: frictionloss of MuJoCo is a soft constraint, under which a joint at rest creeps"
)


def write(plant: Plant, speed: float) -> Export:
    """A model of one joint that turns or slides freely."""
    joint, inertia = joint_of(plant, speed), float(plant.inertia)
    lost = [*told(plant, joint, limited=True), CREEPS]
    held = ["inertia as armature", "Coulomb and viscous friction"]
    limit = float(plant.drive.get("limit", np.inf))
    limited = ""
    if np.isfinite(limit):
        limited = f' ctrllimited="true" ctrlrange="{-limit!r} {limit!r}"'
        held.append("the limit of the drive")
    if plant.servo:
        lost.append("the controller of the servo: its motor is driven by current here")
    if plant.gravity:
        lost.append(
            f"a pendulum of {plant.gravity:.6g} {plant.effort_unit}: give the body its mass"
        )
    if plant.weight:
        lost.append(f"a weight of {plant.weight:.6g} {plant.effort_unit}: give the body its mass")
    kind = "hinge" if plant.motion == "rotary" else "slide"
    # A body has to have a mass of its own; the armature is the inertia.
    text = (
        '<mujoco model="plant">\n  <option integrator="implicitfast" gravity="0 0 0"/>\n'
        "  <worldbody>\n    <body>\n"
        f'      <joint name="joint" type="{kind}" axis="0 0 1" armature="{inertia!r}"'
        f' damping="{joint.damping!r}" frictionloss="{joint.friction!r}"/>\n'
        '      <inertial pos="0 0 0" mass="1e-9" diaginertia="1e-9 1e-9 1e-9"/>\n'
        "    </body>\n  </worldbody>\n  <actuator>\n"
        f'    <motor name="motor" joint="joint" gear="{plant.gain!r}"{limited}/>\n'
        "  </actuator>\n</mujoco>\n"
    )
    numbers = {"armature": inertia, "damping": joint.damping, "frictionloss": joint.friction}
    numbers["gear"] = plant.gain
    kept = tuple(lost)
    files = {"joint.xml": text, "joint.json": sidecar(plant, numbers, kept)}
    return Export("mujoco", files, tuple(held), kept, numbers)
