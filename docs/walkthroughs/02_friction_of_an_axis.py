"""
Friction of a linear axis
=========================

**Simulated data.** The axis has the published mass, gain and friction of the EMPS benchmark (95
kg on a ball screw, driven by a voltage). The recording of the benchmark itself states no licence,
so it is not part of this package; :doc:`the effort residual </effort-residual>` has what the real
one gives, and the command for it. Which mass, Coulomb and viscous friction does the axis have,
and how well does a recording tell? As it is simulated, the answer is known.
"""

import numpy as np

import stiction as st

GAIN = 35.15  # N/V, as published for EMPS
axis = st.Plant.from_dict(
    {
        "motion": {"kind": "linear"},
        "drive": {"input": "voltage_v", "gain": GAIN},
        "body": {"inertia": 95.1},
        "friction": {"law": "coulomb", "coulomb": 20.4, "viscous": 203.5},
        "effects": [{"name": "torque_bias", "bias": -3.2}],
        "sensor": {"count_m": 1e-6},
    }
)

# %%
# Trapezoids of voltage at several levels, with a ripple that keeps the acceleration from being the
# same at every start.

dt = 1e-3
time = dt * np.arange(24_000)
levels = np.repeat([1.5, -1.5, 2.5, -2.5, 1.0, -1.0, 3.0, -3.0], 3000)
voltage = levels + 0.8 * np.sin(2 * np.pi * 3.7 * time)
measured = axis.simulate(voltage[:-1], dt, outputs=["measured"]).measured
position = np.concatenate([[0.0], measured])

# %%
# What a user knows: the gain of the drive, and that friction is dry. Nothing else is stated; the
# starting values come from the data.

unknown = st.Plant.from_dict(
    {
        "motion": {"kind": "linear"},
        "drive": {"input": "voltage_v", "gain": GAIN},
        "friction": {"law": "coulomb"},
        "effects": [{"name": "torque_bias"}],
    }
)
found = st.fit(unknown, st.Recording(time, voltage, position))
print(found.summary())

# %%
# Standard errors allow for residuals that are correlated over a second. The truth lies within them.

for name, true in {"inertia": 95.1, "coulomb": 20.4, "viscous": 203.5, "bias": -3.2}.items():
    number = found[name]
    low, high = number.ci95
    print(f"{name}: {number.value:.2f}, 95 % {low:.2f} to {high:.2f}; true {true}")

# %%
# Friction over speed, fitted and true, drawn into one figure.

curves = found.plant.plot_friction(label="fitted")
axis.plot_friction(ax=curves, label="true")
