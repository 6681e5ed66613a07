"""A contact that yields up to its friction and never breaks away is found from the data alone."""

from __future__ import annotations

import numpy as np
import pytest
from tests.reference.hsieh_pan_reference import follow_motion

import stiction as st
from stiction.fitting.start import complete, yielding_starts
from stiction.residual.weak_form import WeakForm

DT = 0.01
NOISE = 0.005
# What a fit leaves of the effort at most: starts that break away at every reversal left 5 to 10 %.
LEFT = 0.02
YIELDING = {
    "one that creeps on": {"hardening_coefficient": 1.4e-3, "creep_rate": 2e-3},
    "one that does not creep": {"hardening_coefficient": 1e-9, "creep_rate": 2.0},
    "a soft one": {
        "initial_stiffness": 8e5,
        "final_stiffness": 5e3,
        "decay_distance": 1e-3,
        "hardening_coefficient": 1e-3,
        "hardening_exponent": 1.5,
        "creep_rate": 5e-4,
        "damping": 1000.0,
    },
}
USUAL = {
    "initial_stiffness": 3.6e6,
    "final_stiffness": 1e4,
    "decay_distance": 3.2e-4,
    "hardening_exponent": 1.25,
    "damping": 5200.0,
}


def plant(**stated: float) -> st.Plant:
    return st.Plant.from_dict(
        {
            "motion": {"kind": "linear"},
            "drive": {"kind": "prescribed_motion"},
            "friction": {"law": "hsieh_pan", **stated},
        }
    )


def moved(**contact: float) -> st.Recording:
    """A damper that is moved, and the force that it takes."""
    time = DT * np.arange(1000)
    position = sum(0.004 * np.sin(2 * np.pi * f * time + f) for f in (0.5, 1.3, 2.9))
    found = follow_motion(np.diff(position) / DT, DT, step=1e-3, **{**USUAL, **contact})
    force = np.concatenate([[0.0], found.friction])
    size = NOISE * float(np.sqrt(np.mean(force**2)))
    noise = size * np.random.default_rng(0).standard_normal(len(time))
    return st.Recording(time, None, position, effort=force + noise)


@pytest.mark.parametrize("contact", YIELDING)
def test_a_contact_that_never_breaks_away_is_fitted_from_its_law_alone(contact: str) -> None:
    found = st.fit(plant(), moved(**YIELDING[contact]))
    assert found.train_relative < LEFT
    assert found.heldout_relative is not None
    assert found.heldout_relative < LEFT


def test_what_is_stated_of_break_away_or_stiffness_stays() -> None:
    form = WeakForm(plant(), moved(**YIELDING["a soft one"]))
    assert len(yielding_starts(plant(), complete(plant(), [form]), [form])) == 1
    for stated in ({"breakaway": 500.0}, {"initial_stiffness": 1e6}, {"final_stiffness": 1e3}):
        own = plant(**stated)
        assert yielding_starts(own, complete(own, [form]), [form]) == []
