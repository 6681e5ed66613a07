"""
Compensation in a loop
======================

What is an identified friction worth as a feed-forward? A simulated PD loop follows a slow sine
without it and with it; then the same joint is put into MuJoCo, whose own joint friction creeps
under a held load. Needs ``pip install 'stiction[mujoco]'``.
"""

import mujoco
import numpy as np

import stiction as st
from stiction.compensation import compensate
from stiction.mujoco import attach, step

plant = st.Plant.from_dict(
    {
        "motion": {"kind": "rotary"},
        "drive": {"input": "torque_nm", "gain": 1.0},
        "body": {"inertia": 0.0076},
        "friction": {
            "law": "maxwell_slip",
            "coulomb": 0.3,
            "initial_stiffness": 300.0,
            "viscous": 0.01,
        },
        "controller": {"kind": "pd", "kp": 20.0, "kd": 0.3},
    }
)

# %%
# The reference that the loop is to follow, half a turn to and fro.

dt = 1e-3
time = dt * np.arange(8000)
reference = 1.5 * np.sin(2 * np.pi * 0.25 * time)
torque = np.zeros(len(time))  # what was recorded does not matter: the loop is simulated
recording = st.Recording(time, torque, reference, reference=reference)

found = compensate(plant, [recording])
print(found.message)

# %%
# The tracking error over time. Where the motion turns round is where friction changes its sign.

followed = found.recordings[0].plot()

# %%
# The same friction in MuJoCo: an arm of 0.5 kg whose weight the contact bears, and bears for good.
# A joint with MuJoCo's own ``frictionloss`` creeps under it.

ARM = """<mujoco><option timestep="1e-3"/><worldbody><body>
<joint name="elbow" type="hinge" axis="0 1 0" frictionloss="{own}"/>
<geom type="capsule" fromto="0 0 0 .1 0 0" size=".02" mass=".5"/>
</body></worldbody></mujoco>"""
held = st.Plant.from_dict(
    {"body": {"inertia": 0.0076}, "friction": {"law": "coulomb", "coulomb": 0.3}}
)
model = mujoco.MjModel.from_xml_string(ARM.format(own=0.0))
elbow = attach(model, "elbow", held)
data = mujoco.MjData(model)
plain = mujoco.MjModel.from_xml_string(ARM.format(own=0.3))
without = mujoco.MjData(plain)
for _ in range(10_000):
    step(model, data, [elbow])
    mujoco.mj_step(plain, without)
print(f"after 10 s under its weight: {data.qpos[0]:.6f} rad with the law,")
print(f"{without.qpos[0]:.6f} rad with frictionloss")
