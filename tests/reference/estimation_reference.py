"""Recordings for the estimation of parameters, made by the oracle of the sticking machine.

Five recordings, each from a virgin contact at rest: torque held and then loops below the held
level; a staircase of holds; experiment 2; experiment 1 to two targets. Torques of experiments 1
and 2 are open-loop here, cut or held where the illustrative rig reaches about 24, 40 and 12
arc-seconds.
"""

from __future__ import annotations

import numpy as np

from .hsieh_pan_reference import ARC_SECOND, simulate_sticking

COUNT = 0.8 * ARC_SECOND  # rad
NOISE = 0.4 * ARC_SECOND  # rad rms, half a count, before rounding
SLOW, FAST = 1e-3, 1e-4  # s
STEPS = {SLOW: 2.5e-4, FAST: 1e-4}  # s, of the oracle; a ring asks for finer ones
TRUTH = {
    "initial_stiffness": 3000.0,
    "final_stiffness": 800.0,
    "decay_distance": 60.0 * ARC_SECOND,
    "hardening_coefficient": 1.6e-3,
    "hardening_exponent": 2.0,
    "creep_rate": 2.0,
    "damping": 0.45,
    "inertia": 0.0076,
}


def through(levels, rate, hold, start=0.0, dt=SLOW):
    """Torque through levels: ramps at `rate` (N m/s), each level held for `hold` (s)."""
    pieces, torque = [], start
    for level in levels:
        samples = max(1, round(abs(level - torque) / rate / dt))
        pieces.append(torque + (level - torque) * np.arange(1, samples + 1) / samples)
        pieces.append(np.full(round(hold / dt), level))
        torque = level
    return np.concatenate(pieces)


def ramps_and_cuts(cut, repeats, dt=FAST, rate=0.25, pause=0.25):
    """Experiment 1 by torque alone: ramp to `cut` (N m), cut, pause, again."""
    ramp = rate * dt * np.arange(round(cut / rate / dt))
    return np.tile(np.concatenate([ramp, np.zeros(round(pause / dt))]), repeats)


def torques():
    """Name: (dt in s, torque in N m)."""
    loops = np.concatenate(
        [through([0.40], 0.2, 4.0), through([0.1, 0.4, -0.1, 0.4, -0.3, 0.4], 0.2, 0.4, 0.4)]
    )
    ramp = 0.25 * SLOW * np.arange(540)
    return {
        "loops": (SLOW, loops),
        "holds": (SLOW, through([0.12, 0.2, 0.3, 0.4], 0.2, 3.0)),
        "experiment 2": (SLOW, np.concatenate([ramp, np.full(4000, 0.135)])),
        "experiment 1": (FAST, ramps_and_cuts(0.215, 4)),
        "experiment 1, farther": (FAST, ramps_and_cuts(0.30, 4)),
    }


def motions():
    """Positions of the oracle, rad, by name of the recording."""
    return {
        name: simulate_sticking(torque, dt, step=STEPS[dt], **TRUTH).position
        for name, (dt, torque) in torques().items()
    }


def readings(position, rng, noise=NOISE):
    """Position as a noisy encoder of 0.8 arc-seconds reads it."""
    return np.round((position + rng.normal(0.0, noise, len(position))) / COUNT) * COUNT
