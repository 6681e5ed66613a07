"""Effects of contacts, heat, load and gaps against closed forms and another integrator."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from .contact_effect_reference import LADDER, ReversePoints, exponential_curve, ladder_curve
from .effect_catalogue import EFFECTS
from .effect_reference import Setting, Situation
from .excitation_reference import draw_plant
from .test_more_effects_reference import J, T, run_of


def one_lane(name, amplitude, shape):
    """An effect alone, to be asked step by step."""
    one = np.ones(1)
    setting = Setting(slice(0, 1), 1e-4, coulomb=one, presliding=one, inertia=one)
    shape = {key: np.array([value]) for key, value in shape.items()}
    return EFFECTS[name](np.array([amplitude]), shape, setting)


@pytest.mark.parametrize("fall", [0.0, 1.0])
@pytest.mark.parametrize("pure", [0.0, 1.0])
def test_friction_follows_a_growing_speed_late(pure, fall):
    a, velocity, time, rate = 0.2, 0.3, 0.0123, 5.0
    shape = {"velocity": velocity, "time": time, "pure": pure, "fall": fall}
    effect = one_lane("frictional_lag", a, shape)
    s = Situation(step=1e-4, sample_time=1e-3, substeps=10)
    for n in range(2000):
        t = n * s.step
        s.n, s.v = n, np.array([rate * t])
        share = effect.share(s)[0]
        v = rate * t
        late = rate * max(t - time, 0.0) if pure else rate * (t + time * math.expm1(-t / time))
        then, now = (math.exp(-((w / velocity) ** 2)) for w in (late, v))
        expected = a * (then - (1.0 - fall) * now)
        assert share == pytest.approx(expected, abs=1e-5)


LENGTH, BEND = 1e-3, 0.4


def points(curve=None):
    return ReversePoints(LENGTH, curve or exponential_curve(BEND), 1)


def go(memory, *turns):
    """Values after each leg; every leg in steps of its own."""
    values, x = [], 0.0
    for goal in turns:
        for dx in np.diff(np.linspace(x, goal, 378)):
            value = memory.move(np.array([dx]))
        values.append(float(value[0]))
        x = goal
    return values


def test_a_closed_loop_is_wiped_out_with_all_that_is_in_it():
    plain, nested = points(), points()
    (straight,) = go(plain, 9e-4)
    at, *_, again, beyond = go(nested, 6e-4, 1e-4, 4e-4, 2e-4, 3e-4, -1e-4, 6e-4, 9e-4)
    assert again == pytest.approx(at, abs=1e-9)
    assert beyond == pytest.approx(straight, abs=1e-9)
    assert nested.depth[0] == 0


def test_branches_of_reverse_points_are_congruent_and_end_at_one():
    memory = points()
    full, back, over = go(memory, 5e-3, 5e-3 - 7e-4, 1e-3)
    assert full == 1.0
    assert full - back == pytest.approx(2.0 * memory.virgin(3.5e-4), abs=1e-9)
    assert over == -1.0
    other = points()
    low, up = go(other, -6e-4, -6e-4 + 7e-4)
    assert up - low == pytest.approx(full - back, abs=1e-9)


def elements_of_the_exponential(number):
    """Slip distances and stiffnesses: minus its curvature, and what it has left at its end."""
    edges = np.arange(number + 1) / number
    slope = np.exp(-edges / BEND) / BEND / -math.expm1(-1.0 / BEND)
    stiffness = -np.diff(slope)
    stiffness[-1] += slope[-1]
    return LENGTH * (edges[1:] + edges[:-1]) / 2.0, stiffness / LENGTH


@pytest.mark.parametrize("form", ["library", "foreign"])
def test_reverse_points_do_what_elements_in_parallel_do(form):
    if form == "library":
        memory, bound = points(ladder_curve), 1e-9
        slip = LENGTH * np.array(LADDER)
        stiffness = 1.0 / len(LADDER) / slip
    else:
        memory, bound = points(), 2e-3
        slip, stiffness = elements_of_the_exponential(4000)
    extension, x = np.zeros(slip.size), 0.0
    for goal in np.random.default_rng(2).normal(0.0, 0.4 * LENGTH, 200).cumsum():
        extension = np.clip(extension + goal - x, -slip, slip)
        value = memory.move(np.array([goal - x]))[0]
        x = goal
        assert value == pytest.approx(stiffness @ extension, abs=bound)


def test_memory_of_reverse_points_is_booked_against_a_rigid_contact():
    plant = draw_plant("coulomb", np.random.default_rng(5)) | {"viscous": 0.0}
    level, a, shape = plant["coulomb"], 0.3, {"length": 4e-3, "bend": 0.375}
    torque = np.where(T < 0.1, 2.0, np.where(T < 0.2, -2.0, 0.0)) * level
    run = run_of("reverse_point_memory", torque, a, shape, plant=plant, substeps=10)
    x, v = run.true_position[:, 0], run.velocity[:, 0]
    turn = int(np.argmax(x))
    sliding = slice(turn + 1, turn + 12)
    back = np.minimum(0.5 * (x.max() - x[sliding]), 4e-3)
    m = 1.0 - 2.0 * np.expm1(-back / 1.5e-3) / np.expm1(-4e-3 / 1.5e-3)
    assert np.all(v[sliding] < 0.0)
    # The mean over a sample is that half a sample later.
    booked = run.hidden[0, sliding, 0]
    now = 0.5 * (booked[1:] + booked[:-1])
    np.testing.assert_allclose(now, a * level * (-1.0 - m)[1:], atol=0.01 * a * level)


def test_a_held_torque_relaxes_at_a_constant_speed():
    plant = draw_plant("maxwell_slip", np.random.default_rng(5)) | {"viscous": 0.5}
    a, exponent = 1e-4, 2.5
    torque = 0.6 * plant["coulomb"] * np.minimum(np.arange(3000) / 500.0, 1.0)
    run = run_of("relaxation", torque, a, {"exponent": exponent}, base="maxwell_slip", plant=plant)
    x = run.true_position[:, 0]
    speed = (x[-1] - x[-1001]) / 1.0
    assert speed == pytest.approx(a * 0.6**exponent, rel=1e-3)


def sliding_friction(name, amplitude, shape, side, plant, **options):
    """Dry friction of a slide, from what the run says of friction and speed."""
    torque = np.full(150, side * 6.0 * plant["coulomb"])
    run = run_of(name, torque, amplitude, shape, plant=plant, **options)
    v = 0.5 * (run.velocity[1:, 0] + run.velocity[:-1, 0])
    return side * (run.friction[:-1, 0] - plant["viscous"] * v)[50:], v[50:], run


@pytest.mark.parametrize("quadratic", [0.0, 1.0])
def test_load_makes_friction_in_four_quadrants(quadratic):
    plant = draw_plant("coulomb", np.random.default_rng(5))
    level, a, back = plant["coulomb"], 0.1, 0.4
    shape = {"back": back, "velocity": 0.01, "quadratic": quadratic}
    for side in (1.0, -1.0):
        for load in (1.2 * level, -1.2 * level):
            options = {"load": np.full((150, 1), load)}
            dry, v, _ = sliding_friction(
                "load_dependent_friction", a, shape, side, plant, **options
            )
            assert np.all(side * v > 1.0)
            grown = a * (1.0 if load * side < 0.0 else back) * 1.2
            grown *= 1.2 if quadratic else 1.0
            np.testing.assert_allclose(dry, level * (1.0 + grown), rtol=1e-5)


def test_friction_falls_with_the_temperature():
    plant = draw_plant("coulomb", np.random.default_rng(5))
    level, viscous, a = plant["coulomb"], plant["viscous"], 2e-3
    warm = np.linspace(20.0, 45.0, 150)[:, None]
    shape = {"viscous_part": 1.5}
    name = "temperature_dependent_friction"
    *_, run = sliding_friction(name, a, shape, 1.0, plant, temperature=warm)
    v = 0.5 * (run.velocity[1:, 0] + run.velocity[:-1, 0])
    expected = a * (warm[:-1, 0] - 25.0) * (level + 1.5 * viscous * v)
    # A mean over the sample of what is quadratic in time.
    np.testing.assert_allclose(run.hidden[0, 1:-1, 0], expected[1:], atol=1e-6 * level)


def test_friction_may_fall_as_a_viscosity_does():
    effect = one_lane(
        "temperature_dependent_friction", 2e-3, {"viscous_part": 1.0, "activation": 5e3}
    )
    s = Situation(step=1e-4, sample_time=1e-3, substeps=10)

    def share(t):
        s.temperature = np.array([t])
        return effect.share(s)[0]

    assert share(25.0) == 0.0
    assert (share(25.01) - share(24.99)) / 0.02 == pytest.approx(-2e-3, rel=1e-4)
    fluid = 2e-3 * 298.15**2 / 5e3  # the part of friction that falls
    ratio = (fluid + share(45.0)) / (fluid + share(20.0))
    assert math.log(ratio) == pytest.approx(5e3 * (1.0 / 318.15 - 1.0 / 293.15), rel=1e-9)


def backlash_flight(share, gap, u, turn):
    """Speeds of a free motor at T: push with u, from `turn` on with -u."""
    near = (1.0 - share) * J
    # Through half the gap, an impact, and on together until the motor is braked.
    meet = math.sqrt(gap * near / u)
    joined = u * turn / J
    fly = math.sqrt(2.0 * gap * near / u)
    again = turn + fly
    both = u * (turn - fly) / J
    return (
        meet,
        again,
        np.select(
            [meet > T, turn > T, again > T],
            [u * T / near, u * T / J, joined - u * (T - turn) / near],
            both - u * (T - again) / J,
        ),
    )


def test_a_reversed_motor_is_free_for_just_as_long_as_the_gap_takes():
    share, gap, u, turn = 0.4, 8e-3, 0.3, 0.1
    torque = np.where(turn > T + 1e-9, u, -u)
    run = run_of("backlash", torque, share, {"gap": gap})
    meet, again, expected = backlash_flight(share, gap, u, turn)
    near = [np.abs(T - at) < 1.1e-3 for at in (meet, again)]
    away = ~(near[0] | near[1])
    np.testing.assert_allclose(run.velocity[away, 0], expected[away], atol=1e-3 * expected.max())
    # It lacks the far inertia while it flies, gets its momentum back at the impact, and has no
    # secret while the two move together.
    hidden, far = run.hidden[0, :, 0], share * J
    flying = (turn + 1e-3 < T) & (again - 2e-3 > T)
    np.testing.assert_allclose(hidden[flying], -far * u / (J - far), rtol=1e-9)
    together = (again + 2e-3 < T) | ((meet + 2e-3 < T) & (turn - 1e-3 > T))
    assert np.abs(hidden[together]).max() < 1e-9
    assert hidden.sum() * 1e-3 == pytest.approx(0.0, abs=1e-9)


def test_an_elastic_gap_does_what_another_integrator_says():
    share, gap, u, damping, frequency = 0.4, 8e-3, 0.3, 2.0, 80.0
    shape = {"gap": gap, "frequency": frequency, "damping": damping}
    torque = u * np.where(T < 0.1, 1.0, -1.0)
    run = run_of("backlash", torque, share, shape)
    near, far = (1.0 - share) * J, share * J
    stiffness = near * far / J * (2.0 * np.pi * frequency) ** 2

    def rates(t, y, push):
        apart, rate = y[0] - y[2], y[1] - y[3]
        side = math.copysign(1.0, apart)
        pressed = max(abs(apart) - 0.5 * gap, 0.0)
        torque = side * stiffness * pressed * max(1.0 + damping * side * rate, 0.0)
        return [y[1], (push - torque) / near, y[3], torque / far]

    y, parts = np.zeros(4), []
    for begin, end, push in ((0, 100, u), (100, 399, -u)):
        options = {"rtol": 1e-9, "atol": 1e-12, "max_step": 2e-4, "args": (push,)}
        piece = solve_ivp(rates, (T[begin], T[end]), y, t_eval=T[begin : end + 1], **options)
        parts.append(piece.y[0, :-1])
        y = piece.y[:, -1]
    expected = np.concatenate(parts)
    np.testing.assert_allclose(run.true_position[:-1, 0], expected, atol=1e-3 * gap)
