"""Goals for servos: within the limits when the loop is simulated, and nothing but goals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.reference.servo_reference import Servo

import stiction as st
from stiction.plan import plan

RATE = 500.0


def drawn(seed: int) -> tuple[Servo, st.Plant, dict[str, float]]:
    """A servo, its plant, and limits."""
    source = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return float(np.exp(source.uniform(np.log(low), np.log(high))))

    constant, supply, resistance = between(0.1, 1.0), between(5.0, 24.0), between(1.0, 8.0)
    stall = constant * supply / resistance
    servo = Servo(
        constant=constant,
        resistance=resistance,
        supply=supply,
        proportional=between(0.5, 8.0),
        inertia=between(1e-4, 4e-3),
        mass=between(0.02, 0.25) * stall / (9.81 * 0.1),
        length=0.1,
        coulomb=between(0.01, 0.1) * stall,
        viscous=between(0.001, 0.02) * stall,
    )
    plant = st.Plant.from_dict(
        {
            "drive": {
                "kind": "servo",
                "proportional": servo.proportional,
                "supply_v": supply,
                "resistance_ohm": resistance,
                "torque_constant": constant,
            },
            "body": {"inertia": servo.inertia, "payload_kg": servo.mass, "payload_m": servo.length},
            "friction": {"law": "coulomb", "coulomb": servo.coulomb, "viscous": servo.viscous},
        }
    )
    return servo, plant, {"position": between(0.3, 3.0), "speed": between(0.5, 8.0)}


@pytest.mark.long
@pytest.mark.parametrize("seed", range(10))
def test_ten_random_servos_stay_within_their_limits(seed: int) -> None:
    servo, plant, limits = drawn(seed)
    made = plan(plant, **limits, rate=RATE, seed=seed)
    assert {signal.column for signal in made.signals} == {"goal_rad"}
    assert len(made.signals) >= 15
    for signal in made.signals:
        assert np.max(np.abs(signal.values)) <= limits["position"]
        moved = plant.simulate(signal.values, 1.0 / RATE, outputs=["position", "velocity"])
        assert np.max(np.abs(moved.position)) <= limits["position"], signal.name
        assert np.max(np.abs(moved.velocity)) <= limits["speed"], signal.name
    # The independent servo takes its time: the fastest signal of each plant is enough.
    fastest = max(made.signals, key=lambda each: each.greatest["speed"])
    reached = servo.run(fastest.values[: round(4.0 * RATE)], 1.0 / RATE, substeps=40)
    assert np.max(np.abs(reached)) <= limits["position"]
    assert np.max(np.abs(np.diff(reached))) * RATE <= limits["speed"]


def test_what_a_servo_cannot_be_told_is_left_out_and_said(tmp_path: Path) -> None:
    _, plant, limits = drawn(0)
    made = plan(plant, **limits, rate=RATE, only=("ramps", "pulses", "chirp"))
    assert {signal.experiment for signal in made.signals} == {"ramps"}
    assert any("pulses, chirp are left out" in note for note in made.notes)
    where = made.save(tmp_path / "plan")
    head = (where / "signals" / "ramps-train.csv").read_text(encoding="utf-8").splitlines()[0]
    assert head == "time_s,goal_rad"
