"""A plant that states another law than the machine has, and nothing beside it is missing."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis import verdict
from stiction.diagnosis.passing import MOMENTS
from stiction.diagnosis.result import Unexplained
from stiction.diagnosis.words import NO_COORDINATE


def test_only_what_the_law_lacks_is_named_of_a_machine_with_another_law() -> None:
    """`lugre` has no memory of reversals; what of the other curve follows other causes is none."""
    made = make_session(601, base="maxwell_slip")
    drive, sensor = as_plant(made).to_dict()["drive"], as_plant(made).to_dict()["sensor"]
    plant = st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": drive,
            "friction": {"law": "lugre"},
            "sensor": sensor,
        }
    )
    found = st.diagnose(plant, as_session(made))
    assert [cause.name for cause in found.effects if cause.decided] == ["reverse_point_memory"]
    assert found.verdict in ("ambiguous", "unexplained")
    assert all(f"perhaps {c.name}" in found.sentence for c in found.effects if not c.decided)


@pytest.mark.parametrize(
    ("coordinate", "share", "little"),
    [
        # The first took 80 of 100, the second 8, and 12 are left.
        (NO_COORDINATE, 0.9, [False, True]),
        ("effort", 0.4, [False, True]),
        ("effort", 0.2, [False, False]),
        # What stands out in some rows says nothing of the others.
        (MOMENTS.name, 0.9, [False, False]),
        ("third alone", 0.9, [False, False]),
    ],
)
def test_a_name_that_took_less_than_twice_what_is_left_is_not_decided(
    coordinate: str, share: float, little: list[bool]
) -> None:
    models = [SimpleNamespace(blocks=(None, np.full(4, p))) for p in (25.0, 5.0, 3.0)]
    selection: Any = SimpleNamespace(models=models)
    assert verdict.outweighed(selection, [Unexplained(coordinate, share)]) == little
    assert verdict.outweighed(selection, []) == [False, False]
