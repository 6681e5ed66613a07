"""A law that outdoes the stated one beside the first cause: the diagnosis goes on with it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from tests.diagnosis.builders import model, search
from tests.diagnosis.second_base import fail_the_second_base

import stiction as st
from stiction.bench.ordinary.draw import Spec, ordinary
from stiction.bench.ordinary.files import write
from stiction.diagnosis import pipeline, restated
from stiction.diagnosis.selection.laws import Rival
from stiction.errors import NotEnoughData

SPEC = Spec(
    11,
    law="dahl",
    contact="dry",
    hidden="viscous_quadratic",
    size=0.3,
    seconds=8.0,
    recordings=3,
    dt=0.004,
    counts=131072,
    loop="open",
)
"""Beside the dead band that stands for it a dry contact leaves a fiftieth of what this law does."""


@pytest.fixture
def session(tmp_path: Path) -> st.Session:
    return st.load(write(ordinary(SPEC), tmp_path / "session"))


@pytest.fixture
def sooner(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(restated, "HOPELESS", 10.0)


def rival(law: str, beside: float) -> Rival:
    return Rival(law, False, model(paths=()), beside=beside, z=5.0, counts=True)


@pytest.mark.parametrize(
    ("beside", "outdone"), [((0.995, 0.2), True), ((0.98, 0.5), False), ((), False)]
)
def test_a_law_is_outdone_where_another_leaves_a_hundredth(
    beside: tuple[float, ...], outdone: bool
) -> None:
    rivals = [rival(law, each) for law, each in zip(("coulomb", "lugre"), beside, strict=False)]
    assert restated.outdo(rivals) is outdone


def test_half_a_comparison_outdoes_nothing() -> None:
    found = search(interrupted=True)
    with pytest.raises(KeyboardInterrupt):
        restated.is_outdone(found)


@pytest.mark.usefixtures("sooner")
def test_what_is_told_is_what_the_whole_search_tells(
    session: st.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = st.diagnose(None, session)
    monkeypatch.setattr(restated, "HOPELESS", 100.0)
    whole = st.diagnose(None, session)
    assert found.better_law == whole.better_law == "coulomb"
    assert "less than dahl with drive_deadband. With coulomb:" in found.sentence
    assert "less than dahl, whatever is added to it. With coulomb:" in whole.sentence
    assert found.verdict == whole.verdict
    assert found.effects == whole.effects
    assert found.gain == whole.gain
    assert [row.law for row in found.laws] == ["coulomb"]


@pytest.mark.usefixtures("sooner")
def test_where_nothing_comes_of_it_the_search_goes_on(
    session: st.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun = fail_the_second_base(monkeypatch, NotEnoughData("too short"))
    found = st.diagnose(None, session)
    monkeypatch.setattr(restated, "HOPELESS", 100.0)
    begun.clear()
    entire = st.diagnose(None, session)
    assert found.success
    assert found.to_dict()["effects"] == entire.to_dict()["effects"]
    assert found.sentence == entire.sentence
    assert "whatever is added to it" in found.sentence


@pytest.mark.usefixtures("sooner")
def test_after_an_interrupt_what_was_told_of_the_stated_law_stays(
    session: st.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    fail_the_second_base(monkeypatch, KeyboardInterrupt())
    found = st.diagnose(None, session)
    assert not found.success
    assert found.message.startswith("interrupted")
    assert found.plant.friction.law == "dahl"
    assert found.better_law == "coulomb"
    assert "less than dahl with drive_deadband." in found.sentence


def test_who_asks_for_laws_has_them_beside_all_that_is_named(
    session: st.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: Any) -> bool:
        raise AssertionError("asked")

    monkeypatch.setattr(pipeline, "is_outdone", never)
    found = st.diagnose(None, session, laws=("coulomb",))
    assert found.better_law == "coulomb"
    assert "whatever is added to it" in found.sentence
