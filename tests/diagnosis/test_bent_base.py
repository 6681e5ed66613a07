"""Refits that begin where a base without the effect stands, and would be caught there."""

from __future__ import annotations

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_sessions

import stiction as st
from stiction.diagnosis.screening.base import fit_baseline
from stiction.diagnosis.screening.model import step_beside

# One seed in which the elements that yield first vanish from the base: small efforts move nothing.
HIDDEN = ("drive_deadband", 0.0129)
SPEC = {"seed": 5810023, "base": "maxwell_slip", "hidden": (HIDDEN,)}


@pytest.mark.slow
def test_an_effect_towards_which_the_base_has_bent_itself_is_found() -> None:
    (made,) = make_sessions([SPEC])
    plant, session = as_plant(made), as_session(made)
    _, base = fit_baseline(plant, session.recordings)
    assert base.plant.parameters["friction.weight_2"].value < 0.1  # the bend
    found = st.diagnose(plant, session, surrogates=12)
    assert [cause.name for cause in found.effects] == [HIDDEN[0]]
    width = found.effects[0].parameters["effects.drive_deadband.deadband"]
    assert width.value == pytest.approx(made.effects[0].amplitude, rel=0.1)
    assert found.gain is not None
    assert found.gain.ci95[0] > 0.2


@pytest.mark.slow
def test_a_base_at_a_kink_keeps_no_cause_from_being_found() -> None:
    """On hsieh_pan a base may end where it does not follow once the effect is there."""
    hidden = (("position_dependent_friction:foreign", 0.01495),)
    (made,) = make_sessions([{"seed": 7720018, "base": "hsieh_pan", "hidden": hidden}])
    found = st.diagnose(as_plant(made), as_session(made))
    assert [cause.name for cause in found.effects] == ["position_dependent_friction"]
    assert found.gain is not None
    assert found.gain.value > 0.7


@pytest.mark.slow
def test_a_shape_far_from_every_signature_is_no_freed_base() -> None:
    """Signatures of a lag end at usual speeds; of this one they explain a fifth of what it does."""
    hidden = (("frictional_lag", 0.013034, {"fall": 0.0}),)
    (made,) = make_sessions([{"seed": 10520001, "base": "coulomb", "hidden": hidden}])
    found = st.diagnose(as_plant(made), as_session(made))
    assert [cause.name for cause in found.effects] == ["frictional_lag"]
    assert found.gain is not None
    assert found.gain.value > 0.7


def test_what_nothing_explains_moves_no_base() -> None:
    (made,) = make_sessions([{"seed": 7720000, "base": "hsieh_pan", "seconds": 78.0}])
    _, base = fit_baseline(as_plant(made), as_session(made).recordings)
    rows = len(base.residual)
    for path, given in step_beside(base, np.zeros(rows)).parameters.items():
        assert given.value == pytest.approx(base.plant.parameters[path].value, rel=1e-12)
    # What is explained in its place by something else it gives up, but for what damping keeps.
    place = list(base.solution.variables.paths).index("friction.viscous")
    column = base.columns.matrix()[:, place]
    before = base.plant.parameters["friction.viscous"].value
    moved = step_beside(base, 0.01 * before * column).parameters["friction.viscous"].value
    assert 1.005 * before < moved < 1.01 * before
