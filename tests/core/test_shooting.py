"""Windows of simulation along a motion, against simulations put together from pieces."""

from itertools import pairwise

import numpy as np
import pytest

import stiction as st
from stiction.errors import InputError

from .rigs import motor
from .test_sensitivity import changed, smooth_current

DT = 1e-4
LENGTH, STRIDE = 300, 170
# Of sums over a window, as a share of the greatest.
ROUND_OFF = 1e-9
SAME_BRANCHES = 1e-5
STEP = 1e-5


def moved(kind, seed, **keywords):
    """A machine, a motion near one that it makes, and the input."""
    machine = motor(kind, effects={"torque_bias": {"bias": 0.02}}, **keywords)
    current = smooth_current(1.6, 1200, seed)
    position = machine.copy().simulate(current, DT).position
    offset = 1e-4 * np.sin(40.0 * DT * np.arange(len(position) + 1))
    return machine, np.concatenate([[0.0], position]) + offset, current


def weights(seed=0):
    return np.random.default_rng(seed).standard_normal(LENGTH)


def pieces(machine, position, current, load):
    """What `shoot` says, from `follow`, a state that is set, and `simulate`."""
    sums = []
    for start in range(0, len(current) - LENGTH + 1, STRIDE):
        own = machine.copy()
        own.reset(position[0], 0.0)
        if start:
            own.follow(st.Motion(position[: start + 1], current[:start], DT, load=load[:start]))
        before, after = max(start - 1, 0), start + 1
        slope = (position[after] - position[before]) / (DT * (after - before))
        own.state = own.state | {"position": position[start], "velocity": slope}
        span = slice(start, start + LENGTH)
        run = own.simulate(current[span], DT, load=load[span])
        sums.append(weights() @ (run.position - position[start]))
    return np.array(sums)


