"""A mass pulled through a spring: stick-slip when pulled slowly, smooth sliding when pulled fast.

python examples/stick_slip.py [figure.png]
"""

import sys

import numpy as np

import stiction as st
from stiction import plot

STIFFNESS = 20.0  # of the pulling spring, N·m/rad
DT = 1e-4  # s


def pull(speed, duration):
    """Time (s), position (rad), torque of the spring (N·m), break-aways, pulled at `speed`."""
    friction = st.FrictionModel(
        "hsieh_pan", breakaway=0.5, coulomb=0.35, stribeck_velocity=0.05, viscous=0.05
    )
    motor = st.Motor(inertia=0.0076, friction=friction)  # kg·m²
    position, torque = np.zeros(round(duration / DT)), np.zeros(round(duration / DT))
    x = v = 0.0
    for k in range(len(position)):
        # A load is held over its sample: take the spring at the middle of it, not at its start.
        load = STIFFNESS * (speed * (k + 0.5) * DT - (x + 0.5 * v * DT))
        x, v = motor.step(0.0, DT, load=load)
        position[k] = x
        torque[k] = STIFFNESS * (speed * (k + 1) * DT - x)
    time = DT * np.arange(1, len(position) + 1)
    return time, position, torque, motor.statistics["breakaways"]


def main():
    runs = {speed: pull(speed, 2.0) for speed in (0.1, 1.0)}  # rad/s, s
    for speed, (time, _, torque, breakaways) in runs.items():
        late = torque[time > 1.0]
        print(
            f"pulled at {speed} rad/s: {breakaways} break-aways, spring between "
            f"{late.min():.3f} and {late.max():.3f} N·m in the last second"
        )
    if len(sys.argv) > 1:
        figure, (panel,) = plot.figure()
        for (speed, (time, _, torque, _)), colour in zip(runs.items(), plot.CYCLE, strict=False):
            panel.plot(time, torque, color=colour, linewidth=1.2, label=f"{speed} rad/s")
        panel.set_xlabel("time (s)")
        panel.set_ylabel("torque of the spring (N·m)")
        plot.legend(panel)
        print("wrote", plot.save(figure, sys.argv[1]))


if __name__ == "__main__":
    main()
