"""Nested hysteresis loops before the slip: reverse points are recovered, closed loops forgotten.

python examples/presliding_loops.py [figure.png]
"""

import sys

import numpy as np

import stiction as st
from stiction import plot

ARC_SECOND = np.pi / 648_000.0  # rad
# Where the motion turns round, arc-seconds: a loop, in it a loop, in that another one.
TURNS = (0.0, 60.0, -20.0, 40.0, 10.0, 40.0, -20.0, 60.0, 80.0)
SPEED = 10.0 * ARC_SECOND  # rad/s
DT = 0.01  # s


def walk():
    """Position (rad), friction (N·m) along the path, and what is remembered at its turns."""
    # Spring alone: neither creep nor damper, so that the loops close to the last digits.
    law = st.FrictionModel(
        "hsieh_pan",
        initial_stiffness=3000.0,  # N·m/rad, right after a turn
        final_stiffness=500.0,  # N·m/rad, far from it
        decay_distance=30.0 * ARC_SECOND,
        hardening_coefficient=0.0,
        damping=0.0,
    )
    position, friction, turns = [0.0], [0.0], []
    for leg in np.diff(TURNS) * ARC_SECOND:
        samples = round(abs(leg) / (SPEED * DT))
        friction += list(law.simulate(np.full(samples, leg / (samples * DT)), DT))
        position += list(position[-1] + leg * np.arange(1, samples + 1) / samples)
        turns.append((friction[-1], len(law.state["reverse_points"])))
    return np.array(position), np.array(friction), turns


def main():
    position, friction, turns = walk()
    for turn, (force, points) in zip(TURNS[1:], turns, strict=True):
        print(f"at {turn:5.1f} arcsec: {force:+.9f} N·m, {points} reverse points remembered")
    if len(sys.argv) > 1:
        figure, (panel,) = plot.figure()
        panel.plot(position / ARC_SECOND, friction, color=plot.SIMULATED, linewidth=1.2)
        panel.set_xlabel("position (arcsec)")
        panel.set_ylabel("friction (N·m)")
        print("wrote", plot.save(figure, sys.argv[1]))


if __name__ == "__main__":
    main()
