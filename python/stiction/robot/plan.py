"""Signals to record a robot with: all joints together, and each one alone."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from .._support import given
from .._support.arrays import FloatArray
from .._support.given import number
from .._support.progress import phase
from .._support.wording import commas, did_you_mean
from ..errors import InputError
from ..plan.experiments import EXPERIMENTS, Experiment
from ..plan.limits import SHARE_TO_ACCELERATE, Sizes
from ..plan.run import SMALLER, TRIES
from ..plant.assumed import LEVELS
from ..plant.presliding import presliding
from ..recording.recording import SPLIT_ROLES
from .excitation import ArmLoad, Excitation, excitation
from .limits import ArmLimits, arm_limits
from .robot import Robot
from .signals import RobotPlan, RobotSignal

__all__ = ["TOGETHER", "plan_robot"]

TOGETHER: Final = "together"
"""The experiment that moves all joints."""
ALONE: Final = ("ramps", "dwells")
"""Experiments of one axis that each joint goes through by itself: slow steady motion and rests,
which a motion of all joints has none of."""
PERIODS, LEAST_S = 3, 30.0
"""Of the motion of all joints in a recording, and its length at least: what differs between
periods is no model's."""
RATES: Final = (20.0, 1e4)
SET_ASIDE: Final = 0.2
"""Share of the effort for friction of a joint that states no level of it."""
CHECKED_S: Final = 0.01
"""Between the rows at which efforts are looked at: smooth motion changes less."""
BLEND_S: Final = 0.3
"""Least time to full speed of a joint that moves alone."""

_logger = logging.getLogger(__name__)


def plan_robot(
    robot: Robot,
    *,
    position: float | None = None,
    speed: float | None = None,
    effort: float | None = None,
    rate: float = 100.0,
    only: Sequence[str] = (),
    seed: int = 0,
) -> RobotPlan:
    """Signals with which to record a robot, within the limits of all its joints.

    ``together`` moves all joints on Fourier series that give the regressor of base parameters,
    rotors and plain friction a small condition number; ``ramps`` and ``dwells`` move one joint
    while the others rest. All begin and end at rest in the middle of the positions, and stay 15 %
    below the limits of position, speed and effort.

    Parameters
    ----------
    robot : Robot
        Limits are those of ``limits`` in its joints, else the URDF's.
    position, speed, effort : float, optional
        Narrower limits of every joint: distance from the middle, rad or m; rad/s or m/s; N·m or N.
    rate : float
        Samples a second.
    only : sequence of str
        Names of experiments; all without it.
    seed : int
        Of everything random.

    Returns
    -------
    RobotPlan

    Raises
    ------
    InputError
        No robot; no pinocchio; a limit that nobody states or that is no number above 0, or within
        which an arm cannot be moved; a rate or seed out of bounds; an unknown experiment.
    """
    given.instance(robot, Robot, "plan_robot: robot", "a Robot, as Robot.load returns it")
    rate = number(rate, "plan_robot: rate")
    if not RATES[0] <= rate <= RATES[1]:
        raise InputError(
            f"rate = {rate:g} is out of bounds: allowed is {RATES[0]:g} to {RATES[1]:g} samples/s"
        )
    seed = given.whole(seed, "seed", least=0)
    asked = _asked(given.names(only, "plan_robot: only"))
    limits, notes = arm_limits(robot, position=position, speed=speed, effort=effort)
    load, guessed = _load(robot, limits)
    notes += guessed
    signals: list[RobotSignal] = []
    found: list[Excitation] = []
    if TOGETHER in asked:
        for k, role in enumerate(SPLIT_ROLES):
            phase(_logger, "planning the motion of all joints, %d of %d", k + 1, len(SPLIT_ROLES))
            one = excitation(load, limits, np.random.default_rng([seed, k]))
            path = one.path(limits.home, rate, max(PERIODS, math.ceil(LEAST_S / one.period)))
            found.append(one)
            signals.append(_signal(robot, load, TOGETHER, "", role, path, rate))
    for experiment in (e for e in EXPERIMENTS if e.name in asked):
        for joint, name in enumerate(robot.names):
            phase(_logger, "planning %s of %s", experiment.name, name)
            made = [
                _alone(robot, load, limits, experiment, joint, role, rate, [seed, k, joint])
                for k, role in enumerate(SPLIT_ROLES)
            ]
            kept = [one for one in made if one is not None]
            if len(kept) < len(made):
                notes.append(
                    f"{experiment.name} of {name} is left out: nothing of it stays within the "
                    "limits"
                )
                continue
            signals += kept
    if not signals:
        raise InputError(f"{robot.source}: no signal stays within these limits; widen one of them")
    return RobotPlan(robot, tuple(signals), tuple(found), tuple(notes))


