"""Two causes at once: each makes the other's strength look uneven."""

from __future__ import annotations

import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_sessions

import stiction as st

# One seed in which the first cause is refused for its unevenness while the second one is missing.
CASES = {
    "hsieh_pan": (2040003, (("drive_deadband", 0.0116), ("warm_up", 0.0127))),
    "maxwell_slip": (2040004, (("position_dependent_friction", 0.012), ("torque_bias", 0.012))),
}


@pytest.mark.slow
@pytest.mark.parametrize("base", CASES)
def test_both_are_named(base: str) -> None:
    seed, hidden = CASES[base]
    (made,) = make_sessions([{"seed": seed, "base": base, "hidden": hidden}])
    found = st.diagnose(as_plant(made), as_session(made), surrogates=12)
    assert {cause.name for cause in found.effects} == {name for name, _ in hidden}
    assert found.verdict == "missing_effect"
    assert found.gain is not None
    assert found.gain.ci95[0] > 0.2
