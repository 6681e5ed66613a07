"""Rigid links: efforts, regressors, base parameters, links that can exist."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stiction.errors import InputError, NotEnoughData
from stiction.robot import fit_robot, load_session
from stiction.robot.consistency import consistent, exist, feasible
from stiction.robot.dynamics import Arm
from stiction.robot.regression import base_parameters

from .simulated import Friction, SimulatedRobot

pinocchio = pytest.importorskip("pinocchio")
pytest.importorskip("mujoco")

EXACT = 1e-10
"""Share of the largest effort: rounding of a few thousand products."""


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    file = tmp_path / "arm.urdf"
    file.write_text(SimulatedRobot().urdf)
    return file


def motions(joints: int, seed: int = 0) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return [rng.standard_normal((40, joints)) for _ in range(3)]


def test_efforts_are_those_of_another_simulator(urdf: Path) -> None:
    robot = SimulatedRobot()
    arm = Arm(urdf, robot.joints)
    found, expected = arm.efforts(*motions(3)), robot.links(*motions(3))
    assert np.abs(found - expected).max() < EXACT * np.abs(expected).max()


def test_efforts_are_those_of_pinocchio(urdf: Path) -> None:
    arm, q, v, a = Arm(urdf, SimulatedRobot().joints), *motions(3)
    model = pinocchio.buildModelFromUrdf(str(urdf))
    data = model.createData()
    turned = np.stack([np.cos(q), np.sin(q)], axis=2).reshape(len(q), 6)
    expected = [pinocchio.rnea(model, data, *row) for row in zip(turned, v, a, strict=True)]
    assert np.abs(arm.efforts(q, v, a) - expected).max() < EXACT * np.abs(expected).max()


def test_a_regressor_times_the_parameters_is_the_effort(urdf: Path) -> None:
    arm = Arm(urdf, SimulatedRobot().joints)
    other = feasible(arm.prior * 1.3)
    by_columns = arm.regressor(*motions(3)) @ other
    efforts = arm.efforts(*motions(3), other)
    assert np.abs(by_columns.T - efforts).max() < EXACT * np.abs(efforts).max()


def test_a_joint_that_mimics_another_adds_its_effort(urdf: Path) -> None:
    text = urdf.read_text().replace(
        '<axis xyz="0 1 0"/></joint>\n</robot>',
        '<axis xyz="0 1 0"/><mimic joint="shoulder" multiplier="-0.5" offset="0.2"/></joint>\n'
        "</robot>",
    )
    urdf.write_text(text)
    arm, whole = Arm(urdf, ("base", "shoulder")), SimulatedRobot()
    q, v, a = motions(2)
    follows = [np.column_stack([x, -0.5 * x[:, 1] + at]) for x, at in ((q, 0.2), (v, 0), (a, 0))]
    all_of_them = whole.links(*follows)
    expected = np.column_stack([all_of_them[:, 0], all_of_them[:, 1] - 0.5 * all_of_them[:, 2]])
    assert np.abs(arm.efforts(q, v, a) - expected).max() < EXACT * np.abs(expected).max()


def test_a_locked_joint_stays_where_it_is(urdf: Path) -> None:
    arm = Arm(urdf, ("base", "shoulder"), locked={"elbow": 0.7})
    q, v, a = motions(2)
    whole = [np.column_stack([x, np.full(len(x), at)]) for x, at in ((q, 0.7), (v, 0), (a, 0))]
    expected = SimulatedRobot().links(*whole)[:, :2]
    assert np.abs(arm.efforts(q, v, a) - expected).max() < EXACT * np.abs(expected).max()


def test_a_joint_of_which_nobody_says_how_it_moves_is_refused(urdf: Path) -> None:
    with pytest.raises(InputError, match=r"nothing says how joint 'elbow' moves.*locked"):
        Arm(urdf, ("base", "shoulder"))
    with pytest.raises(InputError, match="has no joint 'wrist' that moves"):
        Arm(urdf, ("base", "shoulder", "wrist"))


def test_links_that_can_exist_come_back_from_what_they_need(urdf: Path) -> None:
    arm = Arm(urdf, SimulatedRobot().joints)
    true = feasible(arm.prior * 0.8)
    columns = np.vstack(list(arm.regressor(*motions(3))))
    told, free = base_parameters(columns, columns @ true, arm.prior)
    assert len(told) < len(true)
    assert np.allclose(columns @ free, columns @ true, atol=1e-8)
    # A mass that nothing supports would be needed here: the nearest that can exist is not it.
    other = true.copy()
    other[20] = -1.0
    best, left = consistent(columns, columns @ other, arm.prior, 0)
    assert all(exist(best))
    assert not all(exist(other))
    assert left > 0.0
    best, left = consistent(columns, columns @ true, arm.prior, 0)
    assert left < 1e-6 * np.sum((columns @ true) ** 2)


def test_a_fit_finds_the_friction_and_the_rotors_of_a_robot(tmp_path: Path) -> None:
    robot = SimulatedRobot()
    fit = fit_robot(load_session(robot.lay_out(tmp_path, seconds=10.0)))
    for found, true in zip(fit.arm.friction, robot.friction, strict=True):
        assert found[0] == pytest.approx(true.viscous, rel=0.03)
        assert found[1] == pytest.approx(true.coulomb, rel=0.03)
        assert found[2] == pytest.approx(true.bias, abs=0.05)
    # Those before it turn with their links alone, and are hardly told apart from these.
    assert fit.arm.rotors[2] == pytest.approx(robot.rotors[2], rel=0.1)
    assert all(exist(fit.arm.links))
    assert fit.arm.cost < 0.01
    for run, recording in enumerate(fit.session.runs):
        table = robot.record(run, 10.0)
        moved = np.column_stack([table[f"q{k}"] for k in (1, 2, 3)])
        inside = slice(fit.motions[run].ends, -fit.motions[run].ends)
        assert len(recording.joints[0]) == len(moved)
        assert np.abs(fit.motions[run].position - moved)[inside].max() < 1e-3


def test_a_joint_that_never_moves_is_named(tmp_path: Path) -> None:
    session = SimulatedRobot().lay_out(tmp_path, seconds=4.0)
    for file in tmp_path.glob("run*.npz"):
        table = dict(np.load(file))
        table["q2"] = np.full_like(table["q2"], 0.3)
        np.savez(file, **table)
    with pytest.raises(NotEnoughData, match="shoulder moves in no row"):
        fit_robot(load_session(session))


def test_friction_that_grows_with_the_load_is_not_taken_for_a_mass(tmp_path: Path) -> None:
    hides = Friction(5.0, 7.0, -0.2, "load_dependent_friction", 0.3)
    base, _, elbow = SimulatedRobot().friction
    robot = replace(SimulatedRobot(), friction=(base, hides, elbow))
    fit = fit_robot(load_session(robot.lay_out(tmp_path, seconds=16.0)))
    assert fit.arm.by_load == pytest.approx([0.0, 0.3, 0.0], abs=0.02)
    assert fit.arm.friction[1][:2] == pytest.approx([7.0, 5.0], rel=0.03)
    for run, motion in enumerate(fit.motions):
        inside = slice(motion.ends, -motion.ends)
        moved = motion.position, motion.velocity, motion.acceleration
        true = robot.links(*moved) + np.array(robot.rotors) * motion.acceleration
        found = fit.efforts(run) + fit.arm.rotors * motion.acceleration
        missed = (found - true)[inside, 1]
        # Beside plain friction alone it was 1.4 to 2 % of the Coulomb friction.
        assert np.std(missed) < 0.012 * hides.coulomb
