"""A break-away level that fell below a force that opposes the motion holds nothing."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st

TYPICAL = {
    each.name: each.typical
    for record in st.laws()
    if record.name == "hsieh_pan"
    for each in record.parameters
}
ROOM = {"hardening_exponent": (1.05, 9.0), "stribeck_exponent": (0.4, 4.0)}


@pytest.mark.parametrize("curve", ["masing", "same"])
def test_friction_opposes_a_motion_of_many_reaches(curve: str) -> None:
    asked = 0
    for seed in range(1500):
        rng = np.random.default_rng([29, seed])
        drawn = {name: value * np.exp(rng.uniform(-1.0, 1.0)) for name, value in TYPICAL.items()}
        drawn |= {name: float(np.clip(drawn[name], *ends)) for name, ends in ROOM.items()}
        drawn["coulomb"] = min(drawn["coulomb"], drawn["breakaway"])
        soft = min(drawn["final_stiffness"], 0.9 * drawn["initial_stiffness"])
        drawn["final_stiffness"] = soft
        dt = 4.7e-3 * np.exp(rng.uniform(-1.0, 1.0))
        turning = np.sin(rng.uniform(0.05, 1.5) * np.arange(150.0) + rng.uniform(0.0, 6.0))
        velocity = rng.uniform(0.01, 0.5) * turning * np.exp(rng.normal(0.0, 0.5, 150))
        law = st.FrictionModel("hsieh_pan", virgin_curve=curve, **drawn)
        friction = law.simulate(velocity, dt)
        reach = drawn["breakaway"] / soft + drawn["slip_distance"]
        far = np.abs(velocity) * dt > 10.0 * reach
        asked += int(far.sum())
        assert np.all(friction[far] * velocity[far] > 0.0), seed
    assert asked > 1000
