"""Friction that is a share of the effort: told from inertia where the motor brakes, else not."""

from __future__ import annotations

import numpy as np
import pytest

from stiction import FrictionModel, Motor, Plant, Recording, fit

DT = 1e-3
TRUE = {"drive": 0.1, "coulomb": 0.35, "viscous": 0.3}
INERTIA = 0.0076


def recorded(effort: np.ndarray, noise: float = 2e-3) -> Recording:
    motor = Motor(INERTIA, friction=FrictionModel("load_dependent", **TRUE))
    position = np.concatenate([[0.0], motor.simulate(effort[:-1], DT).position])
    measured = effort + noise * np.random.default_rng(1).standard_normal(len(effort))
    return Recording(np.arange(len(effort)) * DT, measured, position)


def named_alone(**body: object) -> Plant:
    return Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": body,
            "friction": {"law": "load_dependent"},
        }
    )


def driving(n: int = 10_000) -> np.ndarray:
    """Never against the motion."""
    time = DT * np.arange(n)
    return 0.7 + 0.2 * np.sin(3.0 * time) + 0.1 * np.sin(11.0 * time)


def braking(n: int = 10_000) -> np.ndarray:
    """Against the motion for a good part of the time."""
    time = DT * np.arange(n)
    return 1.2 * np.sign(np.sin(40.0 * time)) + 0.4 * np.sin(2.0 * time)


def slow(n: int = 10_000) -> np.ndarray:
    """To and fro, with rests at the turns: never against the motion either."""
    time = DT * np.arange(n)
    return 0.9 * np.sin(time) + 0.2 * np.sin(2.3 * time)


@pytest.mark.parametrize("effort", [driving, slow])
def test_a_motor_that_drives_all_the_time_does_not_tell_its_share(effort) -> None:
    found = fit(named_alone(), recorded(effort()))
    said = [text for text in found.undetermined if text.startswith("only a combination of")]
    assert any("body.inertia" in text and "friction.drive" in text for text in said)
    assert found["drive"].stderr == np.inf
    assert found["inertia"].stderr == np.inf


def test_a_motor_that_brakes_tells_it() -> None:
    found = fit(named_alone(), recorded(braking()))
    assert not any("friction.drive" in text for text in found.undetermined)
    assert found["drive"].value == pytest.approx(TRUE["drive"], abs=0.02)
    assert found["inertia"].value == pytest.approx(INERTIA, rel=0.02)


def test_a_damper_is_told_though_its_force_goes_with_the_effort() -> None:
    time = DT * np.arange(10_000)
    effort = 0.8 * np.sin(time) + 0.1 * np.sin(3.0 * time)
    motor = Motor(INERTIA, friction=FrictionModel("coulomb", coulomb=0.01, viscous=1.0))
    position = np.concatenate([[0.0], motor.simulate(effort[:-1], DT).position])
    measured = effort + 2e-3 * np.random.default_rng(1).standard_normal(len(effort))
    plant = Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": {"law": "coulomb"}})
    found = fit(plant, Recording(time, measured, position))
    assert not any("friction.viscous" in text for text in found.undetermined)
    assert found["viscous"].value == pytest.approx(1.0, rel=0.01)
