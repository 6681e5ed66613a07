"""Parameters of which one must not exceed the other, where one is held or bounded."""

from __future__ import annotations

import numpy as np
import pytest
from tests.fit.test_fit import TRUE, plant, recorded

from stiction import InputError, Plant, Recording, fit
from stiction.fitting.variables import Variables


@pytest.fixture(scope="module")
def recording() -> Recording:
    return recorded(6_000)


@pytest.mark.parametrize(
    ("friction", "free", "held"),
    [
        (
            {"law": "lugre", "coulomb": {"value": 0.4, "fixed": True}, "breakaway": 0.5},
            "breakaway",
            0.4,
        ),
        ({"law": "hsieh_pan", "final_stiffness": {"value": 300.0, "fixed": True}}, None, 0.0),
        ({"law": "hsieh_pan", "initial_stiffness": {"value": 300.0, "fixed": True}}, None, 0.0),
    ],
)
def test_one_that_is_held_bounds_the_other(
    friction: dict[str, object], free: str | None, held: float, recording: Recording
) -> None:
    found = fit(plant(friction=friction), recording)
    known = found.plant.friction.parameters
    if free is not None:
        assert known[free].value >= held
        (told,) = [s for s in found.bounds_hit if f"friction.{free}" in s]
        assert "which is held" in told
    else:
        assert known["final_stiffness"].value < known["initial_stiffness"].value


def test_numbers_in_the_wrong_order_are_refused_as_they_were_written(recording: Recording) -> None:
    wrong = {"law": "lugre", "coulomb": 0.3, "breakaway": {"value": 0.15, "fixed": True}}
    with pytest.raises(InputError, match=r"coulomb = 0\.3 must not exceed breakaway = 0\.15"):
        fit(plant(friction=wrong), recording)


@pytest.mark.parametrize(
    ("stated", "side", "end"),
    [({"value": 0.1, "max": 0.12}, "upper", 0.12), ({"value": 0.35, "min": 0.33}, "lower", 0.33)],
)
def test_a_stated_bound_of_the_lesser_one_is_told(
    stated: dict[str, float], side: str, end: float, recording: Recording
) -> None:
    friction = {"law": "lugre", "coulomb": stated, "breakaway": 0.5}
    found = fit(plant(friction=friction), recording)
    assert TRUE["coulomb"] != end
    assert found["coulomb"].value == pytest.approx(end)
    assert found["coulomb"].at_bound == side
    assert any(f"friction.coulomb ended at its {side} bound" in s for s in found.bounds_hit)


def test_what_stays_at_its_bound_has_no_slope() -> None:
    bounded = plant(
        friction={"law": "lugre", "coulomb": {"value": 0.1, "max": 0.12}, "breakaway": 0.5}
    )
    variables = Variables.of(bounded, ["friction.coulomb", "friction.breakaway"])
    beyond, inside = np.array([0.5, 0.5]), np.array([0.2, 0.5])
    by_parameters = np.array([[1.0, 2.0], [3.0, 4.0]])
    assert variables.bounds_hit(beyond) == {0: "upper"}
    assert variables.bounds_hit(inside) == {}
    for vector in (beyond, inside):
        slopes = variables.chain(by_parameters, vector)
        for k, step in enumerate(1e-6 * np.eye(2)):
            moved = variables.values(vector + step) - variables.values(vector - step)
            np.testing.assert_allclose(slopes[:, k], by_parameters @ moved / 2e-6, atol=1e-8)


@pytest.mark.parametrize("start", [3.0, -2.9, 4.0])
def test_an_angle_goes_on_past_half_a_turn(start: float) -> None:
    true = {"gravity_amplitude": 0.5, "gravity_zero_rad": 3.3}
    time = 1e-3 * np.arange(8_000)
    effort = 0.3 * np.sin(2 * np.pi * 0.4 * time) + 0.25 * np.sin(2 * np.pi * 1.3 * time)
    friction = {"law": "coulomb", "coulomb": 0.05, "viscous": 0.02}
    drive = {"input": "torque_nm", "gain": 1.0}
    machine = Plant.from_dict(
        {"drive": drive, "body": {"inertia": 0.01, **true}, "friction": friction}
    )
    run = machine.simulate(effort[:-1], 1e-3)
    rows = Recording(time, effort, np.concatenate([[0.0], run.position]))
    stated = {"gravity_amplitude": 0.4, "gravity_zero_rad": start}
    found = fit(
        Plant.from_dict({"drive": drive, "body": stated, "friction": {"law": "coulomb"}}), rows
    )
    assert found["gravity_zero_rad"].at_bound == ""
    assert np.cos(found["gravity_zero_rad"].value - 3.3) == pytest.approx(1.0, abs=1e-3)
    assert found["gravity_amplitude"].value == pytest.approx(0.5, rel=0.02)
