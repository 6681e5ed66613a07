"""Servos whose clock is uneven, whose goal comes late, or which warm up as the session goes on."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.reference.servo_reference import Servo

import stiction as st
from stiction.residual.effort import free_run
from stiction.residual.loop_form import LoopForm

DT = 5e-3
COUNT = 2.0 * np.pi / 4096
TRUE = Servo(proportional=1.2)
PLANT: dict[str, Any] = {
    "drive": {
        "kind": "servo",
        "proportional": 1.2,
        "supply_v": 7.4,
        "resistance_ohm": 3.5,
        "torque_constant": {"value": 0.35, "min": 0.1, "max": 2.0},
    },
    "body": {"inertia": 0.002, "payload_kg": 0.3, "payload_m": 0.1},
    "friction": {"law": "coulomb", "coulomb": 0.03, "viscous": 0.002},
}
ROLES = ["train", "train", "train", "train", "select", "select", "test", "test"]


def session(
    servo: Servo, steps: np.ndarray, *, jumps: bool = False, clock: float = 0.0
) -> list[st.Recording]:
    """Sines, each other recording with jumps of the goal if asked for, one after the other."""
    made, time = [], np.concatenate([[0.0], np.cumsum(steps)])[:-1]
    for k, role in enumerate(ROLES):
        rng = np.random.default_rng(k)
        a, b = rng.uniform(0.6, 1.2, 2)
        goal = a * np.sin(2.0 * b * time) + 0.2 * np.sin(5.3 * a * time)
        if jumps and k % 2:
            goal += 0.4 * np.sign(np.sin(0.9 * time + b))
        since = clock * k
        reached = servo.run(goal, steps, substeps=100, clock=since)
        noise = 0.2 * rng.standard_normal(len(goal))
        read = COUNT * np.round(np.concatenate([[0.0], reached[:-1]]) / COUNT + noise)
        made.append(st.Recording(time, goal, read, role=role, kind=f"{k}", start_s=since))
    return made


def even(rows: int) -> np.ndarray:
    return np.full(rows, DT)


def uneven(rows: int) -> np.ndarray:
    return np.where(np.random.default_rng(5).random(rows) < 0.7, DT, 1.006 * DT)


@pytest.mark.long
@pytest.mark.parametrize("steps", [even, uneven])
def test_a_fit_of_an_uneven_clock_ends_in_the_same_machine(steps: Any) -> None:
    """A goal that is held to even stamps came half a sample late, and was taken for friction."""
    recordings = session(TRUE, steps(1600), jumps=True)
    found = st.fit(st.Plant.from_dict(PLANT), recordings[:4])
    values = {path.rsplit(".", 1)[1]: each.value for path, each in found.parameters.items()}
    assert values["torque_constant"] == pytest.approx(TRUE.constant, rel=0.01)
    assert values["coulomb"] == pytest.approx(TRUE.coulomb, rel=0.05)
    assert values["viscous"] == pytest.approx(TRUE.viscous, rel=0.15)
    assert abs(found.timing_offset) < 0.1 * DT
    assert free_run(found.plant, recordings[7]).rms < 1.5 * COUNT


def test_rows_of_an_uneven_clock_are_those_of_the_recording() -> None:
    """But for some in between where rows are missing."""
    steps = uneven(400)
    (recording, *_) = session(TRUE, steps)
    form = LoopForm(st.Plant.from_dict(PLANT), recording)
    np.testing.assert_array_equal(form.time, recording.time[1:])
    np.testing.assert_array_equal(form.input, recording.input[:-1])
    assert recording.position is not None
    kept = np.ones(400, dtype=bool)
    kept[100:103] = False
    gone = st.Recording(recording.time[kept], recording.input[kept], recording.position[kept])
    again = LoopForm(st.Plant.from_dict(PLANT), gone)
    assert len(again.time) == 399
    np.testing.assert_allclose(again.time, recording.time[1:], atol=0.02 * DT)


@pytest.mark.slow
def test_a_goal_that_comes_a_part_of_a_sample_late_is_no_friction() -> None:
    late = Servo(proportional=1.2, tardy=0.3)
    found = st.diagnose(st.Plant.from_dict(PLANT), session(late, even(1600), jumps=True))
    assert found.verdict == "nothing_missing", found.sentence
    assert found.extended is not None
    told = st.fit(st.Plant.from_dict(PLANT), session(late, even(1600), jumps=True)[:4])
    assert told.timing_offset == pytest.approx(0.3 * DT, abs=0.1 * DT)
    values = {path.rsplit(".", 1)[1]: each.value for path, each in told.parameters.items()}
    assert values["viscous"] == pytest.approx(late.viscous, rel=0.2)


@pytest.mark.long
def test_what_a_servo_answers_to_its_noise_is_no_response() -> None:
    """Smooth goals alone: a third of what noise left went with the effort that it had made."""
    found = st.diagnose(st.Plant.from_dict(PLANT), session(TRUE, even(1600)))
    assert found.verdict == "nothing_missing", found.sentence


@pytest.mark.slow
def test_a_servo_that_warms_up_is_simulated_as_warm_as_it_is() -> None:
    """Each recording was begun cold by the loop that bears a name out, and none bore this one."""
    warm = Servo(proportional=1.2, cold=1.0, warming=25.0)
    recordings = session(warm, even(1600), jumps=True, clock=8.2)
    found = st.diagnose(st.Plant.from_dict(PLANT), recordings)
    (cause,) = found.effects
    assert {cause.name, *cause.look_alikes} & {"warm_up", "run_in"}
    assert cause.name == "warm_up"
    assert found.gain is not None
    assert found.gain.ci95[0] > 0.5


def test_speeds_of_an_uneven_clock_are_those_of_the_machine() -> None:
    """Smoothed as if rows were even, each late row gave a step of the speed."""
    steps = np.where(np.random.default_rng(6).random(600) < 0.8, DT, 1.3 * DT)
    time = np.concatenate([[0.0], np.cumsum(steps)])[:-1]
    position = 0.8 * np.sin(2.0 * time)
    form = LoopForm(st.Plant.from_dict(PLANT), st.Recording(time, position, position))
    # A rigid contact is taken to rest about its turns, and the smoothing has ends.
    inside = np.flatnonzero(np.abs(np.cos(2.0 * form.time)) > 0.2)[40:-40]
    velocity = 1.6 * np.cos(2.0 * form.time)[inside]
    bent = -3.2 * np.sin(2.0 * form.time)[inside]
    np.testing.assert_allclose(form.velocity[inside], velocity, atol=0.01 * 1.6)
    np.testing.assert_allclose(form.acceleration[inside], bent, atol=0.02 * 3.2)
    later = form.late(st.Plant.from_dict(PLANT))[inside]
    np.testing.assert_allclose(later, form.stiffness * velocity, atol=0.02 * 1.6 * form.stiffness)