def _asked(only: Sequence[str]) -> tuple[str, ...]:
    known = (TOGETHER, *ALONE)
    for name in only:
        if name not in known:
            raise InputError(
                f"only: a robot has no experiment '{name}'{did_you_mean(name, known)}; it has "
                f"{commas(known)}"
            )
    return tuple(name for name in known if not only or name in only)


def _load(robot: Robot, limits: ArmLimits) -> tuple[ArmLoad, list[str]]:
    """What the drives bear: links of the URDF, stated rotors, stated friction or a share for it."""
    friction = SET_ASIDE * limits.effort
    silent = []
    for k, joint in enumerate(robot.joints):
        if any(name in joint.friction for name in LEVELS):
            own = joint.plant(1.0, f"{robot.source}: joint '{joint.name}'")
            speeds = limits.speed[k] * np.linspace(0.01, 1.0, 50)
            friction[k] = float(np.max(own.friction_curve(speeds)))
        else:
            silent.append(joint.name)
    notes = []
    if silent:
        notes.append(
            f"{robot.source} states no level of friction of {commas(silent)}: a fifth of the "
            "effort is set aside for it"
        )
    rotors = np.array([joint.rotor_inertia for joint in robot.joints])
    return ArmLoad(robot.arm, rotors, friction), notes


def _alone(
    robot: Robot,
    load: ArmLoad,
    limits: ArmLimits,
    experiment: Experiment,
    joint: int,
    role: str,
    rate: float,
    seed: Sequence[int],
) -> RobotSignal | None:
    """One joint through an experiment of one axis while the others rest at home."""
    sizes = _sizes(robot, load, limits, joint)
    if sizes is None:
        return None
    plant = robot.joints[joint].plant(sizes.inertia, f"{robot.source}: joint {joint + 1}")
    dt, share = 1.0 / rate, 1.0
    for _ in range(TRIES):
        path = experiment.build(plant, sizes, dt, np.random.default_rng(seed), share)
        positions = np.tile(limits.home, (len(path), 1))
        positions[:, joint] += path
        made = _signal(robot, load, experiment.name, robot.names[joint], role, positions, rate)
        allowed = {"position": limits.reach, "speed": limits.speed, "effort": limits.effort}
        about = {**made.greatest, "position": np.max(np.abs(positions - limits.home), axis=0)}
        # Rounding to samples is no fault.
        if all(np.all(about[key] <= 1.02 * most) for key, most in allowed.items()):
            return made
        share *= SMALLER
    return None


def _sizes(robot: Robot, load: ArmLoad, limits: ArmLimits, joint: int) -> Sizes | None:
    """Sizes of a joint's own signals, None where its drive has nothing left for them."""
    reach = float(limits.reach[joint])
    q = np.tile(limits.home, (41, 1))
    q[:, joint] += reach * np.linspace(-1.0, 1.0, 41)
    still, pushed = np.zeros_like(q), np.zeros_like(q)
    pushed[:, joint] = 1.0
    rests = load.arm.efforts(q, still, still)[:, joint]
    carried = load.arm.efforts(q, still, pushed)[:, joint] - rests
    inertia = float(np.max(carried) + load.rotors[joint])
    most, friction = float(limits.effort[joint]), float(load.friction[joint])
    spare = SHARE_TO_ACCELERATE * (most - friction - float(np.max(np.abs(rests))))
    if spare <= 0.0:
        # Near home gravity may take less: signals are made smaller from what is left there.
        spare = SHARE_TO_ACCELERATE * (most - friction - abs(float(rests[20])))
    if spare <= 0.0 or inertia <= 0.0:
        return None
    speed = float(limits.speed[joint])
    acceleration = min(spare / inertia, speed / BLEND_S)
    law = robot.joints[joint].plant(inertia).friction
    yields = presliding(law, friction) if law.springy else 0.0
    return Sizes(reach, speed, acceleration, most, friction, yields, inertia)


def _signal(
    robot: Robot,
    load: ArmLoad,
    experiment: str,
    joint: str,
    role: str,
    positions: FloatArray,
    rate: float,
) -> RobotSignal:
    dt = 1.0 / rate
    apart = max(1, round(CHECKED_S * rate))
    seen, step = positions[::apart], apart * dt
    v = np.gradient(seen, step, axis=0)
    a = np.zeros_like(seen)
    a[1:-1] = np.diff(seen, 2, axis=0) / step**2
    speeds = np.abs(np.diff(positions, axis=0)) / dt
    greatest = {
        "position": np.max(np.abs(positions), axis=0),
        "speed": np.max(speeds, axis=0),
        "effort": np.max(load.efforts(seen, v, a), axis=0),
    }
    return RobotSignal(
        experiment,
        joint,
        role,
        robot.names,
        tuple("m" if one.motion == "linear" else "rad" for one in robot.joints),
        np.asarray(np.arange(len(positions)) * dt, dtype=np.float64),
        positions,
        greatest,
    )
