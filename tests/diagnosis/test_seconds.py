"""What acts for a second or two, in rows of some roles alone, and who may tell of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.diagnosis.builders import fitted, model, number, plant, search, trial
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.screening.model import Model
from stiction.diagnosis.selection import seconds
from stiction.diagnosis.selection.replication import vanishes_where_active
from stiction.diagnosis.selection.search import Search
from stiction.diagnosis.selection.seconds import holds_more, tried_names
from stiction.errors import InputError
from stiction.recording.split import split

BLOCKS, ROWS = 40, 50
BLOCK = np.repeat(np.arange(BLOCKS), ROWS)
LIMITS = ("drive_saturation", "voltage_limit")


def diagnosed(seed: int, *hidden: tuple[Any, ...], base: str = "coulomb") -> st.Diagnosis:
    made = make_session(seed, base=base, hidden=hidden)
    return st.diagnose(as_plant(made), as_session(made))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "base", "name", "size"),
    [
        (12890003, "coulomb", "drive_saturation", 0.004872),
        pytest.param(12750007, "maxwell_slip", "voltage_limit", 0.010977, marks=pytest.mark.slow),
    ],
)
def test_a_limit_is_named_where_rows_that_decide_are_fitted_too(
    seed: int, base: str, name: str, size: float
) -> None:
    """In two or three places of the session, as it was dealt: they tell of each other.

    A contact that yields may show its limit at the first look already.
    """
    found = diagnosed(seed, (name, size), base=base)
    assert found.verdict == "missing_effect"
    (cause,) = found.effects
    assert (cause.name, cause.decided) == (name, True)
    again = found.data["split"]["select"] == []
    assert again or base != "coulomb"
    assert ("the rows of select train as well" in found.split) is again
    # What the first look said of all others stands, and each is told once.
    names = [row.name for row in found.candidates]
    assert len(set(names)) == len(names) > 20


@pytest.mark.slow
def test_a_limit_that_one_recording_shows_is_not_testable_by_name() -> None:
    """Fitted to one second, which leaves no doubt of it; rows that test are asked nothing."""
    found = diagnosed(12750005, ("voltage_limit", 0.0113))
    assert (found.verdict, found.effects) == ("not_testable", ())
    assert "voltage_limit (" in found.sentence
    assert "the rows of select train as well" in found.split


@pytest.mark.slow
def test_it_is_found_beside_a_name_as_well() -> None:
    """Everything is asked again then, for the name has to be found again."""
    hidden = (("drive_saturation", 0.021924), ("frictional_lag", 0.014924, {"fall": 0.0}))
    found = diagnosed(10910000, *hidden)
    assert {cause.name for cause in found.effects} == {"frictional_lag", "drive_saturation"}
    assert found.verdict == "missing_effect"


@pytest.mark.slow
def test_a_moment_in_rows_that_test_alone_is_told_and_decides_nothing() -> None:
    found = diagnosed(12900021, ("drive_saturation:foreign", 0.013579))
    assert (found.verdict, found.effects) == ("nothing_missing", ())
    (check,) = (each for each in found.data["checks"] if each["name"] == "alone")
    assert check["recording"] == "recording 6"
    assert "in one second" in check["what"]
    assert check["what"] in found.sentence


@pytest.mark.parametrize(
    ("left", "noise", "gone"), [(0.0, 1.0, True), (0.5, 1.0, False), (0.0, 30.0, False)]
)
def test_next_to_nothing_is_left_where_it_acts(left: float, noise: float, gone: bool) -> None:
    """A half of it is left, or it is no more than noise: neither bears a name out."""
    source = np.random.default_rng(4)
    explained = np.where(np.isin(BLOCK, (7, 8)), 12.0 * source.standard_normal(len(BLOCK)), 0.0)
    rest = noise * source.standard_normal(len(BLOCK))
    after = rest + left * explained
    assert vanishes_where_active(BLOCK, explained, after + explained, after, 10.0) is gone


@pytest.mark.parametrize("roles", [["train", "select", "test"] * 2, [None] * 6, [None]])
def test_rows_that_decide_train_as_well_and_those_that_test_stay(roles: list[str | None]) -> None:
    source = np.random.default_rng(1)
    time = 5e-3 * np.arange(4000)
    recordings = [
        st.Recording(time, source.standard_normal(4000), source.standard_normal(4000), role=role)
        for role in roles
    ]
    apart, joined = split(recordings), split(recordings, joined=True)
    assert joined.test == apart.test
    assert joined.select == ()
    assert set(joined.train) == {*apart.train, *apart.select}
    assert set(joined.train) == {part for fold in joined.folds for part in fold.held}
    for fold in joined.folds:
        assert not {*fold.fit} & {*fold.held}
    assert joined.rules[-1].startswith("To decide, ")


def looked(*names: str, unseen: bool = False) -> Search:
    told = {"voltage_limit": 0.1} if unseen else {}
    models = [*(model() for _ in names), limited(0.9, whole=True)]
    return search(*names, models=models, unseen=told)


def limited(share: float, *, whole: bool = False, stderr: float = 0.02) -> Model:
    """A model with limits that hold back this share; all of it from .95 on."""
    value = 1.0 if whole else share
    limits = [{"name": name, "share": value, "limit": 1.0} for name in LIMITS]
    numbers = {f"{name}__share": number(share, stderr=stderr) for name in LIMITS}
    return model(fitted=plant(effects=limits), fit_result=fitted(**numbers))


def test_a_second_look_stands_where_it_holds_the_first_one_and_limits() -> None:
    limit = "voltage_limit"
    assert holds_more(looked(limit), looked())
    assert holds_more(looked("stribeck", limit), looked("stribeck"))
    assert not holds_more(looked("warm_up"), looked())
    assert not holds_more(looked("warm_up", limit), looked())
    assert not holds_more(looked(limit), looked("stribeck"))
    assert not holds_more(looked("stribeck"), looked("stribeck"))
    assert holds_more(looked(unseen=True), looked())
    assert not holds_more(looked(unseen=True), looked(unseen=True))
    assert not holds_more(looked(), looked())


@pytest.mark.parametrize(
    ("share", "stderr", "whole", "known"),
    [(0.3, 0.02, False, True), (0.5, 3.0, False, False), (1.0, 44.0, True, True)],
)
def test_what_a_limit_holds_back_is_known_or_everything(
    share: float, stderr: float, whole: bool, known: bool
) -> None:
    final = limited(share, whole=whole, stderr=stderr)
    assert seconds._is_known(trial("drive_saturation"), final) is known


def test_a_push_in_few_seconds_is_no_limit_of_the_drive_for_sure() -> None:
    """Drag of ten milliseconds after each of the greatest efforts, as somebody else made it."""
    made = make_session(817, base="coulomb")
    efforts = np.abs(np.concatenate([r.torque_nm for r in made.recordings]))
    least = np.quantile(efforts, 0.999)
    parts = []
    for each in made.recordings:
        out = np.abs(each.torque_nm) > least
        late = np.convolve(out, np.ones(10), "full")[: len(out)] > 0
        parts.append(late * np.sign(each.truth["velocity"]))
    rms = float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))
    torque = [
        each.torque_nm + 0.02 * made.plant["coulomb"] / rms * part
        for each, part in zip(made.recordings, parts, strict=True)
    ]
    found = st.diagnose(as_plant(made), as_session(made, torque))
    assert not any(cause.decided for cause in found.effects)


def test_copies_are_not_fitted_and_judged_on_in_turn() -> None:
    source = np.random.default_rng(2)
    time = 5e-3 * np.arange(2000)
    made = [(source.standard_normal(2000), source.standard_normal(2000)) for _ in range(4)]
    roles = ["train", "train", "select", "test"]
    recordings = [st.Recording(time, *each, role=r) for each, r in zip(made, roles, strict=True)]
    recordings.append(st.Recording(time, *made[0], role="train"))
    split(recordings)
    with pytest.raises(InputError, match="the same recording twice"):
        split(recordings, joined=True)


def test_limits_alone_are_asked_again_where_nothing_is_named() -> None:
    names = {record.name for record in st.effects()} - set(tried_names(looked()))
    assert names == {"drive_saturation", "voltage_limit"}
    assert tried_names(looked("stribeck")) == ()