@pytest.mark.parametrize("kind", ["stribeck", "hook", "sticking"])
def test_a_window_is_a_simulation_from_where_following_led(kind):
    machine, position, current = moved(kind, 2)
    load = 0.05 * np.sin(300.0 * DT * np.arange(len(current)))
    machine.reset(position[0], 0.0)
    kept = machine.copy()
    sums = machine.shoot(st.Motion(position, current, DT, load=load), weights(), STRIDE)
    assert machine == kept
    expected = pieces(machine, position, current, load)
    assert sums.shape == expected.shape
    # The velocity that ends `follow` differs: it has no neighbour there.
    np.testing.assert_allclose(sums, expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("kind", ["stribeck", "hook", "sticking"])
def test_derivatives_of_windows_equal_differences(kind):
    machine, position, current = moved(kind, 5)
    machine.reset(position[0], 0.0)
    wanted = [
        p
        for p, v in machine.parameters.items()
        if np.isfinite(v) and v and p != "drive.gain" and not p.endswith("exponent")
    ]
    if machine.parameters.get("friction.breakaway") == machine.parameters.get("friction.coulomb"):
        wanted = [p for p in wanted if p not in ("friction.breakaway", "friction.coulomb")]
    exact = machine.shoot_sensitivity(st.Motion(position, current, DT), weights(), STRIDE, wanted)

    def chord(path, relative):
        step = relative * abs(machine.parameters[path])
        sums = []
        for sign in (1.0, -1.0):
            other = changed(machine, path, machine.parameters[path] + sign * step)
            other.reset(position[0], 0.0)
            sums.append(other.shoot(st.Motion(position, current, DT), weights(), STRIDE))
        return (sums[0] - sums[1]) / (2.0 * step)

    right = 0
    for row, path in zip(exact, wanted, strict=True):
        difference = (4.0 * chord(path, STEP) - chord(path, 2.0 * STEP)) / 3.0
        scale = np.abs(row).max()
        if scale * abs(machine.parameters[path]) < 1e-6:
            continue
        agree = np.abs(row - difference) < SAME_BRANCHES * scale
        # A window in which both runs take different branches has no chord.
        assert agree.mean() > 0.6, (path, row, difference)
        right += int(agree.all())
    assert right >= len(wanted) // 2


def test_the_response_to_all_parts_is_that_to_a_constant_effort():
    machine, position, current = moved("hook", 3)
    machine.reset(position[0], 0.0)
    parts = machine.shoot_response(st.Motion(position, current, DT), weights(), STRIDE, 7)
    by_bias = machine.shoot_sensitivity(
        st.Motion(position, current, DT), weights(), STRIDE, ["effects.torque_bias.bias"]
    )[0]
    assert parts.shape == (7, len(by_bias))
    assert np.abs(parts.sum(axis=0) - by_bias).max() < ROUND_OFF * np.abs(by_bias).max()


CANDIDATES = [
    ("gravity_unbalance", {}),
    ("cogging", {"order": 7.0}),
    ("encoder_eccentricity", {}),
    ("viscous_quadratic", {}),
    ("drive_deadband", {}),
    ("input_delay", {}),
]


def test_signatures_of_windows_are_what_effects_add_times_the_response():
    parts = 7
    machine, position, current = moved("hook", 6)
    machine.reset(position[0], 0.0)
    motion = st.Motion(position, current, DT)
    found = machine.shoot_signatures(motion, weights(), STRIDE, CANDIDATES, parts)
    response = machine.shoot_response(motion, weights(), STRIDE, parts)
    edges = [k * (LENGTH // parts) for k in range(parts)] + [LENGTH]
    starts = STRIDE * np.arange(response.shape[1])
    rows = zip(found, *machine.signatures(motion, CANDIDATES), strict=True)
    for row, needed, driven, ahead in rows:
        total = np.concatenate([[0.0], np.cumsum(driven - needed)])
        means = [
            (total[starts + last] - total[starts + first]) / (last - first)
            for first, last in pairwise(edges)
        ]
        bent = [weights() @ ahead[start : start + LENGTH] for start in starts]
        expected = np.sum(response * np.array(means), axis=0) - bent
        assert np.any(expected != 0.0)
        assert np.abs(row - expected).max() < ROUND_OFF * np.abs(expected).max()
    short = st.Motion(position[:100], current[:99], DT)
    assert machine.shoot_signatures(short, weights(), STRIDE, CANDIDATES, parts).size == 0


def test_a_run_that_is_drawn_needs_no_pull_when_the_pull_is_its_load():
    machine, position, current = moved("hook", 4)
    load = 0.03 * np.cos(200.0 * DT * np.arange(len(current)))
    machine.reset(position[0], 0.0)
    readings, pull = machine.accompany(st.Motion(position, current, DT, load=load), 50.0, 0.5)
    alone = machine.copy().simulate(current, DT, load=load + pull).position
    np.testing.assert_array_equal(readings, alone)
    # Pushed off by an effort that the motion knows nothing of.
    free = machine.copy().simulate(current, DT, load=load + 0.2).position
    drawn, _ = machine.accompany(st.Motion(position, current, DT, load=load + 0.2), 2e3, 4.0)
    assert np.abs(drawn - position[1:]).max() < 0.1 * np.abs(free - position[1:]).max()


def test_windows_that_are_none_are_refused():
    machine, position, current = moved("stribeck", 1)
    with pytest.raises(InputError, match="weights"):
        machine.shoot(st.Motion(position, current, DT), [], STRIDE)
    with pytest.raises(InputError, match="stride"):
        machine.shoot(st.Motion(position, current, DT), weights(), 0)
    with pytest.raises(InputError, match="parts"):
        machine.shoot_response(st.Motion(position, current, DT), weights(), STRIDE, LENGTH + 1)
    with pytest.raises(InputError, match="parts"):
        machine.shoot_signatures(st.Motion(position, current, DT), weights(), STRIDE, [], 0)
    assert len(machine.shoot(st.Motion(position[:100], current[:99], DT), weights(), STRIDE)) == 0
    assert isinstance(machine, st.Motor)
