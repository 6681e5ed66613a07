"""Ctrl-C ends every long call soon and leaves what it was called on as it was."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import stiction as st
from stiction import _native
from stiction.fitting import levenberg

from .rigs import contact, motor

# Asked for is 0.2 s; a machine that is busy with other tests takes its time.
SOON = 1.0
DT = 1e-4
LONG = 60_000_000


def interrupted(call, wait=0.15):
    """How long a call went on after SIGINT, s; fails where it ended before by itself."""
    sent = []

    def strike():
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(wait, strike)
    timer.start()
    try:
        call()
        timer.join()
        time.sleep(0.1)
    except KeyboardInterrupt:
        return time.perf_counter() - sent[0]
    finally:
        timer.cancel()
        timer.join()
    pytest.fail("the call was over before it was interrupted")


@pytest.fixture(autouse=True)
def _as_in_a_terminal():
    """A shell that starts tests in the background has them ignore Ctrl-C."""
    usual = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, usual)


@pytest.fixture(scope="module")
def held():
    """An input of many samples, all the same place in memory."""
    return np.zeros(LONG)


@pytest.fixture(scope="module")
def swinging():
    return swing()


def swing():
    """A motion that is long to follow."""
    n = 1_500_000
    position = 1e-3 * np.sin(np.arange(n + 1) * 1e-3)
    return _native.Motion(position, np.zeros(n), DT)


def slow(**keywords):
    """A motor whose samples are divided into hundreds of steps."""
    friction = st.FrictionModel("lugre", initial_stiffness=1e8)
    return st.Motor(1e-3, friction=friction, **keywords)


GAP = {"backlash": {"inertia_share": 0.3, "contact_time": 1e-3}}
PUSHED = np.full(20_000, 0.1)
# Numbers of Motion and kernels as the residual has them, from which long calls are made.
CALLS = {
    "simulate": lambda m, _: m.simulate(PUSHED, 2e-4, outputs=()),
    "simulate, reference": lambda m, _: m.simulate(PUSHED, 1e-4, outputs=()),
    "simulate_segments": lambda m, _: m.simulate_segments([180.0], [0.1]),
    "follow": lambda m, motion: [m.follow(motion) for _ in range(20)],
    "sensitivity": lambda m, _: m.sensitivity(PUSHED, 4e-5, ["friction.coulomb"]),
    "signatures": lambda m, motion: [
        m.signatures(motion, [(e.name, {}) for e in st.effects()], threads=2) for _ in range(5)
    ],
    "shoot": lambda m, motion: m.shoot(motion, np.ones(50), 1),
    "shoot_sensitivity": lambda m, motion: m.shoot_sensitivity(
        motion, np.ones(50), 1, ["friction.coulomb"]
    ),
    "accompany": lambda m, motion: [m.accompany(motion, 100.0, 1.0) for _ in range(20)],
}
MADE = {
    "simulate, reference": lambda: st.Motor(
        1e-3,
        friction=st.FrictionModel("hsieh_pan", initial_stiffness=1e7),
        integrator="reference",
    ),
    "simulate_segments": lambda: motor("hook", effects=GAP),
    "simulate": slow,
    "sensitivity": slow,
}


@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_ends_a_long_call_of_a_motor_which_is_then_as_before(name, swinging):
    machine = MADE.get(name, lambda: motor("hook"))()
    machine.step(0.1, 1e-4)
    before = machine.state
    took = interrupted(lambda: CALLS[name](machine, swinging))
    assert took < SOON
    # Of calls one after the other those that ended had their way.
    if name in ("simulate", "simulate, reference", "simulate_segments", "sensitivity", "shoot"):
        np.testing.assert_equal(machine.state, before)


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_an_ensemble_on_all_its_threads(threads):
    many = st.Ensemble(motor("hook"), 200)
    current = np.full(2_000_000, 0.1)
    before = many.step_many(0.0, DT)
    took = interrupted(lambda: many.simulate(current, DT, reduce="last", threads=threads))
    assert took < SOON
    np.testing.assert_equal(many.step_many(0.0, DT), before)


def test_ctrl_c_ends_one_sample_of_many_motors():
    many = st.Ensemble(slow(), 3000)
    assert interrupted(lambda: [many.step_many(0.1, 1e-4) for _ in range(1000)]) < SOON


def test_ctrl_c_ends_a_contact_that_is_moved(held):
    model = contact("hook")
    before = model.state
    assert interrupted(lambda: model.simulate(held, DT)) < SOON
    np.testing.assert_equal(model.state, before)
    rows = held[: LONG // 2 * 2].reshape(1000, -1)
    assert interrupted(lambda: model.simulate(rows, DT)) < SOON


def test_ctrl_c_ends_a_smoothing(held):
    halves = list(range(0, 400))
    assert interrupted(lambda: _native.adaptively_smoothed(held[:300_000], 1e-6, halves)) < SOON


def test_ctrl_c_ends_sums_over_rows():
    columns, rows = 100, 2_000_000
    left, slopes = np.zeros(rows), np.zeros((columns, rows))
    free, every = np.full(columns, np.inf), list(range(columns))

    def call():
        levenberg.descend(
            lambda x: [left], lambda x: ([(every, slopes)], None),
            np.zeros(columns), (-free, free), np.ones(columns), most=9, tolerance=1e-9,
        )  # fmt: skip

    assert interrupted(call) < SOON


def test_a_handler_of_ones_own_is_heard_and_may_let_the_call_go_on():
    heard = []
    usual = signal.signal(signal.SIGINT, lambda *_: heard.append(time.perf_counter()))
    timer = threading.Timer(0.01, lambda: os.kill(os.getpid(), signal.SIGINT))
    try:
        timer.start()
        run = slow().simulate(PUSHED[:1500], 2e-4)
        ended = time.perf_counter()
    finally:
        timer.join()
        signal.signal(signal.SIGINT, usual)
    assert len(run) == 1500
    assert len(heard) == 1
    assert heard[0] < ended


def test_a_call_on_another_thread_goes_on():
    results = []
    worker = threading.Thread(target=lambda: results.append(slow().simulate(PUSHED[:500], 1e-3)))
    worker.start()
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
    worker.join()
    assert len(results[0]) == 500


def test_a_call_that_is_refused_on_its_way_leaves_the_motor_as_it_was():
    machine = motor("hook")
    before = machine.state
    with pytest.raises(st.InputError, match="too long for this machine"):
        machine.simulate(np.full(3, 0.1), [1e-4, 1e-4, 1e5])
    np.testing.assert_equal(machine.state, before)
