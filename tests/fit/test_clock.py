"""A fitted plant can be simulated at the clock of its recordings."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction.fitting.clock import bounded_plants, follows
from stiction.fitting.rows import Rows, rows_of
from stiction.recording import Part
from stiction.residual.weak_form import WeakForm

DT = 1e-3


class Told(Rows):
    """Rows that leave what a plant tells, of samples of 1 ms."""

    def __init__(self, left: Callable[[st.Plant], float]) -> None:
        time = DT * np.arange(1000)
        machine = plant(1e-3, 0.01)
        form = WeakForm(machine, st.Recording(time, np.cos(time), np.sin(time)))
        super().__init__(machine, form, 0, np.ones(len(form), dtype=bool))
        self.left = left

    def residual(self, plant: st.Plant, nuisances: Any) -> Any:
        return np.full(len(self.mask), self.left(plant))


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
    assert bounded_plants(well, PATHS, rows, NONE) == []


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
    found, *_ = bounded_plants(stiff, PATHS, rows, NONE)
    assert follows(found, rows)
    own, other = found.parameters[moved], found.parameters[stays]
    assert own.value in (own.min, own.max)
    assert other == stiff.parameters[stays]


def test_a_contact_too_stiff_and_too_damped_gives_way_as_a_whole() -> None:
    law = {"law": "elasto_plastic", "initial_stiffness": 3e10, "damping": 40.0}
    table = {"drive": {"input": "torque_nm", "gain": 1.0}, "body": {"inertia": 1e-3}}
    stiff = st.Plant.from_dict({**table, "friction": law})
    rows: Any = [Told(lambda plant: 1.0 if plant.inertia == stiff.inertia else 1e9)]
    assert not follows(stiff, rows, ease=1.0)
    first, *_ = bounded_plants(stiff, ("body.inertia", "friction.damping"), rows, NONE)
    assert follows(first, rows)
    assert first.inertia == stiff.inertia


def test_what_leaves_no_numbers_is_none() -> None:
    stiff = plant(1e-12, 3000.0)
    rows: Any = [Told(lambda plant: 1.0 if plant == stiff else np.nan)]
    assert bounded_plants(stiff, PATHS, rows, NONE) == []


def test_rows_that_see_a_long_gap_are_left_out() -> None:
    time = np.arange(3000) * 1e-3
    stamps = time + 0.2 * (time > 1.5)
    position = np.sin(2.0 * np.pi * time)
    plant = st.Plant.from_dict(
        {"drive": {"input": "torque_nm", "gain": 1.0}, "friction": {"law": "coulomb"}}
    )

    def kept(stamps: np.ndarray) -> tuple[np.ndarray, float]:
        recording = st.Recording(stamps, np.cos(time), position)
        form = WeakForm(plant, recording)
        mask = rows_of(form, recording, 0, [Part(0, 0, len(stamps))])
        return form.time[mask], form.kernel.support

    even, _ = kept(time)
    broken, support = kept(stamps)
    assert np.max(np.diff(even)) < 2e-3
    inside = (broken > 1.5 - 0.49 * support) & (broken < 1.7 + 0.49 * support)
    assert not np.any(inside)
    # And no more than a kernel on either side.
    assert np.any((broken > 1.5 - support) & (broken < 1.5))
    assert np.any((broken > 1.7) & (broken < 1.7 + support))
