"""Friction inside an implicit solver of yours: trial as often as the iteration needs, then commit.

A mass on a stiff spring, J·x'' + K·x = u − F, by the trapezoidal rule with Newton's iteration.

python examples/implicit_host.py [figure.png]
"""

import sys

import numpy as np

import stiction as st
from stiction import plot

J, K = 0.0076, 500.0  # kg·m², N·m/rad
DT = 2e-4  # s
TIME = DT * np.arange(1, 4001)
TORQUE = 0.6 * np.sin(2 * np.pi * 5.0 * TIME)  # held over each sample, N·m


def host(law):
    """Positions at the end of each sample, and how many trials they took."""
    x = v = 0.0
    force, trials = 0.0, 0
    positions = np.empty(len(TORQUE))
    for k, u in enumerate(TORQUE):
        start, new = u - K * x - force, v
        for _ in range(20):
            # The law sees the mean velocity of the sample: its displacement is then exact.
            mean = 0.5 * (v + new)
            force, slope = law.trial(mean, DT)
            trials += 1
            miss = J * (new - v) / DT - 0.5 * (start + u - K * (x + DT * mean) - force)
            step = miss / (J / DT + 0.25 * (K * DT + slope))
            new -= step
            if abs(step) < 1e-12:
                break
        law.commit()  # only now does the law remember anything
        x, v = x + DT * mean, new
        positions[k] = x
    return positions, trials


def main():
    law = st.FrictionModel("hsieh_pan", breakaway=0.5, stribeck_velocity=0.05)
    ours, trials = host(law.copy())
    print(f"{trials / len(ours):.2f} trials a sample; ends at {ours[-1]:.6e} rad")
    print(f"{law.state['breakaways']:.0f} break-aways in the law that was copied, never stepped")
    if len(sys.argv) > 1:
        figure, (panel,) = plot.figure()
        panel.plot(TIME, ours, color=plot.SIMULATED, linewidth=1.2)
        panel.set_xlabel("time (s)")
        panel.set_ylabel("position (rad)")
        print("wrote", plot.save(figure, sys.argv[1]))


if __name__ == "__main__":
    main()
