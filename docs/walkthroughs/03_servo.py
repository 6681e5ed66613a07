"""
A servo
=======

The input of a servo is a goal position. Its electronics turn the position error into a voltage,
so every simulation is a closed loop, and a fit compares positions. Here a simulated servo with a
payload is identified from goals and positions alone.
"""

import numpy as np

import stiction as st

stated = {
    "motion": {"kind": "rotary"},
    "drive": {
        "kind": "servo",
        "proportional": 1.2,
        "supply_v": 7.4,
        "resistance_ohm": 3.5,
        "torque_constant": 0.4,
    },
    "body": {"inertia": 0.004, "payload_kg": 0.5, "payload_m": 0.1},
    "friction": {"law": "coulomb", "coulomb": 0.06, "viscous": 0.02},
    "sensor": {"counts_per_rev": 4096},
}
servo = st.Plant.from_dict(stated)

# %%
# Goals in steps and in slow swings, at 200 samples a second, as a log of a bus has them.

dt = 5e-3
time = dt * np.arange(4000)
goal = 0.6 * np.sin(0.9 * time) + 0.5 * np.sign(np.sin(1.7 * time)) * (time > 8.0)
run = servo.simulate(goal[:-1], dt, outputs=["position", "measured"])
recording = st.Recording(time, goal, np.concatenate([[0.0], run.measured]))

# %%
# The payload was weighed, the drive is known. Friction is not, and the inertia of rotor and gears
# is a guess to start from, half of what it is.

guessed = {"inertia": 0.002, "payload_kg": 0.5, "payload_m": 0.1}
unknown = st.Plant.from_dict({**stated, "body": guessed, "friction": {"law": "coulomb"}})
found = st.fit(unknown, recording)
print(found.summary())

# %%
# From the goal alone, the fitted servo against the recorded one.

again = found.plant.simulate(goal[:-1], dt, outputs=["position"])
off = np.sqrt(np.mean((again.position - run.position) ** 2))
print(f"position error of the loop: {1e3 * off:.2f} mrad rms")
compared = again.plot()
