"""The paper's experiments on the illustrative rig, computed with the oracles.

Protocols (Hsieh and Pan, Wear 242 (2000) 1-17, section 2.1). The paper leaves sampling,
pauses and ramps between static levels open; the values below are the readings that give
the prototype's figures for the illustrative rig.

* The controller of experiments 1 and 2 samples every millisecond. At instant k it reads the
  position; below the target it applies rate * (t_k - t_start) until instant k + 1; at or
  above it, it cuts to zero (1), or holds the value the ramp has at that very instant (2).
* Experiment 1 starts its next ramp from zero after a pause long enough for the ring to die,
  at least a quarter of a second. The target is an absolute position, never reset.
* Static levels are approached by a ramp of force of 0.045 N m/s, then held for 2 s, the
  hold counted from the end of the ramp.
* Experiment 3 starts each 0.1 s period with 0.02 s of pulse.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .hsieh_pan_reference import ARC_SECOND, HsiehPanParameters, StickingMachine

STATIC_LEVELS = (0.16, 0.02, 0.16, 0.26, 0.06, 0.26, 0.36, 0.10, 0.36, 0.40)  # N m
STATIC_RAMP = 0.045  # N m/s
STATIC_HOLD = 2.0  # s
RAMP_RATE = 0.25  # N m/s
CONTROL_PERIOD = 1e-3  # s
STEP = 5e-5  # s


@dataclass(frozen=True)
class RampAndCut:
    """Experiment 1. cut_torque N m; rest_position and peaks rad; the rest s.

    rest_position[i] is read at the end of the pause after cut i. peak_time and peak_position
    are the extremes of the first ring, the moment of the cut excluded.
    """

    cut_time: np.ndarray
    cut_torque: np.ndarray
    rest_position: np.ndarray
    peak_time: np.ndarray
    peak_position: np.ndarray

    def ring_frequency(self):
        """Hz, one value for each half cycle of the first ring."""
        return 0.5 / np.diff(self.peak_time)

    def half_cycle_ratio(self):
        """Ratio of consecutive excursions from the first rest position."""
        excursion = np.abs(self.peak_position - self.rest_position[0])
        return excursion[1:] / excursion[:-1]


def ramp_and_cut(
    *, target=24.0 * ARC_SECOND, cuts=3, pause=0.25, control_period=CONTROL_PERIOD, **parameters
):
    """Experiment 1: ramp until the target is reached, cut, pause, repeat."""
    machine = StickingMachine(**parameters)
    substeps = round(control_period / STEP)
    start = k = 0
    cut_time, cut_torque, rest, times, positions = [], [], [], [], []
    while len(rest) < cuts:
        if machine.position < target:
            torque = RAMP_RATE * (k - start) * control_period
            for _ in range(substeps):
                machine.advance(torque, STEP)
            k += 1
            continue
        cut_time.append(k * control_period)
        cut_torque.append(RAMP_RATE * (k - start) * control_period)
        for _ in range(round(pause / control_period)):
            for _ in range(substeps):
                machine.advance(0.0, STEP)
                if not rest:
                    times.append(machine.time)
                    positions.append(machine.position)
            k += 1
        rest.append(machine.position)
        start = k
    peak_time, peak_position = _peaks(np.array(times), np.array(positions))
    return RampAndCut(
        np.array(cut_time), np.array(cut_torque), np.array(rest), peak_time, peak_position
    )


def _peaks(time, position, least=0.5 * ARC_SECOND):
    """Extremes by a parabola through three samples, as far as swings exceed `least`."""
    before, here, after = position[:-2], position[1:-1], position[2:]
    at = np.flatnonzero((here - before) * (after - here) < 0.0) + 1
    curvature = position[at + 1] - 2.0 * position[at] + position[at - 1]
    lean = position[at + 1] - position[at - 1]
    peak_time = time[at] - (time[1] - time[0]) * lean / (2.0 * curvature)
    peak_position = position[at] - lean**2 / (8.0 * curvature)
    swings = np.abs(np.diff(peak_position))
    last = 1 + int(np.argmax(swings < least)) if np.any(swings < least) else at.size
    # The cut itself may leave a tiny overshoot of the target; it is not part of the ring.
    first = 1 if peak_time[0] - time[0] < 2e-3 else 0
    return peak_time[first:last], peak_position[first:last]


def ramp_and_hold(
    *,
    target=12.0 * ARC_SECOND,
    read_after=(0.25, 0.5, 1.0, 2.0, 3.0),
    control_period=CONTROL_PERIOD,
    **parameters,
):
    """Experiment 2. Returns (held torque, position one period after, positions at read_after)."""
    machine = StickingMachine(**parameters)
    substeps = round(control_period / STEP)
    k = 0
    while machine.position < target:
        for _ in range(substeps):
            machine.advance(RAMP_RATE * k * control_period, STEP)
        k += 1
    torque = RAMP_RATE * k * control_period
    readings = [round(t / control_period) for t in (control_period, *read_after)]
    positions = []
    for i in range(1, readings[-1] + 1):
        for _ in range(substeps):
            machine.advance(torque, STEP)
        if i in readings:
            positions.append(machine.position)
    return torque, positions[0], np.array(positions[1:])


def pulse_train(*, sizes=(0.15, 0.2, 0.15, -0.15), pulses=20, machine=None, **parameters):
    """Experiment 3: 10 Hz, 20 % duty. Hardening (rad) at the end of each train of pulses."""
    machine = machine or StickingMachine(**parameters)
    hardening = []
    for size in sizes:
        for _ in range(pulses):
            for _ in range(round(0.02 / STEP)):
                machine.advance(size, STEP)
            for _ in range(round(0.08 / STEP)):
                machine.advance(0.0, STEP)
        hardening.append(machine.hardening)
    return np.array(hardening)


@dataclass(frozen=True)
class ForcePath:
    """Position, plastic (x_p) and hardening (h), rad, at the end of each held level."""

    position: np.ndarray
    plastic: np.ndarray
    hardening: np.ndarray


def force_driven_path(
    levels=STATIC_LEVELS, *, ramp_rate=STATIC_RAMP, hold=STATIC_HOLD, ramp_steps=2000, **parameters
):
    """Levels of force approached by ramps and held, with no inertia and no damper.

    The force is known, so that h' = alpha (f - h) is a linear equation with a given right-hand
    side: an exponential with the mid-point force in each of `ramp_steps` pieces of a ramp,
    exact while the level is held. `ramp_rate = inf` steps at once.
    """
    p = HsiehPanParameters(**parameters)
    spring = p.spring()
    plastic = hardening = force = 0.0
    rows = []
    for level in levels:
        piece = abs(level - force) / ramp_rate / ramp_steps
        stretches = [
            (force + (level - force) * (i + 0.5) / ramp_steps, piece) for i in range(ramp_steps)
        ]
        for held, time in (*stretches, (level, hold)):
            excess = p.possible_hardening(held) - hardening
            if excess > 0.0:
                growth = -excess * math.expm1(-p.creep_rate * time)
                hardening += growth
                plastic += math.copysign(growth, held)
        rows.append((spring.move_to_force(level) + plastic, plastic, hardening))
        force = level
    return ForcePath(*np.array(rows).T)


def dahl_displacement(start, end, *, stiffness=2063.0, coulomb=0.5):
    """Travel of Dahl's law with i = 2 between two forces, rad, in closed form.

    dF/dx = gamma (1 - s F / F_c)^2 in direction s gives
    x = s (F_c / gamma) [1 / (1 - s F / F_c)] between the two forces.
    """
    s = math.copysign(1.0, end - start)
    inverse = [1.0 / (1.0 - s * force / coulomb) for force in (start, end)]
    return s * coulomb / stiffness * (inverse[1] - inverse[0])
