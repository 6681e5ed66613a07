"""Rate-and-state friction against its oracle and against what is published of it."""

import math

import numpy as np
import pytest
from tests.reference.rate_and_state_reference import (
    RateAndState,
    along,
    carried,
    critical_stiffness,
)

import stiction as st

BOTH = pytest.mark.parametrize("evolution", ["ageing", "slip"])
INERTIA = 0.0076
# The oracle's own tolerance, 1e-11 of ln theta, over 180 samples.
HELD_SHARE = 1e-10
# Of the range, at 1e-4 s; the reference integrator divides each step by eight.
BODY_SHARE = {"fast": 3e-3, "reference": 3e-4}


def core(law: RateAndState, **more) -> st.FrictionModel:
    """The same law in forces."""
    return st.FrictionModel(
        "rate_and_state",
        coulomb=law.mu_0 * law.normal,
        direct_effect=law.a / law.mu_0,
        evolution_effect=law.b / law.mu_0,
        slip_distance=law.distance,
        reference_velocity=law.speed,
        viscous=law.viscous,
        evolution=law.evolution,
        **more,
    )


@BOTH
@pytest.mark.parametrize("seed", range(3))
def test_held_speeds_follow_the_oracle_for_samples_of_any_length(evolution, seed):
    rng = np.random.default_rng(seed)
    law = RateAndState(
        evolution=evolution,
        a=rng.uniform(0.004, 0.02),
        b=rng.uniform(0.0, 0.03),
        speed=1e-3,
        normal=0.7,
        viscous=0.02,
    )
    # From a hundredth of a slip distance a sample to three hundred of them.
    speeds = 10.0 ** rng.uniform(-6.0, 0.0, 60) * rng.choice([1.0, -1.0], 60)
    velocity, dt = np.repeat(speeds, 3), 3e-3
    friction, psi = along(law, velocity, dt)
    model = core(law)
    ours = model.simulate(velocity, dt)
    assert np.abs(ours - friction).max() < HELD_SHARE * law.mu_0 * law.normal
    assert model.state["log_age"] == pytest.approx(psi[-1] - law.psi_at(law.speed), abs=1e-8)
    finer = core(law).simulate(np.repeat(velocity, 7), dt / 7.0)[6::7]
    assert np.abs(finer - ours).max() < 1e-12 * law.mu_0


@BOTH
def test_a_step_of_speed_by_e_shows_a_and_then_a_less_b(evolution):
    law = RateAndState(evolution=evolution, speed=3e-6, distance=10e-6)
    model, fast = core(law), math.e * 3e-6
    dt = 1e-3 * law.distance / fast
    before = model.simulate(np.full(10, law.speed), dt)[-1]
    after = model.simulate(np.full(20_000, fast), dt)
    # Within the first sample a thousandth of the distance is forgotten.
    assert after[0] - before == pytest.approx(law.a, rel=3e-3)
    assert after[-1] - before == pytest.approx(law.a - law.b, rel=1e-6)


