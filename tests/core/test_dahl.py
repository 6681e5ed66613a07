"""Dahl's curve against its closed forms, its oracle and the paper's simulation of static 1."""

import itertools

import numpy as np
import pytest
from scipy.integrate import quad
from tests.reference.laws import dahl as oracle

import stiction as st

ARC_SECOND = np.pi / (180.0 * 3600.0)
# The paper's Fig. 8.
PAPER = {"coulomb": 0.5, "initial_stiffness": 2063.0, "exponent": 2.0}
# The oracle's own tolerance over some hundred samples, of F_c.
ORACLE_SHARE = 1e-8
DT = 1e-3


def moved(displacements, **parameters):
    """Friction after each of these displacements."""
    model = st.FrictionModel("dahl", **parameters)
    return np.array([model.step(d / DT, DT) for d in displacements])


def distance(start, end, *, coulomb, initial_stiffness, exponent):
    """Displacement over which the force goes from one level to another, by quadrature."""
    s = np.sign(end - start)
    slope = lambda f: initial_stiffness * (1.0 - f * s / coulomb) ** exponent  # noqa: E731
    return quad(lambda f: 1.0 / slope(f), start, end, epsabs=0.0, epsrel=1e-13)[0]


@pytest.mark.parametrize("seed", range(6))
def test_held_speeds_follow_the_oracle(seed):
    rng = np.random.default_rng(seed)
    values = {
        "coulomb": 0.35 * 3.0 ** rng.uniform(-1.0, 1.0),
        "initial_stiffness": 3000.0 * 3.0 ** rng.uniform(-1.0, 1.0),
        "exponent": rng.uniform(1.0, 3.0),
        "viscous": 0.05,
    }
    reach = values["coulomb"] / values["initial_stiffness"]
    # From a thousandth of the reach a sample to twenty of it.
    velocity = reach * 10.0 ** rng.uniform(-3.0, 1.3, 60) * rng.choice([1.0, -1.0], 60) / DT
    velocity[::9] = 0.0
    friction = oracle.along(velocity, DT, **values)
    ours = st.FrictionModel("dahl", **values).simulate(velocity, DT)
    assert np.abs(ours - friction).max() < ORACLE_SHARE * values["coulomb"]


@pytest.mark.parametrize("exponent", [0.0, 0.4, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5, 2.0, 5.0])
def test_a_step_of_any_length_is_exact(exponent):
    values = {"coulomb": 0.35, "initial_stiffness": 3000.0, "exponent": exponent}
    rng = np.random.default_rng(0)
    path = rng.uniform(-3.0, 3.0, 100) * 0.35 / 3000.0
    whole = moved(path, **values)
    finer = moved(np.repeat(path, 50) / 50.0, **values)[49::50]
    assert np.abs(whole - finer).max() < 1e-12 * 0.35
    assert np.abs(whole).max() <= 0.35


def test_the_first_loading_has_its_closed_forms():
    x = 0.35 / 3000.0 * np.array([1e-9, 1e-3, 0.3, 0.9, 3.0, 1e3])
    y = 3000.0 * x / 0.35
    forms = {
        0.0: np.minimum(y, 1.0),
        0.5: 1.0 - np.maximum(1.0 - 0.5 * y, 0.0) ** 2,
        1.0: -np.expm1(-y),
        2.0: y / (1.0 + y),
        3.0: 1.0 - (1.0 + 2.0 * y) ** -0.5,
    }
    for exponent, form in forms.items():
        ours = [moved([d], coulomb=0.35, initial_stiffness=3000.0, exponent=exponent)[0] for d in x]
        assert ours == pytest.approx(0.35 * form, rel=1e-12, abs=1e-16)


