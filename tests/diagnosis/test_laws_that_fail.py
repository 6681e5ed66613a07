"""A law that cannot be compared is an entry with its reason, and never the end of the answer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction.diagnosis.data.evidence import Cells
from stiction.diagnosis.data.gain import MOST_LEFT, HeldOut, gain_of
from stiction.diagnosis.selection import laws
from stiction.errors import InputError
from stiction.fitting.variables import Variables


def machine(**friction: float) -> st.Plant:
    return st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm"},
            "body": {"inertia": 0.5},
            "friction": {"law": "load_dependent", **friction},
        }
    )


def recorded(plant: st.Plant, seconds: float) -> st.Recording:
    """A slow direct drive."""
    dt = 2e-3
    time = np.arange(0.0, seconds, dt)
    effort = 3.0 * np.sin(2.0 * np.pi * 0.4 * time) + np.sin(2.0 * np.pi * 1.3 * time)
    position = np.append(0.0, plant.simulate(effort[:-1], dt).position)
    return st.Recording(time, effort, position, kind="sines")


def test_levels_of_0_are_shares_of_one_another_and_numbers() -> None:
    plant = machine(coulomb=0.0, breakaway=0.0)
    variables = Variables.of(plant, ("friction.coulomb", "friction.breakaway"))
    for levels in ([0.0, 0.0], [0.1, 0.2], [0.0, 0.2]):
        vector = variables.vector(np.array(levels))
        low, high = variables.bounds()
        assert np.all((low <= vector) & (vector <= high))
        assert variables.values(vector) == pytest.approx(levels, abs=1e-3)


def test_a_plant_whose_levels_are_0_can_be_fitted() -> None:
    given = machine(coulomb=0.0, breakaway=0.0, stribeck_velocity=0.1, viscous=0.3)
    found = st.fit(given, recorded(given, 4.0))
    assert found.success
    assert found.parameters["friction.viscous"].value == pytest.approx(0.3, rel=1e-3)


@pytest.fixture(scope="module")
def session() -> st.Session:
    """Friction that the effort alone makes: the level of the right law comes out as 0."""
    plant = machine(coulomb=0.0, drive=0.1, viscous=0.3)
    return st.Session([recorded(plant, 12.0)])


def coulomb() -> st.Plant:
    return st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm"},
            "friction": {"law": "coulomb"},
        }
    )


def entry(session: st.Session) -> Any:
    found = st.diagnose(coulomb(), session, surrogates=4, laws=("load_dependent",))
    assert found.baseline is not None
    (row,) = (row for row in found.laws if row.law == "load_dependent")
    return row


def test_a_law_whose_level_comes_out_as_0_is_compared(session: st.Session) -> None:
    assert entry(session).reason.startswith(("explains", "fitted"))


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        (InputError("plant: friction.coulomb: nan is not a number"), "nan is not a number"),
        (IndexError("a fault of its own"), "IndexError: a fault of its own"),
    ],
)
def test_a_law_that_fails_is_an_entry_with_its_reason(
    fault: Exception,
    reason: str,
    session: st.Session,
    monkeypatch: pytest.MonkeyPatch,
    left_out: list[str],
) -> None:
    def fails(*_: object) -> None:
        raise fault

    monkeypatch.setattr(laws, "_fitted", fails)
    row = entry(session)
    assert row.gain is None
    assert row.reason.startswith("could not be fitted to these data: ")
    assert reason in row.reason
    # What a law cannot do with these data is said where it is asked for; a fault is logged.
    logged = any("comparison with load_dependent" in sentence for sentence in left_out)
    assert logged is not isinstance(fault, InputError)


def test_a_gain_is_a_finite_number_whatever_runs_away() -> None:
    block = np.repeat(np.arange(20), 50)
    before = np.where(block < 1, 1.0, 0.0)
    cells = Cells(block, np.zeros_like(block), np.zeros_like(block), ("sines",))
    for most in (1e6, MOST_LEFT):
        residuals = (before, np.full(len(block), most))
        held = HeldOut(residuals, np.ones(len(block)), before, cells, ())
        found = gain_of(held, 0, 1, 0)
        assert np.all(np.isfinite([found.value, *found.ci95]))
        assert found.value < 0.0
