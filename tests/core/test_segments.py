"""Motor.simulate_segments: inputs held for long."""

from __future__ import annotations

import time
from typing import Any, Final

import numpy as np
import pytest

import stiction as st

TOLERANCE: Final = 0.1 * np.pi / 648000
INERTIA: Final = 0.0076


def rig(law: str = "hsieh_pan", **parameters: Any) -> st.Motor:
    return st.Motor(INERTIA, friction=st.FrictionModel(law, **parameters))


def test_ends_of_segments_are_those_of_fixed_steps() -> None:
    durations, currents = np.array([0.02, 0.3, 0.02, 0.5]), np.array([0.2, 0.0, -0.15, 0.05])
    run = rig().simulate_segments(durations, currents)
    dt = 2e-5
    inputs = np.repeat(currents, np.round(durations / dt).astype(int))
    motor = st.Motor(INERTIA, friction=st.FrictionModel("hsieh_pan"), integrator="reference")
    fixed = motor.simulate(inputs, dt, outputs=("position",))
    ends = np.round(np.cumsum(durations) / dt).astype(int) - 1
    np.testing.assert_allclose(run.position, fixed.position[ends], atol=TOLERANCE, rtol=0)
    np.testing.assert_allclose(run.time, np.cumsum(durations), rtol=1e-15)


@pytest.mark.parametrize(
    ("law", "own"), [("hsieh_pan", {"breakaway": 0.5}), ("maxwell_slip", {"viscous": 0.3})]
)
def test_rings_on_a_spring_take_fewer_steps_than_fixed_ones(
    law: str, own: dict[str, float]
) -> None:
    durations = np.tile([0.02, 0.08], 8)
    currents = np.zeros(16)
    currents[::2] = np.tile([0.15, 0.2, -0.15, -0.2], 2)
    run = rig(law, **own).simulate_segments(durations, currents)
    assert run.statistics["evaluations"] < 0.5 * durations.sum() / 1e-4
    dt = 2e-5
    inputs = np.repeat(currents, np.round(durations / dt).astype(int))
    motor = st.Motor(INERTIA, friction=st.FrictionModel(law, **own), integrator="reference")
    fixed = motor.simulate(inputs, dt, outputs=("position",))
    ends = np.round(np.cumsum(durations) / dt).astype(int) - 1
    np.testing.assert_allclose(run.position, fixed.position[ends], atol=TOLERANCE, rtol=0)


def test_rows_stand_at_the_times_asked_for_and_the_motor_goes_on_from_the_end() -> None:
    motor = rig()
    run = motor.simulate_segments([0.5, 1.0], [0.1, 0.0], times=[0.2, 0.5, 0.7])
    np.testing.assert_allclose(run.time, [0.2, 0.5, 0.7, 1.5])
    assert motor.state["time"] == 1.5
    assert motor.state["position"] == run.position[-1]
    later = motor.simulate_segments([1.0], [0.0], outputs=("velocity",))
    assert list(later) == ["velocity"]
    assert later.time[0] == 2.5
    assert motor.simulate([0.1] * 5, 1e-3).time[0] == pytest.approx(2.501)


def test_a_day_of_rest_costs_no_more_than_a_minute() -> None:
    def cost(rest: float) -> int:
        run = rig().simulate_segments([0.02, rest], [0.2, 0.0])
        assert run.statistics["rests"] == 1
        return run.statistics["evaluations"]

    assert cost(86400.0) == cost(60.0) <= 500


def test_a_smaller_tolerance_comes_nearer_at_more_steps() -> None:
    args = ([0.02, 0.05], [0.25, 0.0])
    fine = rig().simulate_segments(*args, tolerance=1e-11)
    far = [
        (abs(run.position[-1] - fine.position[-1]), run.statistics["evaluations"])
        for run in (rig().simulate_segments(*args, tolerance=t) for t in (1e-6, 1e-8))
    ]
    assert far[0][0] <= 1e-6
    assert far[1][0] <= 1e-8
    assert far[0][1] < far[1][1]


def test_load_of_a_segment_adds_to_its_input() -> None:
    one = rig().simulate_segments([1.0, 1.0], [0.1, 0.0], load=[0.0, 0.05])
    other = rig().simulate_segments([1.0, 1.0], [0.1, 0.05])
    np.testing.assert_allclose(one.position, other.position, rtol=1e-12)


@pytest.mark.parametrize(
    ("durations", "current", "keywords", "sentence"),
    [
        ([1.0], [0.0, 1.0], {}, "current"),
        ([0.0], [0.0], {}, "durations = 0 is out of bounds"),
        ([1.0], [0.0], {"tolerance": -1.0}, "tolerance = -1 is out of bounds"),
        ([1.0], [0.0], {"times": [0.5, 0.2]}, "times = 0.2 is out of bounds"),
        ([1.0], [0.0], {"times": [1.5]}, "times = 1.5 is out of bounds"),
        ([1.0], [0.0], {"load": [1.0, 2.0]}, "load has shape"),
        ([1.0], [0.0], {"outputs": ["path"]}, "output 'path' is unknown"),
        ([1.0], [0.0], {"outputs": "position"}, "is a word"),
        ([np.inf], [0.0], {}, "durations"),
    ],
)
def test_what_cannot_be_run_is_refused(
    durations: list[float], current: list[float], keywords: dict[str, Any], sentence: str
) -> None:
    motor = rig()
    with pytest.raises(st.InputError, match=sentence):
        motor.simulate_segments(durations, current, **keywords)
    assert motor.state["time"] == 0.0


def test_a_call_that_would_never_end_is_refused_in_a_sentence() -> None:
    effects = {"backlash": {"inertia_share": 0.3, "contact_time": 1e-3}}
    behind_a_gap = st.Motor(INERTIA, friction=st.FrictionModel("hsieh_pan"), effects=effects)
    for motor, duration, tolerance in ((behind_a_gap, 1e9, TOLERANCE), (rig(), 1000.0, 1e-300)):
        before = motor.state
        began = time.process_time()
        with pytest.raises(
            st.InputError, match=r"more work than .* inner steps .*; ask for more rows"
        ):
            motor.simulate_segments([duration], [0.2], tolerance=tolerance)
        assert time.process_time() - began < 5.0
        np.testing.assert_equal(motor.state, before)
