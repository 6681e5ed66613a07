"""A mass pulled through a spring: stick-slip below a critical speed, smooth sliding above it."""

import numpy as np
import pytest

import stiction as st

from .rigs import HOOK, ILLUSTRATIVE, INERTIA, drawn_rig

STIFFNESS = 20.0
STEPS = (4e-4, 1e-4, 2e-5)
# Amplitude at the three steps.
AMPLITUDE_SHARE = 0.01
# No stretch of sticking or slipping is an artefact of the step.
SHORTEST_EPISODE = 20
# Stick-slip at the first speed, smooth sliding at the second.
CASES = [
    {"viscous": 0.05, "below": 0.3, "above": 1.0},
    {"viscous": 0.1, "below": 0.2, "above": 0.5},
]


def pulled(speed, dt, duration, *, sliding=False, inertia=INERTIA, stiffness=STIFFNESS, **law):
    """Position, velocity, mode and pulling force at the end of each step, and the motor.

    Started under a slack spring, at rest or sliding at the speed of its far end.
    """
    velocity = speed if sliding else 0.0
    friction = st.FrictionModel(law.pop("law", "hsieh_pan"), **law)
    machine = st.Motor(inertia=inertia, friction=friction)
    machine.reset(velocity=velocity)
    x, v = 0.0, velocity
    rows = np.empty((round(duration / dt), 4))
    step = machine.step
    breaks = sticks = 0
    slipping = 0.0
    for k in range(len(rows)):
        load = stiffness * (speed * (k + 0.5) * dt - (x + v * dt / 2.0))
        x, v = step(0.0, dt, load=load)
        counted = machine.statistics
        if counted["breakaways"] != breaks or counted["sticks"] != sticks:
            breaks, sticks = counted["breakaways"], counted["sticks"]
            slipping = float(breaks > sticks)
        rows[k] = x, v, slipping, load
    return rows.T, machine


def episodes(mode):
    """Lengths in steps of the stretches of equal mode, but for the first and the last."""
    edges = np.flatnonzero(np.diff(mode) != 0.0)
    return np.diff(edges)


def contact(viscous, stribeck_velocity=0.05):
    return (
        ILLUSTRATIVE
        | HOOK
        | {"viscous": viscous, "stribeck_velocity": stribeck_velocity, "slip_distance": 2e-5}
    )


@pytest.mark.parametrize("start", ["rest", "sliding"])
@pytest.mark.parametrize("stribeck_velocity", [0.05, 0.1])
@pytest.mark.parametrize("case", CASES, ids=lambda case: f"viscous {case['viscous']}")
def test_stick_slip_below_and_smooth_sliding_above_the_critical_speed(
    case, stribeck_velocity, start
):
    law = contact(case["viscous"], stribeck_velocity)
    for speed, sticks in ((case["below"], True), (case["above"], False)):
        (_, v, mode, _), _ = pulled(speed, 1e-4, 3.0, sliding=start == "sliding", **law)
        late = slice(len(v) // 2, None)
        if sticks:
            assert (mode[late] == 0.0).any()
            assert (mode[late] == 1.0).any()
            assert v[late].max() > 1.3 * speed
            # The friction alone stops a body that starts without a pull, within a millisecond;
            # what comes after that is the machine's own.
            assert episodes(mode[1000:]).min() >= SHORTEST_EPISODE
        else:
            assert np.all(mode[late] == 1.0)
            # What is left of the start dies away on a flank that falls ever less.
            quarter = slice(3 * len(v) // 4, None)
            assert np.ptp(v[quarter]) < 0.5 * speed
            assert np.ptp(v[quarter]) < np.ptp(v[late])


@pytest.mark.parametrize(("viscous", "speed"), [(0.05, 0.1), (0.05, 0.3), (0.1, 0.2)])
def test_stick_slip_amplitude_does_not_depend_on_the_step(viscous, speed):
    law = contact(viscous)
    amplitudes, periods = [], []
    for dt in STEPS:
        (_, v, mode, load), machine = pulled(speed, dt, 1.0, **law)
        late = slice(len(v) // 3, None)
        amplitudes.append(np.ptp(load[late]))
        breaks = np.flatnonzero(np.diff(mode) == 1.0)
        periods.append(np.diff(breaks[1:]).mean() * dt)
        assert episodes(mode).min() >= SHORTEST_EPISODE
        assert machine.statistics["breakaways"] == len(breaks)
    assert np.ptp(amplitudes) < AMPLITUDE_SHARE * amplitudes[-1]
    assert np.ptp(periods) < AMPLITUDE_SHARE * periods[-1]


@pytest.mark.parametrize("seed", range(3))
def test_drawn_machines_stick_and_slip_alike_at_every_step(seed):
    inertia, law, force = drawn_rig(seed + 50, factor=2.0, hook=True)
    # A spring that stretches a radian at a third of break-away, as on the illustrative rig.
    stiffness = 40.0 * force
    critical_damping = 2.0 * np.sqrt(stiffness * inertia)
    law["viscous"] = 0.02 * critical_damping
    # Slow against the speed that the release of the spring reaches.
    speed = 0.3 * (law["breakaway"] - law["coulomb"]) / np.sqrt(stiffness * inertia)
    period = 2.0 * np.pi * np.sqrt(inertia / stiffness)
    amplitudes = []
    for dt in STEPS[:2]:
        (_, _, mode, load), _ = pulled(
            speed, dt, 12.0 * period, inertia=inertia, stiffness=stiffness, **law
        )
        amplitudes.append(np.ptp(load[len(load) // 2 :]))
        assert (mode == 0.0).any()
        assert episodes(mode).min() >= SHORTEST_EPISODE
    assert np.ptp(amplitudes) < AMPLITUDE_SHARE * amplitudes[-1]


@pytest.mark.parametrize("slip_distance", [2e-6, 2e-4, 5e-3])
def test_stick_slip_does_not_chatter_at_any_slip_distance(slip_distance):
    law = contact(0.05) | {"slip_distance": slip_distance}
    (_, _, mode, _), machine = pulled(0.2, 1e-4, 1.5, **law)
    assert machine.statistics["breakaways"] > 3
    assert episodes(mode).min() >= SHORTEST_EPISODE


def test_coulomb_stick_slips_with_the_exact_period():
    from tests.reference.coulomb_reference import pulled_coulomb

    speed = 0.2
    law = {"law": "coulomb", "coulomb": 0.35, "breakaway": 0.5, "stribeck_velocity": 1e-5}
    slip, stick = pulled_coulomb(speed, STIFFNESS, inertia=INERTIA, coulomb=0.35, breakaway=0.5)
    for dt in STEPS:
        (_, _, mode, _), _ = pulled(speed, dt, 1.0, **law)
        breaks = np.flatnonzero(np.diff(mode) == 1.0)
        assert np.diff(breaks).mean() * dt == pytest.approx(slip + stick, rel=AMPLITUDE_SHARE), dt
        assert episodes(mode).min() >= SHORTEST_EPISODE, dt
