"""A body that is under way when its contact is first asked, and turns round within that step."""

import numpy as np
import pytest

import stiction as st

INERTIA, COULOMB, EFFORT = 2e-3, 0.02, 0.19
DT, SAMPLES = 5e-3, 4
RIGID = {
    "coulomb": {},
    "rigid_perfectly_plastic": {"unhardened_share": 1.0},
    "load_dependent": {"breakaway": COULOMB, "drive": 0.0, "back_drive": 0.0},
}


def exact(velocity, time):
    """Position and velocity where friction slows the body down, then holds against the effort."""
    stop = -velocity * INERTIA / (EFFORT + COULOMB)
    there = 0.5 * velocity * stop
    rate = (EFFORT - COULOMB) / INERTIA
    return there + 0.5 * rate * (time - stop) ** 2, rate * (time - stop)


@pytest.mark.parametrize("integrator", ["fast", "reference"])
@pytest.mark.parametrize("velocity", [-1e-4, -0.026, -0.2, -0.45])
@pytest.mark.parametrize("law", RIGID)
def test_a_turn_within_the_first_step_is_located(law, velocity, integrator):
    friction = st.FrictionModel(law, coulomb=COULOMB, viscous=0.0, **RIGID[law])
    motor = st.Motor(INERTIA, friction=friction, integrator=integrator)
    motor.reset(0.0, velocity)
    run = motor.simulate([EFFORT] * SAMPLES, DT)
    position, speed = exact(velocity, DT * SAMPLES)
    assert run.position[-1] == pytest.approx(position, rel=1e-10)
    assert run.velocity[-1] == pytest.approx(speed, rel=1e-10)


def test_an_effect_of_next_to_nothing_changes_next_to_nothing():
    plant = {
        "drive": {"input": "torque_nm", "gain": 1.0},
        "body": {"inertia": INERTIA},
        "friction": {"law": "coulomb", "coulomb": COULOMB, "viscous": 0.004},
    }
    beside = {"effects": [{"name": "cogging", "cosine": 1e-9, "order": 3.0}]}
    runs = []
    for each in (plant, plant | beside):
        motor = st.Plant.from_dict(each).motor()
        motor.reset(0.0, -0.026)
        runs.append(motor.simulate([EFFORT] * 40, DT).position)
    assert np.max(np.abs(runs[1] - runs[0])) < 1e-8
