"""LuGre against its oracle, its special cases and what was published of it."""

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
from tests.reference.laws import lugre as oracle
from tests.reference.laws.lugre import PUBLISHED

import stiction as st

DT = 1e-3
# The oracle's own tolerance over some hundred samples, of F_s.
ORACLE_SHARE = 1e-8


def law(**values):
    return st.FrictionModel("lugre", **values)


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
        "damping": around(1.0),
        "damping_velocity": around(0.1) if seed % 2 else np.inf,
        "viscous": around(0.05),
    }


@pytest.mark.parametrize("seed", range(6))
def test_held_speeds_follow_the_oracle(seed):
    rng, values = drawn(seed)
    velocity = 10.0 ** rng.uniform(-4.0, 0.0, 60) * rng.choice([1.0, -1.0], 60)
    velocity[::9] = 0.0
    friction = oracle.along(velocity, DT, **values)
    ours = law(**values).simulate(velocity, DT)
    scale = values["breakaway"] + values["damping"] * np.abs(velocity).max()
    assert np.abs(ours - friction).max() < ORACLE_SHARE * scale


def test_a_step_of_any_length_is_exact():
    rng, values = drawn(1)
    velocity = 10.0 ** rng.uniform(-4.0, 1.0, 100) * rng.choice([1.0, -1.0], 100)
    whole = law(**values).simulate(velocity, 0.01)
    finer = law(**values).simulate(np.repeat(velocity, 50), 0.01 / 50.0)[49::50]
    assert np.abs(whole - finer).max() < 1e-11 * np.abs(whole).max()


@pytest.mark.parametrize("speed", [1e-4, 5e-4, 1e-3, 2e-3, 5e-3, -1e-3])
def test_steady_sliding_follows_the_stribeck_curve(speed):
    settled = law(**PUBLISHED).simulate(np.full(200, speed), 1.0)[-1]
    level = 1.0 + 0.5 * np.exp(-((speed / 1e-3) ** 2))
    assert settled == pytest.approx(np.sign(speed) * level + 0.4 * speed, rel=1e-12)


def test_without_fall_and_damping_it_is_dahls_curve_of_exponent_1():
    values = {"coulomb": 0.35, "initial_stiffness": 3000.0, "viscous": 0.05}
    velocity = np.random.default_rng(3).uniform(-1.0, 1.0, 500)
    ours = law(**values, damping=0.0).simulate(velocity, 1e-4)
    curve = st.FrictionModel("dahl", **values, exponent=1.0).simulate(velocity, 1e-4)
    assert np.abs(ours - curve).max() < 1e-14


def test_around_rest_it_is_a_spring_with_a_damper():
    model = law(**PUBLISHED)
    force, slope = model.trial(1e-9, 1e-4)
    stiffness, damping = 1e5, np.sqrt(1e5) + 0.4
    assert force == pytest.approx(1e-9 * (stiffness * 1e-4 + damping), rel=1e-6)
    assert slope == pytest.approx(stiffness * 1e-4 + damping, rel=1e-6)


def test_break_away_falls_with_the_rate_of_the_force():
    # The experiment behind their figure of break-away against force rate, 1 to 50 N/s.
    rates = [0.1, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0]
    found = np.array([broken_away(law(**PUBLISHED), rate, "fast") for rate in rates])
    assert np.all(np.diff(found) < 0.0)
    assert found[0] == pytest.approx(1.5, rel=0.03)
    assert 1.0 < found[-1] < 1.25
    for rate, peak in zip(rates[1::2], found[1::2], strict=True):
        times = np.linspace(0.0, 2.0 / rate + 0.1, 8001)
        x, v, z = oracle.body(lambda t, _, r=rate: r * t, times, inertia=1.0, **PUBLISHED)
        resisted = oracle.friction(z, v, **PUBLISHED)
        exact = resisted[: np.argmax(x > 3e-4) + 1].max()
        assert peak == pytest.approx(exact, rel=1e-3)


