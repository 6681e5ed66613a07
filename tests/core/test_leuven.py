"""The Leuven model against its oracle, its special cases and what was published of it."""

import numpy as np
import pytest
from tests.core.published import (
    PULLING_SPEED,
    PULLING_SPRING,
    broken_away,
    lags,
    period_of_two_phases,
    pulled,
)
from tests.reference.laws import leuven as oracle

import stiction as st

DT = 1e-3
# Runge-Kutta on the way to sliding, of F_s: where n is no whole number the rate is not smooth where
# the force changes its sign.
ORACLE_SHARE = 2e-7
# A mass of 1 kg with LuGre's published levels, damping and stiffness.
SLOW = {
    "coulomb": 1.0,
    "breakaway": 1.5,
    "stribeck_velocity": 1e-3,
    "stribeck_exponent": 2.0,
    "initial_stiffness": 1e5,
    "saturation": 1.5,
    "exponent": 1.0,
    "damping": np.sqrt(1e5),
    "viscous": 0.4,
}


def law(**values):
    return st.FrictionModel("leuven", **values)


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
        "saturation": rng.uniform(1.05, 3.0),
        "exponent": 1.0 if seed == 0 else rng.uniform(1.0, 6.0),
        "damping": around(1.0),
        "damping_velocity": around(0.1) if seed % 2 else np.inf,
        "viscous": around(0.05),
    }


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_held_speeds_follow_the_oracle(seed):
    rng, values = drawn(seed)
    velocity = 10.0 ** rng.uniform(-3.5, 0.0, 80) * rng.choice([1.0, -1.0], 80)
    velocity[::9] = 0.0
    friction = oracle.along(velocity, DT, **values)
    model = law(**values)
    ours = model.simulate(velocity, DT)
    scale = values["breakaway"] + values["damping"] * np.abs(velocity).max()
    assert np.abs(ours - friction).max() < ORACLE_SHARE * scale


@pytest.mark.parametrize("seed", range(3))
def test_results_do_not_depend_on_the_sampling(seed):
    rng, values = drawn(seed)
    velocity = 10.0 ** rng.uniform(-4.0, 1.0, 100) * rng.choice([1.0, -1.0], 100)
    whole = law(**values).simulate(velocity, 0.01)
    finer = law(**values).simulate(np.repeat(velocity, 50), 0.01 / 50.0)[49::50]
    assert np.abs(whole - finer).max() < ORACLE_SHARE * np.abs(whole).max()


@pytest.mark.parametrize("speed", [1e-4, 5e-4, 1e-3, 2e-3, -1e-3, 0.1])
@pytest.mark.parametrize("exponent", [1.0, 3.0])
def test_steady_sliding_follows_the_stribeck_curve(speed, exponent):
    settled = law(**SLOW | {"exponent": exponent}).simulate(np.full(200, speed), 1.0)[-1]
    level = 1.0 + 0.5 * np.exp(-((speed / 1e-3) ** 2))
    assert settled == pytest.approx(np.sign(speed) * level + 0.4 * speed, rel=1e-12)


def test_with_n_1_the_first_loading_is_a_logistic_way():
    # dF/dx = k_0 (1 - F/F_inf) (1 - F/g): (g - F)/(F_inf - F) decays exponentially.
    values = {"coulomb": 0.5, "breakaway": 0.5, "initial_stiffness": 3000.0, "damping": 0.0}
    ours = law(**values, saturation=1.5).simulate(np.full(60, 0.01), DT)
    x = 0.01 * DT * np.arange(1, 61)
    u = 0.5 / 0.75 * np.exp(-3000.0 * x * (1.0 / 0.5 - 1.0 / 0.75))
    assert ours == pytest.approx((0.5 - 0.75 * u) / (1.0 - u), rel=1e-8)


def test_a_hysteresis_that_saturates_nowhere_is_lugre():
    values = {"coulomb": 0.35, "breakaway": 0.5, "initial_stiffness": 3000.0, "viscous": 0.05}
    velocity = np.random.default_rng(3).uniform(-1.0, 1.0, 500)
    ours = law(**values, saturation=1000.0).simulate(velocity, 1e-4)
    bristles = st.FrictionModel("lugre", **values).simulate(velocity, 1e-4)
    assert np.abs(ours - bristles).max() < 2e-3 * 0.5


def test_loops_within_loops_close_in_the_deflection_and_leave_no_trace():
    # Late slip: below F_s the deflection is the displacement but for some 1e-9 of it.
    values = SLOW | {"exponent": 10.0, "damping": 0.0, "viscous": 0.0, "stribeck_velocity": 1e5}
    turns = np.array([2.0e-6, -1.5e-6, 1.0e-6, -0.5e-6, 1.0e-6, -1.5e-6, 2.0e-6])
    model = law(**values)
    force = model.simulate(np.diff(turns, prepend=0.0) / DT, DT)
    assert np.abs(force).max() < 0.2
    for back, there in ((4, 2), (5, 1), (6, 0)):
        assert force[back] == pytest.approx(force[there], rel=1e-7)
    # Bristles without reverse points would be elastic here, and those of LuGre drift.
    assert force[2] != pytest.approx(1e5 * turns[2], rel=1e-3)
    model.step(1e-8 / DT, DT)
    assert model.state["reverse_points"].shape[0] == 0
    assert model.state["closings"] >= 2


