"""The generalized Maxwell-slip model against its oracle, its closed forms and what it is for."""

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
from tests.reference.laws import gms as oracle

import stiction as st

DT = 1e-3
# The oracle's own tolerance over some hundred samples, of F_s.
ORACLE_SHARE = 1e-8
# A mass of 1 kg with LuGre's published levels.
SLOW = {
    "coulomb": 1.0,
    "breakaway": 1.5,
    "stribeck_velocity": 1e-3,
    "stribeck_exponent": 2.0,
    "initial_stiffness": 1e5,
    "yield_shape": 0.2,
    "attraction": 100.0,
    "viscous": 0.4,
}


def law(**values):
    return st.FrictionModel("gms", **values)


def level(speed):
    return 1.0 + 0.5 * np.exp(-((speed / 1e-3) ** 2))


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
        "yield_shape": rng.uniform(-1.5, 0.85),
        "attraction": 10.0 ** rng.uniform(0.0, 3.0),
        "viscous": around(0.05),
    }


@pytest.mark.parametrize("seed", range(6))
def test_held_speeds_follow_the_oracle(seed):
    rng, values = drawn(seed)
    velocity = 10.0 ** rng.uniform(-4.0, 0.0, 100) * np.repeat(rng.choice([1.0, -1.0], 20), 5)
    velocity[::9] = 0.0
    friction = oracle.along(velocity, DT, **values)
    ours = law(**values).simulate(velocity, DT)
    assert np.abs(ours - friction).max() < ORACLE_SHARE * values["breakaway"]


@pytest.mark.parametrize("seed", range(3))
def test_results_do_not_depend_on_the_sampling(seed):
    rng, values = drawn(seed)
    velocity = 10.0 ** rng.uniform(-4.0, 1.0, 100) * rng.choice([1.0, -1.0], 100)
    whole = law(**values).simulate(velocity, 0.01)
    finer = law(**values).simulate(np.repeat(velocity, 50), 0.01 / 50.0)[49::50]
    assert np.abs(whole - finer).max() < 1e-11 * np.abs(whole).max()


@pytest.mark.parametrize("speed", [1e-4, 5e-4, 1e-3, 2e-3, -1e-3, 0.1])
def test_steady_sliding_follows_the_stribeck_curve(speed):
    settled = law(**SLOW).simulate(np.full(200, speed), 1.0)[-1]
    assert settled == pytest.approx(np.sign(speed) * level(speed) + 0.4 * speed, rel=1e-12)


def test_after_a_jump_of_speed_friction_nears_its_level_at_the_rate_of_attraction():
    values = SLOW | {"viscous": 0.0, "attraction": 5.0}
    for before, after in ((5e-4, 2e-3), (2e-3, 5e-4)):
        model = law(**values)
        model.simulate(np.full(200, before), 1.0)
        time = DT * np.arange(1, 501)
        left = (level(before) - level(after)) * np.exp(-5.0 * time / level(after))
        assert model.simulate(np.full(500, after), DT) == pytest.approx(level(after) + left)


@pytest.mark.parametrize("attraction", [0.1, 1e4])
def test_without_a_fall_it_is_a_maxwell_slip_model(attraction):
    values = {"coulomb": 0.4, "breakaway": 0.4, "initial_stiffness": 250.0}
    model = law(**values, yield_shape=0.5, attraction=attraction)
    limits = 0.4 * (np.arange(8) + 0.5) / 32.0
    held, stiffness = np.zeros(8), 250.0 / 8.0
    for move in np.random.default_rng(4).normal(0.0, 1e-3, 300):
        held = np.clip(held + stiffness * move, -limits, limits)
        assert model.step(move / DT, DT) == pytest.approx(held.sum(), abs=1e-14)


def test_loops_within_loops_close_and_leave_no_trace():
    # Slow against v_s, so that the level is F_s throughout.
    values = SLOW | {"stribeck_velocity": 1e5, "viscous": 0.0}
    turns = np.array([2.5e-5, -1e-5, 1.5e-5, 2e-6, 1.5e-5, -1e-5, 2.5e-5])
    moves = np.diff(turns, prepend=0.0)
    model, straight = law(**values), law(**values)
    force = model.simulate(moves / DT, DT)
    assert force[4] == pytest.approx(force[2], abs=1e-12)
    assert force[5] == pytest.approx(force[1], abs=1e-12)
    assert force[6] == pytest.approx(force[0], abs=1e-12)
    straight.step(turns[0] / DT, DT)
    assert model.step(1e-2, DT) == pytest.approx(straight.step(1e-2, DT), abs=1e-12)
    # Its branches are steeper than where they began: it is no function of the place.
    assert abs(force[3] - force[5]) > 0.05


