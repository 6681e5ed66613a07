"""Several joints in one file: told apart by names or by numbers, and one of them chosen."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.cli import run
from stiction.recording import Table, read_table
from stiction.recording.guess import guess
from stiction.recording.joints import Joints, joints_of

ROWS = 1500


def arm(joints: int = 3, seed: int = 0) -> dict[str, list[np.ndarray]]:
    """Joints that swing with their own periods: a column of each for every joint."""
    time = 2e-3 * np.arange(ROWS)
    wave = [1.0 + 0.7 * k + 0.1 * seed for k in range(joints)]
    return {
        "t": [time],
        "q": [0.5 * np.sin(w * time) for w in wave],
        "qd": [0.5 * w * np.cos(w * time) for w in wave],
        "tau": [2.0 * np.sign(np.cos(w * time)) - 0.3 * w**2 * np.sin(w * time) for w in wave],
    }


def table(names: dict[str, str], joints: tuple[str, ...], path: str = "run.npz") -> Table:
    """A file whose columns are called as the patterns say, ``{}`` for the joint."""
    columns = {"t": arm()["t"][0]}
    for role, pattern in names.items():
        for label, values in zip(joints, arm()[role], strict=True):
            columns[pattern.format(label)] = values
    return Table(Path(path), columns)


@pytest.mark.parametrize(
    ("q", "qd", "tau", "joints"),
    [
        ("q{}", "qd{}", "tau{}", ("1", "2", "3")),
        ("position[{}]", "velocity[{}]", "effort[{}]", ("0", "1", "2")),
        ("actual_q_{}", "actual_qd_{}", "actual_current_{}", ("0", "1", "2")),
        ("J{}.position [deg]", "J{}.speed [deg/s]", "J{}.torque [Nm]", ("1", "2", "3")),
        ("/joint_states/position.{}", "/joint_states/velocity.{}", "/joint_states/effort.{}",
         ("0", "1", "2")),
        ("/joint_states/{}/position", "/joint_states/{}/velocity", "/joint_states/{}/effort",
         ("shoulder", "elbow", "wrist_3")),
        ("position.{}", "velocity.{}", "effort.{}", ("shoulder", "elbow", "hand")),
    ],
)  # fmt: skip
def test_names_tell_joints(q: str, qd: str, tau: str, joints: tuple[str, ...]) -> None:
    robot = table({"q": q, "qd": qd, "tau": tau}, joints)
    found = joints_of([robot])
    assert found is not None
    assert found.labels == joints
    assert list(found.only(robot, joints[1]).columns) == [
        "t",
        *(pattern.format(joints[1]) for pattern in (q, qd, tau)),
    ]


@pytest.mark.parametrize(
    "names",
    [
        ["t", "q", "i"],
        ["t", "pos1", "pos2", "u"],
        ["t", "theta1", "theta2", "omega1", "omega2", "current"],
        ["t", "q [rad]", "temp1", "temp2", "volt1", "volt2"],
        ["time_s", "motor.position", "motor.velocity", "load.position", "load.velocity", "i"],
    ],
)
def test_one_axis_is_not_several_joints(names: list[str]) -> None:
    wave = np.sin(np.arange(ROWS) * 1e-2)
    assert joints_of([Table(Path("run.npz"), dict.fromkeys(names, wave))]) is None


def nameless(path: Path, joints: int, seed: int = 0) -> Path:
    columns = [values for group in arm(joints, seed).values() for values in group]
    np.savetxt(path, np.column_stack(columns), delimiter=",", fmt="%.6f")
    return path


@pytest.mark.parametrize("joints", [2, 3, 7])
def test_numbers_tell_joints_of_files_without_names(tmp_path: Path, joints: int) -> None:
    found = joints_of([read_table(nameless(tmp_path / "run.csv", joints))])
    assert isinstance(found, Joints)
    assert found.labels == tuple(str(k) for k in range(1, joints + 1))
    assert [found.of[f"column {k}"] for k in (2, 2 + joints, 2 + 2 * joints)] == ["1"] * 3


def test_position_and_velocity_without_names_are_found_in_any_order() -> None:
    columns = {f"column {k}": arm()[role][0] for k, role in enumerate(("tau", "qd", "t", "q"), 1)}
    found = guess([Table(Path("run.csv"), columns)])
    assert {role: one.column for role, one in found.by_role.items()} == {
        "time": "column 3",
        "velocity": "column 2",
        "position": "column 4",
    }
    # Nothing tells in what it is measured: it is offered, and not taken.
    offered = [one for one in found.columns if one.candidate == "input"]
    assert [one.column for one in offered] == ["column 1"]
    assert "explain" in offered[0].reason
    assert "input" in found.missing


def test_init_drafts_one_joint_and_says_which_there_are(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [str(nameless(tmp_path / f"run{k}.csv", 3, k)) for k in range(2)]
    out = tmp_path / "drafts"
    header = ["--header", "t,q*3,qd*3,tau*3"]
    assert run(["init", *files, "--joint", "2", *header, "-o", str(out), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["joints"] == ["2", "1", "3"]
    assert found["to_do"] == []
    text = (out / "session.toml").read_text("utf-8")
    columns = tomllib.loads(text)["columns"]
    names = {role: column["name"] for role, column in columns.items()}
    assert names == {"time": "column 1", "position": "column 3", "velocity": "column 6",
                     "input": "column 9"}  # fmt: skip
    assert "Joint 2 alone: the recordings hold 1, 3" in text
    position = st.load(out / "session.toml").recordings[0].position
    np.testing.assert_allclose(position, arm()["q"][1], atol=1e-6)


def test_without_a_choice_the_first_joint_that_moves_is_taken(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = table({"q": "q{}", "tau": "tau{}"}, ("1", "2", "3"), str(tmp_path / "run.npz"))
    robot.columns["q1"][:] = 0.25
    np.savez(robot.path, **robot.columns)
    assert run(["init", str(robot.path), "-o", str(tmp_path)]) == 0
    assert "joint: 2 (others: 1, 3; --joint takes them)" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--joint", "4"], "there is no joint '4'; the file has 3 joints: 1, 2, 3"),
        (["--header", "t,q*3"], "has 10 columns, and --header names 4"),
        (["--header", "t,q*x"], "'q*x' ends in no number from 1 to"),
        (["--header", "t,t"], "empty or there twice"),
    ],
)
def test_what_no_file_has_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    path = nameless(tmp_path / "run.csv", 3)
    assert run(["init", str(path), "-o", str(tmp_path / "out"), *arguments]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_joint_of_a_single_axis_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t,q,i\n" + "".join(f"{k},{k % 9},{k % 7}\n" for k in range(300)))
    assert run(["init", str(path), "-o", str(tmp_path), "--joint", "1"]) == 2
    assert "not those of several joints" in capsys.readouterr().err
    assert run(["init", str(path), "-o", str(tmp_path), "--header", "t,q,i"]) == 2
    assert "--header is for files without" in capsys.readouterr().err


def test_five_logs_of_a_robot_without_a_header_are_drafted(
    shared_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = shared_data / "ur10e"
    for joint in "123456":
        out = tmp_path / joint
        assert run(["init", str(folder), "--joint", joint, "-o", str(out), "--json"]) == 0
        found = json.loads(capsys.readouterr().out)
        roles = {one["role"]: one["column"] for one in found["columns"] if one["role"]}
        own = int(joint)
        assert roles == {
            "time": "column 1",
            "position": f"column {1 + own}",
            "velocity": f"column {7 + own}",
        }
        assert len(found["recordings"]) == 5
        text = (out / "session.toml").read_text("utf-8")
        assert f'# input = {{ name = "column {13 + own}"' in text
