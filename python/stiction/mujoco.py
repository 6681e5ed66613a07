"""Joints of MuJoCo with the friction of a plant, every law and what effects make of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ._support import given
from ._support.arrays import FloatArray
from .errors import InputError
from .motor import Motor
from .plant import Plant
from .plant.parameter import Parameter

if TYPE_CHECKING:
    from .plant.stated import Effect

__all__ = ["Joint", "attach", "patch", "simulator", "step"]

AS_FOUND: Final = 1e-9
"""Share of the change of a velocity by which the simulator may miss it through rounding alone."""
SAME: Final = 1e-12
"""Share by which an inertia may change before the motor is made anew."""
SWEEPS: Final = 60
"""Times that joints which move each other are asked at most,"""
SETTLED: Final = 1e-10
"""and share of the greatest friction by which it still changes when they are not any more."""
NUDGES: Final = 4
NO_AXIS: Final = "joint = '{}' is no hinge and no slide; friction of a plant has one axis"


class Joint:
    """A joint of a model whose friction is that of a plant.

    Made by ``attach``. One belongs to one ``MjData``; ``copy`` makes another for the next. Where
    the time of that goes back (``mj_resetData``) and no state was set, the contact begins anew.

    Attributes
    ----------
    name : str
    plant : Plant
        What acts here: law, effects at the contact, added efforts.
    lost : tuple of str
        What of the given plant does not act here, a sentence each.
    friction : float
        Effort of the last step, N·m or N, positive where it resists motion along +x.
    """

    def __init__(self, model: Any, name: str, plant: Plant) -> None:
        self.name, self.friction = name, 0.0
        self._model = model
        self._number, self._place, self._dof = _places(model, name)
        kept = tuple(e for e in plant.effects if e.record.at_contact)
        self.lost = tuple(_sentences(plant, kept))
        moved = {"input": "torque_nm" if plant.motion == "rotary" else "force_n", "gain": 1.0}
        self.plant = replace(plant, drive=moved, body={}, effects=kept, sensor={}, controller={})
        self._inertia = float("nan")
        self._motor: Motor | None = None
        self._begun: dict[str, Any] | None = None
        # The data and the time of the last step; none where what comes next is another run.
        self._last: tuple[int, float] | None = None

    @property
    def state(self) -> dict[str, Any]:
        """State of the contact, as ``Motor.state`` has it; set, it goes on to the bit."""
        if self._motor is None:
            return dict(self._begun or self._made(1.0).state)
        return self._motor.state

    @state.setter
    def state(self, value: dict[str, Any]) -> None:
        self._last = None
        if self._motor is None:
            self._made(1.0).state = value
            self._begun = dict(value)
        else:
            self._motor.state = value

    def reset(self) -> None:
        """A contact that was never moved."""
        self._motor = self._begun = self._last = None
        self._inertia, self.friction = float("nan"), 0.0

    def copy(self) -> Joint:
        """The same joint for another ``MjData``, with the present state."""
        other = Joint(self._model, self.name, self.plant)
        other.lost, other.friction = self.lost, self.friction
        other._begun = dict(self.state)
        return other

    def _begin(self, data: Any) -> None:
        """A step of this data comes next: of no other than the last, unless something was set."""
        if self._last is None:
            return
        own, time = self._last
        if own != id(data):
            raise InputError(
                f"joint '{self.name}' has the state of another MjData; give this one a joint of "
                "its own (joint.copy()), or begin anew (joint.reset())"
            )
        if data.time < time:
            self.reset()

    def _made(self, inertia: float) -> Motor:
        body = {"inertia": Parameter(inertia, fixed=True)}
        return replace(self.plant, body=body).motor()

    def _with(self, inertia: float) -> Motor:
        """The motor with the inertia that the joint has where it stands."""
        if self._motor is None or not abs(inertia - self._inertia) <= SAME * inertia:
            state = self._begun if self._motor is None else self._motor.state
            self._motor, self._inertia = self._made(inertia), inertia
            if state is not None:
                self._motor.state = state
            self._begun = None
        return self._motor

    def _goes(
        self, data: Any, effort: float, inertia: float, span: float
    ) -> tuple[Motor, float, float]:
        """The motor after a step under an effort, its velocity then, and the mean friction."""
        motor = self._with(inertia).copy()
        before = float(data.qvel[self._dof])
        at = float(data.qpos[self._place])
        motor.state = {**motor.state, "position": at, "velocity": before}
        # What no motor gives loads the contact from outside: friction may go with it.
        drive = float(data.qfrc_actuator[self._dof])
        _, velocity = motor.step(drive, span, load=effort - drive)
        return motor, velocity, effort - inertia * (velocity - before) / span


def attach(model: Any, joint: str, plant: Plant, *, armature: bool = True) -> Joint:
    """Give a joint of a model the friction of a plant.

    Damping and frictionloss of the joint become 0, and motors on it that have no input (of
    ``patch``, say) act no longer, for the plant has its own friction; with ``armature`` that
    becomes the inertia of the plant. Simulate with ``step`` of this module in the place of
    ``mujoco.mj_step``.

    Parameters
    ----------
    model : mujoco.MjModel
        With an Euler integrator, or implicit ones.
    joint : str
        Name of a hinge or a slide.
    plant : Plant
    armature : bool, optional
        False where the model has the inertia of the drive already.

    Returns
    -------
    Joint

    Raises
    ------
    InputError
        No such joint, one that is no hinge or slide, a plant that moves otherwise, an integrator
        of several stages; MuJoCo is missing.
    """
    made = Joint(
        model, given.word(joint, "joint"), given.instance(plant, Plant, "plant", "a Plant")
    )
    hinge = int(model.jnt_type[made._number]) == int(simulator().mjtJoint.mjJNT_HINGE)
    _check_motion(joint, plant, hinge)
    dof = made._dof
    model.dof_damping[dof] = model.dof_frictionloss[dof] = 0.0
    for actuator in range(len(model.actuator_trntype)):
        on_joint = int(model.actuator_trntype[actuator]) == int(simulator().mjtTrn.mjTRN_JOINT)
        at = int(model.actuator_trnid[actuator, 0])
        if on_joint and int(model.jnt_dofadr[at]) == dof and not model.actuator_ctrlnum[actuator]:
            model.actuator_gear[actuator] = 0.0
    if armature and "inertia" in plant.body:
        model.dof_armature[dof] = plant.inertia
    return made


def patch(
    spec: Any, joint: str, plant: Plant, *, speed: float | None = None, drive: bool = True
) -> tuple[str, ...]:
    """Write a plant into a joint of a model that is being edited, as ``export("mujoco")`` does.

    MuJoCo's own elements act: armature, damping and frictionloss, or a ``dcmotor`` without an input
    for a law that its LuGre has, and for cogging; the motor, with delay, limit, or the controller
    of a servo. ``attach`` has every law and effect.

    Parameters
    ----------
    spec : mujoco.MjSpec
    joint : str
        Name of a hinge or a slide.
    plant : Plant
    speed : float, optional
        Greatest speed at which friction matters, rad/s or m/s; as for ``Plant.export``.
    drive : bool, optional
        False where the model has the motor of this joint already.

    Returns
    -------
    tuple of str
        What it cannot hold, a sentence each.

    Raises
    ------
    InputError
        No such joint, one that is no hinge or slide, a plant that moves otherwise; MuJoCo is
        missing.
    """
    from .export.mjcf import STIFF, Mjcf
    from .export.speeds import greatest_speed

    mujoco = simulator()
    given.instance(plant, Plant, "plant", "a Plant")
    own = spec.joint(given.word(joint, "joint"))
    if own is None:
        names = ", ".join(each.name for each in spec.joints)
        raise InputError(f"joint = '{joint}' is not in the model; there are {names}")
    hinge = own.type == mujoco.mjtJoint.mjJNT_HINGE
    if not hinge and own.type != mujoco.mjtJoint.mjJNT_SLIDE:
        raise InputError(NO_AXIS.format(joint))
    _check_motion(joint, plant, hinge)
    made = Mjcf.of(plant, greatest_speed(plant, speed))
    own.armature, own.frictionloss = made.joint["armature"], made.joint["frictionloss"]
    own.solref_friction[:], own.solimp_friction[:3] = STIFF.values()
    own.damping[:] = [made.joint["damping"], *[0.0] * (len(own.damping) - 1)]
    for tag, attributes in made.actuators if drive else made.actuators[1:]:
        named = {"name": f"{joint}_{attributes['name']}", "target": joint}
        actuator = spec.add_actuator(trntype=mujoco.mjtTrn.mjTRN_JOINT, **named)
        _set(mujoco, actuator, tag, dict(attributes))
    return made.lost


def _set(mujoco: Any, actuator: Any, tag: str, given_as: dict[str, Any]) -> None:
    """Attributes of MJCF, on an actuator of a specification."""
    del given_as["name"]
    if tag == "motor":
        actuator.set_to_motor()
    else:
        inputs = {"none": mujoco.mjtCtrlInput.mjINPUT_NONE, "pos": mujoco.mjtCtrlInput.mjINPUT_POS}
        names = given_as.keys() - {"input", "delay", "nsample"}
        own = {name: given_as.pop(name) for name in names}
        actuator.set_to_dcmotor(**own, ctrlspec=int(inputs[given_as.pop("input")]))
    if "gear" in given_as:
        actuator.gear[0] = given_as.pop("gear")
    if "ctrllimited" in given_as:
        actuator.ctrllimited = given_as.pop("ctrllimited") == "true"
    for name, value in given_as.items():
        setattr(actuator, name, value)


def step(model: Any, data: Any, joints: Sequence[Joint] | Joint) -> None:
    """Take one step of a simulation, as ``mujoco.mj_step`` does, with the friction of these joints.

    Each joint is a motor with the inertia that the rest of the robot leaves it, under all efforts
    but those of constraints (contacts, limits), for the time step: its law decides whether it
    sticks and where within the step it breaks away. Joints that move each other are asked in turn
    until their friction does not change any more.

    Parameters
    ----------
    model : mujoco.MjModel
    data : mujoco.MjData
    joints : sequence of Joint, or Joint
        Of ``attach``, each in the state that belongs to ``data``.

    Raises
    ------
    InputError
        As a motor refuses: a time step that is too long for the contact, efforts that are no
        numbers. A joint that went with another ``MjData``.
    """
    mujoco, span = simulator(), float(model.opt.timestep)
    joints = [joints] if isinstance(joints, Joint) else joints
    for joint in joints:
        joint._begin(data)
    mujoco.mj_step1(model, data)
    mujoco.mj_fwdActuation(model, data)
    mujoco.mj_fwdAcceleration(model, data)
    free, dofs = np.array(data.qacc_smooth), [joint._dof for joint in joints]
    answers = np.array([_answer(mujoco, model, data, dof) for dof in dofs]).reshape(-1, model.nv)
    acted, before = np.array(data.qfrc_applied), np.array(data.qvel)
    went = _together(data, joints, free, answers, span)
    stuck = {
        dof
        for dof, (_, velocity, _) in zip(dofs, went, strict=True)
        if velocity == 0.0 == before[dof]
    }
    for dof, (_, _, friction) in zip(dofs, went, strict=True):
        data.qfrc_applied[dof] = acted[dof] - friction
    for dof, answer in zip(dofs, answers, strict=True):
        if dof in stuck and stuck.issuperset(np.flatnonzero(answer).tolist()):
            _balance(data, dof)
    mujoco.mj_step2(model, data)
    data.qfrc_applied[:] = acted
    for joint, (motor, velocity, friction) in zip(joints, went, strict=True):
        missed = abs(float(data.qvel[joint._dof]) - velocity)
        change = max(abs(velocity), abs(float(before[joint._dof])), abs(friction) * span)
        if missed <= AS_FOUND * change:
            data.qvel[joint._dof] = velocity
        joint._motor, joint.friction = motor, friction
        joint._last = (id(data), float(data.time))


def _together(
    data: Any, joints: Sequence[Joint], free: FloatArray, answers: FloatArray, span: float
) -> list[tuple[Motor, float, float]]:
    """Where each joint goes, with the friction of all of them.

    ``free`` has the accelerations without it, ``answers`` those by a unit of effort on each joint.
    Joints that rest are held, and released one after the other where the law of one does not bear
    what the others leave it: a joint beside one that rests has more inertia than beside a free one.
    """
    dofs = [joint._dof for joint in joints]
    free, mobility = free[dofs], answers[:, dofs]
    frictions = np.zeros(len(joints))
    went: dict[int, tuple[Motor, float, float]] = {}

    def ask(k: int, held: list[int]) -> float:
        """Asks one joint; by how much its friction changed."""
        others = [i for i in range(len(joints)) if i != k and i not in held]
        left = free - mobility[:, others] @ frictions[others]
        own, at = float(mobility[k, k]), float(left[k])
        if held:
            block = mobility[np.ix_(held, held)]
            own -= float(mobility[k, held] @ np.linalg.solve(block, mobility[held, k]))
            at -= float(mobility[k, held] @ np.linalg.solve(block, left[held]))
        went[k] = joints[k]._goes(data, at / own, 1.0 / own, span)
        change = abs(went[k][2] - float(frictions[k]))
        frictions[k] = went[k][2]
        return change

    held = [k for k in range(len(joints)) if float(data.qvel[dofs[k]]) == 0.0]
    while True:
        moving = [k for k in range(len(joints)) if k not in held]
        for _ in range(SWEEPS if len(moving) > 1 else 1):
            change = max((ask(k, held) for k in moving), default=0.0)
            if change <= SETTLED * float(np.max(np.abs(frictions), initial=0.0)):
                break
        for k in held:
            ask(k, [i for i in held if i != k])
        released = [k for k in held if went[k][1] != 0.0]
        if not released:
            return [went[k] for k in range(len(joints))]
        # The one that is pushed most: it may relieve the others.
        held.remove(max(released, key=lambda k: abs(went[k][1])))


def _balance(data: Any, dof: int) -> None:
    """Lets the efforts on a joint at rest sum up to 0, to the last bit."""
    others = float(data.qfrc_passive[dof]) - float(data.qfrc_bias[dof])
    for _ in range(NUDGES):
        left = (others + float(data.qfrc_applied[dof])) + float(data.qfrc_actuator[dof])
        if left == 0.0:
            return
        data.qfrc_applied[dof] -= left


def _answer(mujoco: Any, model: Any, data: Any, dof: int) -> FloatArray:
    """Accelerations by a unit of effort on one degree of freedom; shape (nv,)."""
    unit, answer = np.zeros((1, model.nv)), np.zeros((1, model.nv))
    unit[0, dof] = 1.0
    mujoco.mj_solveM(model, data, answer, unit)
    own: FloatArray = answer[0]
    return own


def _places(model: Any, name: str) -> tuple[int, int, int]:
    """Which joint it is, and where it stands in positions and in velocities."""
    mujoco = simulator()
    kind = mujoco.mjtJoint
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
    if number < 0:
        names = [model.joint(k).name for k in range(model.njnt)]
        raise InputError(f"joint = '{name}' is not in the model; there are {', '.join(names)}")
    if int(model.jnt_type[number]) not in (int(kind.mjJNT_HINGE), int(kind.mjJNT_SLIDE)):
        raise InputError(NO_AXIS.format(name))
    if int(model.opt.integrator) == int(mujoco.mjtIntegrator.mjINT_RK4):
        raise InputError(
            "the model is integrated by RK4, in stages between which no contact can stick; "
            "set option.integrator to Euler or implicitfast"
        )
    return number, int(model.jnt_qposadr[number]), int(model.jnt_dofadr[number])


def _check_motion(joint: str, plant: Plant, hinge: bool) -> None:
    """Refuses a plant that turns on a joint that slides, and the other way round."""
    if hinge != (plant.motion == "rotary"):
        kind, moves = ("hinge", "linear") if hinge else ("slide", "rotary")
        raise InputError(
            f"joint = '{joint}' is a {kind}, and {plant.source} is {moves}: its numbers are in "
            f"other units; give a joint that fits, or state motion.kind in the plant"
        )


def _sentences(plant: Plant, kept: Sequence[Effect]) -> list[str]:
    """What of a plant its joint in a robot does not have."""
    lost = [
        f"{effect.name}: {effect.record.summary}"
        + (": actuators of the model have their own" if effect.record.before_drive else "")
        for effect in plant.effects
        if effect not in kept
    ]
    if plant.hangs:
        lost.append("gravity of the plant: bodies of the model have their own")
    if plant.servo:
        lost.append("the controller of the servo: actuators of the model drive the joint")
    return lost


def simulator() -> Any:
    """The package itself.

    Raises
    ------
    InputError
        It is missing.
    """
    try:
        import mujoco
    except ImportError:
        raise InputError(
            "stiction.mujoco: MuJoCo is missing; install it: pip install mujoco"
        ) from None
    return mujoco
