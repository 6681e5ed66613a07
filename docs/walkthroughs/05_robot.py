"""
A robot arm
===========

Simulated data: one elbow whose truth is known. A robot is a machine of many joints. Its links are
fitted to all joints together, by the rigid-body dynamics of its URDF; then each joint has a
friction of its own. Needs ``pip install 'stiction[robot]'``.
"""

import tempfile
from pathlib import Path

import numpy as np

import stiction as st
from stiction.robot import Robot, RobotSession, Run, fit_robot

URDF = """<robot name="arm"><link name="base"/>
<link name="fore"><inertial><origin xyz="0.3 0 0"/><mass value="2"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.05"/></inertial></link>
<joint name="elbow" type="continuous"><parent link="base"/><child link="fore"/>
<axis xyz="0 1 0"/></joint></robot>"""
folder = Path(tempfile.mkdtemp())
(folder / "arm.urdf").write_text(URDF)

# %%
# One elbow that carries a fore-arm of 2 kg, and a log of its angle and torque.

elbow = {
    "name": "elbow",
    "columns": {"position": "q", "input": "tau"},
    "drive": {"input": "torque_nm"},
}
robot = Robot.from_dict({"robot": {"urdf": str(folder / "arm.urdf"), "joints": [elbow]}})

time = np.arange(4000) / 200.0
q = np.sin(2.0 * time) + 0.4 * np.sin(5.0 * time)
v = 2.0 * np.cos(2.0 * time) + 2.0 * np.cos(5.0 * time)
a = -4.0 * np.sin(2.0 * time) - 10.0 * np.sin(5.0 * time)
noise = 0.02 * np.random.default_rng(0).standard_normal(len(time))
torque = 0.3 * a - 2.0 * 9.81 * 0.3 * np.cos(q) + 0.8 * np.sign(v) + 0.5 * v + noise
session = RobotSession(robot, (Run((st.Recording(time, torque, q),)),))

# %%
# Links and friction together. The truth: 0.5 N·m·s/rad viscous, 0.8 N·m Coulomb, no offset.

fitted = fit_robot(session)
viscous, coulomb, bias = fitted.arm.friction[0]
print(f"viscous {viscous:.3f} N·m·s/rad, Coulomb {coulomb:.3f} N·m, offset {bias:.4f} N·m")

# %%
# The friction of the elbow over speed, fitted and true. ``stiction diagnose`` of such a session
# goes on from here: it looks for what each joint has beside this.


def joint_friction(coulomb, viscous):
    friction = {"law": "coulomb", "coulomb": float(coulomb), "viscous": float(viscous)}
    return st.Plant.from_dict({"body": {"inertia": 0.3}, "friction": friction})


curves = joint_friction(coulomb, viscous).plot_friction(label="fitted")
joint_friction(0.8, 0.5).plot_friction(ax=curves, label="true")