def test_friction_lags_behind_speed_the_more_the_faster_it_changes():
    gaps = list(lags(law(**PUBLISHED)))
    slow, faster, fastest = (np.max(gap) for gap in gaps)
    assert 0.0 < slow < faster < fastest


def test_a_pre_sliding_loop_is_hysteresis_about_its_turning_points():
    # Their pre-sliding experiment: a force to and fro below break-away, on a body of 1 kg.
    motor = st.Motor(inertia=1.0, friction=law(**PUBLISHED))
    time = np.arange(300_000) * 1e-4
    run = motor.simulate(1.425 * np.sin(2.0 * np.pi * 0.1 * time), 1e-4)
    x, f = run.position[200_000:], run.friction[200_000:]
    assert np.ptp(x) < 3e-4
    lost = np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x))
    assert 0.1 * np.ptp(x) * np.ptp(f) < lost < np.ptp(x) * np.ptp(f)


def test_stick_slip_follows_the_oracle_and_has_the_period_of_its_two_phases():
    # A mass of 1 kg on a spring of 2 N/m pulled at 0.1 m/s, as in their simulation.
    end, dt = 32.0, 2e-4
    ours = pulled(law(**PUBLISHED), "fast", end, dt)
    times = np.linspace(0.0, end, 16_001)
    pull = lambda t, x: PULLING_SPRING * (PULLING_SPEED * t - x)  # noqa: E731
    exact = oracle.body(pull, times, inertia=1.0, **PUBLISHED)[0]
    every = round((times[1] - times[0]) / dt)
    assert np.abs(ours[every - 1 :: every] - exact[1:]).max() < 2e-3 * np.ptp(exact)
    speed = np.diff(exact) / np.diff(times)
    starts = times[1:-1][(speed[:-1] < 0.05) & (speed[1:] >= 0.05)]
    # It sticks until the spring bears F_s.
    assert starts[0] == pytest.approx(1.5 / (PULLING_SPRING * PULLING_SPEED), rel=0.03)
    assert np.diff(starts) == pytest.approx(period_of_two_phases(PUBLISHED["viscous"]), rel=0.03)


def taken_from(model, length, speed):
    """Work done on a contact that is bent slowly and then pulled on very fast, at its least."""
    work = np.sum(model.simulate(np.full(4000, 1e-6), 0.02 * length / 1e-6)) * 0.02 * length
    dx = 1e-3 * length
    return work + np.cumsum(model.simulate(np.full(1000, speed), dx / speed) * dx).min()


def test_it_is_passive_where_barabanov_and_ortega_say_so_and_nowhere_else():
    values = {"coulomb": 1.0, "breakaway": 1.5, "initial_stiffness": 1e3, "damping": 1.0}
    # sigma_2 against sigma_1 (F_s - F_c) / F_c = 0.5.
    for viscous, passive in ((0.51, True), (0.49, False), (0.4, False)):
        model = law(**values, viscous=viscous)
        assert model.passive is passive
        if viscous == 0.4:
            assert taken_from(model, 1e-3, 1e5) < 0.0
        elif passive:
            assert taken_from(model, 1e-3, 1e5) > 0.0
    assert not law(**PUBLISHED).passive
    assert law(**values, viscous=0.0, damping_velocity=1.0).passive
    assert not law(**values, viscous=0.0, damping_velocity=1e3).passive


def test_a_ripple_below_the_coulomb_level_ratchets():
    motor = st.Motor(inertia=0.0076, friction=law(coulomb=0.35, breakaway=0.35))
    time = np.arange(600_000) * 1e-4
    run = motor.simulate(0.35 * (0.5 + 0.3 * np.sin(2.0 * np.pi * 5.0 * time)), 1e-4)
    assert run.statistics["breakaways"] == 0
    # It never slides, and yet goes on and on: many times the reach F_c / sigma_0.
    per_cycle = np.diff(run.position[1999::2000])[20:]
    assert np.all(per_cycle > 0.0)
    assert run.position[-1] > 100.0 * np.ptp(run.position[-2000:])


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
