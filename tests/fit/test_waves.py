"""A wave is told by its amplitude and its phase, whatever its parts are."""

import numpy as np
import pytest

import stiction as st
from stiction.fitting.result import FitParameter
from stiction.fitting.statistics import correlations
from stiction.fitting.waves import as_waves, waves_of

PATHS = ("effects.cogging.cosine_2", "friction.coulomb", "effects.cogging.sine_2")


def part(value: float, stderr: float) -> FitParameter:
    return FitParameter(value, stderr, (value - 2 * stderr, value + 2 * stderr), "N·m", "", 0.0)


def test_errors_are_those_of_drawn_parts():
    rng = np.random.default_rng(3)
    root = np.array([[2.0, 0.0, 0.0], [0.5, 1.0, 0.0], [-1.0, 0.3, 1.5]]) * 1e-3
    covariance = root @ root.T
    value = np.array([0.03, 0.4, -0.05])
    parameters = {
        path: part(each, float(np.sqrt(covariance[k, k])))
        for k, (path, each) in enumerate(zip(PATHS, value, strict=True))
    }
    found = waves_of(parameters, covariance)
    cosine, _, sine = (value + rng.standard_normal((100_000, 3)) @ root.T).T
    drawn = {"amplitude": np.hypot(cosine, sine), "phase": np.arctan2(sine, cosine)}
    assert set(found) == {f"effects.cogging.{name}_2" for name in drawn}
    for name, numbers in drawn.items():
        wave = found[f"effects.cogging.{name}_2"]
        assert wave.value == pytest.approx(np.mean(numbers), abs=0.1 * wave.stderr)
        assert wave.stderr == pytest.approx(np.std(numbers), rel=0.02)
        assert wave.ci95[1] - wave.value == pytest.approx(2.0 * wave.stderr)


def test_correlations_are_those_of_amplitude_and_phase():
    rng = np.random.default_rng(5)
    root = np.array([[2.0, 0.0, 0.0], [0.5, 1.0, 0.0], [-1.0, 0.3, 1.5]]) * 1e-4
    covariance = root @ root.T
    value = np.array([0.03, 0.4, -0.05])
    parameters = {path: part(float(each), 1e-3) for path, each in zip(PATHS, value, strict=True)}
    cosine, other, sine = (value + rng.standard_normal((100_000, 3)) @ root.T).T
    drawn = np.corrcoef([np.hypot(cosine, sine), other, np.arctan2(sine, cosine)])
    assert correlations(as_waves(parameters, covariance)) == pytest.approx(drawn, abs=0.02)


def test_a_wave_of_which_one_part_was_fitted_is_told_by_its_part():
    assert waves_of({PATHS[0]: part(0.1, 0.01)}, np.eye(1)) == {}


def test_a_small_part_of_a_large_wave_is_not_called_undetermined():
    plant = {
        "drive": {"input": "torque_nm", "gain": 1.0},
        "body": {"inertia": 0.01},
        "friction": {"law": "coulomb", "coulomb": 0.1, "viscous": 0.02},
        "effects": [{"name": "cogging", "cosine": 0.0, "sine": 0.03, "order": 5.0}],
    }
    rng = np.random.default_rng(1)
    time = np.arange(8000) * 1e-3
    effort = 0.2 * np.sin(3.0 * time) + 0.1 * np.sin(7.1 * time)
    motion = st.Plant.from_dict(plant).simulate(effort, 1e-3).position
    position = np.append(0.0, motion[:-1]) + 2e-6 * rng.standard_normal(len(time))
    plant["effects"][0]["order"] = {"value": 5.0, "fixed": True}
    found = st.fit(st.Plant.from_dict(plant), [st.Recording(time, effort, position)])
    wave = found.waves["effects.cogging.amplitude"]
    assert wave.value == pytest.approx(0.03, abs=4.0 * wave.stderr)
    assert wave.stderr < 1e-3 * wave.value
    assert not any("cogging" in sentence for sentence in found.undetermined)
    told = str(found)
    assert "effects.cogging.phase" in told
    assert "effects.cogging.cosine" not in told
    assert "effects.cogging.cosine" in found.to_dict()["parameters"]
