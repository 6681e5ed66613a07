"""Servo gear friction against its oracle and against the published models M1 to M6."""

import numpy as np
import pytest
from tests.reference.laws import load_dependent as reference

import stiction as st

INERTIA = 0.0076
# The parameters that were published for the XL330 (M6), in N·m and rad/s.
XL330 = reference.Gear(
    friction_base=0.0023258418670152347,
    friction_stribeck=0.0001856264715700908,
    load_friction_motor=0.23063000784446322,
    load_friction_external=0.26077932692372613,
    load_friction_motor_stribeck=1.9157733081388423e-06,
    load_friction_external_stribeck=0.15158776983752117,
    load_friction_motor_quad=0.005595958708218643,
    load_friction_external_quad=0.0037747149629857673,
    dtheta_stribeck=0.11532863880939243,
    alpha=1.000022697315946,
    friction_viscous=0.0185448141303962,
)
# Motor, load, speed, and what the published formula makes of them with those parameters.
PUBLISHED = [
    (0.5, -0.3, 0.0, 0.2418772835225139),
    (0.2, -0.45, 0.0, 0.23442688495302963),
    (0.2, -0.45, 0.1, 0.19463675939619277),
    (0.4, 0.3, 0.05, 0.04594223935735174),
]
PLAIN = {"coulomb": 0.1, "drive": 0.2, "back_drive": 0.3}


def drawn(rng):
    """A gear with every term."""
    return reference.Gear(
        friction_base=rng.uniform(0.02, 0.4),
        friction_stribeck=rng.uniform(0.0, 0.2),
        load_friction_motor=rng.uniform(0.0, 0.4),
        load_friction_external=rng.uniform(0.0, 0.4),
        load_friction_motor_stribeck=rng.uniform(0.0, 0.2),
        load_friction_external_stribeck=rng.uniform(0.0, 0.2),
        load_friction_motor_quad=rng.uniform(0.0, 0.3),
        load_friction_external_quad=rng.uniform(0.0, 0.3),
        dtheta_stribeck=rng.uniform(0.03, 0.3),
        alpha=rng.uniform(1.0, 3.0),
        friction_viscous=rng.uniform(0.0, 0.1),
    )


def model(law):
    return st.FrictionModel("load_dependent", **law.parameters)


@pytest.mark.parametrize(("motor", "external", "speed", "friction"), PUBLISHED)
def test_the_oracle_and_the_core_give_the_published_gear_its_friction(
    motor, external, speed, friction
):
    assert XL330.dry(motor, external, speed) == pytest.approx(friction, rel=1e-12)
    # So slow that nothing of the fall is gone, and still a slide: all of the budget shows.
    v = max(speed, 1e-12)
    ours = model(XL330).step(v, 1e-3, effort=motor + external, load=external)
    assert ours - XL330.friction_viscous * v == pytest.approx(friction, rel=1e-10)


@pytest.mark.parametrize("seed", range(4))
def test_drawn_gears_follow_the_oracle_under_any_efforts(seed):
    rng = np.random.default_rng(seed)
    law, samples = drawn(rng), 400
    motor, external = rng.uniform(-1.0, 1.0, (2, samples))
    velocity = rng.uniform(-0.4, 0.4, samples) * (rng.random(samples) > 0.2)
    exact = reference.along(velocity, 1e-3, motor=motor, external=external, **law.parameters)
    ours = model(law).simulate(velocity, 1e-3, effort=motor + external, load=external)
    assert np.abs(ours - exact).max() < 1e-13


def test_without_efforts_nothing_but_coulomb_with_its_fall_is_left():
    levels = {"coulomb": 0.3, "breakaway": 0.45, "viscous": 0.02, "stribeck_velocity": 0.07}
    velocity = np.random.default_rng(5).uniform(-0.3, 0.3, 200)
    gear = st.FrictionModel("load_dependent", **levels).simulate(velocity, 1e-3)
    coulomb = st.FrictionModel("coulomb", **levels).simulate(velocity, 1e-3)
    assert np.array_equal(gear, coulomb)


