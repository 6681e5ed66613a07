"""A contact that yields stated of one that sticks, and what only the other kind of law tells."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from tests.diagnosis.builders import cause, evidence, model, plant, search, trial
from tests.diagnosis.second_base import fail_the_second_base

import stiction as st
from stiction.bench.ordinary.draw import Spec, ordinary
from stiction.bench.ordinary.files import write
from stiction.diagnosis.findings.verdict import relatives
from stiction.diagnosis.phrases import THE_LAW
from stiction.diagnosis.records import CandidateRow
from stiction.diagnosis.screening.model import Model
from stiction.diagnosis.selection import left_open
from stiction.diagnosis.selection.decide import degeneracy
from stiction.errors import NotEnoughData

SHORT: Any = {"seconds": 8.0, "recordings": 3, "dt": 0.004, "counts": 131072, "loop": "open"}


def session(folder: Path, spec: Spec) -> st.Session:
    return st.load(write(ordinary(spec), folder))


def test_a_law_that_yields_is_told_of_a_dry_contact_and_the_diagnosis_goes_on(
    tmp_path: Path,
) -> None:
    # In place of the law a dead band of the drive explains what a dry contact holds at rest.
    found = st.diagnose(None, session(tmp_path, Spec(11, law="dahl", contact="dry", **SHORT)))
    assert found.better_law == "coulomb"
    assert found.to_dict()["better_law"] == "coulomb"
    assert "The friction law itself lacks something: coulomb" in found.sentence
    assert "With coulomb: Nothing" in found.sentence
    assert found.effects == ()
    assert [left.coordinate for left in found.unexplained] == [THE_LAW]
    assert found.verdict == "unexplained"
    page = found.save(tmp_path / "out").read_text("utf-8")
    assert "still follows some coordinates" not in page
    # What is handed over is the plant with the law that is the better one.
    assert found.plant.friction.law == "coulomb"
    assert found.advice[-1].experiment == (
        'state law = "coulomb" in the plant file, as the extended plant does'
    )


@pytest.mark.parametrize(
    ("fault", "success", "broken"),
    [
        (NotEnoughData("too short"), True, False),
        (ArithmeticError("a fault of ours"), True, True),
        (KeyboardInterrupt(), False, False),
    ],
)
def test_what_was_told_stays_where_the_diagnosis_with_the_better_law_comes_to_nothing(
    fault: BaseException,
    success: bool,
    broken: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    left_out: list[str],
) -> None:
    begun = fail_the_second_base(monkeypatch, fault)
    found = st.diagnose(None, session(tmp_path, Spec(11, law="dahl", contact="dry", **SHORT)))
    assert len(begun) == 2
    assert found.success is success
    assert len(left_out) == broken
    assert found.better_law == "coulomb"
    assert found.plant.friction.law == "dahl"
    assert "The friction law itself lacks something: coulomb" in found.sentence


def test_what_is_missing_beside_the_better_law_is_named_there(tmp_path: Path) -> None:
    spec = Spec(11, law="dahl", contact="dry", hidden="viscous_quadratic", size=0.3, **SHORT)
    found = st.diagnose(None, session(tmp_path, spec))
    assert found.better_law == "coulomb"
    assert "With coulomb: The simulation lacks" in found.sentence
    assert "viscous_quadratic" in [cause.name for cause in found.effects]


@pytest.mark.parametrize("hidden", ["torque_bias", "direction_asymmetry"])
def test_two_levels_of_a_dry_contact_are_one_level_and_a_bias(hidden: str, tmp_path: Path) -> None:
    spec = Spec(12, law="coulomb", contact="dry", hidden=hidden, size=0.2, **SHORT)
    found = st.diagnose(None, session(tmp_path, spec))
    assert found.verdict == "ambiguous"
    (cause,) = found.effects
    assert {cause.name, *cause.look_alikes} >= {"torque_bias", "direction_asymmetry"}
    assert not cause.decided


@pytest.mark.parametrize(
    ("law", "bias", "asked", "others"),
    [
        ("coulomb", 0.3, True, ["direction_asymmetry"]),
        ("coulomb", 1.2, True, []),
        ("dahl", 0.3, True, []),
        ("coulomb", 0.3, False, []),
    ],
)
def test_a_bias_that_outweighs_the_level_or_bends_a_spring_is_told(
    law: str, bias: float, asked: bool, others: list[str]
) -> None:
    plant = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm"},
            "friction": {"law": law, "coulomb": 1.0},
            "effects": [{"name": "torque_bias", "bias": bias}],
        }
    )
    row = CandidateRow("direction_asymmetry", 0.1, 0.05, 0.2, "")
    winner = trial("torque_bias", refit=model(fitted=plant))
    selection = search(winner, rows={row.name: row} if asked else {})
    assert relatives(selection, 0) == others


def test_a_fit_that_lost_its_inertia_or_its_input_is_no_cause() -> None:
    def fitted(inertia: float, given: float, *, simulated: bool = False) -> Model:
        own = plant(body={"inertia": inertia})
        return model(evidence(simulated=simulated), own, relative_input_power=given)

    base = fitted(1.0, 1.0)
    assert degeneracy(base, fitted(0.9, 1.0)) == ""
    assert "the inertia" in degeneracy(base, fitted(0.1, 1.0))
    # What is simulated without it misses the motion, which counts against it as it is.
    base = fitted(1.0, 1.0, simulated=True)
    assert degeneracy(base, fitted(0.1, 1.0, simulated=True)) == ""
    assert "the effort itself" in degeneracy(base, fitted(1.0, 0.005, simulated=True))


def test_beside_a_law_that_nobody_stated_what_laws_have_is_not_decided() -> None:
    named = [cause("creep_hardening", "creep"), cause("cogging", "cogging")]
    found = left_open.beside_another_law(named)
    assert [each.decided for each in found] == [False, True]
    assert found[0].doubt


@pytest.mark.parametrize(
    ("names", "strength", "doubted"),
    [
        (("stribeck", "viscous_quadratic"), 6.0, {"viscous_quadratic"}),
        (("viscous_quadratic", "stribeck"), 6.0, {"stribeck"}),
        (("stribeck", "viscous_quadratic"), 60.0, set()),
        (("stribeck", "cogging"), 6.0, set()),
        (("viscous_quadratic",), 6.0, set()),
    ],
)
def test_a_second_name_of_the_curve_over_speed_may_be_the_form_of_the_first(
    names: tuple[str, ...], strength: float, doubted: set[str]
) -> None:
    selection = search(*names, models=[model(strength=strength)])
    assert left_open.of_one_curve(selection) == doubted


@pytest.mark.parametrize("name", ["smallest", "alpha"])
@pytest.mark.parametrize("given", [0.0, 1.0, -0.1, True, "1", float("nan")])
def test_what_is_no_share_is_refused(name: str, given: Any, tmp_path: Path) -> None:
    recordings = session(tmp_path, Spec(11, law="coulomb", contact="dry", **SHORT))
    with pytest.raises(st.InputError, match=f"^{name} = .* is out of bounds: give a share"):
        st.diagnose(None, recordings, **{name: given})


def test_what_is_smaller_than_was_asked_for_gets_no_name(tmp_path: Path) -> None:
    spec = Spec(12, law="coulomb", contact="dry", hidden="torque_bias", size=0.1, **SHORT)
    recordings = session(tmp_path, spec)
    named, *_ = st.diagnose(None, recordings).effects
    assert 0.01 < named.size < 0.1
    found = st.diagnose(None, recordings, smallest=0.2)
    assert found.effects == ()
    assert found.to_dict()["smallest"] == 0.2
    reasons = {row.name: row.reason for row in found.candidates}
    assert "below the 20 % that matter" in reasons["torque_bias"]


def test_what_is_missing_and_fast_is_no_noise_once_it_has_a_name(tmp_path: Path) -> None:
    # Twelve periods a turn of a quick machine: noise, for who does not know of them.
    spec = Spec(52, law="coulomb", contact="dry", hidden="cogging", size=0.15, **SHORT)
    found = st.diagnose(None, session(tmp_path, spec))
    before, after = found.baseline, found.extended
    assert before is not None
    assert after is not None
    assert "cogging" in [cause.name for cause in found.effects]
    assert after.noise_floor_rms == before.noise_floor_rms < 0.5 * before.train_rms
    gap = before.train_rms**2 - after.noise_floor_rms**2
    assert found.gap_closed == pytest.approx(
        min(1.0, (before.train_rms**2 - after.train_rms**2) / gap)
    )
    assert found.to_dict()["gap_closed"] == found.gap_closed > 0.5


def test_a_delay_is_found_where_the_base_has_taken_half_a_sample_of_it(tmp_path: Path) -> None:
    # Simulated over windows, an offset of timing and a delay are one slope: no score tells of it.
    spec = Spec(
        5_770_012,
        law="coulomb",
        hidden="input_delay",
        size=0.1559517219096808,
        contact="dry",
        seconds=30.841489440739025,
    )
    found = st.diagnose(None, session(tmp_path, spec))
    named = {name for cause in found.effects for name in (cause.name, *cause.look_alikes)}
    assert "input_delay" in named
    assert found.gain is not None
    assert found.gain.value > 0.5
