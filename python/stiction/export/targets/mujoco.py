"""MJCF: a joint with armature, damping and dry friction, its motor, and the plant beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ..._support.arrays import FloatArray
from ...plant.joint import body_losses, sidecar
from ..made import Export
from ..mjcf import STIFF, Attributes, Mjcf
from ..runs import MotionRun, Windows, gravity_effort

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "MJCF of a joint and its motor: friction or LuGre, cogging, limit, delay, servo"
LONGEST_STEP: Final = 1e-3
"""Of the simulator, s: a sample is divided into as few equal steps as are no longer."""
ROUNDING: Final = 1e-6
"""Of a sample."""
DRIVES: Final = 1
"""Group of actuators that is switched off with the drive."""


def write(plant: Plant, speed: float) -> Export:
    """A model of one joint that turns or slides freely."""
    made = Mjcf.of(plant, speed)
    lost = list(made.lost)
    if plant.servo and made.actuators[0][0] == "motor":
        lost.append("the controller of the servo: its motor is driven by current here")
    lost += body_losses(plant, armature=True)
    kind = "hinge" if plant.motion == "rotary" else "slide"
    stiff = STIFF if made.joint["frictionloss"] else {}
    own = _attributes({**made.joint, **stiff})
    actuators = "".join(
        f'    <{tag} joint="joint" {_attributes(attributes)}/>\n'
        for tag, attributes in made.actuators
    )
    # A body has to have a mass of its own; the armature is the inertia. Its centre is off the
    # joint, or MuJoCo would scale the friction of a slide by that mass alone.
    text = (
        '<mujoco model="plant">\n  <option integrator="implicitfast" gravity="0 0 0"/>\n'
        "  <worldbody>\n    <body>\n"
        f'      <joint name="joint" type="{kind}" axis="0 0 1" {own}/>\n'
        '      <inertial pos="1e-3 0 0" mass="1e-9" diaginertia="1e-9 1e-9 1e-9"/>\n'
        "    </body>\n  </worldbody>\n  <actuator>\n"
        f"{actuators}  </actuator>\n</mujoco>\n"
    )
    numbers = made.joint | {"gear": plant.gain}
    kept = tuple(lost)
    files = {"joint.xml": text, "joint.json": sidecar(plant, numbers, kept)}
    return Export("mujoco", files, made.held, kept, numbers)


def _attributes(numbers: Attributes) -> str:
    """As XML has them."""

    def text(value: str | float | tuple[float, ...]) -> str:
        return " ".join(map(repr, value)) if isinstance(value, tuple) else f"{value}"

    return " ".join(f'{name}="{text(value)}"' for name, value in numbers.items())


def runs(made: Export, plant: Plant) -> tuple[MotionRun, MotionRun]:
    """The model that was written, with the joint that MuJoCo has and with that of the callback.

    Its body is given the weight that the plant has, as whoever takes the joint is told to.
    """
    from ... import mujoco as joints

    mujoco = joints.simulator()

    def native(windows: Windows) -> FloatArray:
        model = mujoco.MjModel.from_xml_string(made.files["joint.xml"])
        led = _Led(plant, windows) if plant.friction.springy and model.na else None

        def step(data: Any, row: int | None) -> None:
            if row is not None and led is not None:
                data.act[-1] = _bent(plant, led.state_at(row))
            mujoco.mj_step(model, data)

        return _gone(mujoco, plant, model, windows, step)

    def with_callback(windows: Windows) -> FloatArray:
        model = mujoco.MjModel.from_xml_string(made.files["joint.xml"])
        joint = joints.attach(model, "joint", plant)
        led = _Led(joint.plant, windows)

        def step(data: Any, row: int | None) -> None:
            if row is not None:
                joint.reset()
                joint.state = led.state_at(row)
            joints.step(model, data, [joint])

        return _gone(mujoco, plant, model, windows, step)

    return MotionRun("", native), MotionRun("with the callback", with_callback)


def _bent(plant: Plant, state: Mapping[str, Any]) -> float:
    """How far the bristles of MuJoCo's lugre are bent in a state of the law."""
    if "deflection" in state:
        return float(state["deflection"])
    stiffness = plant.friction.model().parameters["initial_stiffness"]
    return float(state["dry_friction"]) / stiffness


class _Led:
    """A contact that is led along a measured motion, from one row to the next that is asked for."""

    def __init__(self, plant: Plant, windows: Windows) -> None:
        self._windows, self._row = windows, 0
        self._motor = replace(plant, drive={"kind": "prescribed_motion"}).follower()
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
    longest = windows.dt if windows.steps is None else float(np.max(windows.steps))
    parts = max(1, int(np.ceil(longest / LONGEST_STEP - 1e-6)))
    model.opt.timestep = windows.dt / parts
    # A drive that is off does nothing; the bristles of a joint are a motor too, and stay.
    model.actuator_group[0] = DRIVES
    data = mujoco.MjData(model)
    found = np.empty((len(windows.starts), windows.length))
    for window, start in enumerate(windows.starts.tolist()):
        mujoco.mj_resetData(model, data)
        begun = windows.velocity(start)
        data.qpos[0], data.qvel[0] = windows.position[start], begun
        if model.actuator_delay[0] > 0.0:
            number = int(model.actuator_history[0, 0])
            ago = model.opt.timestep * np.arange(-number, 0)
            before = start + np.floor(ago / windows.dt + ROUNDING).astype(int)
            inputs = np.where(before < 0, 0.0, windows.input[np.maximum(before, 0)])
            mujoco.mj_initCtrlHistory(model, data, 0, ago, inputs[:, None])
        row: int | None = start
        for sample in range(windows.length):
            data.ctrl[0] = windows.input[start + sample]
            model.opt.timestep = windows.duration(start + sample) / parts
            model.opt.disableactuator = 0 if windows.drives(start + sample) else 1 << DRIVES
            for _ in range(parts):
                borne = float(gravity_effort(plant, data.qpos)[0])
                data.qfrc_applied[0] = windows.load[start + sample] - borne
                step(data, row)
                row = None
            # Its steps hold the velocity of their ends: half a step of what it gained is too much.
            gained = data.qvel[0] - begun
            found[window, sample] = data.qpos[0] - 0.5 * model.opt.timestep * gained
    return found
