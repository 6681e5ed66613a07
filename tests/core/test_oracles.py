"""The core against the independent oracles, on drawn rigs instead of the illustrative one."""

import itertools

import numpy as np
import pytest
from tests.reference.broken_closing import WRONG_RULES, ReversePointSpring
from tests.reference.coulomb_reference import simulate_coulomb, slide_closed_form
from tests.reference.hook_reference import (
    follow_motion_with_events,
    pulled_mass,
    simulate_with_events,
)
from tests.reference.hsieh_pan_reference import follow_motion, simulate_sticking

import stiction as st

from .rigs import HOOK, ILLUSTRATIVE, INERTIA, RATED, around, drawn_rig, for_oracle

# Asked for: the fast integrator at 1e-4 s within 0.5 % of the range of the oracle at 5e-5 s.
FAST_DT = 1e-4
FAST_SHARE = 0.005
# The oracle's own error: 256 elements and reversals that no fixed step of RK4 locates.
REFERENCE_SHARE = 0.0005
# Ladder of the oracle: 256 elements meet the curve within 1e-5 of its range.
ELEMENTS = 256
# Friction along a given motion has no body to accumulate errors: the ladder's own and the creep's.
MOTION_SHARE = 1e-3
# Held forces a twentieth of a second, then the events, are located to 1e-10 s by the oracle.
EVENT_SHARE = 0.005
# Sums of a few thousand moves, no approximation on either side.
WALK_ROUND_OFF = 1e-12
CURVE = ("initial_stiffness", "final_stiffness", "decay_distance")


def worst_share(ours, theirs):
    """Greatest difference as a share of the range of the second."""
    return np.abs(ours - theirs).max() / np.ptp(theirs)


