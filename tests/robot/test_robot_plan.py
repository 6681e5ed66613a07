"""Signals for a robot: within its limits by another simulator, and good enough to fit with."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from stiction.cli import main
from stiction.errors import InputError
from stiction.robot import Robot, RobotPlan, fit_robot, load_session, plan_robot

from .simulated import SimulatedRobot

pytest.importorskip("pinocchio")
pytest.importorskip("mujoco")

TRUE = SimulatedRobot()
POSITION, SPEED, EFFORT = (
    {"base": [-2.0, 1.0]},
    1.5,
    {"base": 40.0, "shoulder": 70.0, "elbow": 25.0},
)


def laid(folder: Path, arm: SimulatedRobot = TRUE, **limits: float) -> Path:
    """A robot file with limits, and levels of friction as far as they are known."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "arm.urdf").write_text(arm.urdf)
    lines = ["[robot]", 'urdf = "arm.urdf"']
    for k, name in enumerate(arm.joints, 1):
        own = arm.friction[k - 1]
        position = POSITION.get(name, [-1.5, 1.5])
        effort = limits.get("effort", EFFORT[name])
        lines += [
            "[[robot.joints]]",
            f'name = "{name}"',
            f'columns = {{ position = {{ name = "q{k}", unit = "rad" }}, input = "tau{k}" }}',
            'drive = { input = "torque_nm" }',
            f"rotor_inertia = {arm.rotors[k - 1]}",
            f'friction = {{ law = "coulomb", coulomb = {own.coulomb}, viscous = {own.viscous} }}',
            f"limits = {{ position = {position}, speed = {SPEED}, effort = {effort} }}",
        ]
    (folder / "robot.toml").write_text("\n".join(lines) + "\n")
    return folder / "robot.toml"


def ran(*words: str) -> int:
    with pytest.raises(SystemExit) as left:
        main(list(words))
    return int(left.value.code or 0)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> RobotPlan:
    return plan_robot(Robot.load(laid(tmp_path_factory.mktemp("plan"))), rate=100.0)


def test_every_signal_stays_within_position_speed_and_effort(made: RobotPlan) -> None:
    low = np.array([POSITION.get(name, [-1.5, 1.5])[0] for name in TRUE.joints])
    high = np.array([POSITION.get(name, [-1.5, 1.5])[1] for name in TRUE.joints])
    for signal in made.signals:
        q, dt = signal.positions, signal.time[1]
        assert np.all((q >= low) & (q <= high)), signal.name
        v, a = np.gradient(q, dt, axis=0), np.zeros_like(q)
        a[1:-1] = np.diff(q, 2, axis=0) / dt**2
        assert np.abs(v).max() <= SPEED
        some = slice(None, None, 7)
        needed = TRUE.links(q[some], v[some], a[some])
        for k, name in enumerate(TRUE.joints):
            own = needed[:, k] + TRUE.rotors[k] * a[some, k]
            own = own + TRUE.friction[k].acts(q[some, k], v[some, k], needed[:, k])
            assert np.abs(own).max() <= EFFORT[name], (signal.name, name)


def test_signals_go_from_rest_at_home_to_rest_at_home(made: RobotPlan) -> None:
    home = np.array([-0.5, 0.0, 0.0])
    for signal in made.signals:
        assert signal.positions[0] == pytest.approx(home, abs=1e-9)
        assert np.abs(signal.positions[1] - home).max() < 1e-3 * SPEED
        if signal.experiment != "dwells":  # which end where their last rest is
            assert signal.positions[-1] == pytest.approx(home, abs=1e-6)
        moved = np.ptp(signal.positions, axis=0) > 1e-3
        expected = [signal.joint in ("", name) for name in TRUE.joints]
        assert moved.tolist() == expected


def test_the_motion_of_all_joints_is_conditioned_better_than_chance(made: RobotPlan) -> None:
    assert len(made.excitations) == 3
    for found in made.excitations:
        assert found.condition < 0.6 * found.drawn
        assert 5.0 <= found.period <= 20.0 * (1.0 + 1e-9)


def test_a_plan_says_what_it_holds(made: RobotPlan) -> None:
    assert made["together-train"].joint == ""
    assert made["joint2-ramps-test"].joint == "shoulder"
    assert "random motion within the same limits" in repr(made)
    with pytest.raises(KeyError, match="there is no signal 'ramps'"):
        made["ramps"]
    assert {entry["role"] for entry in made.schedule()} == {"train", "select", "test"}


