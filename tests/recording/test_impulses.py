"""Inputs that leave their neighbours: what the machine got stays, what a logger made up goes.

The machine is the independent one of ``tests/reference``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.coulomb_reference import simulate_coulomb
from tests.reference.session_reference import make_session

import stiction as st
from stiction.recording import Recording
from stiction.recording.checks import impulse_checks, without_failures
from stiction.recording.checks.impulses import impulses
from stiction.session import Session

DT = 1e-3
ROWS = 8000
COUNT = 2.0 * np.pi / 2**18
NOISE = 2e-3


def driven() -> np.ndarray:
    """Sines of several sizes, N·m."""
    time = np.arange(ROWS) * DT
    return sum(0.45 * np.sin(2.0 * np.pi * f * time + f) for f in (0.4, 1.1, 2.3))


def moved(effort: np.ndarray) -> np.ndarray:
    constants = {"inertia": 0.0076, "coulomb": 0.3, "breakaway": 0.3, "viscous": 0.05}
    run = simulate_coulomb(effort[:-1], DT, **constants)
    return np.round(np.concatenate([[0.0], run["position"]]) / COUNT) * COUNT


def bursts(effort: np.ndarray, number: int, length: int, times: float) -> np.ndarray:
    rng = np.random.default_rng(number)
    struck, most = effort.copy(), times * float(np.max(np.abs(effort)))
    # Apart from each other, so that none looks like a longer one.
    for place in 20 + (ROWS - 40) // number * np.arange(number):
        struck[place : place + length] = rng.choice([-1.0, 1.0]) * most
    return struck


def recording(effort: np.ndarray, position: np.ndarray, **more: Any) -> Recording:
    noise = NOISE * np.random.default_rng(1).standard_normal(len(effort))
    return Recording(np.arange(len(effort)) * DT, effort + noise, position, **more)


@pytest.mark.long
@pytest.mark.parametrize(("number", "length", "times"), [(20, 1, 5.0), (5, 3, 5.0), (3, 1, 8.0)])
def test_what_the_machine_got_stays_and_what_it_did_not_goes(
    number: int, length: int, times: float
) -> None:
    effort = driven()
    logged = bursts(effort, number, length, times)
    got, failed = recording(logged, moved(logged)), recording(logged, moved(effort))
    (one,) = impulses([got])
    assert (len(one.rows), one.got) == (number * length, True)
    assert without_failures([got])[0] is got
    (one,) = impulses([failed])
    assert (len(one.rows), one.got) == (number * length, False)
    (mended,) = without_failures([failed])
    assert mended.input is not None
    assert np.max(np.abs(mended.input - effort)) < 0.05
    ((_, said),) = impulse_checks([failed])
    assert said.verdict == "note"
    assert "the machine does not answer" in said.means
    ((_, said),) = impulse_checks([got])
    assert said.verdict == "fine"


@pytest.mark.long
@pytest.mark.parametrize("samples", [10, 50, 90])
def test_an_impulse_that_comes_late_is_one_all_the_same(samples: int) -> None:
    effort = driven()
    logged = bursts(effort, 20, 1, 5.0)
    late = np.concatenate([np.zeros(samples), logged[:-samples]])
    assert impulses([recording(logged, moved(late))])[0].got is not False


@pytest.mark.long
def test_what_a_limit_leaves_of_an_impulse_is_no_failed_reading() -> None:
    effort = driven()
    logged = bursts(effort, 20, 3, 5.0)
    most = 1.2 * float(np.max(np.abs(effort)))
    (one,) = impulses([recording(logged, moved(np.clip(logged, -most, most)))])
    assert (one.got, one.answers) == (None, True)
    ((_, said),) = impulse_checks([recording(logged, moved(np.clip(logged, -most, most)))])
    assert "answers to a part of that" in said.means


@pytest.mark.long
def test_no_other_recording_takes_taps_away_that_moved_the_machine() -> None:
    """Between taps there is no usual input, against which they could be told to be whole."""
    taps = bursts(np.full(ROWS, 1e-3), 80, 3, 8000.0)
    moving = recording(taps, moved(taps))
    failed = recording(bursts(driven(), 20, 1, 5.0), moved(driven()))
    assert [each.got for each in impulses([moving, failed])] == [None, False]
    assert without_failures([moving, failed])[0] is moving


def test_at_rest_the_other_recordings_of_a_session_tell() -> None:
    effort = driven()
    resting = bursts(0.1 * effort, 20, 1, 5.0)
    still = recording(resting, np.full(ROWS, 0.1))
    assert impulses([still])[0].got is None
    assert without_failures([still])[0] is still
    ((_, said),) = impulse_checks([still])
    assert "does not tell" in said.means
    failed = recording(bursts(effort, 20, 1, 5.0), moved(effort))
    assert [each.got for each in impulses([still, failed])] == [False, False]


@pytest.mark.long
@pytest.mark.parametrize("name", ["noise", "steps", "corners", "coarse"])
def test_ordinary_inputs_hold_no_impulses(name: str) -> None:
    time = np.arange(ROWS) * DT
    effort = driven()
    given = {
        "noise": effort + 0.3 * np.random.default_rng(2).standard_normal(ROWS),
        "steps": np.sign(np.sin(2.0 * np.pi * 7.0 * time)),
        "corners": np.abs(np.mod(time, 0.4) - 0.2),
        "coarse": np.round(20.0 * effort) / 20.0,
    }[name]
    assert len(impulses([Recording(time, given, moved(effort))])[0].rows) == 0


def test_a_goal_has_no_impulses() -> None:
    logged = bursts(driven(), 5, 1, 5.0)
    settings = {"proportional": 400.0}
    assert len(impulses([recording(logged, moved(driven()), settings=settings)])[0].rows) == 0


def test_readings_that_failed_are_no_drive_that_holds_inputs_back() -> None:
    """Sixty samples of up to twenty times the largest input were a sure ``drive_saturation``."""
    made = make_session(701, base="coulomb", seconds=60.0)
    rng = np.random.default_rng(701)
    struck = []
    for each in as_session(made).recordings:
        given = np.array(each.input)
        most = float(np.max(np.abs(given)))
        places = rng.choice(len(given), 60, replace=False)
        given[places] = rng.choice([-1.0, 1.0], 60) * most * rng.uniform(5.0, 20.0, 60)
        labels = {"role": each.role, "kind": each.kind, "start_s": each.start_s}
        struck.append(Recording(each.time, given, each.position, **labels))
    found = st.diagnose(as_plant(made), Session(struck))
    assert found.effects == ()
    assert found.verdict == "nothing_missing"
    notes = [one for one in found.data["checks"] if one["name"] == "impulses of the input"]
    assert len(notes) == len(struck)
