"""Sessions that people describe in public, made again by a simulator of their own."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

import stiction as st
from stiction.bench.ordinary.machine import Effects, Machine, simulate

COUNTS = 8192
ORDERS = (42, 84)
"""Of motors with 6 and with 12 slots and 7 pole pairs."""


def read(position: list[float], count: float, rng: np.random.Generator) -> np.ndarray:
    """As an encoder reads it, which flickers a little."""
    x = np.array(position) / count
    return np.round(x + 0.1 * rng.standard_normal(len(x))) * count


@cache
def motor_with_cogging(order: int) -> tuple[st.Recording, ...]:
    """A light motor that follows slow references under a stiff loop, at 1 kHz."""
    machine = Machine(
        inertia=1e-4,
        coulomb=0.03,
        viscous=0.002,
        effects=Effects(waves=((0.012, float(order), 0.7),)),
    )
    found = []
    for k in range(3):
        rng = np.random.default_rng([order, k])
        dt, samples = 1e-3, 8000
        t = np.arange(samples) * dt
        hertz, phase = np.exp(rng.uniform(np.log(0.05), np.log(0.5), 3)), rng.uniform(0, 6.28, 3)
        goal = np.sin(2 * np.pi * t[:, None] * hertz + phase) @ hertz**-0.5
        loop = Loop(goal - goal[0], machine.inertia, 2.0 * np.pi * 12.0, dt)
        moved = simulate(machine, loop, samples, dt)
        x = read(moved.position, loop.count, rng)
        found.append(st.Recording(t, np.array(loop.given), x, kind="follow"))
    return tuple(found)


class Loop:
    """A position loop with an integral part, which reads the encoder."""

    count = 2.0 * math.pi / COUNTS

    def __init__(self, goal: np.ndarray, inertia: float, rate: float, dt: float) -> None:
        self.goal, self.stiffness, self.dt = goal, inertia * rate**2, dt
        self.damping, self.slow = 1.4 * inertia * rate, 10.0 * self.stiffness * dt
        self.before, self.speed, self.held = 0.0, 0.0, 0.0
        self.given: list[float] = []

    def __call__(self, k: int, x: float) -> float:
        seen = round(x / self.count) * self.count
        self.speed += 0.2 * ((seen - self.before) / self.dt - self.speed)
        self.before = seen
        behind = float(self.goal[k]) - seen
        self.held += self.slow * behind
        dry = 0.03 * math.tanh(behind / 0.01)
        self.given.append(self.stiffness * behind - self.damping * self.speed + dry + self.held)
        return self.given[-1]


def motor() -> st.Plant:
    """What its owner states."""
    return st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "friction": {"law": "coulomb"},
            "sensor": {"counts_per_rev": COUNTS},
        }
    )


@pytest.mark.parametrize("order", ORDERS)
def test_fast_cogging_of_a_light_motor_is_found(order: int) -> None:
    # What is as fast as this passes for noise beside the base, whose run strays by 70 counts.
    found = st.diagnose(motor(), list(motor_with_cogging(order)), surrogates=8)
    assert [cause.name for cause in found.effects] == ["cogging"]
    cause = found.effects[0]
    assert cause.decided
    assert "amplitude 0.01" in cause.what
    assert "cosine" not in cause.what
    (amplitude,) = [p for path, p in cause.waves.items() if path.endswith("amplitude")]
    assert amplitude.value == pytest.approx(0.012, rel=0.02)
    assert cause.chosen["effects.cogging.order"] == order
    assert found.plant.inertia == pytest.approx(1e-4, rel=0.03)


@cache
def drivetrain(dt: float) -> tuple[st.Recording, ...]:
    """Slow ramps and steps of voltage both ways: ks, kv and ka are what its user wants."""
    machine = Machine(inertia=0.35, coulomb=0.25, viscous=2.4)
    found = []
    for kind, side in (("ramp", 1.0), ("ramp", -1.0), ("step", 1.0), ("step", -1.0)):
        t = np.arange(round((12.0 if kind == "ramp" else 4.0) / dt)) * dt
        volts = side * (0.5 * t if kind == "ramp" else 6.0 * (t > 0.3))
        moved = simulate(machine, lambda k, x, u=volts: float(u[k]), len(t), dt)
        x = read(moved.position, 2.2e-5, np.random.default_rng(len(found)))
        found.append(st.Recording(t, volts, x, kind=kind))
    return tuple(found)


@pytest.mark.parametrize("dt", [5e-3, 2e-2])
def test_a_drivetrain_that_lacks_nothing_gives_its_three_numbers(dt: float) -> None:
    plant = st.Plant.from_dict(
        {
            "motion": {"kind": "linear"},
            "drive": {"input": "voltage_v", "gain": 1.0},
            "friction": {"law": "coulomb"},
        }
    )
    found = st.diagnose(plant, list(drivetrain(dt)), surrogates=8)
    assert found.verdict == "nothing_missing"
    known = found.plant.parameters
    assert known["friction.coulomb"].value == pytest.approx(0.25, rel=0.02)
    assert known["friction.viscous"].value == pytest.approx(2.4, rel=0.01)
    assert known["body.inertia"].value == pytest.approx(0.35, rel=0.03)


def jumping() -> list[st.Recording]:
    """A clock that jumps by half a second while the machine moves."""
    machine, dt = Machine(inertia=0.02, coulomb=0.3, viscous=0.1), 4e-3
    found = []
    for k in range(4):
        rng = np.random.default_rng([4, k])
        t = np.arange(3000) * dt
        hertz, phase = np.exp(rng.uniform(np.log(0.1), np.log(2.0), 4)), rng.uniform(0, 6.28, 4)
        torque = np.sin(2 * np.pi * t[:, None] * hertz + phase).sum(axis=1)
        torque *= 1.5 / np.abs(torque).max()
        moved = simulate(machine, lambda k, x, u=torque: float(u[k]), len(t), dt)
        x = read(moved.position, 2.0 * math.pi / 65536, rng)
        stamps = t + 0.5 * (t > 6.0) if k == 1 else t
        found.append(st.Recording(stamps, torque, x, kind="sines"))
    return found


def test_a_clock_that_jumps_in_motion_spoils_nothing_else() -> None:
    plant = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "friction": {"law": "coulomb"},
            "sensor": {"counts_per_rev": 65536},
        }
    )
    found = st.diagnose(plant, jumping(), surrogates=8)
    assert found.verdict == "nothing_missing"
    assert found.plant.inertia == pytest.approx(0.02, rel=3e-3)
