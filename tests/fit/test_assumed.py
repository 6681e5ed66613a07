"""A gain that nobody stated is said wherever results are shown."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from tests.reference.coulomb_reference import simulate_coulomb

import stiction as st
from stiction.report.fit_page import fit_page

SENTENCE = (
    "[drive] gain is not stated: every effort, friction and inertia is in A and not in N·m, until "
    "you state the N·m/A"
)


@cache
def recording() -> st.Recording:
    rng = np.random.default_rng(1)
    time = np.arange(9000) * 1e-3
    effort = sum(0.45 * np.sin(2 * np.pi * f * time + rng.uniform(0, 6)) for f in (0.4, 1.1, 2.3))
    run = simulate_coulomb(effort[:-1], 1e-3, inertia=0.0076, coulomb=0.3, breakaway=0.3)
    noise = 2e-3 * rng.standard_normal(len(time))
    position = np.round(np.concatenate([[0.0], run["position"]]) / 2e-5) * 2e-5
    return st.Recording(time, effort + noise, position)


def plant(**drive: object) -> st.Plant:
    table = {"body": {"inertia": 0.007}, "friction": {"law": "coulomb"}}
    return st.Plant.from_dict({**table, "drive": drive} if drive else table)


def test_a_gain_that_is_not_stated_is_said_with_a_fit() -> None:
    found = st.fit(plant(input="current_a"), recording())
    assert found.assumed == (SENTENCE,)
    assert SENTENCE in str(found)
    assert SENTENCE in fit_page(found, [recording()], "Fit")
    assert found.to_dict()["assumed"] == [SENTENCE]
    assert found.unit == "A"
    assert found["inertia"].unit == "A·s²/rad"
    assert found["viscous"].unit == "A·s/rad"
    assert "N·m" not in str(found).replace(SENTENCE, "")


@pytest.mark.parametrize(
    "drive", [{"input": "current_a", "gain": 1.0}, {"input": "torque_nm"}, {}], ids=str
)
def test_nothing_is_said_of_a_gain_that_is_stated_or_needs_none(drive: dict[str, object]) -> None:
    found = st.fit(plant(**drive), recording())
    assert found.assumed == ()
    assert (found.unit, found["inertia"].unit) == ("N·m", "kg·m²")


def test_a_column_in_amperes_tells_where_the_plant_does_not(tmp_path) -> None:
    file = tmp_path / "run.csv"
    table = np.column_stack([recording().time, recording().input, recording().position])
    np.savetxt(
        file, table, delimiter=",", header="time_s,current_a,position_rad", comments="", fmt="%.9g"
    )
    assert st.fit(plant(), st.Recording.load(file)).assumed == (SENTENCE,)


def test_a_gain_that_is_not_stated_is_said_with_a_diagnosis(tmp_path) -> None:
    without = [effect.name for effect in st.effects()][1:]
    found = st.diagnose(plant(input="current_a"), recording(), without=without, surrogates=4)
    assert found.baseline is not None
    assert SENTENCE in found.baseline.remarks
    assert SENTENCE in str(found)
    assert SENTENCE in found.save(tmp_path).read_text(encoding="utf-8")
