"""``stiction init`` of a robot: a URDF and logs become drafts that load."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from stiction.cli import main
from stiction.robot import Robot, load_session

from .simulated import SimulatedRobot

pytest.importorskip("pinocchio")
pytest.importorskip("mujoco")

GAINS = (4.0, 5.0, 2.5)


def ran(*words: str) -> int:
    with pytest.raises(SystemExit) as left:
        main(list(words))
    return int(left.value.code or 0)


@pytest.fixture
def logs(tmp_path: Path) -> Path:
    """A URDF, and logs of currents without a header; one of them carries something."""
    robot = SimulatedRobot()
    (tmp_path / "arm.urdf").write_text(robot.urdf)
    for k, name in enumerate(("run-a", "run-b", "run-load")):
        table = robot.record(k, 10.0)
        columns = [table["t"], *(table[f"q{j}"] for j in (1, 2, 3))]
        columns += [table[f"tau{j}"] / gain for j, gain in zip((1, 2, 3), GAINS, strict=True)]
        columns += [0.9 * column for column in columns[-3:]]
        np.savetxt(tmp_path / f"{name}.csv", np.column_stack(columns), delimiter=",", fmt="%.6f")
    return tmp_path


def drafted(logs: Path, header: str) -> Path:
    files = [str(logs / f"run-{name}.csv") for name in ("a", "b", "load")]
    out = logs / "drafts"
    assert ran("init", str(logs / "arm.urdf"), *files, "--header", header, "-o", str(out)) == 0
    return out


def test_logs_without_names_become_a_robot_and_its_session(logs: Path) -> None:
    out = drafted(logs, "t,q*3,i*3,i_target*3")
    robot = Robot.load(out / "robot.toml")
    assert robot.names == SimulatedRobot().joints
    # What was measured, not what was wished.
    assert [joint.columns["input"].name for joint in robot.joints] == [
        "column 5",
        "column 6",
        "column 7",
    ]
    session = load_session(out / "session.toml")
    assert [run.payload for run in session.runs] == [0.0, 0.0, 1.0]
    for joint, run in zip(robot.joints, session.runs[0].joints, strict=True):
        assert joint.input == "current_a"
        assert run.input is not None


def test_gains_are_those_with_which_the_masses_move_as_measured(logs: Path) -> None:
    robot = Robot.load(drafted(logs, "t,q*3,i*3,x*3") / "robot.toml")
    assert robot.joints[1].gain == pytest.approx(GAINS[1], rel=0.1)
    assert robot.joints[2].gain == pytest.approx(GAINS[2], rel=0.1)


def test_the_answer_says_what_is_left_to_do(logs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["init", str(logs / "arm.urdf"), str(logs / "run-a.csv"), "-o", str(logs / "d")]
    assert ran(*words, "--json") == 2
    assert "--header" in capsys.readouterr().err
    assert ran(*words, "--header", "t,q*3,i*3,x*3", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert list(told["joints"]) == list(SimulatedRobot().joints)
    assert told["files"] == [str(logs / "d" / name) for name in ("robot.toml", "session.toml")]


def test_nothing_is_overwritten(logs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = drafted(logs, "t,q*3,i*3,x*3")
    words = ["init", str(logs / "arm.urdf"), str(logs / "run-a.csv"), "-o", str(out)]
    assert ran(*words, "--header", "t,q*3,i*3,x*3") == 2
    assert "robot.toml" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ([], "no logs are given"),
        (["run-a.csv", "--joint", "2"], "a robot has all"),
        (["run-a.csv", "--header", "t,q*4,i*4,k"], "are of 4 joints"),
    ],
)
def test_what_cannot_be_drafted_is_one_sentence(
    logs: Path, more: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [str(logs / word) if word.endswith(".csv") else word for word in more]
    assert ran("init", str(logs / "arm.urdf"), *words) == 2
    assert told in capsys.readouterr().err


def test_joints_without_columns_are_taken_to_rest(logs: Path) -> None:
    out = drafted(logs, "t,q*2,a,i*2,b,c,d,e")
    robot = Robot.load(out / "robot.toml")
    assert robot.names == ("base", "shoulder")
    assert dict(robot.locked) == {"elbow": 0.0}


def test_efforts_of_joint_states_are_torques_that_somebody_has_to_confirm(
    logs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = SimulatedRobot()
    table = robot.record(0, 10.0)
    words = {"position": "q", "velocity": "v", "effort": "tau"}
    columns = {"__time": table["t"]}
    for word, key in words.items():
        for j, joint in enumerate(robot.joints, 1):
            rate = np.gradient(table[f"q{j}"], table["t"]) if key == "v" else table[f"{key}{j}"]
            columns[f"/joint_states/{joint}/{word}"] = rate
    np.savetxt(
        logs / "states.csv", np.column_stack(list(columns.values())), delimiter=",",
        header=",".join(columns), comments="",
    )  # fmt: skip
    words_of = ["init", str(logs / "arm.urdf"), str(logs / "states.csv"), "-o", str(logs / "d")]
    assert ran(*words_of) == 0
    said = capsys.readouterr().out
    assert f"/joint_states/{robot.joints[0]}/effort [Nm]" in said
    assert "to do: confirm in robot.toml the unit of the input of " in said
    drafted_robot = Robot.load(logs / "d" / "robot.toml")
    assert [(one.input, one.gain) for one in drafted_robot.joints] == [("torque_nm", 1.0)] * 3
