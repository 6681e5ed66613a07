"""The elasto-plastic bristles against their oracle, their regions and LuGre."""

import numpy as np
import pytest
from tests.reference.laws import elasto_plastic as oracle
from tests.reference.laws import lugre

import stiction as st

DT = 1e-3
# A step of Runge-Kutta on the way from elastic to sliding, of F_s.
ORACLE_SHARE = 1e-8
RIPPLE = 0.35 * (0.5 + 0.3 * np.sin(2.0 * np.pi * 5.0 * np.arange(600_000) * 1e-4))


def law(**values):
    return st.FrictionModel("elasto_plastic", **values)


def drawn(seed):
    rng = np.random.default_rng(seed)
    around = lambda x: x * 3.0 ** rng.uniform(-1.0, 1.0)  # noqa: E731
    coulomb = around(0.35)
    return rng, {
        "coulomb": coulomb,
        "breakaway": coulomb * rng.uniform(1.0, 2.5),
        "stribeck_velocity": around(0.05),
        "stribeck_exponent": rng.uniform(0.5, 3.0),
        "initial_stiffness": around(3000.0),
        "elastic_share": rng.uniform(0.0, 0.97),
        "damping": around(1.0),
        "damping_velocity": around(0.1) if seed % 2 else np.inf,
        "viscous": around(0.05),
    }


@pytest.mark.parametrize("seed", range(6))
def test_held_speeds_follow_the_oracle(seed):
    rng, values = drawn(seed)
    velocity = 10.0 ** rng.uniform(-3.5, 0.0, 60) * rng.choice([1.0, -1.0], 60)
    velocity[::9] = 0.0
    friction = oracle.along(velocity, DT, **values)
    ours = law(**values).simulate(velocity, DT)
    scale = values["breakaway"] + values["damping"] * np.abs(velocity).max()
    assert np.abs(ours - friction).max() < ORACLE_SHARE * scale


def test_results_do_not_depend_on_the_sampling():
    rng, values = drawn(1)
    velocity = 10.0 ** rng.uniform(-4.0, 1.0, 100) * rng.choice([1.0, -1.0], 100)
    whole = law(**values).simulate(velocity, 0.01)
    finer = law(**values).simulate(np.repeat(velocity, 50), 0.01 / 50.0)[49::50]
    assert np.abs(whole - finer).max() < ORACLE_SHARE * np.abs(whole).max()


def test_below_its_elastic_limit_it_is_a_spring_with_a_damper():
    values = {"coulomb": 0.35, "initial_stiffness": 3000.0, "elastic_share": 0.8, "damping": 0.5}
    model = law(**values, viscous=0.05)
    # Peaks of 0.79 F_c, over and over: the force is a function of place and speed.
    phase = 2.0 * np.pi * np.arange(1, 4001) / 200.0
    x = 0.79 * 0.35 / 3000.0 * np.sin(phase)
    velocity = np.diff(x, prepend=0.0) / DT
    force = model.simulate(velocity, DT)
    assert np.abs(force - 3000.0 * x - 0.55 * velocity).max() < 1e-13


@pytest.mark.parametrize("speed", [1e-3, 0.02, 0.05, 0.5, -0.1])
def test_it_slides_at_the_level_of_lugre(speed):
    values = {"coulomb": 0.35, "breakaway": 0.5, "stribeck_velocity": 0.05, "viscous": 0.1}
    settled = law(**values).simulate(np.full(200, speed), 1.0)[-1]
    bristles = st.FrictionModel("lugre", **values).simulate(np.full(200, speed), 1.0)[-1]
    assert settled == pytest.approx(bristles, rel=1e-13)


def test_above_its_steady_deflection_it_is_lugre():
    # Bent by F_s, then fast: from there on all of the motion slips in both.
    values = {"coulomb": 0.35, "breakaway": 0.7, "stribeck_velocity": 0.01, "damping": 0.3}
    slow, fast = np.full(4000, 1e-3), np.full(40, 0.5)
    model, bristles = law(**values), st.FrictionModel("lugre", **values)
    assert model.simulate(slow, 1e-4)[-1] > 0.65
    bristles.state = model.state
    assert model.simulate(fast, 1e-4) == pytest.approx(bristles.simulate(fast, 1e-4), rel=1e-12)


def test_a_ripple_leaves_no_drift_where_lugre_ratchets():
    def drift(name):
        friction = st.FrictionModel(name, coulomb=0.35, breakaway=0.35)
        motor = st.Motor(inertia=0.0076, friction=friction)
        return np.diff(motor.simulate(RIPPLE, 1e-4).position[1999::2000])

    ours, theirs = drift("elasto_plastic"), drift("lugre")
    assert np.abs(ours[20:]).max() < 1e-13
    assert theirs.min() > 1e-4


def test_a_body_follows_the_oracle():
    _, values = drawn(3)
    values["initial_stiffness"] = 3000.0
    effort = lambda t: 1.5 * values["breakaway"] * np.sin(12.0 * t)  # noqa: E731
    dt, n = 1e-5, 60_000
    motor = st.Motor(inertia=0.0076, friction=law(**values))
    x = motor.simulate(effort((np.arange(n) + 0.5) * dt), dt).position
    times = np.linspace(0.0, n * dt, 601)
    exact = lugre.body(
        lambda t, _: effort(t), times, inertia=0.0076, rate=oracle.slipping, rtol=1e-9, **values
    )[0]
    assert np.abs(x[99::100] - exact[1:]).max() < 1e-4 * np.ptp(exact)


def test_it_says_as_lugre_does_whether_it_is_passive():
    values = {"coulomb": 1.0, "breakaway": 1.5, "damping": 1.0}
    for viscous in (0.51, 0.49):
        passive = law(**values, viscous=viscous).passive
        assert passive is st.FrictionModel("lugre", **values, viscous=viscous).passive
        assert passive is (viscous > 0.5)
