"""Isaac Lab: the configuration of an actuator, static, dynamic and viscous friction with it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from ...plant.joint import body_losses, head_of, joint_of, losses_of, sidecar
from ..made import Export
from ..pd import PdServo
from ..runs import EffortRun, dry_friction

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "configuration of an actuator of Isaac Lab (friction, armature, limits, servo), Python"


def write(plant: Plant, speed: float) -> Export:
    """An actuator of one joint, to be put to those of an articulation."""
    joint, servo = joint_of(plant, speed), PdServo.of(plant)
    # It has a level of rest of its own.
    lost = list(losses_of(plant, replace(joint, static=joint.friction), limited=True))
    lost.append("true stick and break-away where Newton simulates: one level, as a soft constraint")
    lost += body_losses(plant, armature=True)
    numbers = {
        "armature": 0.0 if plant.prescribed_motion else float(plant.inertia),
        "friction": max(joint.static, joint.friction),
        "dynamic_friction": joint.friction,
        "viscous_friction": joint.damping,
    }
    held = ["inertia as armature", "break-away, Coulomb and viscous friction"]
    most = float(plant.drive.get("limit", math.inf)) * abs(plant.gain)
    if servo is not None:
        kind = "DCMotorCfg"
        numbers |= {
            "stiffness": servo.stiffness,
            "damping": servo.damping,
            "saturation_effort": servo.stall,
            "actuator_velocity_limit": servo.no_load,
            "actuator_effort_limit": servo.most,
        }
        held.append("proportional and derivative gain of the servo, and what its motor can")
        if servo.integral:
            lost.append("the integral of the servo")
    else:
        # Efforts are commanded; without these numbers those of the model's file would act.
        kind = "ImplicitActuatorCfg"
        numbers |= {"stiffness": 0.0, "damping": 0.0}
        if math.isfinite(most):
            numbers["joint_effort_limit"] = most
            held.append("the limit of the drive")
        if plant.servo:
            lost.append("the controller of the servo: its motor turns the other way round")
    rows = "".join(f"    {name}={value!r},\n" for name, value in numbers.items())
    text = (
        f"{head_of('Isaac Lab 3', plant, lost)}"
        f"from isaaclab.actuators import {kind}\n\n"
        f'JOINT = {kind}(\n    joint_names_expr=["joint"],\n{rows})\n'
    )
    files = {"actuator.py": text, "joint.json": sidecar(plant, numbers, tuple(lost))}
    return Export("isaaclab", files, tuple(held), tuple(lost), numbers)


def runs(made: Export, plant: Plant) -> tuple[EffortRun]:
    """The joint that was written, while it moves."""
    numbers = made.numbers
    return dry_friction(plant, numbers["dynamic_friction"], numbers["viscous_friction"])
