"""A fitted plant can be simulated at the clock of its recordings."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction.fitting.clock import bounded, follows

DT = 1e-3


class Told:
    """Rows that leave what a plant tells, of samples of 1 ms."""

    def __init__(self, left: Any) -> None:
        self.left, self.weight, self.mask = left, 1.0, np.ones(4, dtype=bool)
        self.form = SimpleNamespace(dt=DT)

    def residual(self, plant: st.Plant, nuisances: Any) -> Any:
        return np.full(4, self.left(plant))


def plant(inertia: float, viscous: float) -> st.Plant:
    return st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm"},
            "body": {"inertia": inertia},
            "friction": {"law": "coulomb", "coulomb": 0.1, "viscous": viscous},
        }
    )


NONE: Any = None
PATHS = ("body.inertia", "friction.viscous")


def test_what_samples_can_follow_stays_as_it_is() -> None:
    rows: Any = [Told(lambda plant: 1.0)]
    well = plant(1e-3, 0.01)
    assert follows(well, rows)
    assert bounded(well, PATHS, rows, NONE) == []


@pytest.mark.parametrize(
    ("shows", "moved", "stays"),
    [
        ("viscous", "body.inertia", "friction.viscous"),
        ("inertia", "friction.viscous", "body.inertia"),
    ],
)
def test_the_number_that_the_data_do_not_show_gives_way(shows: str, moved: str, stays: str) -> None:
    stiff = plant(1e-12, 3000.0)

    def left(other: st.Plant) -> float:
        own = other.inertia if shows == "inertia" else other.parameters["friction.viscous"].value
        true = stiff.inertia if shows == "inertia" else 3000.0
        return 1.0 + abs(np.log(own / true))

    rows: Any = [Told(left)]
    assert not follows(stiff, rows)
    found, *_ = bounded(stiff, PATHS, rows, NONE)
    assert follows(found, rows)
    own, other = found.parameters[moved], found.parameters[stays]
    assert own.value in (own.min, own.max)
    assert other == stiff.parameters[stays]


def test_what_leaves_no_numbers_is_none() -> None:
    stiff = plant(1e-12, 3000.0)
    rows: Any = [Told(lambda plant: 1.0 if plant == stiff else np.nan)]
    assert bounded(stiff, PATHS, rows, NONE) == []
