"""The options of hsieh_pan and the effects: what they promise, on both integrators."""

import itertools

import numpy as np
import pytest

import stiction as st

from .rigs import (
    CONTACTS,
    HOOK,
    ILLUSTRATIVE,
    INERTIA,
    drawn_rig,
    motor,
    wandering_velocity,
)

DT = 1e-4
OPTIONS = [
    {"virgin_curve": curve, "damper": damper, "after_slip": after}
    for curve, damper, after in itertools.product(
        ("masing", "same"), ("hook", "spring"), ("reset", "keep")
    )
]
EFFECTS = {
    "cogging": {"cosine": 0.03, "sine": -0.02, "order": 40.0},
    "stribeck": {"excess": 0.2, "velocity": 0.05},
    "torque_bias": {"bias": 0.04},
}
# The fast integrator is of second order: over a short run both stay within this share.
INTEGRATORS_SHARE = 0.005
ROUND_OFF = 1e-12


def model(**keywords):
    return st.FrictionModel("hsieh_pan", **ILLUSTRATIVE | HOOK | keywords)


def worst_share(one, other):
    return np.abs(one - other).max() / np.ptp(other)


def pulses(force, n=4000, seed=0):
    rng = np.random.default_rng(seed)
    return force * np.repeat(rng.uniform(-1.0, 1.0, n // 100), 100)


@pytest.mark.parametrize("options", OPTIONS, ids=lambda o: " ".join(o.values()))
@pytest.mark.parametrize("hook", [False, True])
@pytest.mark.parametrize("seed", range(2))
def test_integrators_agree_under_every_option(options, hook, seed):
    inertia, parameters, force = drawn_rig(seed, factor=2.0, hook=hook)
    law = st.FrictionModel("hsieh_pan", **parameters | options)
    current = pulses(1.6 * force if hook else force, seed=seed)
    runs = [
        st.Motor(inertia=inertia, friction=law, integrator=name).simulate(current, DT)
        for name in ("fast", "reference")
    ]
    for name in ("position", "velocity", "spring_force"):
        assert worst_share(runs[0][name], runs[1][name]) < INTEGRATORS_SHARE, name
    for name in ("breakaways", "sticks"):
        assert runs[0].statistics[name] == runs[1].statistics[name]
    assert (runs[0].statistics["breakaways"] > 0) == hook


@pytest.mark.parametrize("damper", ["hook", "spring"])
def test_creep_of_the_fast_integrator_is_of_second_order(damper):
    inertia, parameters, force = drawn_rig(0, factor=2.0)
    law = st.FrictionModel("hsieh_pan", **parameters, damper=damper)
    time = np.arange(300) * 1e-3
    current = force * np.sin(2.0 * np.pi * 5.0 * time) * np.minimum(1.0, time / 0.1)

    def plastic(parts, integrator):
        machine = st.Motor(inertia=inertia, friction=law, integrator=integrator)
        return machine.simulate(np.repeat(current, parts), 1e-3 / parts).plastic[parts - 1 :: parts]

    exact = plastic(160, "reference")
    errors = [worst_share(plastic(parts, "fast"), exact) for parts in (10, 20, 40)]
    # A quarter for each halving; a half would be first order.
    assert errors[1] < 0.35 * errors[0]
    assert errors[2] < 0.35 * errors[1]


@pytest.mark.parametrize("slip_distance", [2e-5, 3e-7])
@pytest.mark.parametrize("damper", ["hook", "spring"])
def test_a_slide_that_slows_down_sticks_once(damper, slip_distance):
    # A light body on a strong damper: where the hook catches while the body still moves, a force
    # that is not continuous would let it go again at once.
    law = {
        "breakaway": 0.5,
        "coulomb": 0.286,
        "stribeck_velocity": 0.215,
        "initial_stiffness": 501.0,
        "decay_distance": 3e-3,
        "hardening_coefficient": 0.0,
        "damping": 3.3,
    }
    contact = st.FrictionModel("hsieh_pan", **law, damper=damper, slip_distance=slip_distance)
    for dt in (1e-3, 1e-4, 1e-5):
        machine = st.Motor(inertia=2.5e-4, friction=contact)
        part = round(0.05 / dt)
        run = machine.simulate(np.concatenate((np.full(part, 0.55), np.full(6 * part, 0.2))), dt)
        assert run.mode[-1] == 0.0
        assert run.statistics["breakaways"] == run.statistics["sticks"] == 1, dt


@pytest.mark.parametrize("effect", EFFECTS)
@pytest.mark.parametrize("kind", CONTACTS)
def test_integrators_agree_under_every_effect(kind, effect):
    current = pulses(0.8)
    runs = [
        motor(kind, effects={effect: EFFECTS[effect]}, integrator=name).simulate(current, DT)
        for name in ("fast", "reference")
    ]
    assert worst_share(runs[0].position, runs[1].position) < INTEGRATORS_SHARE
    plain = motor(kind).simulate(current, DT)
    assert worst_share(runs[0].position, plain.position) > 1e-3


@pytest.mark.parametrize("kind", CONTACTS)
def test_fast_and_reference_converge_on_each_other(kind):
    current = pulses(0.8, 1000)
    errors = []
    for divided in (1, 4):
        fast = motor(kind).simulate(np.repeat(current, divided), DT / divided)
        fine = motor(kind, integrator="reference").simulate(np.repeat(current, 16), DT / 16)
        errors.append(worst_share(fast.position[divided - 1 :: divided], fine.position[15::16]))
    # Second order would be a sixteenth; reversals that are not located leave first order.
    assert errors[1] < 0.4 * errors[0] + 1e-9


def test_torque_bias_is_a_constant_push():
    current = pulses(0.8)
    for kind in CONTACTS:
        pushed = motor(kind, effects={"torque_bias": {"bias": 0.05}}).simulate(current, DT)
        driven = motor(kind).simulate(current, DT, load=0.05)
        assert worst_share(pushed.position, driven.position) < 1e-9


def test_cogging_is_a_push_that_depends_on_position():
    machine = motor("coulomb", effects={"cogging": {"cosine": 0.2, "sine": 0.0, "order": 10.0}})
    machine.simulate(np.full(200, 0.1), 1e-3)
    # 0.1 + 0.2·cos(0) stays below the 0.35 that the contact holds, 0.2 + 0.2 does not.
    assert machine.state["position"] == 0.0
    assert machine.state["friction"] == pytest.approx(0.3, rel=1e-12)
    machine.simulate(np.full(200, 0.2), 1e-3)
    assert machine.state["position"] > 0.0


def test_stribeck_effect_raises_friction_at_low_speed():
    plain = motor("coulomb").simulate(np.full(500, 0.38), 1e-3)
    assert plain.velocity[-1] > 0.0
    held = motor("coulomb", effects={"stribeck": {"excess": 0.2, "velocity": 0.05}})
    run = held.simulate(np.full(500, 0.38), 1e-3)
    assert np.all(run.position == 0.0)
    run = held.simulate(np.full(500, 0.45), 1e-3)
    assert run.velocity[-1] > 0.0
    # Far above the Stribeck speed the friction is that of the law alone.
    assert run.friction[-1] == pytest.approx(0.35, rel=1e-6)


def delayed_mean(current, durations, delay):
    """Mean over each sample of the held input delayed; 0 before the first."""
    ends = np.cumsum(durations)
    stamps = np.concatenate([[-1.0, 0.0], ends])
    integral = np.concatenate([[0.0, 0.0], np.cumsum(current * durations)])
    late = np.interp(np.concatenate([[0.0], ends]) - delay, stamps, integral)
    return np.diff(late) / durations


@pytest.mark.parametrize("delay", [0.0, 2.5e-4, 2e-3, 0.0213])
@pytest.mark.parametrize("kind", ["coulomb", "hook"])
def test_input_delay_is_the_mean_of_the_delayed_input(kind, delay):
    rng = np.random.default_rng(3)
    current = pulses(0.8, 1000)
    durations = rng.uniform(2e-4, 2e-3, 1000)
    late = delayed_mean(current, durations, delay)
    run = motor(kind, effects={"input_delay": {"delay": delay}}).simulate(current, durations)
    shifted = motor(kind).simulate(late, durations)
    assert worst_share(run.position, shifted.position) < 1e-8
    path = np.concatenate([[0.0], run.position])
    both = motor(kind, effects={"input_delay": {"delay": delay / 2}, "torque_bias": {}})
    driven = both.follow(st.Motion(path, current, durations))[0]
    assert np.allclose(driven, delayed_mean(current, durations, delay / 2), rtol=0, atol=1e-12)


@pytest.mark.parametrize("delay", [0.0, 2.5e-4, 1e-3, 0.0213])
def test_a_delay_is_differentiated_towards_longer_ones(delay):
    # 1e-3 is two samples: a kink, as is 0.
    current = pulses(0.8, 400)
    path = np.linspace(0.0, 1.0, 401)
    machine = motor("coulomb", effects={"input_delay": {"delay": delay}})
    _, driven, _ = machine.follow_sensitivity(
        st.Motion(path, current, 5e-4), ["effects.input_delay.delay"]
    )
    durations = np.full(400, 5e-4)
    near, here = (delayed_mean(current, durations, d) for d in (delay + 1e-7, delay))
    assert np.allclose(driven[0], (near - here) / 1e-7, rtol=0, atol=1e-4 * np.abs(driven).max())
    if delay == 0.0:
        assert np.array_equal(driven[0], (np.concatenate([[0.0], current[:-1]]) - current) / 5e-4)


def test_inputs_on_their_way_are_part_of_the_state():
    machine = motor("hook", effects={"input_delay": {"delay": 2.5e-3}})
    assert machine.state["input_history"].tolist() == [[0.0, 0.0], [0.0, 2.5e-3]]
    machine.simulate([0.1, 0.2, 0.3], 1e-3)
    history = machine.state["input_history"]
    assert history[:, 0].tolist() == [0.1, 0.1, 0.2, 0.3]
    assert np.allclose(history[:, 1], [0.0, 5e-4, 1e-3, 1e-3], rtol=1e-12)
    for broken in (history[1:], history[:-1], history * [1.0, -1.0]):
        with pytest.raises(st.InputError, match="input_history"):
            machine.state = machine.state | {"input_history": broken}
    assert "input_history" not in motor("hook").state
    machine.reset()
    assert machine == motor("hook", effects={"input_delay": {"delay": 2.5e-3}})


def test_virgin_curve_same_is_a_whole_branch_and_masing_half_of_one():
    keywords = {"hardening_coefficient": 0.0, "damping": 0.0, "breakaway": np.inf}
    distances = np.linspace(1e-6, 2e-3, 400)
    moves = np.diff(distances, prepend=0.0) / DT
    masing = model(**keywords | {"coulomb": np.inf})
    same = model(**keywords | {"coulomb": np.inf, "virgin_curve": "same"})
    half = masing.simulate(moves, DT)
    whole = same.simulate(moves, DT)
    # V(x) = G(2x)/2 where Masing's rule holds, G(x) where it does not; then a branch down.
    doubled = model(**keywords | {"coulomb": np.inf, "virgin_curve": "same"})
    assert np.allclose(doubled.simulate(2.0 * moves, DT) / 2.0, half, rtol=1e-12, atol=0)
    turned = whole[-1]
    down = same.simulate(-moves, DT)
    assert np.allclose(turned - down, whole, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("virgin_curve", ["masing", "same"])
def test_memory_returns_to_the_virgin_curve_of_either_kind(virgin_curve):
    keywords = {
        "hardening_coefficient": 0.0,
        "damping": 0.0,
        "breakaway": np.inf,
        "coulomb": np.inf,
        "virgin_curve": virgin_curve,
    }
    looped, straight = model(**keywords), model(**keywords)

    def walk(contact, *targets):
        start = contact.state["spring"]
        return contact.simulate(np.diff(targets, prepend=start) / DT, DT)[-1]

    walk(looped, 4e-4, 1e-4, 3e-4, 2e-4, 3e-4, 4e-4, 5e-4)
    assert walk(straight, 5e-4) == pytest.approx(looped.state["spring_force"], rel=ROUND_OFF)
    assert len(looped.state["reverse_points"]) == 0
    walk(looped, -6e-4)
    closes = virgin_curve == "masing"
    assert (len(looped.state["reverse_points"]) == 0) == closes


def test_keep_goes_on_hardening_where_reset_starts_again():
    press, slide = np.full(400, 2e-4), np.full(50, 0.2)
    kept, reset = model(after_slip="keep"), model()
    for contact in (kept, reset):
        contact.simulate(press, 1e-3)
        contact.simulate(np.zeros(500), 1e-3)
    before = kept.state["hardening"]
    assert before > 0.0
    for contact in (kept, reset):
        contact.simulate(slide, 1e-3)
        assert contact.state["mode"] == 1.0
        # Frozen while it slides.
        frozen = contact.state["hardening"]
        contact.simulate(slide, 1e-3)
        assert contact.state["hardening"] == frozen
        contact.simulate([-1e-9], 1e-6)
        assert contact.state["mode"] == 0.0
    assert kept.state["hardening"] >= before
    assert reset.state["hardening"] < 1e-3 * before


@pytest.mark.parametrize("options", OPTIONS, ids=lambda o: " ".join(o.values()))
def test_every_option_is_finite_and_bounded_by_its_levels(options):
    contact = model(**options)
    velocity = wandering_velocity(4, 20_000)
    force = contact.simulate(velocity, 1e-3)
    assert np.isfinite(force).all()
    # Break-away or sliding level, and the damper beside them.
    greatest = 0.5 + (0.45 + 0.05) * np.abs(velocity).max()
    assert np.abs(force).max() <= greatest * (1.0 + ROUND_OFF)


@pytest.mark.parametrize("options", OPTIONS, ids=lambda o: " ".join(o.values()))
def test_every_option_is_odd_in_direction(options):
    velocity = wandering_velocity(4, 3000)
    assert np.array_equal(
        model(**options).simulate(velocity, 1e-3), -model(**options).simulate(-velocity, 1e-3)
    )


def test_a_damper_on_the_spring_acts_as_one_on_the_hook_where_nothing_creeps():
    keywords = {"hardening_coefficient": 0.0, "breakaway": np.inf, "coulomb": np.inf}
    velocity = wandering_velocity(7, 2000)
    hook = model(**keywords).simulate(velocity, 1e-3)
    spring = model(**keywords, damper="spring").simulate(velocity, 1e-3)
    assert worst_share(spring, hook) < ROUND_OFF


@pytest.mark.parametrize("integrator", ["fast", "reference"])
@pytest.mark.parametrize("creep_rate", [20.0, 2e3, 1e5])
def test_fast_creep_stays_finite(integrator, creep_rate):
    # Creep unloads the spring at α·(1 + f'·k), thousands of times α on a stiff contact: a rate
    # far above what the machine's own frequency asks of the step.
    law = {
        "initial_stiffness": 3.6e4,
        "final_stiffness": 3.4e3,
        "decay_distance": 9e-4,
        "hardening_coefficient": 5e-4,
        "hardening_exponent": 3.75,
        "creep_rate": creep_rate,
        "damping": 1.3,
        "breakaway": 4.0,
    }
    machine = st.Motor(
        inertia=6e-3, friction=st.FrictionModel("hsieh_pan", **law), integrator=integrator
    )
    # A call may take so much work: fewer samples where each is divided into thousands.
    samples = {20.0: 1000, 2e3: 600, 1e5: 100}[creep_rate]
    run = machine.simulate(pulses(6.0, 1000)[:samples], 1e-4)
    assert run.success
    assert np.abs(run.position).max() < 10.0


@pytest.mark.parametrize("options", OPTIONS, ids=lambda o: " ".join(o.values()))
def test_following_a_held_rest_relaxes_and_never_grows(options):
    contact = model(**options)
    contact.simulate(np.full(100, 1e-3), 1e-3)
    force = contact.simulate(np.zeros(5000), 1e-3)
    assert force[0] > 0.0
    assert np.all(np.diff(force[1:]) <= ROUND_OFF)
    assert 0.0 < force[-1] < force[0]


def test_inertia_alone_decides_nothing_about_a_stuck_contact_at_rest():
    # Over five decades of inertia the rest position under a slow ramp is the contact's own.
    rest = []
    for inertia in (1e-3 * INERTIA, INERTIA, 1e2 * INERTIA):
        law = st.FrictionModel("hsieh_pan", **ILLUSTRATIVE | {"hardening_coefficient": 0.0})
        machine = st.Motor(inertia=inertia, friction=law)
        ramp = 0.2 * (1.0 - np.cos(np.linspace(0.0, np.pi, 20_000))) / 2.0
        machine.simulate(ramp, 1e-3, outputs=())
        machine.simulate(np.full(2000, 0.2), 1e-3, outputs=())
        rest.append(machine.state["position"])
    assert np.ptp(rest) < 1e-3 * rest[0]


@pytest.mark.parametrize("seed", range(40))
def test_a_damper_on_the_spring_gives_no_more_than_both_can_at_any_step(seed):
    rng = np.random.default_rng(seed)
    scale = dict(zip("kdhcrv", 10.0 ** rng.uniform(-1.0, 1.0, 6), strict=True))
    model = st.FrictionModel(
        "hsieh_pan",
        damper="spring",
        initial_stiffness=3000.0 * scale["k"],
        final_stiffness=100.0,
        decay_distance=3e-4 * scale["d"],
        hardening_coefficient=1.6e-3 * scale["h"],
        hardening_exponent=rng.uniform(1.1, 4.0),
        creep_rate=2.0 * scale["r"],
        damping=0.45 * scale["c"],
    )
    # Slow after fast: creep that a great force began must not go on past the force 0.
    dt = 10.0 ** rng.uniform(-5.0, -1.0)
    velocity = 10.0 ** rng.uniform(-6.0, 0.0, 300) * rng.choice([1.0, 0.0, -1.0], 300)
    force = model.simulate(velocity, dt)
    way = np.ptp(np.cumsum(velocity * dt))
    parameters = model.parameters
    most = parameters["initial_stiffness"] * way + parameters["damping"] * np.abs(velocity).max()
    assert np.abs(force).max() < 2.0 * most


@pytest.mark.parametrize("name", ["fast", "reference"])
def test_a_voltage_limit_runs_out_of_effort_towards_its_speed_without_load(name):
    given, limit, no_load = 0.8, 1.0, 12.0
    frictionless = st.FrictionModel("coulomb", coulomb=0.0)
    shape = {"share": 1.0, "limit": limit, "no_load": no_load}
    # Slow for the reference integrator's samples, so that both follow the line closely.
    inertia, dt = 0.05, 1e-3
    machine = st.Motor(
        inertia=inertia, friction=frictionless, effects={"voltage_limit": shape}, integrator=name
    )
    run = machine.simulate(np.full(3000, given), dt)
    time = np.asarray(run.time)
    reached = no_load * (1.0 - given / limit)  # up to there all of it arrives
    begin = reached * inertia / given
    falling = no_load + (reached - no_load) * np.exp(-limit * (time - begin) / (no_load * inertia))
    expected = np.where(time < begin, given * time / inertia, falling)
    np.testing.assert_allclose(run.velocity, expected, atol=2e-3 * no_load)


def test_a_voltage_limit_reaches_further_against_the_motion():
    shape = {"share": 0.5, "limit": 1.0, "no_load": 10.0}
    inputs = np.array([0.9, 1.4, -0.9, -1.4, 3.0])
    speeds = np.array([5.0, -5.0, 5.0, 5.0, 20.0])
    # R is 0.5, 1.5, 1.5, 1.5 and, beyond the speed without load, 0.
    expected = [0.7, 1.4, -0.9, -1.4, 1.5]
    drawn = []
    for given, speed in zip(inputs, speeds, strict=True):
        machine = motor("coulomb", effects={"voltage_limit": shape})
        motion = st.Motion(np.array([0.0, speed * 1e-3, 2e-3 * speed]), np.full(2, given), 1e-3)
        drawn.append(machine.follow(motion)[0][-1])
    np.testing.assert_allclose(drawn, expected, rtol=1e-12)
