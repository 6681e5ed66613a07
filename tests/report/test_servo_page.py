"""Nobody measures the effort of a servo: its report shows the motion, and errors of its loop."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from tests.plant.test_servo import plant, session
from tests.reference.servo_reference import Servo

import stiction as st
from stiction.diagnosis import Diagnosis
from stiction.report import write


@pytest.fixture(scope="module")
def late() -> Diagnosis:
    """A servo of which the goal comes late."""
    return st.diagnose(plant(), session(Servo(late=6)), surrogates=8)


@pytest.mark.long
def test_the_page_of_a_servo_claims_no_measured_effort(late: Diagnosis, tmp_path: Path) -> None:
    text = write(late, tmp_path).read_text("utf-8")
    assert "measured effort" not in text.lower()
    assert "% of the effort" not in text
    assert "Position error of the simulated loop" in text
    assert "measured position" in text


def test_errors_of_a_servo_are_those_of_its_loop(late: Diagnosis) -> None:
    before = late.baseline
    assert before is not None
    assert before.replay is not None
    assert before.replay.heldout_rms is not None
    assert before.heldout_rms is not None
    assert before.stiffness is not None
    assert before.heldout_rms / before.stiffness == pytest.approx(before.replay.heldout_rms, 0.05)
    assert before.heldout_relative is not None
    assert 0.0 < before.heldout_relative < 1.0
    assert "effort error" not in str(late)
    assert "% of the motion" in str(late)


@pytest.mark.long
def test_a_fit_of_a_servo_tells_the_error_of_its_position() -> None:
    found = st.fit(plant(), session(Servo()))
    assert "effort error" not in str(found)
    assert "rad rms, r²" in str(found)
    assert "r²" not in str(replace(found, r2=-28863.0))
    assert "worse than a constant position" in str(replace(found, r2=-28863.0))
    assert "2e+04 times the motion" in str(replace(found, train_relative=2e4))
