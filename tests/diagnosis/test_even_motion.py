"""A controller answers the noise: what it does of its own accord is nothing that is missing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.blind.resolve import recorded
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_sessions

import stiction as st
from stiction.diagnosis.adequacy.coordinates import _asked
from stiction.residual.weak_form import WeakForm

# One seed: a machine that lacks nothing goes evenly, there and back, under its controller.
SEED = 10320000


def even_session() -> Any:
    (made,) = make_sessions([{"seed": SEED, "base": "maxwell_slip"}])
    body = {"inertia": float(made.plant["inertia"])}
    friction = {
        "law": "maxwell_slip",
        "coulomb": float(made.plant["coulomb"]),
        "initial_stiffness": 3.0 * float(made.plant["coulomb"] / made.plant["presliding"]),
        "viscous": float(made.plant["viscous"]),
    }
    stated = as_plant(made).to_dict() | {"body": body, "friction": friction}
    session = recorded(made, st.Plant.from_dict(stated), "cycle")
    first = next(k for k, each in enumerate(session.recordings) if each.cold)
    return replace(session, recordings=session.recordings[first:])


def test_only_a_reference_that_is_followed_takes_the_place_of_the_motion() -> None:
    (rec, *_) = as_session(even_session()).recordings
    asked = rec.channels["reference"]
    plant = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": 0.01},
            "friction": {"law": "maxwell_slip", "coulomb": 0.1, "initial_stiffness": 100.0},
        }
    )

    def looked(reference: Any) -> Any:
        known = {} if reference is None else {"reference": reference}
        made = st.Recording(rec.time, rec.input, rec.position, kind="cycle", **known)
        return _asked(made, WeakForm(plant, made), plant)

    found = looked(asked)
    assert found is not None
    form = WeakForm(plant, rec)
    velocity, acceleration, effort = found
    assert np.std(velocity - form.velocity) < 0.2 * np.std(form.velocity)
    assert np.std(acceleration) < np.std(form.acceleration)
    assert np.std(effort - form.measured_effort(plant)) < np.std(effort)
    # None, and that of another motion.
    for other in (None, -asked):
        assert looked(other) is None


@pytest.mark.slow
def test_what_a_controller_answers_to_noise_is_no_cause() -> None:
    made = even_session()
    found = st.diagnose(as_plant(made), as_session(made), threads=1)
    assert found.verdict == "nothing_missing"
    # Looked at by what was measured, speed and effort go with the noise that they answer.
    bare = [
        st.Recording(r.time, r.input, r.position, role=r.role, kind=r.kind, start_s=r.start_s)
        for r in as_session(made).recordings
    ]
    assert st.diagnose(as_plant(made), bare, threads=1).verdict == "unexplained"