def test_static_1_of_the_paper_drifts_by_11_arc_seconds_a_loop():
    # Fig. 8: the loop between 0.16 and 0.02 N·m never closes.
    levels = [0.0, 0.16, 0.02, 0.16, 0.26, 0.06, 0.26, 0.36, 0.10, 0.36, 0.40]
    steps = [distance(a, b, **PAPER) for a, b in itertools.pairwise(levels)]
    assert moved(steps, **PAPER) == pytest.approx(levels[1:], abs=1e-12)
    positions = np.cumsum(steps) / ARC_SECOND
    assert positions[2] - positions[0] == pytest.approx(11.2, abs=0.05)
    cycles = moved([steps[0], *steps[1:3] * 50], **PAPER)
    assert cycles[-1] == pytest.approx(0.16, abs=1e-12)


@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_a_body_pushed_along_static_1_drifts_as_far(integrator):
    # Without damping the body rings at each turn, and every swing drifts as well.
    friction = st.FrictionModel("dahl", **PAPER, viscous=4.0)
    motor = st.Motor(inertia=0.0076, friction=friction, integrator=integrator)
    # Loaded slowly, so that the friction is the effort.
    ramp = lambda a, b: np.linspace(a, b, 20_001)[1:]  # noqa: E731
    loop = np.concatenate((ramp(0.16, 0.02), ramp(0.02, 0.16)))
    run = motor.simulate(np.concatenate((ramp(0.0, 0.16), loop, loop)), 1e-4)
    first, second, third = run.position[[19_999, 59_999, 99_999]] / ARC_SECOND
    assert second - first == pytest.approx(11.246, rel=5e-3)
    assert third - second == pytest.approx(11.246, rel=5e-3)


def test_the_loop_between_the_coulomb_levels_turns_with_a_slope_of_gamma_2_to_the_i():
    values = {"coulomb": 0.35, "initial_stiffness": 3000.0, "exponent": 1.5}
    model = st.FrictionModel("dahl", **values)
    model.step(1e3, 1.0)
    force, _ = model.trial(-1e-9 / DT, DT)
    assert (0.35 - force) / 1e-9 == pytest.approx(3000.0 * 2.0**1.5, rel=1e-4)


def test_noise_of_a_measured_position_wears_the_force_away():
    # The slope by displacement is steeper on the way back than on the way on.
    model = st.FrictionModel("dahl", coulomb=0.35, initial_stiffness=3000.0, exponent=1.0)
    model.step(-0.35 / 3000.0 * np.log(1.0 - 0.2 / 0.35) / DT, DT)
    assert model.state["dry_friction"] == pytest.approx(0.2)
    count = 15.0 * ARC_SECOND
    noise = np.random.default_rng(0).uniform(-0.4, 0.4, 101) * count
    forces = model.simulate(np.diff(noise) / DT, DT)
    assert np.abs(forces[-20:]).mean() < 0.1


def test_a_force_above_the_coulomb_level_comes_down_to_it():
    model = st.FrictionModel("dahl", coulomb=0.35, initial_stiffness=3000.0, exponent=1.0)
    model.state = model.state | {"dry_friction": 0.5, "direction": 1.0}
    forces = model.simulate(np.full(30, 1e-4 / DT), DT)
    assert np.all(np.diff(forces) <= 0.0)
    assert forces[-1] == pytest.approx(0.35, rel=1e-8)


def test_the_integrators_converge_on_each_other():
    time = np.arange(4000) * 1e-4
    effort = 0.3 * np.sin(40.0 * time) + 0.3 * np.sin(9.0 * time)

    def end(integrator, parts):
        friction = st.FrictionModel("dahl", exponent=1.5, viscous=0.02)
        motor = st.Motor(inertia=0.0076, friction=friction, integrator=integrator)
        return motor.simulate(np.repeat(effort, parts), 1e-4 / parts).position[parts - 1 :: parts]

    exact = end("reference", 8)
    errors = [np.abs(end("fast", parts) - exact).max() / np.ptp(exact) for parts in (1, 4)]
    assert errors[0] < 1e-5
    assert errors[1] < errors[0] / 3.0
    assert np.abs(end("reference", 1) - exact).max() < 1e-5 * np.ptp(exact)