def test_files_that_are_played_make_a_session_to_fit_links_and_friction_to(tmp_path: Path) -> None:
    """As a user goes: plan, play, record, fit; the links of the URDF are wrong by a fifth."""
    rough = SimulatedRobot(tuple(1.2 * m for m in TRUE.masses), TRUE.lengths)  # type: ignore[arg-type]
    robot = laid(tmp_path / "arm", rough)
    out = tmp_path / "plan"
    assert ran("plan", str(robot), "--only", "together", "-o", str(out)) == 0
    rng = np.random.default_rng(0)
    for file in sorted((out / "signals").glob("*.csv")):
        assert file.read_text().startswith("time_s,base_rad,shoulder_rad,elbow_rad\n")
        time, *columns = np.loadtxt(file, delimiter=",", skiprows=1).T
        q = np.stack(columns, axis=1)
        v, a = np.gradient(q, time[1], axis=0), np.zeros_like(q)
        a[1:-1] = np.diff(q, 2, axis=0) / time[1] ** 2
        links = TRUE.links(q, v, a)
        table = {"t": time}
        for k, friction in enumerate(TRUE.friction):
            torque = links[:, k] + TRUE.rotors[k] * a[:, k]
            torque = torque + friction.acts(q[:, k], v[:, k], links[:, k])
            table[f"q{k + 1}"] = q[:, k] + 1e-6 * rng.standard_normal(len(time))
            table[f"tau{k + 1}"] = torque + 0.2 * rng.standard_normal(len(time))
        np.savetxt(
            out / file.name,
            np.column_stack(list(table.values())),
            delimiter=",",
            header=",".join(table),
            comments="",
        )
    fit = fit_robot(load_session(out / "session.toml"))
    for found, true in zip(fit.arm.friction, TRUE.friction, strict=True):
        assert found[0] == pytest.approx(true.viscous, rel=0.05)
        assert found[1] == pytest.approx(true.coulomb, rel=0.05)
        assert found[2] == pytest.approx(true.bias, abs=0.1)


def test_what_was_filled_in_is_not_overwritten(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = laid(tmp_path)
    assert ran("plan", str(robot), "--only", "ramps", "-o", str(tmp_path)) == 2
    assert "is not overwritten" in capsys.readouterr().err
    assert ran("plan", str(robot), "--only", "ramps", "--json", "-o", str(tmp_path / "out")) == 0
    told = json.loads(capsys.readouterr().out)
    assert [signal["joint"] for signal in told["signals"]][::3] == list(TRUE.joints)
    again = Robot.load(tmp_path / "out" / "robot.toml")
    assert again.joints[0].limits == {"position": [-2.0, 1.0], "speed": 1.5, "effort": 40.0}


def test_an_arm_that_its_drives_cannot_hold_is_refused(tmp_path: Path) -> None:
    weak = Robot.load(laid(tmp_path, effort=6.0))
    with pytest.raises(InputError, match=r"joint 'base': friction and gravity take .* planned for"):
        plan_robot(weak)


def test_limits_that_nobody_states_are_asked_for(tmp_path: Path) -> None:
    file = laid(tmp_path)
    kept = [line for line in file.read_text().splitlines() if not line.startswith("limits")]
    file.write_text("\n".join(kept) + "\n")
    bare = Robot.load(file)
    with pytest.raises(InputError, match="neither its file nor the URDF states a limit of speed"):
        plan_robot(bare)
    found = plan_robot(bare, speed=1.0, effort=60.0, only=["ramps"])
    assert "moved by half a turn either way at most" in found.notes[0]
    with pytest.raises(InputError, match="a robot has no experiment 'loops'"):
        plan_robot(bare, speed=1.0, effort=60.0, only=["loops"])
    with pytest.raises(InputError, match="rate = 1 is out of bounds"):
        plan_robot(bare, speed=1.0, effort=60.0, rate=1.0)


@pytest.mark.parametrize(
    ("limits", "told"),
    [
        ("{ position = [1.0, -1.0] }", "the lower first"),
        ("{ position = 1.0 }", r"as in \[-1.5, 1.5\]"),
        ("{ speed = 0.0 }", "give a finite number above 0"),
        ("{ sped = 1.0 }", "sped"),
    ],
)
def test_wrong_limits_are_told(tmp_path: Path, limits: str, told: str) -> None:
    file = laid(tmp_path)
    lines = [
        f"limits = {limits}" if line.startswith("limits") else line
        for line in file.read_text().splitlines()
    ]
    file.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=told):
        Robot.load(file)
