"""What holds a machine that rests under its weight."""

from dataclasses import replace

import numpy as np
import pytest
from tests.reference.pendulum_reference import DRY, WEIGHT, swung

import stiction as st
from stiction.diagnosis.adequacy.holds import holds_of
from stiction.diagnosis.screening.base import fit_baseline
from stiction.plant import Plant

TORQUE = 0.8


def pendulum(**weight):
    return Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {
                "gravity_amplitude": weight or 1.0,
                "gravity_zero_rad": {"value": 0.0, "fixed": True},
            },
            "friction": {"law": "coulomb"},
        }
    )


def moved(roles):
    return [swung(seed, role=role, seconds=8.0) for seed, role in enumerate(roles, 1)]


@pytest.fixture(scope="module")
def session():
    swings = moved(("train", "train", "train", "select", "select", "test"))
    return st.Session([*swings, swung(7, parked=TORQUE, role="train", seconds=9.0)])


def holds(found):
    return [check for check in found.data["checks"] if check["name"] == "hold"]


def test_a_rest_under_a_weight_is_told_with_what_balances_there(session):
    found = st.diagnose(pendulum(), session, threads=1)
    (hold,) = holds(found)
    assert hold["recording"] == "recording 7"
    assert hold["verdict"] == "note"
    more = abs(WEIGHT * np.sin(session.recordings[6].position[-1]) - TORQUE)
    assert f"the drive gives {TORQUE:.3g} N·m" in hold["what"]
    assert float(hold["what"].split("hold up to ")[1].split()[0]) == pytest.approx(more, abs=0.01)
    assert float(hold["what"].split("slides at ")[1].split()[0]) == pytest.approx(DRY, abs=0.01)
    assert "stands still there as the machine does" in hold["means"]


def told(plant, session):
    evidence, base = fit_baseline(plant, session.recordings)
    return holds_of(evidence.shown, base, evidence.names)


def test_a_weight_that_is_stated_wrong_shows_in_what_friction_would_have_to_hold(session):
    plant = pendulum(value=0.5 * WEIGHT, fixed=True)
    known = Plant.from_dict(
        {
            **plant.to_dict(),
            "friction": {"law": "coulomb", "coulomb": {"value": DRY, "fixed": True}},
        }
    )
    ((name, hold),) = told(known, session)
    assert name == "recording 7"
    assert "the friction of this plant holds less" in hold.means
    assert hold.try_


def test_a_rest_is_told_where_there_is_a_weight(session):
    plant = pendulum()
    body = {k: v for k, v in plant.body.items() if not k.startswith("gravity")}
    assert told(plant, session)
    assert told(replace(plant, body=body), session) == []