def ramps_pulses_reversals_and_creep(force, n=5000):
    """An input of n samples that holds one of each."""
    part = n // 5
    ramp = np.linspace(0.0, 0.7, part)
    pulses = np.where(np.arange(part) % (part // 5) < part // 25, 0.9, 0.0)
    reversals = 0.8 * np.sin(2.0 * np.pi * 3.0 * np.linspace(0.0, 1.0, part) ** 2)
    steps = np.repeat([0.6, -0.3, 0.5, -0.7, 0.2], part // 5)
    hold = np.full(n - 4 * part, 0.8)
    return force * np.concatenate((ramp, pulses, reversals, steps, hold))


@pytest.fixture(scope="module", params=range(6))
def stuck(request):
    """A drawn rig, its input and what the oracle makes of it."""
    inertia, parameters, force = drawn_rig(request.param)
    # 0.2 s at 1e-4 s would hide creep; every sample lasts four steps of the fast integrator.
    effort = ramps_pulses_reversals_and_creep(force, 1500)
    sample = 4.0 * FAST_DT
    oracle = simulate_sticking(
        effort, sample, step=5e-5, inertia=inertia, elements=ELEMENTS, **parameters
    )
    return inertia, parameters, np.repeat(effort, 4), oracle


@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_sticking_machine_follows_runge_kutta_through_ramps_pulses_reversals_and_creep(
    stuck, integrator
):
    inertia, parameters, effort, oracle = stuck
    machine = st.Motor(
        inertia=inertia, friction=st.FrictionModel("hsieh_pan", **parameters), integrator=integrator
    )
    run = machine.simulate(effort, FAST_DT)
    share = FAST_SHARE if integrator == "fast" else REFERENCE_SHARE
    for name in ("position", "plastic", "spring", "spring_force", "hardening", "velocity"):
        assert worst_share(run[name][3::4], getattr(oracle, name)) < share, name
    assert run.hardening[-1] > 0.0
    assert run.statistics["reversals"] > 50


@pytest.mark.long
@pytest.mark.parametrize("seed", range(6))
def test_friction_along_a_motion_follows_runge_kutta(seed):
    _, parameters, force = drawn_rig(seed)
    rng = np.random.default_rng(seed + 100)
    reach = force / parameters["initial_stiffness"]
    # A smooth wander over a few times the distance at which the force is felt, then a rest.
    time = np.arange(2000) * 1e-3
    waves = [
        around(rng, 2.0 * np.pi * 3.0) * np.cos(2.0 * np.pi * around(rng, 2.0) * time + k)
        for k in range(3)
    ]
    velocity = reach * np.sum(waves, axis=0) / 2.0
    velocity[1500:] = 0.0
    oracle = follow_motion(velocity, 1e-3, step=1e-4, elements=ELEMENTS, **parameters)
    fine = st.FrictionModel("hsieh_pan", **parameters)
    ours = fine.simulate(np.repeat(velocity, 10), 1e-4)[9::10]
    assert worst_share(ours, oracle.friction) < MOTION_SHARE
    coarse = st.FrictionModel("hsieh_pan", **parameters).simulate(velocity, 1e-3)
    assert worst_share(coarse, oracle.friction) < 10.0 * MOTION_SHARE


@pytest.mark.parametrize("closing", ["correct", *WRONG_RULES])
def test_a_wrong_closing_rule_fails_where_the_right_one_agrees(closing):
    _, parameters, _ = drawn_rig(3)
    curve = {name: parameters[name] for name in CURVE}
    d_0 = curve["decay_distance"]
    # Loops in loops, through their closings and through the mirror point of the first.
    turns = np.array([0.0, 0.9, -0.35, 0.5, -0.1, 0.8, -0.5, 1.3, -1.5, 0.2]) * d_0
    path = np.concatenate([np.linspace(a, b, 200)[1:] for a, b in itertools.pairwise(turns)])
    moves = np.diff(path, prepend=0.0)
    dt = 1e-3
    model = st.FrictionModel("hsieh_pan", damping=0.0, hardening_coefficient=0.0, **curve)
    ours = model.simulate(moves / dt, dt)
    other = ReversePointSpring(closing=closing, **curve)
    share = worst_share(ours, np.array([other.advance(move) for move in moves]))
    assert (share < WALK_ROUND_OFF) == (closing == "correct")
    # A wrong rule is no matter of round-off.
    assert closing == "correct" or share > 1e8 * WALK_ROUND_OFF


def hooked_input(force, seed, n=60):
    """Efforts that break away both ways, rest and pulse; each held for a hundredth of a second."""
    rng = np.random.default_rng(seed)
    return force * np.concatenate(
        (
            np.linspace(0.0, 1.4, n // 4),
            np.zeros(n // 8),
            -np.linspace(0.0, 1.5, n // 4),
            np.repeat(rng.uniform(-1.5, 1.5, n // 8), 3),
        )
    )


@pytest.mark.long
@pytest.mark.parametrize("integrator", ["fast", "reference"])
@pytest.mark.parametrize("seed", range(4))
def test_hooked_machine_follows_the_located_events(seed, integrator):
    inertia, parameters, force = drawn_rig(seed, factor=2.0, hook=True)
    if seed % 2:
        parameters["after_slip"] = "keep"
    effort = hooked_input(force, seed)
    oracle, located = simulate_with_events(
        effort, 0.01, inertia=inertia, elements=ELEMENTS, **parameters
    )
    machine = st.Motor(
        inertia=inertia, friction=st.FrictionModel("hsieh_pan", **parameters), integrator=integrator
    )
    run = machine.simulate(np.repeat(effort, 100), FAST_DT)
    assert worst_share(run.position[99::100], oracle.position) < EVENT_SHARE
    assert worst_share(run.velocity[99::100], oracle.velocity) < EVENT_SHARE
    breaks = [event for event in located.events if event[1] == "break-away"]
    assert len(breaks) >= 2
    assert run.statistics["breakaways"] == len(breaks)
    assert run.statistics["sticks"] == len(located.events) - len(breaks)


@pytest.mark.parametrize("rated", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_hooked_contact_along_a_motion_follows_the_located_events(seed, rated):
    _, parameters, force = drawn_rig(seed + 20, factor=2.0, hook=True)
    reach = force / parameters["initial_stiffness"]
    rng = np.random.default_rng(seed)
    if rated:
        parameters |= {"loading_rate": around(rng, 10.0 * force, 2.0), "loading_time": 0.05}
    speeds = np.repeat(rng.uniform(2.0, 40.0, 12) * ([1, 1, -1, 1, -1, -1] * 2), 4) * reach
    oracle, located = follow_motion_with_events(
        speeds, 0.01, elements=ELEMENTS, **for_oracle(parameters)
    )
    model = st.FrictionModel("hsieh_pan", **parameters)
    ours = model.simulate(np.repeat(speeds, 100), 1e-4)[99::100]
    assert worst_share(ours, oracle.friction) < EVENT_SHARE
    breaks = [event for event in located.events if event[1] == "break-away"]
    assert breaks
    assert model.state["breakaways"] == len(breaks)


@pytest.mark.parametrize("speed", [0.003, 0.03, 0.3])
def test_rated_break_away_happens_at_the_oracles_force(speed):
    parameters = ILLUSTRATIVE | HOOK | RATED
    _, located = follow_motion_with_events(
        np.full(40, speed), 1e-3 * 0.01 / speed, elements=ELEMENTS, **for_oracle(parameters)
    )
    model = st.FrictionModel("hsieh_pan", **parameters)
    model.simulate(np.full(4000, speed), 1e-5 * 0.01 / speed)
    assert len(located.events) == 1
    # Level at which the slide began, to a part in 2000: steps of 1e-4 of the way to it.
    assert model.state["latched_breakaway"] == pytest.approx(located.events[0][2], rel=5e-4)
    # Faster loading lowers it, between the two limits.
    assert 0.35 < model.state["latched_breakaway"] < 0.5


@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_rated_machine_follows_the_located_events(integrator):
    inertia, parameters, force = drawn_rig(31, factor=2.0, hook=True)
    parameters |= {"loading_rate": 4.0 * force, "loading_time": 0.03}
    effort = hooked_input(force, 5)
    oracle, located = simulate_with_events(
        effort, 0.01, inertia=inertia, elements=ELEMENTS, **for_oracle(parameters)
    )
    machine = st.Motor(
        inertia=inertia, friction=st.FrictionModel("hsieh_pan", **parameters), integrator=integrator
    )
    run = machine.simulate(np.repeat(effort, 100), FAST_DT)
    breaks = [event for event in located.events if event[1] == "break-away"]
    assert run.statistics["breakaways"] == len(breaks)
    assert worst_share(run.position[99::100], oracle.position) < EVENT_SHARE


def pulled(speed, dt, duration, *, stiffness=20.0, velocity=0.0, **parameters):
    """The body pulled through a spring whose far end moves at a constant speed."""
    machine = st.Motor(inertia=INERTIA, friction=st.FrictionModel("hsieh_pan", **parameters))
    x, v = 0.0, velocity
    machine.reset(velocity=velocity)
    rows = []
    for k in range(round(duration / dt)):
        load = stiffness * (speed * (k + 0.5) * dt - (x + v * dt / 2.0))
        x, v = machine.step(0.0, dt, load=load)
        rows.append((x, v))
    return np.array(rows).T, machine


@pytest.mark.parametrize("speed", [0.1, 0.3])
def test_pulled_mass_follows_the_located_events(speed):
    parameters = ILLUSTRATIVE | HOOK
    oracle, located = pulled_mass(
        speed, duration=0.8, inertia=INERTIA, elements=ELEMENTS, **parameters
    )
    (position, _), machine = pulled(speed, FAST_DT, 0.8, **parameters)
    assert worst_share(position[99::100], oracle.position) < EVENT_SHARE
    breaks = [event for event in located.events if event[1] == "break-away"]
    assert machine.statistics["breakaways"] == len(breaks)


@pytest.mark.parametrize("integrator", ["fast", "reference"])
@pytest.mark.parametrize("seed", range(5))
def test_coulomb_machine_follows_the_exact_slides(seed, integrator):
    rng = np.random.default_rng(seed)
    inertia, coulomb = around(rng, INERTIA), around(rng, 0.35)
    viscous = [0.0, around(rng, 0.05)][seed % 2]
    effort = np.repeat(rng.uniform(-2.0, 2.0, 60) * coulomb, 3)
    exact = simulate_coulomb(
        effort, 0.01, slide=slide_closed_form, inertia=inertia, coulomb=coulomb, viscous=viscous
    )
    friction = st.FrictionModel("coulomb", coulomb=coulomb, viscous=viscous)
    machine = st.Motor(inertia=inertia, friction=friction, integrator=integrator)
    run = machine.simulate(np.repeat(effort, 100), FAST_DT)
    # Constant forces are integrated exactly; viscous ones to second and fourth order, where the
    # velocity decays by up to 3e-3 a step.
    share = 1e-11 if viscous == 0.0 else 1e-5
    assert worst_share(run.position[99::100], exact["position"]) < share
    assert worst_share(run.velocity[99::100], exact["velocity"]) < share
    rest = exact["velocity"] == 0.0
    assert rest.any()
    assert np.array_equal(run.velocity[99::100] == 0.0, rest)
    assert np.abs(run.friction[99::100] - exact["friction"]).max() < 1e-5 * coulomb


@pytest.mark.parametrize("integrator", ["fast", "reference"])
@pytest.mark.parametrize("seed", range(4))
def test_stribeck_machine_follows_the_located_slides(seed, integrator):
    rng = np.random.default_rng(seed)
    inertia, coulomb = around(rng, INERTIA), around(rng, 0.35)
    law = {
        "coulomb": coulomb,
        "breakaway": coulomb * rng.uniform(1.1, 1.8),
        "viscous": around(rng, 0.05),
        "stribeck_velocity": around(rng, 0.1),
        "stribeck_exponent": [2.0, 1.0, 1.5, 3.0][seed],
    }
    effort = np.repeat(rng.uniform(-2.5, 2.5, 25) * coulomb, 2)
    exact = simulate_coulomb(effort, 0.01, inertia=inertia, **law)
    machine = st.Motor(
        inertia=inertia, friction=st.FrictionModel("coulomb", **law), integrator=integrator
    )
    run = machine.simulate(np.repeat(effort, 100), FAST_DT)
    share = 1e-3 if integrator == "fast" else 1e-6
    assert worst_share(run.position[99::100], exact["position"]) < share
    assert np.array_equal(run.velocity[99::100] == 0.0, exact["velocity"] == 0.0)


def test_a_steep_stribeck_fall_does_not_chatter():
    # An ordinary servo recorded at 1 kHz; the fall is passed within a step or two.
    law = {"coulomb": 0.35, "breakaway": 0.5, "stribeck_velocity": 5e-3, "viscous": 0.05}
    effort = np.concatenate((np.full(200, 0.52), np.zeros(100), np.full(100, -0.6), np.zeros(100)))
    exact = simulate_coulomb(effort[::10], 0.01, inertia=INERTIA, **law)
    for integrator in ("reference", "fast"):
        machine = st.Motor(
            inertia=INERTIA, friction=st.FrictionModel("coulomb", **law), integrator=integrator
        )
        run = machine.simulate(effort, 1e-3)
        assert run.statistics["breakaways"] == 2, integrator
        assert run.statistics["sticks"] == 2, integrator
        assert worst_share(run.position[9::10], exact["position"]) < 0.01, integrator


@pytest.mark.parametrize("seed", range(4))
def test_weighted_elements_follow_the_ladder_that_they_stand_for(seed: int) -> None:
    # Elements that yield evenly (yield_shape 1/2), those of one group as stiff as its weight says.
    source = np.random.default_rng(seed)
    weights = dict(
        zip(("weight_1", "weight_2", "weight_4"), source.uniform(0.2, 4.0, 3).tolist(), strict=True)
    )
    coulomb, stiffness = 0.4, 250.0
    law = st.FrictionModel(
        "maxwell_slip", coulomb=coulomb, initial_stiffness=stiffness, yield_shape=0.5, **weights
    )
    edges = np.array([0.0, 0.25, 0.5, 1.0, 2.0])
    shares = np.array([weights["weight_1"], weights["weight_2"], 1.0, weights["weight_4"]])
    yields = (np.arange(4000) + 0.5) / 2000.0
    elements = shares[np.searchsorted(edges, yields) - 1]
    elements *= stiffness / elements.sum()
    yields *= coulomb / (elements @ yields)
    motion = np.cumsum(source.standard_normal(300)) * 0.3 * coulomb / stiffness
    held = np.zeros_like(yields)
    before, dt = 0.0, 1e-3
    for x in motion:
        held = np.clip(held + x - before, -yields, yields)
        force = law.step((x - before) / dt, dt)
        before = x
        assert force == pytest.approx(elements @ held, abs=2e-6 * coulomb)
