"""Fits of a dry contact whose readings carry white noise, as analog sensors do."""

from __future__ import annotations

import numpy as np
import pytest
from tests.fit.test_fit import DT, NOISE, TRUE, moved, plant, swept

from stiction import Recording, fit

SEEDS = range(8)


def noisy(seed: int, noise: float) -> Recording:
    """The independent Coulomb machine, whose rests are a seventh of the time."""
    rng = np.random.default_rng(seed + 100)
    n = 12_000
    effort = swept(n, seed)
    position = moved(effort) + noise * rng.standard_normal(n)
    return Recording(np.arange(n) * DT, effort + NOISE * rng.standard_normal(n), position)


@pytest.mark.parametrize("noise", [1e-9, 1e-7, 2e-6, 2e-5])
def test_noise_of_a_sensor_does_not_lower_the_friction(noise: float) -> None:
    """Each time that noise moved a machine at rest, its friction was taken for that of a slide."""
    found = fit(plant(), noisy(0, noise))
    for name, value in TRUE.items():
        assert found[name].value == pytest.approx(value, rel=3e-3), name


@pytest.mark.slow
def test_intervals_cover_the_truth_where_readings_are_noisy() -> None:
    covered = 0
    for seed in SEEDS:
        found = fit(plant(), noisy(seed, 2e-6))
        covered += sum(
            found[name].ci95[0] <= value <= found[name].ci95[1] for name, value in TRUE.items()
        )
    assert covered >= 0.75 * len(SEEDS) * len(TRUE)


def test_a_reading_that_fails_for_one_sample_changes_no_fit() -> None:
    good = noisy(0, 2e-6)
    assert good.position is not None
    assert good.input is not None
    position = good.position.copy()
    position[5000] = 1e5
    bad = Recording(good.time, good.input, position)
    one, other = fit(plant(), good), fit(plant(), bad)
    for name in TRUE:
        assert other[name].value == pytest.approx(one[name].value, rel=1e-4), name
