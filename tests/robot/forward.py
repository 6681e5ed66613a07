"""Arms that are driven: MuJoCo's mass matrix and bias, a controller, and dry friction that holds.

Where ``simulated`` prescribes the motion and asks for its efforts, here a controller pushes and the
arm moves as it can: joints stick where friction holds them. Nothing comes from the core.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from .simulated import Friction, SimulatedRobot, _drawn_sines, _multisine

Array = NDArray[np.float64]

STEP = 5e-4
"""Of the simulation, s."""
SWEEPS = 12
"""Of Gauss and Seidel over the joints: friction of one moves the others through the mass matrix."""
BANDWIDTH = 25.0
"""Of the position loops, rad/s."""


def level(own: Friction, position: float, velocity: float, links: float) -> float:
    """What dry friction of a joint holds at most, N·m."""
    found = own.coulomb
    if own.effect == "load_dependent_friction":
        found += own.size * abs(links)
    elif own.effect == "stribeck":
        found += own.size * own.coulomb * float(np.exp(-abs(velocity) / 0.1))
    elif own.effect == "position_dependent_friction":
        found *= 1.0 + own.size * float(np.cos(3.0 * position + 0.4))
    return found


def smooth(own: Friction, velocity: float) -> float:
    """What goes with the speed alone, and the offset, N·m."""
    found = own.viscous * velocity + own.bias
    if own.effect == "viscous_quadratic":
        found += own.size * own.viscous * velocity * abs(velocity)
    return found


def driven(
    robot: SimulatedRobot, seed: int, seconds: float, *, rate: float, control: float
) -> Mapping[str, Array]:
    """A recording of an arm under its controller: t, and q, tau of each joint.

    Parameters
    ----------
    robot : SimulatedRobot
    seed : int
    seconds : float
    rate : float
        Rows a second; each has the effort that is held from its stamp on.
    control : float
        Efforts that the controller sets a second, a multiple of the rate.
    """
    import mujoco

    rng = np.random.default_rng(seed)
    model = mujoco.MjModel.from_xml_string(robot.urdf)
    data = mujoco.MjData(model)
    joints = len(robot.joints)
    count = int(seconds / STEP)
    time = np.arange(count) * STEP
    wanted = [_multisine(_drawn_sines(rng), time) for _ in robot.joints]
    goal, goal_v, goal_a = (np.stack([one[k] for one in wanted], axis=1) for k in range(3))
    every, rows = round(1.0 / (control * STEP)), round(1.0 / (rate * STEP))
    turn = 2.0 * np.pi / robot.counts
    rotors = np.diag(robot.rotors)
    mass, units = np.empty((joints, joints)), np.eye(joints)
    q, v, links, push = goal[0].copy(), np.zeros(joints), np.zeros(joints), np.zeros(joints)
    read, was = q.copy(), q.copy()
    kept_q, kept_tau = [], []
    for k in range(count):
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(model, data)
        for j, unit in enumerate(units):
            mujoco.mj_mulM(model, data, mass[j], unit)
        whole = mass + rotors
        if k % every == 0:
            read = np.round(q / turn) * turn
            rate_v = (read - was) / (every * STEP) if k else np.zeros(joints)
            was = read
            inertia = np.diag(whole)
            ask = goal_a[k] + 2.0 * BANDWIDTH * (goal_v[k] - rate_v)
            ask = ask + BANDWIDTH**2 * (goal[k] - read)
            push = inertia * ask + data.qfrc_bias
            for j, own in enumerate(robot.friction):
                push[j] += (
                    0.8 * own.coulomb * np.tanh(goal_v[k, j] / 0.05) + own.viscous * goal_v[k, j]
                )
        if k % rows == 0:
            kept_q.append(np.round(q / turn) * turn)
            kept_tau.append(push.copy())
        before = v
        v = _next(robot, whole, push - data.qfrc_bias, q, v, links)
        links = mass @ (v - before) / STEP + data.qfrc_bias
        q = q + STEP * v
    table = {"t": np.arange(len(kept_q)) / rate}
    tau = np.array(kept_tau)
    tau += robot.noise * np.sqrt(np.mean(tau**2, axis=0)) * rng.standard_normal(tau.shape)
    for j in range(joints):
        table[f"q{j + 1}"] = np.array(kept_q)[:, j]
        table[f"tau{j + 1}"] = tau[:, j]
    return table


def _next(
    robot: SimulatedRobot, mass: Array, push: Array, q: Array, v: Array, links: Array
) -> Array:
    """Velocities after a step: each joint slides against its friction, or is held by it."""
    inverse = np.linalg.inv(mass)
    free = push - [smooth(own, float(one)) for own, one in zip(robot.friction, v, strict=True)]
    ahead = (v + STEP * inverse @ free).tolist()
    most = [
        level(own, float(q[j]), float(v[j]), float(links[j])) * STEP
        for j, own in enumerate(robot.friction)
    ]
    at = inverse.tolist()
    pulse = [0.0] * len(most)
    for _ in range(SWEEPS):
        for j, bound in enumerate(most):
            # The impulse that would stop it, no greater than friction bears.
            other = pulse[j] - ahead[j] / at[j][j]
            other = min(max(other, -bound), bound)
            change, pulse[j] = other - pulse[j], other
            if change:
                ahead = [one + row[j] * change for one, row in zip(ahead, at, strict=True)]
    return np.array(ahead)
