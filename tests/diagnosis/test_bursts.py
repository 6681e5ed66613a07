"""Single moments far beyond noise: what comes once, or in recordings of one role alone."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.diagnosis.builders import model, plant
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.adequacy.bursts import burst_of
from stiction.diagnosis.data.evidence import Evidence

RECORDINGS, DT = 4, 5e-3
WINDOW = 40
"""Rows in .2 s."""


@cache
def session() -> Evidence:
    """Rows of recordings of 20 s, each weighing twice."""
    source, time = np.random.default_rng(8), 3.0 + DT * np.arange(4000)
    recordings = []
    for role in ("train", "train", "select", "select", "test"):
        waves = [0.3 * np.sin(w * time + source.uniform(0.0, 6.0)) for w in (2.0, 5.3, 13.0)]
        effort = np.sum(waves, axis=0)
        moved = plant().motor().simulate(effort[:-1], DT).position
        position = np.concatenate([[0.0], moved])
        recordings.append(st.Recording(time, effort, position, role=role))
    found = Evidence(plant(), recordings)
    for rows in found.shown:
        rows.weight = 2.0
    return found


def per_recording() -> int:
    """Rows of each recording."""
    return int(session().shown[0].mask.sum())


def into() -> float:
    """When the first of them is, in s from the start of its recording."""
    (first, *_) = session().shown
    return float(first.form.time[first.mask][0]) - 3.0


def found(more: np.ndarray, residual: float = 1.0) -> Any:
    """What bursts of white noise with this beside it, a value for each row."""
    source = np.random.default_rng(9)
    left = model(session(), residual=residual * source.standard_normal(len(more)) + more)
    null = source.standard_normal((len(more), 12))
    return burst_of(session(), left, null, 1.0, [100.0 * k for k in range(RECORDINGS)])


def acting(*windows: tuple[int, int], size: float) -> np.ndarray:
    """A push of .2 s in each of these (recording, window)."""
    push = np.zeros(RECORDINGS * per_recording())
    for recording, window in windows:
        first = recording * per_recording() + WINDOW * window
        push[first : first + WINDOW] = size
    return push


def test_one_window_is_told_with_its_place() -> None:
    burst = found(acting((2, 31), size=12.0))
    assert burst.recording == "recording 3"
    assert burst.start == pytest.approx(into() + 31 * 0.2)
    total = RECORDINGS * per_recording() + 40 * 145.0
    assert burst.share == pytest.approx(40 * 145.0 / total, rel=0.05)
    assert f"{burst.start:.1f} s into recording 3" in burst.advice().experiment
    most = int(np.argmax(burst.view.mean))
    assert burst.view.at[most] == pytest.approx(200.0 + into() + 31 * 0.2 + 0.1)
    assert burst.view.mean[most] == pytest.approx(6.0, rel=0.05)
    assert burst.view.high[most] < 1.0


def test_noise_is_no_burst() -> None:
    assert found(np.zeros(RECORDINGS * per_recording())) is None


@pytest.mark.parametrize("size", [3.0, 8.0])
def test_what_is_small_beside_noise_or_beside_the_rest_is_none(size: float) -> None:
    """A window of three times the noise, and one of which the rest holds twelve times as much."""
    rest = 1.0 if size < 5.0 else 4.0
    assert found(acting((1, 7), size=size), rest) is None


def test_what_comes_in_many_windows_is_no_single_moment() -> None:
    everywhere = [(k, window) for k in range(RECORDINGS) for window in (5, 25, 45)]
    assert found(acting(*everywhere, size=12.0)) is None


@pytest.mark.slow
def test_a_limit_that_is_reached_once_is_not_nothing() -> None:
    """Nothing that was not fitted shows it: it has no name, and a fifth of what is left."""
    made = make_session(12900003, base="coulomb", hidden=(("voltage_limit:foreign", 0.014022),))
    found = st.diagnose(as_plant(made), as_session(made))
    assert found.verdict == "unexplained"
    assert found.effects == ()
    assert found.unexplained[0].coordinate == "single moments in time"
    assert found.unexplained[0].share > 0.1
    assert "into recording 12" in found.advice[0].experiment
    assert found.pictures is not None
    (shown,) = (
        v for v in found.pictures.after.views if v.coordinate.name == "single moments in time"
    )
    assert shown.share == found.unexplained[0].share
