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


@cache
def null_sessions() -> Sequence[Any]:
    made: Sequence[Any] = make_sessions([{"seed": s, "seconds": SECONDS} for s in NULL_SEEDS])
    return made


def names_in(sessions: Sequence[Any]) -> list[str]:
    found = [
        st.diagnose(as_plant(made), as_session(made), surrogates=SURROGATES) for made in sessions
    ]
    return [cause.name for diagnosis in found for cause in diagnosis.effects]


def test_without_calibration_noise_gets_names(monkeypatch: pytest.MonkeyPatch) -> None:
    assert names_in(null_sessions()) == []
    uncalibrated(monkeypatch.setattr)
    assert names_in(null_sessions()) != []


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
