"""Controls that must fail when what they guard is broken."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest
from tests.blind.control import shuffled, uncalibrated
from tests.blind.score import as_plant, as_session
from tests.blind.table import named
from tests.reference.session_reference import make_sessions

import stiction as st

SECONDS = 72.0
SURROGATES = 6
NULL_SEEDS = (11, 12, 13)
GATE = 0.35
"""Share of candidates that may pass the score of sessions without anything hidden; 0.0 to 0.45 in
single ones, 0.45 to 0.7 without calibration."""


@cache
def null_sessions() -> Sequence[Any]:
    made: Sequence[Any] = make_sessions([{"seed": s, "seconds": SECONDS} for s in NULL_SEEDS])
    return made


def passed_the_score(sessions: Sequence[Any]) -> float:
    """Share of candidates that the score alone would let through."""
    found = [
        st.diagnose(as_plant(made), as_session(made), surrogates=SURROGATES) for made in sessions
    ]
    rows = [row for diagnosis in found for row in diagnosis.candidates if row.score is not None]
    return float(np.mean([row.score > row.threshold for row in rows]))  # type: ignore[operator]


@pytest.mark.slow
def test_without_calibration_the_score_lets_noise_through(monkeypatch: pytest.MonkeyPatch) -> None:
    # Held-out rows, blocks and strength still refuse what the score lets through: of twelve such
    # sessions none got a name. It is the score's own gate that must be seen to fail.
    assert passed_the_score(null_sessions()) < GATE
    uncalibrated(monkeypatch.setattr)
    # Not all of them: a gain of one sign alone, pushed the other way, explains nothing at all.
    assert passed_the_score(null_sessions()) > GATE


def test_shuffled_labels_are_right_by_chance_alone() -> None:
    effects = [record.name for record in st.effects()]
    rows = [
        {
            "verdict": "missing_effect",
            "names": [name],
            "found": [{"name": name, "decided": True, "class": name, "classes": [name]}],
        }
        for name in effects * 10
    ]
    assert all(named(row) for row in rows)
    right = np.mean([named(row) for row in shuffled(rows)])
    assert right < 0.2
