"""What is said of a cause fits the machine that has it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.diagnosis.builders import score

import stiction as st
from stiction._native import Motion
from stiction.diagnosis.findings.advice import advise
from stiction.diagnosis.findings.remedies import GOALS, experiment_words, meaning_of
from stiction.diagnosis.findings.words import sentence, what
from stiction.diagnosis.phrases import NO_COORDINATE
from stiction.diagnosis.records import Unexplained
from stiction.diagnosis.screening.candidates import Scales
from stiction.diagnosis.screening.orders import open_orders, order_words
from stiction.diagnosis.selection.listing import row_of_score
from stiction.fitting.result import FitParameter
from stiction.plan import EXPERIMENTS
from stiction.report.views import HINTS, hint

EFFECTS = {record.name: record for record in st.effects()}


def plant(motion: str, *, moved: bool = False) -> st.Plant:
    unit = "torque_nm" if motion == "rotary" else "force_n"
    drive: dict[str, object] = {"kind": "prescribed_motion"} if moved else {"input": unit}
    return st.Plant.from_dict(
        {"motion": {"kind": motion}, "drive": drive, "friction": {"law": "coulomb"}}
    )


@pytest.mark.parametrize("name", EFFECTS)
def test_a_linear_machine_has_no_gear_and_no_angle(name: str) -> None:
    if EFFECTS[name].rotary_only:
        return
    if name in ("direction_asymmetry", "torque_bias", "torque_constant_ripple"):
        told = " ".join(meaning_of(EFFECTS[name], plant("linear")))
        assert not {"gear", "angle", "angles", "torque"} & set(told.replace(",", "").split())
    assert meaning_of(EFFECTS[name], plant("rotary")) == (EFFECTS[name].means, EFFECTS[name].remedy)


@pytest.mark.parametrize("motion", ["rotary", "linear"])
@pytest.mark.parametrize("name", EFFECTS)
def test_a_rig_that_moves_a_specimen_has_no_amplifier_and_no_drive(name: str, motion: str) -> None:
    record = EFFECTS[name]
    if {"input map", "input delay", "input lag", "input rate"} & set(record.hooks):
        return
    rig = plant(motion, moved=True)
    told = " ".join(
        [*meaning_of(record, rig), experiment_words(record.plan, record.experiment, rig)]
    )
    words = ["amplifier", "current", "chirp", "pulses", "the input", "drive", "motor", "rotor"]
    for word in [*words, "controller", "command", "compensat", "feed-forward", "forward over"]:
        assert word not in told
    assert not any("drive" in hint(coordinate, rig) for coordinate in HINTS)
    (advice,) = advise((), (), (record,), (), rig) or (None,)
    if advice is not None:
        assert advice.experiment.startswith("move it by ")


def test_a_servo_is_advised_nothing_that_its_plan_leaves_out() -> None:
    table = {
        "drive": {
            "kind": "servo",
            "proportional": 1.0,
            "supply_v": 7.0,
            "resistance_ohm": 3.0,
            "torque_constant": 0.3,
        },
        "body": {"inertia": 0.002},
        "friction": {"law": "maxwell_slip"},
    }
    servo = st.Plant.from_dict(table)
    left_out = {each.name for each in EXPERIMENTS if each.kind == "input"}
    assert left_out == set(GOALS)
    for record in EFFECTS.values():
        said = experiment_words(record.plan, record.experiment, servo)
        assert said.startswith("send it goals: ") == (record.plan in left_out)


def test_a_dry_contact_is_turned_round_where_others_make_loops_below_break_away() -> None:
    def said(law: str, *separates: str) -> str:
        table = {"drive": {"input": "torque_nm", "gain": 1.0}, "friction": {"law": law}}
        return experiment_words("loops", "nested loops", st.Plant.from_dict(table), separates)

    assert said("coulomb", "torque_bias").startswith("mount it the other way round")
    assert said("coulomb", "creep_hardening") == said("coulomb") == ""
    assert said("hsieh_pan", "creep_hardening") == "loops: nested loops"


def test_what_comes_late_is_told_by_its_sign_and_with_its_fall() -> None:
    def lags(excess: float, fall: float = 0.0, *, moved: bool = False) -> str:
        effect = {"name": "frictional_lag", "excess": excess, "fall": fall}
        table = plant("linear", moved=moved).to_dict() | {"effects": [effect]}
        return meaning_of(EFFECTS["frictional_lag"], st.Plant.from_dict(table))[0]

    for moved in (False, True):
        assert "higher while speeding up" in lags(0.3, moved=moved)
        assert "lower while speeding up" in lags(-0.7, moved=moved)
        assert "rises with speed, and late" in lags(-0.7, 1.0, moved=moved)
    assert "it falls late" in lags(0.3, 1.0)
    assert "stick-slip" not in lags(0.3, 1.0, moved=True)


@pytest.mark.parametrize(
    ("share", "told"),
    [
        (0.2, "dry friction is higher forwards (6 N) than backwards (4 N)"),
        (-0.2, "dry friction is higher backwards (6 N) than forwards (4 N)"),
    ],
)
def test_an_asymmetry_says_which_way_friction_is_higher(share: float, told: str) -> None:
    """As the machine itself has it: the fitted plant is moved both ways."""
    table = plant("linear", moved=True).to_dict()
    table["friction"] |= {"coulomb": 5.0, "viscous": 0.0}
    table["effects"] = [{"name": "direction_asymmetry", "coulomb": share, "viscous": 0.0}]
    machine = st.Plant.from_dict(table)
    positions = np.concatenate([np.linspace(0.0, 1.0, 100), np.linspace(1.0, 0.0, 100)])
    _, _, friction, _ = machine.follower().follow(Motion(positions, np.zeros(199), 1e-3))
    assert (friction[50], friction[150]) == pytest.approx((5 * (1 + share), -5 * (1 - share)), 1e-3)

    def fitted(value: float, half: float, unit: str) -> FitParameter:
        return FitParameter(value, half / 2, (value - half, value + half), unit, "", value)

    own = {
        "friction.coulomb": fitted(5.0, 0.1, "N"),
        "effects.direction_asymmetry.coulomb": fitted(share, 0.01, "1"),
        "effects.direction_asymmetry.viscous": fitted(0.01, 0.02, "1"),
    }
    said = what(EFFECTS["direction_asymmetry"], own, machine.effects[0])
    assert said.startswith(f"{told}, forwards being where the position grows: coulomb {share}")
    assert "viscous friction" not in said
    share_alone = {path: p for path, p in own.items() if not path.startswith("friction.")}
    assert "40 % of its mean" in what(
        EFFECTS["direction_asymmetry"], share_alone, machine.effects[0]
    )


@pytest.mark.parametrize(
    ("left", "told"),
    [(0.096, "all but 10 % of it"), (0.004, "all but 0.4 % of it"), (0.0, "all of")],
)
def test_the_share_that_the_base_imitates_is_a_plain_number(left: float, told: str) -> None:
    own = score("run_in", 0.0, threshold=0.1, heldout=0.0, left=left, visible=0.0)
    assert not own.testable
    assert told in row_of_score(own).reason


def test_more_than_noise_that_goes_with_nothing_is_said_so() -> None:
    said = sentence("unexplained", (), None, (Unexplained(NO_COORDINATE, 0.82),), "")
    assert said.endswith("is more than noise and goes with nothing that was looked at (82 %).")


def test_less_than_a_period_over_a_stroke_determines_no_order() -> None:
    step = 0.5 * 2.0 * math.pi / 0.3
    scales = Scales((0.1, 1.0), tuple(step * k for k in range(1, 9)), False, {})
    path = "effects.cogging.order"

    def fitted(order: float) -> dict[str, FitParameter]:
        return {path: FitParameter(order, 0.1, (order - 0.2, order + 0.2), "1/m", "", order)}

    few, many = open_orders(fitted(1.5 * step), scales), open_orders(fitted(2.5 * step), scales)
    assert few[path].ci95 == (-math.inf, math.inf)
    assert "not determined" in order_words(path, few[path])
    assert many == fitted(2.5 * step)
    assert order_words(path, many[path]) == ""
    turns = Scales((0.1, 1.0), (1.0, 2.0), True, {})
    assert open_orders(fitted(1.0), turns) == fitted(1.0)
