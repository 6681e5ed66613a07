"""A plant that states another law than the machine has, and nothing beside it is missing."""

from __future__ import annotations

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.diagnosis.builders import cause, model, number, search
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.adequacy.passing import MOMENTS
from stiction.diagnosis.phrases import NO_COORDINATE
from stiction.diagnosis.records import Cause, Unexplained
from stiction.diagnosis.selection import left_open


def test_only_what_the_law_lacks_is_named_of_a_machine_with_another_law() -> None:
    """`lugre` has no memory of reversals; what of the other curve follows other causes is none."""
    made = make_session(601, base="maxwell_slip")
    drive, sensor = as_plant(made).to_dict()["drive"], as_plant(made).to_dict()["sensor"]
    plant = st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": drive,
            "friction": {"law": "lugre"},
            "sensor": sensor,
        }
    )
    found = st.diagnose(plant, as_session(made))
    assert [cause.name for cause in found.effects if cause.decided] == ["reverse_point_memory"]
    assert found.verdict in ("ambiguous", "unexplained")
    reasons = {row.name: row.reason for row in found.candidates}
    for each in found.effects[1:]:
        assert not each.decided
        either = {0: "perhaps", 1: "either"}.get(len(each.look_alikes), "one of")
        assert f"{either} {each.name}" in found.sentence
        assert "left without a name" in reasons[each.name]


@pytest.mark.parametrize(
    ("coordinate", "share", "little"),
    [
        # The first took 80 of 100, the second 8, and 12 are left.
        (NO_COORDINATE, 0.9, {"second"}),
        ("effort", 0.4, {"second"}),
        ("effort", 0.2, set()),
        # What stands out in some rows says nothing of the others.
        (MOMENTS.name, 0.9, set()),
        ("third alone", 0.9, set()),
    ],
)
def test_a_name_that_took_less_than_twice_what_is_left_is_not_decided(
    coordinate: str, share: float, little: set[str]
) -> None:
    models = [model(blocks=(np.ones(4), np.full(4, p))) for p in (25.0, 5.0, 3.0)]
    selection = search("first", "second", models=models)
    assert left_open.outweighed_names(selection, [Unexplained(coordinate, share)]) == little
    assert left_open.outweighed_names(selection, []) == set()


@pytest.mark.parametrize(("strength", "sure"), [(60.0, True), (5.0, False)])
def test_a_name_of_which_no_number_is_known_is_decided_by_its_strength_alone(
    strength: float, sure: bool
) -> None:
    def known_to(name: str, *intervals: tuple[float, float]) -> Cause:
        numbers = {f"effects.{name}.{k}": number(ci95=each) for k, each in enumerate(intervals)}
        return cause(name, parameters=numbers)

    open_, known = (-1.0, 2.0), (1.0, 2.0)
    first = known_to("creep_hardening", open_, open_)
    second = known_to("torque_bias", known)
    third = known_to("drive_deadband", open_)
    fourth = known_to("cogging", open_, known)
    causes = [first, second, third, fourth, known_to("warm_up", open_, open_)]
    strengths = {"creep_hardening": strength, "drive_deadband": 5.0, "warm_up": 60.0}
    names = [each.name for each in causes]
    selection = search(*names, models=[model(strength=strengths)])
    found = left_open.leave_zero_open(selection, causes)
    assert [each.decided for each in found] == [sure, True, False, True, True]


def test_a_gain_that_all_else_makes_up_for_is_sure_by_no_strength() -> None:
    """Blocks know nothing of what the fit cannot tell: no interval of it ends."""
    parameters = {"effects.warm_up.coulomb": number(ci95=(-np.inf, np.inf))}
    selection = search("warm_up", models=[model(strength={"warm_up": 60.0})])
    found = left_open.leave_zero_open(selection, [cause("warm_up", parameters=parameters)])
    assert [each.decided for each in found] == [False]


def test_a_known_speed_says_nothing_of_the_strength() -> None:
    def lag(excess: tuple[float, float]) -> Cause:
        numbers = {
            "effects.frictional_lag.excess": number(ci95=excess),
            "effects.frictional_lag.velocity": number(ci95=(1.0, 1.1)),
            "effects.frictional_lag.time": number(ci95=(0.6, 1.2)),
        }
        return cause("frictional_lag", parameters=numbers)

    assert lag((-3.9, 12.5)).doubtful
    assert not lag((3.9, 12.5)).doubtful
