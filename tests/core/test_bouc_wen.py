"""Bouc-Wen friction against its oracle and the exponents that have closed forms."""

import numpy as np
import pytest
from tests.reference.laws import bouc_wen as oracle

import stiction as st

DT = 1e-3
# Steps of Runge-Kutta, of F_c.
ORACLE_SHARE = 1e-7
F_C, STIFFNESS = 0.35, 3000.0
REACH = F_C / STIFFNESS


def moved(displacements, **values):
    """Friction over F_c after each of these displacements, in units of the reach."""
    model = st.FrictionModel("bouc_wen", coulomb=F_C, initial_stiffness=STIFFNESS, **values)
    return np.array([model.step(d * REACH / DT, DT) for d in displacements]) / F_C


@pytest.mark.parametrize("seed", range(6))
def test_held_speeds_follow_the_oracle(seed):
    rng = np.random.default_rng(seed)
    values = {
        "coulomb": F_C * 3.0 ** rng.uniform(-1.0, 1.0),
        "initial_stiffness": STIFFNESS * 3.0 ** rng.uniform(-1.0, 1.0),
        "exponent": rng.uniform(1.0, 6.0),
        "unloading_share": rng.uniform(0.5, 1.0),
        "viscous": 0.05,
    }
    reach = values["coulomb"] / values["initial_stiffness"]
    velocity = reach * 10.0 ** rng.uniform(-3.0, 1.0, 60) * rng.choice([1.0, -1.0], 60) / DT
    velocity[::9] = 0.0
    friction = oracle.along(velocity, DT, **values)
    ours = st.FrictionModel("bouc_wen", **values).simulate(velocity, DT)
    assert np.abs(ours - friction).max() < ORACLE_SHARE * values["coulomb"]


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 7.3, 20.0])
def test_results_do_not_depend_on_the_sampling(exponent):
    path = np.random.default_rng(0).uniform(-3.0, 3.0, 100)
    whole = moved(path, exponent=exponent)
    finer = moved(np.repeat(path, 50) / 50.0, exponent=exponent)[49::50]
    assert np.abs(whole - finer).max() < ORACLE_SHARE
    assert np.abs(whole).max() <= 1.0


@pytest.mark.parametrize("way", [1e-6, 0.01, 0.3, 1.0, 4.0, 40.0])
def test_loading_and_unloading_have_their_closed_forms(way):
    # n = 1: u' = 1 - u, then u' = -(1 + c u) on the way back to zero, c = 2 b - 1.
    for share in (0.5, 0.75, 1.0):
        c = 2.0 * share - 1.0
        up, back = moved([way, -0.5 * min(way, 0.5)], exponent=1.0, unloading_share=share)
        top = -np.expm1(-way)
        assert up == pytest.approx(top, abs=1e-8)
        down = 0.5 * min(way, 0.5)
        left = top - down if c == 0.0 else (top + 1.0 / c) * np.exp(-c * down) - 1.0 / c
        if left > 0.0:
            assert back == pytest.approx(left, abs=1e-8)
    # n = 2: a tanh up and, with c = 1, a tan back.
    up, back = moved([way, -0.5 * way], exponent=2.0, unloading_share=1.0)
    assert up == pytest.approx(np.tanh(way), abs=1e-8)
    angle = np.arctan(np.tanh(way)) - 0.5 * way
    if angle > 0.0:
        assert back == pytest.approx(np.tan(angle), abs=1e-8)
    else:
        assert back == pytest.approx(np.tanh(angle), abs=1e-8)


def test_a_sharp_knee_is_a_spring_and_a_slider():
    path = [0.5, 0.4, 0.4, -0.5, -0.5, -0.9, -1.5]
    sharp = moved(path, exponent=20.0, unloading_share=0.5)
    assert sharp == pytest.approx([0.5, 0.9, 1.0, 0.5, 0.0, -0.9, -1.0], abs=0.06)


def test_a_half_share_unloads_as_stiffly_as_it_loads_at_zero_force():
    model = st.FrictionModel("bouc_wen", unloading_share=0.5, exponent=2.0)
    model.step(1.0, 1.0)
    for force in (0.3, 0.2, 0.1):
        before = model.state["dry_friction"]
        model.step(-(before - force) / STIFFNESS / DT, DT)
        assert model.state["dry_friction"] == pytest.approx(force, rel=1e-12)


def test_loops_below_the_coulomb_level_do_not_close():
    path = np.array([0.6, -0.3, 0.3])
    first, _, third = moved(path)
    assert third < first - 1e-3


def test_a_force_above_the_coulomb_level_comes_down_to_it():
    model = st.FrictionModel("bouc_wen")
    for sign in (1.0, -1.0):
        model.state = model.state | {"dry_friction": sign * 0.5, "direction": sign}
        assert model.trial(sign * 0.1, DT)[0] == pytest.approx(sign * 0.35)
        assert abs(model.trial(-sign * 0.1, 1e-5)[0]) < 0.5


def test_the_integrators_converge_on_each_other():
    time = np.arange(4000) * 1e-4
    effort = 0.3 * np.sin(40.0 * time) + 0.3 * np.sin(9.0 * time)

    def end(integrator, parts):
        friction = st.FrictionModel("bouc_wen", viscous=0.02)
        motor = st.Motor(inertia=0.0076, friction=friction, integrator=integrator)
        return motor.simulate(np.repeat(effort, parts), 1e-4 / parts).position[parts - 1 :: parts]

    exact = end("reference", 8)
    errors = [np.abs(end("fast", parts) - exact).max() / np.ptp(exact) for parts in (1, 4)]
    assert errors[0] < 1e-4
    assert errors[1] < errors[0] / 3.0
