"""The base of a diagnosis: the same machine as a fit finds, wherever it sees the same rows."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stiction as st
from stiction.diagnosis.screening.base import fit_baseline
from stiction.fitting.forms import horizon_of
from stiction.fitting.rows import Nuisances, Rows
from stiction.fitting.solve import SELECT_IS_FITTED
from stiction.residual.weak_form import WeakForm

DT, ROWS = 1e-3, 5000


def recorded(seed: int, **labels: object) -> st.Recording:
    """A machine of the core, moved by sines: what is compared is two ways to one fit."""
    source = np.random.default_rng(seed)
    time = np.arange(ROWS) * DT
    waves = [0.25 * np.sin(w * time + source.uniform(0, 6)) for w in (2.0, 5.3, 13.0)]
    effort = np.sum(waves, axis=0)
    friction = st.FrictionModel("maxwell_slip", coulomb=0.25, viscous=0.02, initial_stiffness=300.0)
    motor = st.Motor(0.006, friction=friction, effects={"torque_bias": {"bias": 0.02}})
    position = np.concatenate([[0.0], motor.simulate(effort[:-1], DT).position])
    count = 2.0 * math.pi / 2**18
    measured = effort + 0.004 * source.standard_normal(len(time))
    return st.Recording(time, measured, np.round(position / count) * count, **labels)


def plant(law: str) -> st.Plant:
    return st.Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": {"law": law}})


@pytest.mark.parametrize("law", ["coulomb", "maxwell_slip"])
def test_fit_and_diagnosis_find_one_machine_on_the_same_rows(law: str) -> None:
    session = [recorded(k, role=role) for k, role in enumerate(("train", "train", "test"))]
    fitted = st.fit(plant(law), session)
    _, base = fit_baseline(plant(law), session)
    assert base.plant == fitted.plant


def test_both_leave_out_a_recording_with_a_fault_and_say_so() -> None:
    good = [recorded(k, role="train", kind=f"{k}") for k in range(3)]
    still = replace_position(good[2], np.zeros(ROWS))
    fitted = st.fit(plant("coulomb"), [*good[:2], still, recorded(9, role="test")])
    _, base = fit_baseline(plant("coulomb"), [*good[:2], recorded(9, role="test")])
    assert base.plant == fitted.plant
    assert "1 recording is left out: recording 3" in fitted.split
    assert "test: recording 4" in fitted.split


def replace_position(recording: st.Recording, position: np.ndarray) -> st.Recording:
    return st.Recording(recording.time, recording.input, position, role="train", kind="2")


def test_a_contact_that_rings_faster_than_the_samples_is_not_simulated() -> None:
    friction = {"law": "maxwell_slip", "coulomb": 0.25, "viscous": 0.02}
    source = np.random.default_rng(3)
    for stiffness, rings_slowly in ((1e3, True), (1e9, False)):
        stated = st.Plant.from_dict(
            {
                "drive": {"input": "torque_nm"},
                "body": {"inertia": 0.006},
                "friction": {**friction, "initial_stiffness": stiffness},
            }
        )
        form = WeakForm(stated, recorded(0))
        form.count = 1e-2
        mask = np.ones(len(form), dtype=bool)
        rows = Rows(stated, form, 0, mask)
        left = source.standard_normal(len(form))
        rows.residual = lambda *_, left=left: left  # type: ignore[method-assign]
        horizon = horizon_of(stated, Nuisances(), [rows], [form])
        assert (horizon is not None) == rings_slowly


def test_where_they_must_differ_both_say_so() -> None:
    session = [recorded(k, role=role) for k, role in enumerate(("train", "select", "test"))]
    assert SELECT_IS_FITTED in st.fit(plant("coulomb"), session).split
    found = st.diagnose(plant("coulomb"), session, surrogates=4)
    assert "stiction fit" in found.split
    assert any("stiction fit" in rule for rule in found.data["split"]["rules"])
    less = [session[0], replace_role(session[1], "train"), session[2]]
    assert SELECT_IS_FITTED not in st.fit(plant("coulomb"), less).split


def replace_role(recording: st.Recording, role: str) -> st.Recording:
    return st.Recording(recording.time, recording.input, recording.position, role=role)


@pytest.mark.parametrize("law", ["coulomb", "maxwell_slip"])
def test_a_plant_of_which_all_is_known_is_diagnosed_as_it_is(law: str) -> None:
    """A fit of it has nothing to do; what it lacks may be asked all the same."""
    known = {"coulomb": 0.25, "viscous": 0.02}
    if law == "maxwell_slip":
        known["initial_stiffness"] = 300.0
    named = plant(law).friction.record.parameters
    known |= {p.name: p.default for p in named if p.name not in known and not p.optional}
    fixed = {name: {"value": value, "fixed": True} for name, value in known.items()}
    whole = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": {"value": 1.0, "fixed": True}},
            "body": {"inertia": {"value": 0.006, "fixed": True}},
            "friction": {"law": law, **fixed},
        }
    )
    session = [recorded(k, role=role) for k, role in enumerate(("train", "train", "select"))]
    _, base = fit_baseline(whole, session)
    assert base.plant.parameters["friction.coulomb"].value == 0.25
    if law == "coulomb":
        assert not base.solution.variables.paths
        with pytest.raises(st.InputError, match="every parameter is fixed"):
            st.fit(whole, session)
