"""A number of the plant file that is held at a wrong value is told, and no cause stands for it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from tests.blind.score import as_plant, as_session
from tests.diagnosis import builders
from tests.reference.session_reference import make_sessions

import stiction as st
from stiction.diagnosis.selection.held_numbers import (
    FILE,
    HELD,
    Held,
    fixed_parameters,
    fixed_words,
)
from stiction.plant.parameter import Parameter

SECONDS = 72.0


@cache
def made(*hidden: tuple[str, float]) -> Any:
    session = {"seed": 31, "seconds": SECONDS, "base": "maxwell_slip", "hidden": hidden}
    return make_sessions([session])[0]


def with_inertia(times: float, *hidden: tuple[str, float]) -> tuple[st.Diagnosis, float]:
    """The diagnosis of a plant whose inertia is held at so many times the true one, and that."""
    machine = made(*hidden)
    own = float(machine.plant["inertia"])
    held = Parameter(times * own, fixed=True)
    plant = replace(as_plant(machine), body={"inertia": held})
    return st.diagnose(plant, as_session(machine), surrogates=6), own


def notes(found: st.Diagnosis) -> list[str]:
    return [each["what"] for each in found.data["checks"] if each["recording"] == FILE]


def test_an_inertia_that_is_right_is_not_doubted() -> None:
    found, _ = with_inertia(1.0)
    assert found.verdict == "nothing_missing"
    assert not notes(found)
    assert "plant file" not in found.sentence


def test_a_cause_beside_a_right_inertia_is_named() -> None:
    found, _ = with_inertia(1.0, ("torque_bias", 0.015))
    assert not notes(found)
    assert found.effects
    assert not set(HELD.values()) & {each.coordinate for each in found.unexplained}


@pytest.mark.parametrize("times", [0.95, 1.06])
def test_a_wrong_inertia_is_told_with_what_it_would_be(times: float) -> None:
    found, own = with_inertia(times)
    assert found.verdict in ("unexplained", "ambiguous")
    assert not any(cause.decided for cause in found.effects)
    (what,) = notes(found)
    assert what.startswith(f"inertia is held at {times * own:.4g} kg·m²; left free it comes to ")
    value = float(what.split("comes to ")[1].split(" ")[0])
    assert value == pytest.approx(own, rel=0.01)
    assert f"In the plant file {what}." in found.sentence
    assert found.advice[0].experiment.startswith("let it be fitted, inertia = { value = ")


def test_rows_that_are_simulated_and_numbers_that_are_free_are_not_asked() -> None:
    free, held = builders.plant(), builders.plant(body={"inertia": {"value": 1.0, "fixed": True}})
    drive = {"kind": "prescribed_motion"}
    prescribed = builders.plant(drive=drive, body={"inertia": {"value": 1.0, "fixed": True}})
    for own, simulated in ((free, False), (held, True), (prescribed, False)):
        final = builders.model(builders.evidence(simulated=simulated), own)
        assert fixed_parameters(builders.search(models=[final])) == []


def test_what_a_cause_stands_for_is_no_rest_of_its_own() -> None:
    beside = Held("inertia", 102.0, 94.75, (94.02, 95.47), "kg", 0.12)
    instead = replace(beside, instead=("torque_constant_ripple",))
    assert [(each.coordinate, each.share) for each in beside.remainders] == [
        ("the inertia that is held fixed", 0.12)
    ]
    assert instead.remainders == ()
    assert fixed_words([]) == ""
    assert fixed_words([instead]) == (
        "In the plant file inertia is held at 102 kg; left free it comes to 94.75 kg (94.02 to "
        "95.47) and explains as much as torque_constant_ripple does."
    )
    both = replace(instead, instead=("voltage_limit", "drive_deadband"))
    assert both.what.endswith("explains as much as voltage_limit and drive_deadband do")
    assert beside.what.endswith("and takes 12 % off what is left on rows held out")