def test_a_slowing_slide_gains_no_more_than_its_springs_are_bent():
    values = SLOW | {"viscous": 0.0, "attraction": 1e4}
    model = law(**values)
    model.simulate(np.full(200, 0.1), 0.1)
    # So slow that the source's equation would reach F_s here, within a hundredth of a micrometre.
    before, after = model.step(0.1, 0.1), model.step(1e-8, 1.0)
    assert before == pytest.approx(1.0, rel=1e-12)
    assert after - before == pytest.approx(1e5 * 1e-8, rel=1e-9)
    assert model.step(0.0, 1e3) == after


def test_it_is_passive_where_the_unbounded_gain_is_not():
    values = SLOW | {"viscous": 0.0, "attraction": 1e4}
    model = law(**values)
    assert model.passive
    # A slide that is slowed down, rests for long, and is let back by its springs: over and over.
    cycle = np.concatenate(([1e-2] * 50, [1e-9] * 50, [-1e-3] * 40))
    dt = 1e-5

    def work(force):
        return np.cumsum(force * np.tile(cycle, 5) * dt)

    assert work(model.simulate(np.tile(cycle, 5), dt)).min() >= -1e-9
    k, share = 1e5 / 8.0, oracle.shares(0.2)
    # The same rest with the source's equation: what the springs then hold, nobody brought there.
    gained = np.minimum(1e4 * 50 * dt, 0.5) * share
    stored = np.sum((share + gained) ** 2 - share**2) / (2.0 * k)
    brought = 1.5 * 1e-9 * 50 * dt
    assert stored > 1e3 * brought


def test_break_away_falls_with_the_rate_of_the_force():
    found = np.array(
        [broken_away(law(**SLOW), r, "fast") for r in (0.1, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)]
    )
    assert np.all(np.diff(found) < 0.0)
    assert found[0] == pytest.approx(1.5, rel=1e-3)
    assert 1.0 < found[-1] < 1.1
    for rate, peak in ((5.0, found[3]), (20.0, found[5])):
        assert broken_away(law(**SLOW), rate, "reference") == pytest.approx(peak, rel=1e-4)


def test_friction_lags_behind_speed_the_more_the_faster_it_changes():
    gaps = list(lags(law(**SLOW)))
    assert all(np.all(gap[1:] > -1e-12) for gap in gaps)
    slow, faster, fastest = (np.max(gap) for gap in gaps)
    assert 0.0 < slow < faster < fastest


@pytest.mark.long
def test_stick_slip_follows_the_oracle_and_has_the_period_of_its_two_phases():
    end, dt = 32.0, 2e-4
    ours = pulled(law(**SLOW), "fast", end, dt)
    times = np.linspace(0.0, end, 16_001)
    exact = oracle.pulled_body(PULLING_SPEED, PULLING_SPRING, times, inertia=1.0, **SLOW)
    every = round((times[1] - times[0]) / dt)
    assert np.abs(ours[every - 1 :: every] - exact[1:]).max() < 2e-3 * np.ptp(exact)
    speed = np.diff(exact) / np.diff(times)
    starts = times[1:-1][(speed[:-1] < 0.05) & (speed[1:] >= 0.05)]
    assert starts[0] == pytest.approx(1.5 / (PULLING_SPRING * PULLING_SPEED), rel=0.03)
    assert np.diff(starts) == pytest.approx(period_of_two_phases(SLOW["viscous"]), rel=0.03)


def test_a_ripple_below_the_coulomb_level_leaves_no_drift():
    motor = st.Motor(inertia=0.0076, friction=law(coulomb=0.35, breakaway=0.5))
    time = np.arange(600_000) * 1e-4
    run = motor.simulate(0.35 * (0.5 + 0.3 * np.sin(2.0 * np.pi * 5.0 * time)), 1e-4)
    per_cycle = np.diff(run.position[1999::2000])
    assert np.abs(per_cycle[100:]).max() < 1e-9 * np.ptp(run.position)


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


def test_a_start_force_is_that_of_the_first_loading():
    values = {"coulomb": 0.35, "breakaway": 0.5, "stribeck_velocity": 1e4}
    fresh = law(**values)
    force = fresh.simulate(np.full(100, 0.003), DT)
    path = 0.003 * DT * np.arange(41)
    motor = st.Motor(inertia=0.0076, friction=law(**values))
    start = {"force": float(force[39])}
    assert 0.2 < start["force"] < 0.4
    friction = motor.follow(st.Motion(path, np.zeros(40), DT), start=start)[2]
    assert friction == pytest.approx(force[40:80], rel=1e-9)
