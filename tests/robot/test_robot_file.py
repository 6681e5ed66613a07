"""Robot files and their sessions: what is read, and one sentence for what is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from stiction.errors import InputError
from stiction.robot import Robot, load_session
from stiction.robot.session import robot_of

URDF = """<robot name="two">
<link name="a"/><link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1"
iyz="0" izz="1"/></inertial></link><link name="c"/>
<joint name="turn" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="slide" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""

PLAIN = """[robot]
urdf = "two.urdf"
[[robot.joints]]
name = "turn"
columns = { position = "q", input = "i" }
drive = { input = "current_a", gain = 0.1, gear_ratio = 50.0 }
[[robot.joints]]
name = "slide"
columns = { position = { name = "x", unit = "mm" }, input = "f" }
drive = { input = "force_n" }
"""

_SLIDE = PLAIN[PLAIN.index('name = "slide"') :]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "two.urdf").write_text(URDF)
    (tmp_path / "robot.toml").write_text(PLAIN)
    time = np.arange(300) / 100.0
    np.savez(
        tmp_path / "run.npz",
        t=time,
        q=0.5 * np.sin(time),
        i=np.cos(time),
        x=100.0 * np.sin(2.0 * time),
        f=np.sin(time),
    )
    (tmp_path / "session.toml").write_text(
        'plant = "robot.toml"\n[columns]\ntime = "t"\n[[recordings]]\nfile = "run.npz"\n'
        "payload_kg = 2.0\n"
    )
    return tmp_path


def test_a_robot_file_says_how_each_joint_is_driven(folder: Path) -> None:
    robot = Robot.load(folder / "robot.toml")
    assert robot.names == ("turn", "slide")
    turn, slide = robot.joints
    assert (turn.motion, slide.motion) == ("rotary", "linear")
    assert turn.effort_per_input == pytest.approx(5.0)
    plant = turn.plant(0.2)
    assert plant.gain == pytest.approx(5.0)
    assert [effect.name for effect in plant.effects] == ["torque_bias"]


def test_a_session_of_a_robot_has_all_joints_over_one_clock(folder: Path) -> None:
    assert robot_of(folder / "session.toml") == (folder / "robot.toml").resolve()
    (run,) = load_session(folder / "session.toml").runs
    turn, slide = run.joints
    assert run.payload == 2.0
    assert np.array_equal(turn.time, slide.time)
    assert slide.position is not None
    assert np.max(slide.position) == pytest.approx(0.1, rel=1e-3)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('"two.urdf"', '"three.urdf"', "there is no such file"),
        ('"two.urdf"', "2", r"urdf = 2; write urdf ="),
        ('name = "turn"', 'name = "tern"', r"'tern' is unknown \(did you mean 'turn'"),
        (_SLIDE, _SLIDE.replace("slide", "turn").replace("force_n", "torque_nm"), "there twice"),
        ('input = "force_n"', 'input = "torque_nm"', "allowed are .*force_n"),
        ("gain = 0.1", "gain = -0.1", "give a finite number above 0"),
        ("gain = 0.1", "gane = 0.1", r"'gane' is unknown \(did you mean 'gain'"),
        (', input = "f"', "", "lacks the input"),
        ('drive = { input = "force_n" }', "", "drive is missing"),
        ('drive = { input = "force_n" }', 'friction = { law = "kulomb" }', "drive is missing"),
        (
            'drive = { input = "force_n" }',
            'drive = { input = "force_n" }\nfriction = { law = "kulomb" }',
            "joint 'slide'.*kulomb",
        ),
        ("[robot]", "[robot]\ngravity = [1.0]", "give three numbers"),
        ("[robot]", "[robot]\nlocked = { turn = inf }", "give a finite position"),
    ],
)
def test_what_cannot_be_read_is_one_sentence(folder: Path, old: str, new: str, told: str) -> None:
    assert old in PLAIN
    (folder / "robot.toml").write_text(PLAIN.replace(old, new))
    with pytest.raises(InputError, match=told) as caught:
        Robot.load(folder / "robot.toml")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("<robot><link", "is not XML"),
        ("<model/>", "and not <robot>"),
        ("<robot/>", "has no joint that moves"),
        (
            URDF.replace('<axis xyz="0 0 1"/>', '<mimic joint="turn" multiplier="x"/>', 2),
            "has 'x' for a number",
        ),
        (URDF.replace('value="1"', 'value="nan"'), "<mass> of link 'b' has value = 'nan'"),
        (URDF.replace('iyy="1"', 'iyy="-1"'), "<inertia> of link 'b' has iyy = '-1'"),
        (URDF.replace('xyz="0 0 1"', 'xyz="0 0 0"', 1), "axis of joint 'turn' is '0 0 0'"),
        (URDF.replace('child link="c"', 'child link="d"'), "is link 'd', which the file does not"),
        (URDF.replace('child link="c"', 'child link="b"'), "'b' hangs on two joints"),
        (URDF.replace('parent link="a"', 'parent link="c"'), "hangs on itself"),
        (URDF.replace('name="slide"', 'name="turn"'), "has joint 'turn' twice"),
    ],
)
def test_a_urdf_that_is_none_is_refused(folder: Path, text: str, told: str) -> None:
    (folder / "two.urdf").write_text(text)
    with pytest.raises(InputError, match=told):
        Robot.load(folder / "robot.toml")


def test_all_faulty_recordings_are_named_at_once(folder: Path) -> None:
    session = (folder / "session.toml").read_text()
    for k in (1, 2):
        np.savez(folder / f"bad{k}.npz", t=np.arange(300.0))
        session += f'[[recordings]]\nfile = "bad{k}.npz"\n'
    (folder / "session.toml").write_text(session)
    with pytest.raises(InputError, match=r"2 recordings cannot be read: \(1\).*bad1.*\(2\).*bad2"):
        load_session(folder / "session.toml")


def test_a_setting_of_a_servo_is_none_of_a_robot(folder: Path) -> None:
    session = (folder / "session.toml").read_text() + "supply_v = 12.0\n"
    (folder / "session.toml").write_text(session)
    with pytest.raises(InputError, match="supply_v is no setting of a robot"):
        load_session(folder / "session.toml")
