"""Every law of the catalogue is fitted by its name alone to a machine that has it."""

from __future__ import annotations

import numpy as np
import pytest

from stiction import FrictionModel, Motor, Plant, Recording, fit, laws

DT = 1e-3
COUNT = 2 * np.pi / 2**18
NOISE = 2e-3
# What a fit leaves of the effort's variance at most; some ring between the samples.
LEFT = 0.01


DEAR = ("bristle",)
"""Laws whose fits take a minute."""


@pytest.mark.parametrize(
    "law",
    [pytest.param(law.name, marks=pytest.mark.slow if law.name in DEAR else ()) for law in laws()],
)
def test_a_law_named_alone_explains_a_machine_that_has_it(law: str) -> None:
    time = DT * np.arange(6000)
    waves = sum(0.45 * np.sin(2 * np.pi * f * time + f) for f in (0.4, 1.1, 2.3))
    effort = np.where(time % 5.0 > 4.5, 0.0, waves)
    motor = Motor(0.0076, friction=FrictionModel(law))
    position = np.concatenate([[0.0], motor.simulate(effort[:-1], DT).position])
    noise = NOISE * np.random.default_rng(0).standard_normal(len(time))
    recording = Recording(time, effort + noise, np.round(position / COUNT) * COUNT)
    plant = Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": {"law": law}})
    found = fit(plant, recording)
    assert found.plant.friction.law == law
    assert 1.0 - found.r2 < LEFT
    assert np.isfinite([each.value for each in found.parameters.values()]).all()
