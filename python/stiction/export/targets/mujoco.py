"""MJCF: a joint with armature, damping and dry friction, its motor, and the plant beside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ..._support.arrays import FloatArray
from ...errors import InputError
from ...plant.joint import joint_of, losses_of, sidecar
from ..made import Export
from ..runs import MotionRun, Windows, gravity_effort

if TYPE_CHECKING:
    from ...mujoco import Joint
    from ...plant import Plant

SUMMARY = "MJCF of a joint (armature, damping, frictionloss) and of its motor (gear, limit)"
LONGEST_STEP: Final = 1e-3
"""Of the simulator, s: a sample is divided into as few equal steps as are no longer."""
CREEPS = (
    "true stick: frictionloss of MuJoCo is a soft constraint, under which a joint at rest creeps"
)


def write(plant: Plant, speed: float) -> Export:
    """A model of one joint that turns or slides freely."""
    joint, inertia = joint_of(plant, speed), float(plant.inertia)
    lost = [*losses_of(plant, joint, limited=True), CREEPS]
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


def runs(made: Export, plant: Plant) -> tuple[MotionRun, MotionRun]:
    """The model that was written, with the joint that MuJoCo has and with that of the callback.

    Its body is given the weight that the plant has, as whoever takes the joint is told to.
    """
    from ... import mujoco as joints

    if plant.servo:
        raise InputError(
            "mujoco: the input of a servo is a goal, and the motor that was written takes a "
            "current; a model with the controller cannot be made from here"
        )
    mujoco = joints.simulator()

    def native(windows: Windows) -> FloatArray:
        model = mujoco.MjModel.from_xml_string(made.files["joint.xml"])
        return _gone(mujoco, plant, model, windows, lambda data, _: mujoco.mj_step(model, data))

    def with_callback(windows: Windows) -> FloatArray:
        model = mujoco.MjModel.from_xml_string(made.files["joint.xml"])
        joint = joints.attach(model, "joint", plant)
        led = _Led(joint, windows)

        def step(data: Any, row: int | None) -> None:
            if row is not None:
                joint.reset()
                joint.state = led.state_at(row)
            joints.step(model, data, [joint])

        return _gone(mujoco, plant, model, windows, step)

    return MotionRun("", native), MotionRun("with the callback", with_callback)


class _Led:
    """A contact that is led along a measured motion, from one row to the next that is asked for."""

    def __init__(self, joint: Joint, windows: Windows) -> None:
        self._windows, self._row = windows, 0
        self._motor = replace(joint.plant, drive={"kind": "prescribed_motion"}).follower()
        at = float(windows.position[0])
        self._motor.reset(at, 0.0, time=windows.clock, path=windows.path)
        self._contact = windows.contact

    def state_at(self, row: int) -> dict[str, Any]:
        """State of the contact at a row, which is not before the last one."""
        if row > self._row:
            motion = self._windows.motion(self._row, row)
            self._motor.follow(motion, start=self._contact, strict=False)
            self._row, self._contact = row, None
        return self._motor.state


def _gone(
    mujoco: Any,
    plant: Plant,
    model: Any,
    windows: Windows,
    step: Callable[[Any, int | None], None],
) -> FloatArray:
    """Where a model gets to in windows; ``step`` gets the row where a new one starts."""
    parts = max(1, int(np.ceil(windows.dt / LONGEST_STEP - 1e-6)))
    model.opt.timestep = windows.dt / parts
    data = mujoco.MjData(model)
    found = np.empty((len(windows.starts), windows.length))
    for window, start in enumerate(windows.starts.tolist()):
        mujoco.mj_resetData(model, data)
        data.qpos[0], data.qvel[0] = windows.position[start], windows.velocity(start)
        row: int | None = start
        for sample in range(windows.length):
            data.ctrl[0] = windows.input[start + sample]
            for _ in range(parts):
                borne = float(gravity_effort(plant, data.qpos)[0])
                data.qfrc_applied[0] = windows.load[start + sample] - borne
                step(data, row)
                row = None
            found[window, sample] = data.qpos[0]
    return found
