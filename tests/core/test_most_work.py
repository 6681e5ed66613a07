"""What a call may cost: five seconds, or one sentence that says what is dear."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import stiction as st

MOST_S = 5.0
"""Of the processor, for less than 10 000 samples."""
DEAR = "takes? more work than"


def refused(call: Callable[[], Any]) -> str:
    """The sentence with which a call is refused in time."""
    began = time.process_time()
    with pytest.raises(st.InputError, match=DEAR) as caught:
        call()
    assert time.process_time() - began < MOST_S
    return str(caught.value)


def stiff() -> st.Motor:
    """A motor that divides 1 ms into some thousand steps, none of them in a row."""
    friction = st.FrictionModel("lugre", initial_stiffness=1e9, coulomb=0.3)
    return st.Motor(0.01, friction=friction, effects={"relaxation": {"speed": 1e-4}})


def test_what_is_known_beforehand_is_refused_at_once_with_the_parameter_that_costs() -> None:
    machine = stiff()
    before = machine.state
    said = refused(lambda: machine.simulate(np.full(4000, 0.1), 1e-3))
    assert "a smaller friction.initial_stiffness, a shorter dt" in said
    np.testing.assert_equal(machine.state, before)
    machine.simulate(np.full(100, 0.1), 1e-3)
    assert len(machine.simulate(np.full(4000, 0.1), 1e-5)) == 4000


def test_internal_variables_of_the_reference_integrator_count() -> None:
    friction = st.FrictionModel("bristle", coulomb=1e-12)
    machine = st.Motor(0.0076, friction=friction, integrator="reference")
    pushed = np.repeat([0.3, -0.2, 0.1], 273)
    began = time.process_time()
    with contextlib.suppress(st.InputError):
        machine.simulate(pushed, 1e-2)
    assert time.process_time() - began < MOST_S


def test_modes_that_change_again_and_again_count() -> None:
    friction = st.FrictionModel(
        "bristle", coulomb=1e-12, initial_stiffness=5.9e-6, scatter=0.95, viscous=0.002
    )
    machine = st.Motor(5e-4, friction=friction, effects={"current_loop_lag": {"time": 0.0}})
    before = machine.state
    said = refused(lambda: machine.simulate_segments(np.full(40, 200.0), np.full(40, 0.3)))
    assert "shorter segments" in said
    np.testing.assert_equal(machine.state, before)


def test_segments_in_samples_are_refused_by_the_clock_of_the_run() -> None:
    friction = st.FrictionModel("rate_and_state")
    machine = st.Motor(0.06, friction=friction, effects={"relaxation": {"speed": 1e-3}})
    assert "s: samples" in refused(lambda: machine.simulate_segments([5e4], [0.1]))


def test_ensembles_share_what_a_call_may_cost() -> None:
    machine = stiff()
    many = st.Ensemble(machine, 4000)
    before = [state["position"] for state in (machine.state,)]
    said = refused(lambda: many.step_many(np.full(4000, 0.1), 1.4e-3))
    assert "a smaller friction.initial_stiffness" in said
    refused(lambda: st.simulate_ensemble(machine, np.full((400, 10), 0.1), 1e-3))
    assert before == [0.0]
    position, _ = many.step_many(np.full(4000, 0.1), 1e-5)
    assert np.isfinite(position).all()


@pytest.mark.long
def test_derivatives_and_windows_count() -> None:
    machine = stiff()
    motion = st.Motion(np.zeros(4001), np.full(4000, 0.1), 1.3e-3)
    # Windows that overlap are simulated each, and count each.
    with pytest.raises(st.InputError, match=DEAR):
        machine.shoot(motion, np.ones(50), 10)
    refused(lambda: machine.sensitivity(np.full(4000, 0.1), 1e-3, parameters=["body.inertia"]))
    slower = st.Motion(np.zeros(4001), np.full(4000, 0.1), 1e-2)
    refused(lambda: machine.accompany(slower, stiffness=10.0, damping=1.0))


def test_ordinary_runs_are_not_refused() -> None:
    for law in st.laws():
        machine = st.Motor(0.0076, friction=st.FrictionModel(law.name))
        assert machine.simulate(np.full(200, 0.1), 1e-2).success
