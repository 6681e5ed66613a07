"""A controller answers the noise: what it does of its own accord is nothing that is missing."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from tests.blind.resolve import recorded
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_sessions

import stiction as st

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
    return recorded(made, SimpleNamespace(plant=st.Plant.from_dict(stated)), "cycle")


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