def test_models_m1_to_m6_follow_from_what_is_left_neutral():
    motor, load, speed = 0.5, -0.3, 0.05
    fall = np.exp(-((speed / 0.1) ** 2))
    more = {
        "M1": ({}, 0.1),
        "M2": ({"breakaway": 0.15}, 0.1 + 0.05 * fall),
        "M3": ({"drive": 0.2}, 0.1 + 0.2 * 0.8),
        "M4": (
            {"breakaway": 0.15, "drive": 0.2, "drive_stribeck": 0.05},
            0.1 + 0.2 * 0.8 + fall * (0.05 + 0.05 * 0.8),
        ),
        "M5": ({"drive": 0.2, "back_drive": 0.3}, 0.1 + 0.2 * 0.5 + 0.3 * 0.3),
        "M6": (
            {"drive": 0.2, "back_drive": 0.3, "drive_quadratic": 0.4, "back_drive_quadratic": 9.0},
            0.1 + 0.2 * 0.5 + 0.3 * 0.3 + fall * 0.4 * 0.3**2,
        ),
    }
    for name, (stated, friction) in more.items():
        law = st.FrictionModel("load_dependent", **({"coulomb": 0.1, "drive": 0.0} | stated))
        ours = law.step(speed, 1e-3, effort=motor + load, load=load)
        assert ours == pytest.approx(friction, rel=1e-12), name


def test_the_quadratic_term_needs_efforts_against_each_other():
    stated = {"coulomb": 0.1, "drive": 0.0, "drive_quadratic": 0.4, "back_drive_quadratic": 0.7}
    at = {
        (0.5, 0.3): 0.0,
        (0.5, 0.0): 0.0,
        (0.5, -0.3): 0.4 * 0.09,
        (-0.3, 0.5): 0.7 * 0.09,
        (0.3, -0.3): 0.4 * 0.09,
    }
    for (motor, load), added in at.items():
        law = st.FrictionModel("load_dependent", **stated)
        ours = law.step(1e-9, 1e-3, effort=motor + load, load=load)
        assert ours == pytest.approx(0.1 + added, rel=1e-12), (motor, load)


@pytest.mark.parametrize("by", ["load", "gravity"])
def test_a_motor_holds_a_load_within_its_drive_and_back_drive_limits(by):
    carried = 0.6
    # It lifts from m (1 - K_m) = F_c + q (1 + K_e) on, sinks below m (1 + K_m) = q (1 - K_e) - F_c.
    lifts = (0.1 + carried * 1.3) / 0.8
    sinks = (carried * 0.7 - 0.1) / 1.2
    for effort, side in ((lifts, 1.0), (sinks, -1.0)):
        for off, moves in ((-1e-9, False), (1e-9, True)):
            body = {"inertia": INERTIA, "friction": st.FrictionModel("load_dependent", **PLAIN)}
            load = -carried if by == "load" else 0.0
            if by == "gravity":
                body |= {"gravity_amplitude": carried, "gravity_zero": -0.5 * np.pi}
            run = st.Motor(**body).simulate(np.full(50, effort + side * off), 1e-3, load=load)
            if moves:
                assert run.position[-1] * side > 0.0
            else:
                assert np.all(run.position == 0.0)


def test_a_gear_that_takes_more_than_it_passes_on_locks_itself():
    law = st.FrictionModel("load_dependent", coulomb=0.1, drive=0.2, back_drive=1.0)
    motor = st.Motor(inertia=INERTIA, friction=law)
    run = motor.simulate(np.zeros(100), 1e-3, load=-50.0)
    assert np.all(run.position == 0.0)


def test_a_slide_under_constant_efforts_is_a_parabola():
    law = st.FrictionModel("load_dependent", **PLAIN)
    motor, load = 0.9, -0.3
    friction = 0.1 + 0.2 * motor + 0.3 * 0.3
    run = st.Motor(inertia=INERTIA, friction=law).simulate(np.full(200, motor), 1e-3, load=load)
    exact = 0.5 * (motor + load - friction) / INERTIA * run.time**2
    assert np.abs(run.position - exact).max() < 1e-12 * exact[-1]


@pytest.mark.parametrize(("integrator", "share"), [("fast", 2e-5), ("reference", 2e-8)])
def test_a_pendulum_that_swings_and_sticks_follows_the_oracle(integrator, share):
    rng = np.random.default_rng(8)
    law = reference.Gear(
        friction_base=0.03,
        friction_stribeck=0.02,
        load_friction_motor=0.1,
        load_friction_external=0.15,
        load_friction_motor_stribeck=0.05,
        load_friction_external_stribeck=0.02,
        dtheta_stribeck=0.3,
        friction_viscous=0.02,
    )
    effort = rng.uniform(-0.5, 0.5, 20)
    exact, speed = reference.carried(law, effort, 0.05, inertia=INERTIA, gravity=0.4, load=0.1)
    machine = st.Motor(
        inertia=INERTIA, friction=model(law), gravity_amplitude=0.4, integrator=integrator
    )
    run = machine.simulate(np.repeat(effort, 200), 2.5e-4, load=0.1)
    assert np.ptp(exact) > 0.5
    assert (speed == 0.0).any()
    assert np.abs(run.position[199::200] - exact).max() < share * np.ptp(exact)
