"""Friction in an implicit solver of your own: try as often as the iteration needs, then commit.

J·x'' + K·x = u − F by the trapezoidal rule.    python examples/implicit_host.py
"""

import numpy as np

import stiction as st

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


def explicit(law):
    """The same by Motor, the spring as a load taken at the middle of each sample."""
    motor = st.Motor(inertia=J, friction=law)
    x = v = 0.0
    positions = np.empty(len(TORQUE))
    for k, u in enumerate(TORQUE):
        x, v = motor.step(u, DT, load=-K * (x + 0.5 * DT * v))
        positions[k] = x
    return positions


def main():
    law = st.FrictionModel("hsieh_pan", breakaway=0.5, stribeck_velocity=0.05)
    ours, trials = host(law.copy())
    theirs = explicit(law)  # Motor copies the law it is given: this one is still virgin
    apart = np.abs(ours - theirs).max() / np.ptp(theirs)
    print(f"{trials / len(ours):.2f} trials a sample; {100 * apart:.2f} % of the range from Motor")


if __name__ == "__main__":
    main()
