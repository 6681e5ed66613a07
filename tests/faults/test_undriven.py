"""Nobody drives them, and they gain nothing."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st

from .undriven import TOLERANCE, count, drawn, gain

FOUND = (
    (291200, 23912),
    *((61, 1668), (61, 6545), (61, 8388), (61, 11362)),
    *((71, 20200), (71, 22984), (72, 4734), (81, 6676)),
    *((82, 395), (82, 8590), (83, 5681), (83, 22647)),
)
"""Seed and number of cases that gained, of some 220 000."""


def test_no_motor_that_nobody_drives_gains_energy() -> None:
    ran, gained = count(400, seed=0)
    assert ran > 200
    assert not gained, "\n".join(f"{case.name} by {more:.3g}: {case}" for case, more in gained)


def test_a_case_is_the_same_again() -> None:
    assert drawn(3, 17) == drawn(3, 17)
    assert gain(drawn(3, 17)) == gain(drawn(3, 17))


@pytest.mark.parametrize(("seed", "number"), FOUND)
def test_what_gained_once_does_not_gain_any_more(seed: int, number: int) -> None:
    more = gain(drawn(seed, number))
    assert more is None or more <= TOLERANCE


def test_drag_that_grows_within_a_sample_is_followed() -> None:
    # From rest to its greatest speed within a sample: drag as at its start would be none at all.
    effort, quadratic, dt = 1e6, 1.3e-3, 1.4e-4
    for integrator in ("fast", "reference"):
        motor = st.Motor(
            7e-3,
            friction=st.FrictionModel("coulomb"),
            effects={"viscous_quadratic": {"quadratic": quadratic}},
            integrator=integrator,
        )
        run = motor.simulate(np.full(400, effort), dt)
        top = np.sqrt(effort / quadratic)
        assert np.max(run.velocity) <= 1.001 * top
        assert run.velocity[-1] == pytest.approx(top, rel=1e-3)


def test_creep_that_speeds_up_within_a_sample_is_followed() -> None:
    # λ·h of the reference integrator is far above what its formula bears, though not at the start.
    law = {"initial_stiffness": 195.0, "hardening_exponent": 10.0, "breakaway": np.inf}
    runs = []
    for integrator in ("fast", "reference"):
        friction = st.FrictionModel("hsieh_pan", **law)
        motor = st.Motor(0.0132, friction=friction, weight=0.17, integrator=integrator)
        motor.reset(0.0, -95.6)
        runs.append(motor.simulate(np.zeros(400), 3.86e-3).position)
    assert np.max(np.abs(runs[1] - runs[0])) < 1e-3 * np.ptp(runs[0])


@pytest.mark.parametrize("law", ["coulomb", "load_dependent", "rigid_perfectly_plastic"])
@pytest.mark.parametrize("share", [1e-6, 1e-9, 1e-12])
def test_a_body_that_stops_at_once_does_not_bounce(law: str, share: float) -> None:
    # Of the first sample it moves for this share.
    inertia, velocity, dt = 2e-4, 1.7, 6e-4
    level = inertia * velocity / (share * dt)
    motor = st.Motor(inertia, friction=st.FrictionModel(law, coulomb=min(level, 9e8)))
    motor.reset(0.0, velocity * min(1.0, 9e8 / level))
    run = motor.simulate(np.zeros(5), dt)
    assert np.max(np.abs(run.position)) <= velocity * share * dt
    assert not np.any(run.velocity)


@pytest.mark.parametrize("integrator", ["fast", "reference"])
@pytest.mark.parametrize("law", ["coulomb", "load_dependent", "rigid_perfectly_plastic"])
def test_drag_beyond_a_stop_pushes_nobody(law: str, integrator: str) -> None:
    # Braked so hard that a step without the stop would end at 10⁷ rad/s: drag there is 10¹² N·m.
    motor = st.Motor(
        4.8e-4,
        friction=st.FrictionModel(law, coulomb=7e8),
        effects={"viscous_quadratic": {"quadratic": 9e-3}},
        integrator=integrator,
    )
    motor.reset(-2.0, -0.05)
    run = motor.simulate(np.zeros(5), 3.3e-5)
    assert np.max(np.abs(run.position + 2.0)) < 1e-9
    assert not np.any(run.velocity)