def test_a_closed_inner_loop_goes_on_along_the_older_branch():
    values = {"coulomb": 0.5, "breakaway": 0.5, "damping": 0.0}
    seen = {}
    for inner in (False, True):
        model = law(**values)
        model.simulate(np.full(10, 0.02), DT)
        force = model.simulate(np.full(3, -0.02), DT)[-1]
        if inner:
            while model.step(0.002, DT) < 0.5 * force + 0.1:
                pass
            while (at := model.step(-1e-4, DT)) > force:
                pass
            assert at == pytest.approx(force, abs=5e-4)
        before = model.step(0.0, DT)
        seen[inner] = (model.step(-1e-3, DT) - before, model.state["reverse_points"].shape[0])
    # The slope behind the closing is that of the branch it left, not of a reversal.
    assert seen[True][1] == seen[False][1] == 1
    assert seen[True][0] == pytest.approx(seen[False][0], rel=5e-3)


def test_break_away_falls_with_the_rate_of_the_force():
    found = np.array(
        [broken_away(law(**SLOW), r, "fast") for r in (0.1, 1.0, 2.0, 5.0, 10.0, 20.0)]
    )
    assert np.all(np.diff(found) < 0.0)
    assert found[0] == pytest.approx(1.5, rel=0.03)
    assert 1.0 < found[-1] < 1.05
    for rate, peak in ((5.0, found[3]), (20.0, found[5])):
        assert broken_away(law(**SLOW), rate, "reference") == pytest.approx(peak, rel=1e-3)


def test_friction_lags_behind_speed_the_more_the_faster_it_changes():
    gaps = list(lags(law(**SLOW)))
    slow, faster, fastest = (np.max(gap) for gap in gaps)
    assert 0.0 < slow < faster < fastest


def test_stick_slip_has_the_period_of_its_two_phases():
    dt = 2e-4
    speed = np.diff(pulled(law(**SLOW), "fast", 32.0, dt)) / dt
    starts = dt * np.flatnonzero((speed[:-1] < 0.05) & (speed[1:] >= 0.05))
    # It slips a little before it slides, and so breaks away somewhat below F_s.
    assert starts[0] == pytest.approx(1.5 / (PULLING_SPRING * PULLING_SPEED), rel=0.02)
    assert np.diff(starts) == pytest.approx(period_of_two_phases(SLOW["viscous"]), rel=0.04)
    finer = np.diff(pulled(law(**SLOW), "reference", 8.0, dt / 2.0)) / (dt / 2.0)
    start = dt / 2.0 * np.flatnonzero((finer[:-1] < 0.05) & (finer[1:] >= 0.05))[0]
    assert starts[0] == pytest.approx(start, abs=2e-3)


def taken_from(model, length, speed):
    """Work done on a contact that is bent slowly and then pulled on very fast, at its least."""
    work = np.sum(model.simulate(np.full(4000, 1e-6), 0.02 * length / 1e-6)) * 0.02 * length
    dx = 1e-3 * length
    return work + np.cumsum(model.simulate(np.full(1000, speed), dx / speed) * dx).min()


@pytest.mark.parametrize("exponent", [1.0, 2.0])
def test_it_is_passive_under_a_condition_and_not_far_from_it(exponent):
    values = {"coulomb": 1.0, "breakaway": 1.5, "initial_stiffness": 1e3, "damping": 1.0}
    bound = 1.5**exponent - 1.0
    assert law(**values, exponent=exponent, viscous=1.01 * bound).passive
    assert not law(**values, exponent=exponent, viscous=0.99 * bound).passive
    far = law(**values, exponent=exponent, viscous=0.8 * bound)
    assert taken_from(far, 1e-3, 1e6) < 0.0
    assert taken_from(law(**values, exponent=exponent, viscous=1.01 * bound), 1e-3, 1e6) > 0.0
    assert law(**values, exponent=exponent, viscous=0.0, damping_velocity=1.0).passive
    assert not law(**SLOW).passive


def test_a_greater_exponent_drifts_less_under_a_ripple():
    time = np.arange(100_000) * 1e-4
    effort = 0.35 * (0.5 + 0.3 * np.sin(2.0 * np.pi * 5.0 * time))
    gone = []
    for exponent in (1.0, 3.0, 10.0):
        friction = law(coulomb=0.35, breakaway=0.35, exponent=exponent)
        run = st.Motor(inertia=0.0076, friction=friction).simulate(effort, 1e-4)
        gone.append(run.position[-1] - run.position[50_000 - 1])
    assert gone[0] > 4.0 * gone[1] > 40.0 * gone[2] > 0.0


def test_the_integrators_converge_on_each_other():
    time = np.arange(4000) * 1e-4
    effort = 0.5 * np.sin(30.0 * time) + 0.3 * np.sin(7.0 * time)

    def end(integrator, parts):
        motor = st.Motor(inertia=0.0076, friction=law(viscous=0.02), integrator=integrator)
        return motor.simulate(np.repeat(effort, parts), 1e-4 / parts).position[parts - 1 :: parts]

    exact = end("reference", 8)
    errors = [np.abs(end("fast", parts) - exact).max() / np.ptp(exact) for parts in (2, 8)]
    assert errors[0] < 1e-4
    assert errors[1] < errors[0] / 8.0
