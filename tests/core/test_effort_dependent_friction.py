"""Friction that grows with the motor's effort: closed forms, and fits that keep the inertia."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st

DT = 1e-3
SHARE, COULOMB, INERTIA = 0.25, 0.3, 0.02


def motor(**more: object) -> st.Motor:
    effects = {"effort_dependent_friction": {"share": SHARE}} | more
    law = st.FrictionModel("coulomb", coulomb=COULOMB)
    return st.Motor(INERTIA, friction=law, effects=effects)


def test_it_breaks_away_where_the_share_that_is_left_exceeds_the_level() -> None:
    # At rest u stands against F_c + c·u: the body moves from F_c/(1 − c) on.
    most = COULOMB / (1.0 - SHARE)
    for effort, moves in ((0.999 * most, False), (1.001 * most, True)):
        run = motor().simulate(np.full(200, effort), DT)
        assert (run.position[-1] > 0.0) == moves


def test_a_constant_effort_drives_less_and_brakes_more() -> None:
    drives = motor().simulate(np.full(200, 1.0), DT)
    gained = (1.0 - SHARE - COULOMB) / INERTIA
    assert drives.velocity[-1] == pytest.approx(0.2 * gained, rel=1e-9)
    brakes = motor()
    brakes.reset(0.0, 20.0)
    slowed = brakes.simulate(np.full(200, -1.0), DT)
    lost = (1.0 + SHARE + COULOMB) / INERTIA
    assert slowed.velocity[-1] == pytest.approx(20.0 - 0.2 * lost, rel=1e-9)


def test_the_load_is_no_part_of_it() -> None:
    # 1.5 of the motor against a load of 1: what is left over is .5, less F_c + c·1.5.
    run = motor().simulate(np.full(200, 1.5), DT, load=np.full(200, -0.5))
    wanted = (1.0 - COULOMB - 1.5 * SHARE) / INERTIA
    assert run.velocity[-1] == pytest.approx(0.2 * wanted, rel=1e-9)


def test_all_ways_through_a_sample_agree_to_the_bit() -> None:
    inputs = 1.2 * np.sin(0.05 * np.arange(2000)) + 0.4 * np.sin(0.31 * np.arange(2000))
    whole = motor(cogging={"sine": 0.1, "order": 3.0}).simulate(inputs, DT)
    steps = motor(cogging={"sine": 0.1, "order": 3.0})
    for k, effort in enumerate(inputs):
        steps.step(effort, DT)
        assert steps.state["position"] == whole.position[k]


def test_slopes_are_those_of_differences() -> None:
    inputs = 1.2 * np.sin(0.05 * np.arange(600))
    path = "effects.effort_dependent_friction.share"
    slope, _ = motor().sensitivity(inputs, DT, [path])

    def moved(share: float) -> np.ndarray:
        law = st.FrictionModel("coulomb", coulomb=COULOMB)
        effects = {"effort_dependent_friction": {"share": share}}
        return st.Motor(INERTIA, friction=law, effects=effects).simulate(inputs, DT)["position"]

    numeric = (moved(SHARE + 1e-6) - moved(SHARE - 1e-6)) / 2e-6
    assert slope[0] == pytest.approx(numeric, abs=1e-3 * np.max(np.abs(numeric)))


@pytest.mark.parametrize("named", ["effect", "law"])
def test_a_fit_keeps_the_inertia_and_finds_the_share(named: str) -> None:
    """Counted as effort, what is left would be least without any inertia."""
    rng = np.random.default_rng(4)
    time = np.arange(6000) * 2e-3
    effort = 0.9 * np.sin(2.5 * time) + 0.7 * np.sin(9.0 * time) + 0.5 * np.sin(23.0 * time)
    law = st.FrictionModel("coulomb", coulomb=COULOMB, viscous=0.05)
    effects = {"effort_dependent_friction": {"share": SHARE}}
    position = st.Motor(INERTIA, friction=law, effects=effects).simulate(effort, 2e-3).position
    read = np.append(0.0, position[:-1]) + 1e-4 * rng.standard_normal(len(time))
    table: dict[str, object] = {"drive": {"input": "torque_nm", "gain": 1.0}}
    if named == "effect":
        own = {"name": "effort_dependent_friction", "share": 0.0}
        table |= {"friction": {"law": "coulomb"}, "effects": [own]}
        path = "effects.effort_dependent_friction.share"
    else:
        table |= {"friction": {"law": "load_dependent", "drive": 0.05}}
        path = "friction.drive"
    found = st.fit(st.Plant.from_dict(table), [st.Recording(time, effort, read)])
    assert found[path].value == pytest.approx(SHARE, abs=0.02)
    assert found["body.inertia"].value == pytest.approx(INERTIA, rel=0.02)
    assert found["friction.coulomb"].value == pytest.approx(COULOMB, rel=0.05)
