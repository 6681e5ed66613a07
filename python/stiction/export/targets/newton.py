"""Newton: the axis of a joint and, of a servo, its actuator, as functions of a model builder."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...plant.joint import body_losses, head_of, joint_of, losses_of, sidecar
from ..made import Export
from ..mjcf import LATE
from ..pd import PdServo
from ..runs import EffortRun, dry_friction

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "axis of a joint and actuator of a servo for a model builder of Newton, Python"
CREEPS = "true stick: friction of a joint is a soft constraint, under which it creeps at rest"


def write(plant: Plant, speed: float) -> Export:
    """A joint of one axis; its numbers go into the joint that people have."""
    joint, servo = joint_of(plant, speed), PdServo.of(plant)
    late = next((e.parameters["delay"].value for e in plant.effects if e.name == LATE), 0)
    own = {LATE} if servo is not None and late else set()
    lost = [
        *losses_of(plant, joint, limited=True, own=own),
        CREEPS,
        *body_losses(plant, armature=True),
    ]
    held = ["inertia as armature", "Coulomb and viscous friction"]
    numbers = {
        "armature": 0.0 if plant.prescribed_motion else float(plant.inertia),
        "friction": joint.friction,
        "damping": joint.damping,
    }
    most = float(plant.drive.get("limit", math.inf)) * abs(plant.gain)
    if servo is not None:
        held.append("proportional and derivative gain of the servo, and what its motor can")
        held += own
        if servo.integral:
            lost.append("the integral of the servo")
    elif plant.servo:
        lost.append("the controller of the servo: its motor turns the other way round")
    if math.isfinite(most):
        numbers["effort_limit"] = most
        held.append("the limit of the drive")
    rows = "".join(f"        {name}={value!r},\n" for name, value in numbers.items())
    text = (
        f"{head_of('Newton 1.8', plant, lost)}import newton\n\n\n"
        "def axis(direction=newton.Axis.Z):\n"
        '    """For builder.add_joint_revolute, add_joint_prismatic and add_joint_d6."""\n'
        f"    return newton.ModelBuilder.JointDofConfig(\n        axis=direction,\n{rows}    )\n"
    )
    if servo is not None:
        text += _actuator(servo, late)
        numbers |= {"kp": servo.stiffness, "kd": servo.damping}
    files = {"joint.py": text, "joint.json": sidecar(plant, numbers, tuple(lost))}
    return Export("newton", files, tuple(held), tuple(lost), numbers)


def runs(made: Export, plant: Plant) -> tuple[EffortRun]:
    """The joint that was written, while it moves."""
    return dry_friction(plant, made.numbers["friction"], made.numbers["damping"])


def _actuator(servo: PdServo, late: float) -> str:
    return f'''

def add_servo(builder, dof{", dt" if late else ""}):
    """The servo of a degree of freedom; its goal is control.joint_target_q."""
    limits = {{
        "saturation_effort": {servo.stall!r},
        "velocity_limit": {servo.no_load!r},
        "max_motor_effort": {servo.most!r},
    }}
    builder.add_actuator(
        newton.actuators.DrivePD,
        index=dof,
        clamping=[(newton.actuators.ClampingDCMotor, limits)],
        delay_steps={f"round({late!r} / dt)" if late else None},
        kp={servo.stiffness!r},
        kd={servo.damping!r},
    )
'''
