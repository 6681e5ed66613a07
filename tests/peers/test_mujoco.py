"""Beside MuJoCo's hinge: the same where the models coincide, and what differs where they do not."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st

mujoco = pytest.importorskip("mujoco", minversion="4.0")

INERTIA, VISCOUS = 0.0076, 0.02
LEVEL, BREAKAWAY, STIFFNESS, DAMPING, STRIBECK = 0.3, 0.45, 300.0, 1.0, 0.1
# Its bristle is stepped explicitly, of first order.
LUGRE_SHARE = 3e-3
# Its joint friction is a soft constraint: it yields a little before it slides.
SLIDING_SHARE = 0.01


def hinge(dt: float, *, loss: float = 0.0, lugre: str = "") -> mujoco.MjModel:
    """One hinge with a motor, dry friction of the joint or bristles of a motor without current."""
    bristles = (
        f'<dcmotor joint="hinge" lugre="{lugre}" motorconst="1e-6" resistance="1"/>'
        if lugre
        else ""
    )
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="{dt}" gravity="0 0 0"/><worldbody><body>
        <joint name="hinge" type="hinge" axis="0 0 1" damping="{VISCOUS}" frictionloss="{loss}"/>
        <inertial pos="0 0 0" mass="1" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>
        </body></worldbody><actuator><motor joint="hinge"/>{bristles}</actuator></mujoco>"""
    )


def moved(model: mujoco.MjModel, efforts: np.ndarray) -> np.ndarray:
    data = mujoco.MjData(model)
    positions = np.empty(len(efforts))
    for k, effort in enumerate(efforts):
        data.ctrl[0] = effort
        mujoco.mj_step(model, data)
        positions[k] = data.qpos[0]
    return positions


def bristles() -> st.FrictionModel:
    return st.FrictionModel(
        "lugre",
        initial_stiffness=STIFFNESS,
        damping=DAMPING,
        coulomb=LEVEL,
        breakaway=BREAKAWAY,
        stribeck_velocity=STRIBECK,
        viscous=VISCOUS,
    )


def swept(dt: float, seconds: float) -> np.ndarray:
    time = np.arange(round(seconds / dt)) * dt
    return 0.6 * np.sin(2.0 * np.pi * time) * np.minimum(1.0, time)


def test_lugre_moves_as_its_motor_with_bristles() -> None:
    dt = 1e-4
    efforts = swept(dt, 3.0)
    lugre = f"{STIFFNESS} {DAMPING} {LEVEL} {BREAKAWAY} {STRIBECK}"
    theirs = moved(hinge(dt, lugre=lugre), efforts)
    ours = st.Motor(INERTIA, friction=bristles()).simulate(efforts, dt).position
    assert np.abs(theirs).max() > 0.5
    assert np.abs(ours - theirs).max() < LUGRE_SHARE * np.ptp(theirs)


def test_coulomb_slides_as_its_joint_with_friction_loss() -> None:
    dt = 1e-4
    efforts = swept(dt, 3.0)
    theirs = moved(hinge(dt, loss=LEVEL), efforts)
    friction = st.FrictionModel("coulomb", coulomb=LEVEL, viscous=VISCOUS)
    ours = st.Motor(INERTIA, friction=friction).simulate(efforts, dt).position
    assert np.abs(ours - theirs).max() < SLIDING_SHARE * np.ptp(theirs)


def test_at_half_its_limit_its_joint_creeps_and_ours_holds() -> None:
    dt, seconds = 5e-4, 60.0
    efforts = np.full(round(seconds / dt), 0.5 * LEVEL)
    theirs = moved(hinge(dt, loss=LEVEL), efforts)
    friction = st.FrictionModel("coulomb", coulomb=LEVEL, viscous=VISCOUS)
    ours = st.Motor(INERTIA, friction=friction).simulate(efforts, dt).position
    assert theirs[-1] > 0.1
    assert np.all(ours == 0.0)


def test_ripple_ratchets_lugre_in_either_and_no_law_with_memory() -> None:
    dt = 5e-4
    time = np.arange(round(20.0 / dt)) * dt
    efforts = LEVEL * (0.5 + 0.3 * np.sin(2.0 * np.pi * 5.0 * time))
    lugre = f"{STIFFNESS} {DAMPING} {LEVEL} {LEVEL} {STRIBECK}"
    theirs = moved(hinge(dt, lugre=lugre), efforts)
    drifting = st.FrictionModel(
        "lugre", **{**bristles().parameters, "breakaway": LEVEL, "coulomb": LEVEL}
    )
    ours = st.Motor(INERTIA, friction=drifting).simulate(efforts, dt).position
    span = LEVEL / STIFFNESS
    assert theirs[-1] > 20.0 * span
    assert ours[-1] == pytest.approx(theirs[-1], rel=0.02)
    holding = st.FrictionModel(
        "maxwell_slip", coulomb=LEVEL, initial_stiffness=STIFFNESS, viscous=VISCOUS
    )
    held = st.Motor(INERTIA, friction=holding).simulate(efforts, dt).position
    assert np.ptp(held[len(held) // 2 :: round(0.2 / dt)]) < 1e-6 * span
    print(f"drift of lugre in 20 s: {ours[-1] / span:.0f} spans, theirs {theirs[-1] / span:.0f}")
