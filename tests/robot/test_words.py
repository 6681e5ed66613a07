"""The lines that tell of a robot: one for each joint."""

from __future__ import annotations

from typing import Any, cast

import pytest
from tests.report.canned import diagnosis

from stiction.robot.agreement import Agreement
from stiction.robot.result import JointFindings, RobotDiagnosis


def told(reasons: tuple[str, ...] = ()) -> list[str]:
    joints = [("shoulder", "ambiguous"), ("elbow", "missing_effect"), ("wrist", "unexplained")]
    apart = [Agreement("elbow", "coulomb", "N·m", (), False, 3.0, reason) for reason in reasons]
    found = [JointFindings(name, name, diagnosis(cast(Any, kind))) for name, kind in joints]
    return str(RobotDiagnosis(cast(Any, None), tuple(found), tuple(apart))).splitlines()


def test_each_joint_has_its_verdict_its_effects_and_which_are_undecided() -> None:
    sentence, _, shoulder, elbow, wrist = told()
    assert "shoulder lacks torque_bias (undecided)" in sentence
    assert "elbow lacks torque_bias;" in sentence
    assert shoulder.startswith("shoulder  ambiguous: torque_bias (undecided); error of held-out")
    assert elbow.startswith("elbow     missing effect: torque_bias; error of held-out torque ")
    assert wrist.startswith("wrist     unexplained remainder")
    assert "nothing" not in "".join(told())


@pytest.mark.parametrize(
    ("reasons", "line"),
    [
        (("warmer",), "1 of 1 parameter differs between recordings; the page says why."),
        (
            ("warmer", ""),
            "2 of 2 parameters differ between recordings; for 1 of them the data show no reason.",
        ),
    ],
)
def test_what_differs_between_recordings_is_one_line(reasons: tuple[str, ...], line: str) -> None:
    assert told(reasons)[-1] == line
