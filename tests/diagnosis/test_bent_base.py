"""A base without an effect bends itself towards it, and a refit that begins there is caught."""

from __future__ import annotations

import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_sessions

import stiction as st
from stiction.diagnosis.base import based

# One seed in which the elements that yield first vanish from the base: small efforts move nothing.
HIDDEN = ("drive_deadband", 0.0129)
SPEC = {"seed": 5810023, "base": "maxwell_slip", "hidden": (HIDDEN,)}


def test_an_effect_towards_which_the_base_has_bent_itself_is_found() -> None:
    (made,) = make_sessions([SPEC])
    plant, session = as_plant(made), as_session(made)
    _, base = based(plant, session.recordings)
    assert base.plant.parameters["friction.weight_2"].value < 0.1  # the bend
    found = st.diagnose(plant, session, surrogates=12)
    assert [cause.name for cause in found.effects] == [HIDDEN[0]]
    width = found.effects[0].parameters["effects.drive_deadband.deadband"]
    assert width.value == pytest.approx(made.effects[0].amplitude, rel=0.1)
    assert found.gain is not None
    assert found.gain.ci95[0] > 0.2
