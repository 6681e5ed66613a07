"""A robot from its URDF and logs to findings: as a user goes, with the truth known."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stiction.cli import main
from stiction.errors import InputError
from stiction.robot import Robot, RobotDiagnosis, diagnose_robot, load_session
from stiction.robot.export import export_robot

from .simulated import Friction, SimulatedRobot, drawn

pytest.importorskip("pinocchio")
pytest.importorskip("mujoco")

HIDDEN = SimulatedRobot(
    friction=(
        Friction(6.0, 8.0, 0.1),
        Friction(5.0, 7.0, -0.2),
        Friction(3.0, 3.0, 0.05, "viscous_quadratic", 0.6),
    )
)
"""Friction of the elbow that grows faster than its speed."""
SECONDS = 8.0


def ran(*words: str) -> int:
    """Exit status of the program."""
    with pytest.raises(SystemExit) as left:
        main(list(words))
    return int(left.value.code or 0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    where = tmp_path_factory.mktemp("robot")
    session = HIDDEN.lay_out(where, seconds=SECONDS)
    assert ran("diagnose", str(session), "--surrogates", "8", "-o", str(where / "out")) == 0
    return where


@pytest.fixture(scope="module")
def findings(folder: Path) -> dict[str, Any]:
    told: dict[str, Any] = json.loads((folder / "out" / "findings.json").read_text())
    return told


def test_what_a_draft_left_open_is_said_with_the_answer(tmp_path: Path) -> None:
    session = HIDDEN.lay_out(tmp_path, seconds=1.0)
    assert load_session(session).assumed == ()
    robot = session.with_name("robot.toml")
    robot.write_text("# TO DO: state the gain.\n" + robot.read_text())
    (told,) = load_session(session).assumed
    assert f"{robot}: 1 line of the draft still says TO DO (1)" in told


def test_the_effect_is_named_in_its_joint_and_nowhere_else(findings: dict[str, Any]) -> None:
    named = {(cause["joint"], cause["name"]) for cause in findings["effects"] if cause["decided"]}
    assert named == {("elbow", "viscous_quadratic")}
    assert findings["verdict"] in ("missing_effect", "ambiguous")
    assert "elbow lacks viscous_quadratic" in findings["sentence"]


def test_the_error_of_held_out_torque_is_told_before_and_after(findings: dict[str, Any]) -> None:
    errors = {joint["name"]: joint["heldout_error"] for joint in findings["joints"]}
    assert list(errors) == list(HIDDEN.joints)
    assert errors["elbow"]["reduction"] > 0.5
    assert errors["elbow"]["after"] < 0.05
    assert errors["base"]["reduction"] == pytest.approx(0.0, abs=0.1)


def test_findings_keep_the_keys_of_schema_1(findings: dict[str, Any]) -> None:
    assert findings["schema"] == 1
    kept = ("verdict", "sentence", "effects", "gain", "candidates", "laws", "baseline", "extended")
    assert set(kept) < set(findings)
    assert {"unexplained", "advice", "data", "version", "seed", "seconds"} < set(findings)
    assert findings["assumed"] == []


def test_recordings_agree_where_nothing_differs(findings: dict[str, Any]) -> None:
    rows = findings["agreement"]
    assert {(row["joint"], row["parameter"]) for row in rows} >= {
        (joint, f"friction.{name}") for joint in HIDDEN.joints for name in ("coulomb", "viscous")
    }
    assert all(len(row["values"]) == 4 for row in rows)
    assert np.mean([row["overlaps"] for row in rows]) > 0.8


def test_each_joint_has_a_page_of_its_own_behind_that_of_the_arm(folder: Path) -> None:
    out = folder / "out"
    page = (out / "report.html").read_text()
    for joint in HIDDEN.joints:
        assert f'href="{joint}/report.html"' in page
        assert (out / joint / "report.html").is_file()
        own = json.loads((out / joint / "findings.json").read_text())
        assert own["baseline"]["effects"] == ["torque_bias"]
    assert "Do the recordings agree?" in page
    assert "{{" not in page
    assert "None" not in page


def test_what_was_found_is_a_robot_again_and_goes_to_other_tools(
    folder: Path, tmp_path: Path
) -> None:
    robot = Robot.load(folder / "out" / "robot.toml")
    (elbow,) = (joint for joint in robot.joints if joint.name == "elbow")
    assert [effect["name"] for effect in elbow.effects] == ["torque_bias", "viscous_quadratic"]
    assert elbow.rotor_inertia == pytest.approx(HIDDEN.rotors[2], rel=0.2)
    file = str(folder / "out" / "robot.toml")
    asked = [word for name in ("urdf", "mujoco", "table") for word in ("--to", name)]
    assert ran("export", file, *asked, "-o", str(tmp_path)) == 0
    tree = ET.parse(tmp_path / "urdf" / "arm.urdf")
    dynamics = {
        joint.attrib["name"]: joint.find("dynamics") for joint in tree.getroot().findall("joint")
    }
    base = dynamics["base"]
    assert base is not None
    assert float(base.attrib["damping"]) == pytest.approx(8.0, rel=0.05)
    assert float(base.attrib["friction"]) == pytest.approx(6.0, rel=0.05)
    joints = ET.parse(tmp_path / "mujoco" / "joints.xml").getroot().findall("joint")
    assert all(joint.get("solreffriction") == "0.0001 1.0" for joint in joints)
    assert [joint.attrib["name"] for joint in joints] == list(HIDDEN.joints)
    assert all((tmp_path / "table" / name / "table.json").is_file() for name in HIDDEN.joints)


def test_the_files_of_the_user_are_spared(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert ran("diagnose", str(folder / "session.toml"), "-o", str(folder)) == 2
    assert "is not overwritten" in capsys.readouterr().err


def test_what_only_one_axis_has_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    session = str(folder / "session.toml")
    assert ran("diagnose", session, "--add", str(folder / "run0.npz")) == 2
    assert "--add is for machines of one axis" in capsys.readouterr().err
    robot = str(folder / "robot.toml")
    assert ran("export", robot, "--to", "urdf", "--check", session) == 2
    assert "--check runs a machine of one axis" in capsys.readouterr().err
    with pytest.raises(InputError, match="to = 'nothing' is unknown"):
        export_robot(Robot.load(robot), "nothing")


@pytest.mark.slow
@pytest.mark.parametrize("seed", [6, 7, 8])
def test_drawn_robots_lack_what_was_hidden(tmp_path: Path, seed: int) -> None:
    robot, joint, effect = drawn(seed)
    session = load_session(robot.lay_out(tmp_path, seconds=16.0, seed=seed))
    with np.errstate(all="ignore"):
        found: RobotDiagnosis = diagnose_robot(session)
    named = {
        (each.name, cause.name)
        for each in found.joints
        for cause in each.diagnosis.effects
        if cause.decided
    }
    assert named == {(joint, effect)}
