"""Single moments far beyond noise: what comes once, or in recordings of one role alone."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.adequacy.bursts import burst_of

RECORDINGS, ROWS, DT = 4, 4000, 5e-3
NAMES = [f"recording {k + 1}" for k in range(RECORDINGS)]


def found(more: np.ndarray, residual: float = 1.0) -> Any:
    """What bursts of white noise with this beside it; shape (RECORDINGS * ROWS,)."""
    source = np.random.default_rng(8)
    time = 3.0 + DT * np.arange(ROWS)
    rows = [
        SimpleNamespace(
            index=k,
            form=SimpleNamespace(dt=DT, stride=1, time=time, clock=100.0 * k),
            mask=np.ones(ROWS, dtype=bool),
            weight=2.0,
        )
        for k in range(RECORDINGS)
    ]
    evidence: Any = SimpleNamespace(
        shown=rows,
        cells=SimpleNamespace(recording=np.repeat(np.arange(RECORDINGS), ROWS)),
        names=NAMES,
        recordings=[SimpleNamespace(time=time)] * RECORDINGS,
    )
    model: Any = SimpleNamespace(residual=residual * source.standard_normal(len(more)) + more)
    null = source.standard_normal((len(more), 12))
    return burst_of(evidence, model, null, 1.0, [100.0 * k for k in range(RECORDINGS)])


def acting(*windows: tuple[int, int], size: float) -> np.ndarray:
    """A push of .2 s in each of these (recording, window)."""
    push = np.zeros(RECORDINGS * ROWS)
    for recording, window in windows:
        first = recording * ROWS + 40 * window
        push[first : first + 40] = size
    return push


def test_one_window_is_told_with_its_place() -> None:
    burst = found(acting((2, 31), size=12.0))
    assert burst.recording == "recording 3"
    assert burst.start == pytest.approx(31 * 0.2)
    total = RECORDINGS * ROWS + 40 * 145.0
    assert burst.share == pytest.approx(40 * 145.0 / total, rel=0.05)
    assert "6.2 s into recording 3" in burst.advice().experiment
    most = int(np.argmax(burst.view.mean))
    assert burst.view.at[most] == pytest.approx(200.0 + 31 * 0.2 + 0.1)
    assert burst.view.mean[most] == pytest.approx(6.0, rel=0.05)
    assert burst.view.high[most] < 1.0


def test_noise_is_no_burst() -> None:
    assert found(np.zeros(RECORDINGS * ROWS)) is None


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
