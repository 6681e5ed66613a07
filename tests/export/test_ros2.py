"""Parameters of a ROS 2 controller, read again by a YAML reader and evaluated as it does."""

import re

import numpy as np
import pytest

import stiction as st
from stiction.export import targets
from stiction.robot.export import export_robot
from stiction.robot.robot import Robot

from .test_steady import plant

yaml = pytest.importorskip("yaml")
DRY = {"law": "coulomb", "coulomb": 0.3, "viscous": 0.02}
UNEVEN = {"name": "direction_asymmetry", "coulomb": 0.1, "velocity": 1e-3}
ARM = """<robot name="arm"><link name="a"/><link name="b"/><link name="c"/>
<joint name="shoulder" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="9" velocity="3"/></joint>
<joint name="elbow" type="{kind}"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="9" velocity="3"/></joint></robot>"""
JOINT = """
[[robot.joints]]
name = "{name}"
columns = {{ position = "q", input = "u" }}
drive = {{ input = "{input}", gain = 1.0 }}
friction = {{ law = "coulomb", coulomb = {coulomb}, viscous = 0.1 }}
"""


def parameters(made):
    table = yaml.safe_load(made.files["friction.yaml"])
    (controller,) = table.values()
    own = controller["ros__parameters"]
    assert own["use_friction"] is True
    columns = [own["friction"][name] for name in ("fp1", "fp2", "fp3")]
    # A double_array takes no whole numbers and no words.
    assert all(isinstance(value, float) for column in columns for value in column)
    return own["joints"], np.array(columns)


def controller(velocity, fp1, fp2, fp3):
    return fp1 / (1.0 + np.exp(-fp2 * (velocity + fp3))) - fp1 / (1.0 + np.exp(-fp2 * fp3))


def test_the_ends_of_the_curve_are_the_dry_friction_of_each_direction():
    made = plant(DRY, UNEVEN).export("ros2", speed=5.0)
    joints, ((fp1,), (fp2,), (fp3,)) = parameters(made)
    assert joints == ["joint"]
    assert [made.numbers[name] for name in ("fp1", "fp2", "fp3")] == [fp1, fp2, fp3]
    assert controller(20.0, fp1, fp2, fp3) == pytest.approx(0.33, rel=1e-4)
    assert controller(-20.0, fp1, fp2, fp3) == pytest.approx(-0.27, rel=1e-4)
    assert controller(0.0, fp1, fp2, fp3) == 0.0
    assert controller(0.5, fp1, fp2, fp3) > 0.94 * 0.33
    (run,) = targets()["ros2"].runs(made, plant(DRY, UNEVEN))
    speeds = np.linspace(-5.0, 5.0, 41)
    by_controller = controller(speeds, fp1, fp2, fp3)
    assert run.effort(speeds, 0.0 * speeds) == pytest.approx(by_controller, abs=1e-12)
    told = " / ".join(made.lost)
    assert "viscous friction: 0.02" in told
    assert "below 0.5 rad/s" in told
    assert "direction" not in told
    assert all(each in made.files["friction.yaml"] for each in made.lost)


@pytest.mark.parametrize("coulomb", [0.0, 1e-12, 3e-5, 7.0])
def test_numbers_of_any_size_are_read_again(coulomb):
    made = plant({"law": "coulomb", "coulomb": coulomb}).export("ros2")
    _, columns = parameters(made)
    assert columns[0, 0] == made.numbers["fp1"]
    assert columns[0, 0] == pytest.approx(2.0 * coulomb, rel=1e-9)


def test_friction_of_nearly_one_direction_alone():
    made = plant(DRY, {**UNEVEN, "coulomb": 0.9}).export("ros2")
    _, columns = parameters(made)
    ends = controller(np.array([-20.0, 20.0]), *columns[:, 0])
    assert ends == pytest.approx([-0.03, 0.57], rel=1e-3)


def robot(folder, kind="revolute", driven="torque_nm"):
    (folder / "arm.urdf").write_text(ARM.format(kind=kind))
    text = '[robot]\nurdf = "arm.urdf"\n'
    for name, own, coulomb in (("elbow", driven, 0.2), ("shoulder", "torque_nm", 0.5)):
        text += JOINT.format(name=name, input=own, coulomb=coulomb)
    (folder / "robot.toml").write_text(text)
    return Robot.load(folder / "robot.toml")


def test_all_joints_of_a_robot_are_one_controller(tmp_path):
    made = export_robot(robot(tmp_path), "ros2")
    assert list(made) == [""]
    joints, columns = parameters(made[""])
    assert joints == ["shoulder", "elbow"]  # from the base on, as the controller has them
    assert columns[0] == pytest.approx([1.0, 0.4], rel=1e-6)
    assert made[""].numbers["elbow.fp1"] == columns[0, 1]
    assert any(each.startswith("elbow: viscous friction: 0.1") for each in made[""].lost)


def test_joints_that_go_straight_are_refused(tmp_path):
    with pytest.raises(st.InputError, match=r"joint 'elbow'.*take joints that turn") as told:
        export_robot(robot(tmp_path, "prismatic", "force_n"), "ros2")
    assert re.fullmatch(r"[^\n]+", str(told.value))
    with pytest.raises(st.InputError, match="speed = 0 is none"):
        export_robot(robot(tmp_path), "ros2", speed=0.0)