def test_a_contact_at_rest_heals_by_b_for_each_factor_e():
    law = RateAndState(speed=1e-3)
    peaks = []
    for hold in (1e2, 1e3, 1e4):
        model = core(law)
        model.simulate(np.full(100, law.speed), 1e-3)
        model.step(0.0, hold)
        peaks.append(model.trial(law.speed, 1e-9)[0])
    assert np.diff(peaks) == pytest.approx(law.b * math.log(10.0), rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("integrator", ["fast", "reference"])
@pytest.mark.parametrize("direct", [0.1, 0.06])
@BOTH
def test_a_body_that_slides_stops_and_creeps_follows_the_oracle(evolution, direct, integrator):
    law = RateAndState(
        evolution=evolution,
        mu_0=0.5,
        a=0.5 * direct,
        b=0.75 * direct,
        speed=1e-3,
        distance=1e-4,
        normal=0.7,
        viscous=0.02,
    )
    effort = 0.35 * np.repeat(np.random.default_rng(3).uniform(-2.0, 2.0, 12), 2)
    exact = carried(law, effort, 0.01, inertia=INERTIA)
    motor = st.Motor(inertia=INERTIA, friction=core(law), integrator=integrator)
    run = motor.simulate(np.repeat(effort, 100), 1e-4)
    for name in ("position", "velocity", "friction"):
        share = np.abs(run[name][99::100] - exact[name]).max() / np.ptp(exact[name])
        assert share < BODY_SHARE[integrator], name


@pytest.mark.parametrize("integrator", ["fast", "reference"])
@pytest.mark.parametrize("dt", [1e-4, 1e-2, 1.0])
def test_a_body_under_half_its_limit_stays_for_an_hour(dt, integrator):
    # The slip distance sets how finely a sample is divided; an hour is long.
    law = RateAndState(mu_0=0.5, a=0.0075, b=0.01, speed=1e-3, distance=1e-3, normal=0.7)
    motor = st.Motor(inertia=INERTIA, friction=core(law), integrator=integrator)
    # A call may take so much work: in steps of seconds it stays for some minutes of the hour.
    longest = 60 if integrator == "reference" else 200
    samples = {1e-4: 20_000, 1e-2: 2000, 1.0: longest}[dt]
    run = motor.simulate(np.full(samples, 0.5 * 0.35), dt)
    assert run.success
    # e^(-33) of the reference speed, for the time that was simulated.
    creep = law.speed * math.exp(-0.5 * law.mu_0 / law.a)
    assert np.abs(run.position).max() < 1.01 * creep * samples * dt
    assert creep * 3600.0 < 1.3e-14
    assert run.friction == pytest.approx(0.175, rel=1e-6)


@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_steps_of_effort_below_the_limit_neither_move_nor_shake_a_body(integrator):
    law = RateAndState(mu_0=0.5, a=0.0075, b=0.01, speed=1e-3, distance=1e-5, normal=0.7)
    motor = st.Motor(inertia=INERTIA, friction=core(law), integrator=integrator)
    effort = 0.35 * np.random.default_rng(0).uniform(-0.7, 0.7, 5000)
    run = motor.simulate(effort, 1e-3)
    assert np.abs(run.position).max() < 1e-9
    assert np.abs(run.friction - effort).max() < 1e-3 * 0.35


def test_a_velocity_of_exactly_0_is_answered_by_what_holds():
    law = RateAndState(mu_0=0.5, a=0.0075, b=0.01, speed=1e-3, distance=1e-5, normal=0.7)
    model = core(law)
    assert model.step(0.0, 1e-3, effort=0.2) == 0.2
    limit = model.step(0.0, 1e-3, effort=-3.0)
    # The contact has grown older meanwhile.
    assert limit == pytest.approx(-0.35, rel=0.02)
    assert limit < -0.35


def pulled(share, *, evolution="ageing", mass=10.0):
    """A body pulled by a spring of this share of the critical stiffness: velocities over V."""
    law = RateAndState(evolution=evolution, a=0.01, b=0.015, speed=1e-6, distance=1e-5)
    stiffness = share * critical_stiffness(law)
    motor = st.Motor(inertia=mass, friction=core(law), torque_constant=1.0)
    x, v = 0.0, law.speed
    motor.reset(velocity=v)
    end = law.steady(v) / stiffness
    period = 2.0 * math.pi * math.sqrt(law.a / (law.b - law.a)) * law.distance / law.speed
    dt = period / 2000.0
    speeds = []
    for k in range(12_000):
        # Half a sample ahead, as the spring moves on during it; a nudge at the start.
        pull = stiffness * (end + law.speed * (k + 0.5) * dt - (x + 0.5 * v * dt))
        x, v = motor.step(pull * (1.0 + 1e-4 * (k < 5)), dt)
        speeds.append(v)
    swing = np.abs(np.log(np.maximum(np.array(speeds), 1e-30) / law.speed))
    return swing[500:3000].max(), swing[-2500:].max()


@BOTH
def test_steady_sliding_on_a_spring_is_stable_above_the_critical_stiffness(evolution):
    first, last = pulled(1.25, evolution=evolution)
    assert last < 0.3 * first
    first, last = pulled(0.8, evolution=evolution)
    assert last > 2.0 * first


@BOTH
def test_a_contact_that_yields_follows_a_rig_of_a_spring_and_an_oracle(evolution):
    from scipy.integrate import solve_ivp

    law = RateAndState(evolution=evolution, a=0.009, b=0.0095, speed=3e-6, distance=7e-6)
    stiffness = 0.007e6
    model = core(law, compliance=1.0 / stiffness)
    dt = 0.02
    speeds = np.concatenate((np.full(3000, 3e-6), np.full(400, 1e-5), np.zeros(300)))
    ours = model.simulate(speeds, dt)

    def rates(t, y):
        slip = law.velocity(y[0] / law.a, y[1])
        return stiffness * (speeds[min(int(t / dt), len(speeds) - 1)] - slip), law.rate(
            abs(slip), y[1]
        )

    state, exact = np.array([0.0, law.psi_at(law.speed)]), []
    for start, end in ((0, 3000), (3000, 3400), (3400, 3700)):
        times = dt * np.arange(start + 1, end + 1)
        run = solve_ivp(
            lambda t, y, own=start: rates((own + 0.5) * dt, y),
            (start * dt, end * dt),
            state,
            "Radau",
            t_eval=times,
            max_step=0.5,
            rtol=1e-10,
            atol=1e-12,
        )
        state = run.y[:, -1]
        exact.extend(run.y[0])
    peak = max(exact[3000:]) - exact[2999]
    # The spring takes a fifth of the direct effect of a step by ln(10/3).
    assert 0.6 < peak / (law.a * math.log(10.0 / 3.0)) < 0.9
    assert np.abs(ours - exact).max() < 1e-3 * peak


@pytest.mark.parametrize("compliance", [0.0, 3e-4])
def test_motion_of_a_contact_along_readings_is_differentiated_exactly(compliance):
    law = {"coulomb": 0.35, "slip_distance": 1e-4, "compliance": compliance}
    motion = 0.01 * np.sin(np.linspace(0.0, 12.0, 400))
    names = [f"friction.{name}" for name in ("coulomb", "direct_effect", "slip_distance")]
    motor = st.Motor(inertia=INERTIA, friction=st.FrictionModel("rate_and_state", **law))

    def friction(**changed):
        model = st.FrictionModel("rate_and_state", **(law | changed))
        other = st.Motor(inertia=INERTIA, friction=model)
        return other.follow(st.Motion(motion, np.zeros(399), 1e-3), start={"log_age": 0.3})[2]

    exact = motor.follow_sensitivity(
        st.Motion(motion, np.zeros(399), 1e-3), names, start={"log_age": 0.3}
    )[0]
    for name, column in zip(names, np.asarray(exact), strict=True):
        short = name.removeprefix("friction.")
        value = {"coulomb": 0.35, "direct_effect": 0.015, "slip_distance": 1e-4}[short]
        step = 1e-6 * value
        chord = (friction(**{short: value + step}) - friction(**{short: value - step})) / step / 2
        assert np.abs(column - chord).max() < 1e-5 * np.abs(chord).max(), name


@BOTH
def test_motion_of_a_body_on_a_rigid_contact_is_differentiated_exactly(evolution):
    # Slides, a stop, creep and a reversal; the generic tests draw contacts that yield.
    values = {"coulomb": 0.35, "direct_effect": 0.02, "slip_distance": 2e-5, "viscous": 0.03}
    effort = np.repeat([0.6, 0.2, -0.5, 0.1, 0.45], 60)

    def end(**changed):
        model = st.FrictionModel("rate_and_state", evolution=evolution, **(values | changed))
        return st.Motor(inertia=INERTIA, friction=model).simulate(effort, 5e-4).position[-1]

    model = st.FrictionModel("rate_and_state", evolution=evolution, **values)
    motor = st.Motor(inertia=INERTIA, friction=model)
    paths = [f"friction.{name}" for name in values]
    found = motor.sensitivity(effort, 5e-4, paths)[0]
    for name, column in zip(values, found, strict=True):
        # A difference of the fourth order: friction bends sharply about rest.
        step = 1e-4 * values[name]
        near = end(**{name: values[name] + step}) - end(**{name: values[name] - step})
        far = end(**{name: values[name] + 2 * step}) - end(**{name: values[name] - 2 * step})
        chord = (8.0 * near - far) / (12.0 * step)
        assert column[-1] == pytest.approx(chord, rel=1e-5), name
