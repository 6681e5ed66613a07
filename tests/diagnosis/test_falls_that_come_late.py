"""Friction that falls with speed, and late: one cause, where nothing in the plant falls yet."""

from __future__ import annotations

import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.data.evidence import Evidence
from stiction.diagnosis.screening.base import fit_baseline
from stiction.diagnosis.screening.candidates import candidates, scales_of
from stiction.diagnosis.screening.model import with_effect
from stiction.diagnosis.selection.eligible import eligible_candidates
from stiction.diagnosis.selection.search import Search
from stiction.diagnosis.selection.sharpen import _held

LAG_ALONE = {"fall": 0.0}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "size"),
    [(12340001, 0.0123), pytest.param(12340019, 0.01235, id="found as a fall and its lag")],
)
def test_a_fall_that_comes_late_is_one_cause(seed: int, size: float) -> None:
    """Beside a fall its lag was a relative, so that neither was sure."""
    made = make_session(seed, hidden=(("frictional_lag", size, {"fall": 1.0}),))
    found = st.diagnose(as_plant(made), as_session(made))
    (cause,) = found.effects
    assert cause.name == "frictional_lag"
    assert cause.decided
    assert "fall 1" in cause.what
    hidden = made.effects[0]
    for name, value in {"excess": hidden.amplitude, **hidden.shape}.items():
        if name in ("excess", "velocity", "time"):
            low, high = cause.parameters[f"effects.frictional_lag.{name}"].ci95
            assert low - 0.1 * value < value < high + 0.1 * value, name
    assert "stribeck" not in found.sentence


@pytest.mark.slow
def test_a_fall_that_is_never_late_is_stribeck() -> None:
    made = make_session(12340000, hidden=(("stribeck", 0.0125),))
    found = st.diagnose(as_plant(made), as_session(made))
    assert [(cause.name, cause.decided) for cause in found.effects] == [("stribeck", True)]


def test_no_friction_rises_from_rest_and_late() -> None:
    """Of another form of a cause a rise at the slowest speeds was left, and named beside it."""
    plant = st.Plant.from_dict(
        {"drive": {"input": "torque_nm", "gain": 1.0}, "friction": {"law": "coulomb"}}
    )
    record = next(each for each in st.effects() if each.name == "frictional_lag")
    made = make_session(3, base="coulomb", seconds=9.0)
    evidence = Evidence(plant, as_session(made).recordings)
    for candidate in candidates(record, scales_of(evidence, plant)):
        (bounds,) = candidate.bounds
        stated = with_effect(plant, candidate, [-0.2]).effects[-1].parameters
        assert (bounds[0] < 0.0) == (candidate.shape["fall"] == 0.0)
        assert (stated["excess"].value < 0.0) == (candidate.shape["fall"] == 0.0)


@pytest.mark.slow
def test_where_a_fall_is_stated_its_lag_is_found_alone() -> None:
    """A fall that comes late took over the one that the plant states, and left neither known."""
    made = make_session(12340003, base="coulomb", hidden=(("frictional_lag", 0.0125, LAG_ALONE),))
    table = as_plant(made).to_dict()
    stated = {**table, "effects": [{"name": "stribeck", "excess": 0.1, "velocity": 0.3}]}
    laws = {**table["friction"], "breakaway": 0.2, "stribeck_velocity": 0.1}
    for own in (stated, {**table, "friction": laws}):
        evidence, base = fit_baseline(st.Plant.from_dict(own), as_session(made).recordings)
        tried = eligible_candidates(evidence, base, (), Search([base]))
        assert {c.shape["fall"] for c in tried if c.name == "frictional_lag"} == {0.0}
    evidence, base = fit_baseline(as_plant(made), as_session(made).recordings)
    for without, forms in (((), {0.0, 1.0}), (("stribeck",), {0.0})):
        tried = eligible_candidates(evidence, base, without, Search([base]))
        assert {c.shape["fall"] for c in tried if c.name == "frictional_lag"} == forms


def test_a_form_is_chosen_and_never_fitted() -> None:
    record = next(each for each in st.effects() if each.name == "frictional_lag")
    assert _held(record) == ()
