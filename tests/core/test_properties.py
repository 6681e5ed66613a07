"""Energy, memory, drift and neutral points, over random parameters and motions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as hs

import stiction as st

from .rigs import (
    CONTACTS,
    HOOK,
    ILLUSTRATIVE,
    INERTIA,
    drawn_rig,
    motor,
    wandering_current,
)

DT = 1e-3
# Round-off of a running sum of 1e5 products, as a share of all the work that went to and fro.
WORK_ROUND_OFF = 1e-12
# A curve that starts like a branch leaves parts of the spring sliding at no force one way. There
# the trapezoidal rule, exact on the safe side for Masing's curve, errs to either side by the
# curvature of a step.
SAME_CURVE_SHARE = 1e-5
# The trapezoidal rule smears a break-away over the step that holds it, one of some hundreds.
BREAKAWAY_SHARE = 2e-5
# Reverse points are met again, and loops wiped out, to this share of the force range.
CLOSING_ROUND_OFF = 1e-12
# Equilibrium of a stuck spring law, rad.
EQUILIBRIUM = 1e-12
STUCK = {"hardening_coefficient": 0.0, "damping": 0.45}
# Speeds at which steps of DT pass a thousandth to a hundred times the decay distance.
SLOW, FAST = -4.0, 1.0


def random_motion(seed, n, *, scale=1.0):
    """Speeds over five decades, turned round at random; rests between."""
    rng = np.random.default_rng(seed)
    velocity = scale * 10.0 ** rng.uniform(SLOW, FAST, n) * rng.choice([-1.0, 1.0], n)
    velocity[rng.random(n) < 0.05] = 0.0
    return velocity


def least_work(force, velocity, damping, dt=DT):
    """(least net work put into the contact, work to and fro) of steps at held velocity.

    The spring's force by the trapezoidal rule, what depends on velocity at the step's end.
    """
    at_once = damping * velocity
    spring = force - at_once
    mean = (spring + np.concatenate(([0.0], spring[:-1]))) / 2.0
    work = (mean + at_once) * velocity * dt
    return np.cumsum(work).min(), np.abs(work).sum()


# Without its damper a contact has less to hide a gain of the spring's or the creep's behind.
@pytest.mark.parametrize("damping", [0.0, 0.45])
@pytest.mark.parametrize("kind", ["sticking", "elastic"])
def test_a_sticking_contact_never_gives_back_more_than_it_took(kind, damping):
    law, keywords = CONTACTS[kind]
    model = st.FrictionModel(law, **keywords | {"damping": damping})
    velocity = random_motion(1, 100_000)
    force = model.simulate(velocity, DT)
    least, total = least_work(force, velocity, model.parameters["damping"])
    assert least >= -WORK_ROUND_OFF * total


@pytest.mark.parametrize("virgin_curve", ["masing", "same"])
@pytest.mark.parametrize("seed", range(4))
def test_drawn_springs_never_give_back_more_than_they_took(seed, virgin_curve):
    _, parameters, force = drawn_rig(seed)
    parameters |= {"damping": 0.0}
    model = st.FrictionModel("hsieh_pan", virgin_curve=virgin_curve, **parameters)
    # Scaled so that the decay distance lies inside the moves.
    velocity = random_motion(seed, 20_000, scale=100.0 * parameters["decay_distance"])
    least, total = least_work(model.simulate(velocity, DT), velocity, 0.0)
    assert total > force * parameters["decay_distance"]
    share = WORK_ROUND_OFF if virgin_curve == "masing" else SAME_CURVE_SHARE
    assert least >= -share * total


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    seed=hs.integers(0, 100_000),
    exponent=hs.floats(1.05, 5.0),
    rate=hs.floats(-1.0, 4.0),
    dt=hs.sampled_from([1e-4, 1e-2, 1.0]),
)
def test_creep_never_gives_energy_back(seed, exponent, rate, dt):
    _, parameters, force = drawn_rig(seed)
    parameters |= {
        "hardening_exponent": exponent,
        "hardening_coefficient": 3.0 * force / parameters["initial_stiffness"] / force**exponent,
        "creep_rate": 10.0**rate,
        "damping": 0.0,
    }
    model = st.FrictionModel("hsieh_pan", **parameters)
    velocity = random_motion(seed, 2000, scale=0.1 * parameters["decay_distance"] / dt)
    least, total = least_work(model.simulate(velocity, dt), velocity, 0.0, dt)
    assert least >= -WORK_ROUND_OFF * total


@pytest.mark.parametrize("kind", [k for k in CONTACTS if k not in ("coulomb", "stribeck")])
@pytest.mark.parametrize("damping", [0.0, 0.45])
def test_a_contact_that_breaks_away_never_gives_back_more_than_it_took(kind, damping):
    # F_v counts as force at held velocity; the damper acts only while the hook sticks.
    law, keywords = CONTACTS[kind]
    model = st.FrictionModel(law, **keywords | {"damping": damping})
    n, dt = 100_000, 1e-5
    speeds = np.repeat(random_motion(3, n // 50, scale=0.1), 50)
    force = np.concatenate(([0.0], model.simulate(speeds, dt)))
    work = (force[1:] + force[:-1]) / 2.0 * speeds * dt
    # At a jump of velocity the damper's force jumps with it: take it at the step's end there.
    jump = np.concatenate(([True], np.diff(speeds) != 0.0))
    work[jump] = force[1:][jump] * speeds[jump] * dt
    assert np.cumsum(work).min() >= -BREAKAWAY_SHARE * np.abs(work).sum()


@pytest.mark.parametrize("kind", CONTACTS)
@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_a_machine_never_has_more_energy_than_its_input_brought(kind, integrator):
    current = wandering_current(5, 20_000, 1.0, dwell=200)
    run = motor(kind, integrator=integrator).simulate(current, 1e-4)
    work = np.cumsum(current * np.diff(run.position, prepend=0.0))
    kinetic = 0.5 * INERTIA * run.velocity**2
    # Held inputs make the work exact; the kinetic energy is that of the integrator, whose error
    # of second order is a thousandth of the greatest energy.
    assert np.max(kinetic - work) <= 1e-3 * max(kinetic.max(), work.max())


def test_a_free_ring_only_loses_energy():
    parameters = ILLUSTRATIVE | {"damping": 0.0, "hardening_coefficient": 0.0}
    machine = st.Motor(inertia=INERTIA, friction=st.FrictionModel("hsieh_pan", **parameters))
    machine.reset(velocity=0.03)
    run = machine.simulate(np.zeros(200_000), 1e-4)
    peaks = np.abs(run.velocity).reshape(-1, 400).max(axis=1)
    # Twenty periods a window; below 1e-3 of the start the loops lose less than the integrator's
    # own ripple.
    assert np.all(np.diff(peaks) <= 1e-6 * peaks[0])
    assert peaks[-1] < 0.02 * peaks[0]


TURN = hs.floats(-1.0, 1.0)


@settings(max_examples=150, deadline=None, derandomize=True)
@given(
    seed=hs.integers(0, 1000),
    turns=hs.lists(TURN, min_size=2, max_size=12),
    parts=hs.integers(1, 5),
    virgin_curve=hs.sampled_from(["masing", "same"]),
)
def test_closed_loops_are_wiped_out(seed, turns, parts, virgin_curve):
    """A loop inside, walked in any number of steps, leaves the older branch as it was."""
    _, parameters, _ = drawn_rig(seed)
    spring = parameters | STUCK | {"damping": 0.0, "virgin_curve": virgin_curve}
    reach = 3.0 * parameters["decay_distance"]
    outer = np.array([1.2, -1.1, 1.15]) * reach
    looped = st.FrictionModel("hsieh_pan", **spring)
    straight = st.FrictionModel("hsieh_pan", **spring)

    def go(model, targets, parts=1):
        forces = []
        for target in targets:
            start = model.state["spring"]
            path = np.linspace(start, target, parts + 1)[1:]
            forces.extend(model.simulate(np.diff(path, prepend=start) / DT, DT).tolist())
        return forces

    scale = np.ptp(go(straight, outer))
    go(looped, outer)
    # From the last turn inward, about, back to the turn, and on past it.
    turned = looped.state["spring_force"]
    inner = [turn * reach for turn in turns]
    go(looped, inner, parts)
    back = go(looped, [outer[-1]], parts)[-1]
    assert abs(back - turned) <= CLOSING_ROUND_OFF * scale
    for target in (1.18 * reach, 1.3 * reach, -2.0 * reach):
        one, other = go(looped, [target])[-1], go(straight, [target])[-1]
        assert abs(one - other) <= CLOSING_ROUND_OFF * scale
    assert len(looped.state["reverse_points"]) == len(straight.state["reverse_points"])


@pytest.mark.parametrize("virgin_curve", ["masing", "same"])
@pytest.mark.parametrize("levels", [(1.0, 0.3), (1.0, -1.0), (1.0, -0.9), (0.2, -1.0)])
def test_memory_stays_bounded_under_many_equal_cycles(levels, virgin_curve):
    model = st.FrictionModel("hsieh_pan", **ILLUSTRATIVE | STUCK, virgin_curve=virgin_curve)
    # A power of two for dt and for the levels keeps the positions exact: equal means equal.
    dt = 2.0**-10
    high, low = (np.round(level * 2.0**8) * 2.0**-22 for level in levels)
    stroke = high - low
    velocity = np.concatenate(([high / dt], np.tile([-stroke / dt, stroke / dt], 100_000)))
    force = model.simulate(velocity, dt)
    state = model.state
    assert len(state["reverse_points"]) <= 2
    assert state["memory_peak"] <= 3
    assert state["reversals"] == 200_000
    forces = force - 0.45 * velocity
    assert np.ptp(forces[1001::2]) <= CLOSING_ROUND_OFF * np.ptp(forces)
    assert np.ptp(forces[1002::2]) <= CLOSING_ROUND_OFF * np.ptp(forces)


def test_memory_stays_bounded_under_cycles_equal_but_for_round_off():
    model = st.FrictionModel("hsieh_pan", **ILLUSTRATIVE | STUCK)
    velocity = np.tile([0.1, -0.07, 0.03, -0.06], 50_000)
    model.simulate(velocity, DT)
    assert model.state["memory_peak"] < 50


@pytest.mark.parametrize("part", [0.3, 0.99])
def test_a_coulomb_contact_below_break_away_does_not_move_a_bit_in_an_hour(part):
    machine = motor("stribeck")
    machine.simulate(np.full(500, 0.8), DT)
    machine.simulate(np.zeros(3000), DT)
    rest = machine.state
    assert rest["velocity"] == 0.0
    hour = 3_600_000
    ripple = 0.5 * part * (1.0 + 0.5 * np.sin(np.arange(hour) / 30.0)) / 1.5
    run = machine.simulate(ripple, DT, outputs=("position",))
    assert np.all(run.position == rest["position"])
    assert machine.state["velocity"] == 0.0
    assert machine.statistics["breakaways"] == rest["breakaways"]


def equilibrium(parameters, force):
    """Where the virgin curve has this force, by bisection."""
    k_0, k_inf, d_0 = (
        parameters[name] for name in ("initial_stiffness", "final_stiffness", "decay_distance")
    )
    low, high = 0.0, force / k_inf
    for _ in range(200):
        x = (low + high) / 2.0
        value = 0.5 * (k_inf * 2 * x - (k_0 - k_inf) * d_0 * np.expm1(-2.0 * x / d_0))
        low, high = (x, high) if value < force else (low, x)
    return (low + high) / 2.0


@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_a_spring_below_break_away_does_not_drift_in_an_hour(integrator):
    parameters = ILLUSTRATIVE | HOOK | {"hardening_coefficient": 0.0}
    machine = st.Motor(
        inertia=INERTIA, friction=st.FrictionModel("hsieh_pan", **parameters), integrator=integrator
    )
    # Loaded so slowly that the virgin curve is never left, then held; 1e-4 s is the longest
    # step that the machine takes whole.
    n = 3_600_000 if integrator == "fast" else 400_000
    ramp = 0.3 * (1.0 - np.cos(np.linspace(0.0, np.pi, 40_000))) / 2.0
    machine.simulate(ramp, 1e-4, outputs=())
    machine.simulate(np.full(20_000, 0.3), 1e-4, outputs=())
    position = machine.simulate(np.full(n, 0.3), 1e-4, outputs=("position",)).position
    assert np.ptp(position) < EQUILIBRIUM
    halves = position.reshape(2, -1).mean(axis=1)
    assert abs(halves[1] - halves[0]) < 0.01 * EQUILIBRIUM
    force = machine.state["spring_force"]
    assert force == pytest.approx(0.3, abs=3000.0 * EQUILIBRIUM)
    if not len(machine.state["reverse_points"]):
        assert abs(position[-1] - equilibrium(parameters, 0.3)) < EQUILIBRIUM


def test_a_ring_down_settles_and_stays_for_an_hour():
    parameters = ILLUSTRATIVE | HOOK | {"hardening_coefficient": 0.0}
    machine = st.Motor(inertia=INERTIA, friction=st.FrictionModel("hsieh_pan", **parameters))
    machine.simulate(np.full(20_000, 0.25), 1e-4, outputs=())
    position = machine.simulate(np.full(3_600_000, 0.25), 1e-4, outputs=("position",)).position
    assert np.ptp(position) < EQUILIBRIUM
    halves = position.reshape(2, -1).mean(axis=1)
    assert abs(halves[1] - halves[0]) < 0.01 * EQUILIBRIUM
    # The memory of a ring-down saturates at round-off.
    assert machine.statistics["memory_peak"] < 512
    assert machine.statistics["memory_growths"] == 0


def test_load_with_ripple_below_break_away_does_not_ratchet():
    parameters = ILLUSTRATIVE | HOOK | {"hardening_coefficient": 0.0}
    machine = st.Motor(inertia=INERTIA, friction=st.FrictionModel("hsieh_pan", **parameters))
    time = np.arange(600_000) * 1e-4
    load = 0.25 + 0.15 * np.sin(2.0 * np.pi * 5.0 * time)
    position = machine.simulate(load, 1e-4, outputs=("position",)).position
    cycles = position[100_000:].reshape(-1, 2000)
    # Five hertz on a ring of a hundred: each cycle ends where it began.
    assert np.ptp(cycles[:, -1]) < 1e-6 * np.ptp(cycles)


# Parameters of laws whose neutral value leaves the rest of the law untouched.
NEUTRAL_EFFECTS = {
    effect.name: {p.name: p.typical if p.neutral is None else p.neutral for p in effect.parameters}
    for effect in st.effects()
}


@pytest.mark.parametrize("kind", CONTACTS)
@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_neutral_effects_change_no_bit(kind, integrator):
    current = wandering_current(8, 1500, 1.0)
    plain = motor(kind, integrator=integrator)
    dressed = motor(kind, integrator=integrator, effects=NEUTRAL_EFFECTS)
    one, other = plain.simulate(current, DT), dressed.simulate(current, DT)
    for name in one:
        assert np.array_equal(one[name], other[name]), name
    # Delay and lag have inputs on their way, some effects a memory, and beside effects the work of
    # the contact is counted: these come with them alone.
    assert dressed.state.keys() == plain.state.keys() | {
        "input_history",
        "lagged_input",
        "limited_input",
        "effect_memory",
        "contact_work",
        "kinetic_peak",
    }
    assert plain.statistics == dressed.statistics


def test_neutral_parameters_of_hsieh_pan_switch_their_part_off():
    velocity = random_motion(2, 3000, scale=0.05)
    curve = {k: ILLUSTRATIVE[k] for k in ("initial_stiffness", "final_stiffness", "decay_distance")}
    none = st.FrictionModel("hsieh_pan", **curve, damping=0.0, hardening_coefficient=0.0)
    want = none.simulate(velocity, DT)
    # No creep because it takes for ever, or because there is none to come: the same to the bit.
    still = st.FrictionModel("hsieh_pan", **curve, damping=0.0, creep_rate=0.0)
    assert np.array_equal(still.simulate(velocity, DT), want)
    # A break-away out of reach, with or without dependence on the loading rate.
    never = st.FrictionModel(
        "hsieh_pan", **curve, damping=0.0, hardening_coefficient=0.0, breakaway=1e6
    )
    assert np.array_equal(never.simulate(velocity, DT), want)
    rated = st.FrictionModel("hsieh_pan", **ILLUSTRATIVE | HOOK, loading_rate=np.inf)
    plain = st.FrictionModel("hsieh_pan", **ILLUSTRATIVE | HOOK)
    assert np.array_equal(rated.simulate(velocity, DT), plain.simulate(velocity, DT))


def test_isotropic_hardening_gives_the_first_direction_all_the_permanent_displacement():
    machine = motor("sticking")
    ramp = np.concatenate((np.linspace(0.0, 0.3, 20_000), np.full(40_000, 0.3)))
    half = []
    for sign in (1.0, -1.0, 1.0, -1.0):
        machine.simulate(sign * ramp, 1e-4, outputs=())
        half.append(machine.state["plastic"])
    first, *later = np.diff(half, prepend=0.0)
    assert first > 1e-5
    assert max(map(abs, later)) < 0.01 * first
