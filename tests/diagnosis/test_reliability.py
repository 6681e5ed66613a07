"""What names told in one manner came to, and what is said of it."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest
from tests.blind.reliability import counted

from stiction.diagnosis.findings.reliability import Reliability, manner, reliability_of
from stiction.diagnosis.records import Cause


def cause(*alike: str, held: Reliability | None = None) -> Cause:
    return Cause("stribeck", "c", not alike, alike, {}, None, "", "", "", "", reliability=held)


@pytest.mark.parametrize("how", list(product((True, False), repeat=3)))
def test_counts_of_every_manner_are_there_and_in_order(how: tuple[bool, bool, bool]) -> None:
    held = reliability_of(decided=how[0], several=how[1], unexplained=how[2])
    assert 0 <= held.first <= held.listed <= held.told
    assert 0.0 < held.probability <= held.coverage < 1.0


def test_a_sure_name_is_more_probable_than_one_of_several() -> None:
    sure = reliability_of(decided=True, several=False, unexplained=False)
    several = reliability_of(decided=False, several=True, unexplained=False)
    assert sure.told > 30
    assert sure.probability > 0.9 > several.probability


def test_of_nothing_counted_anything_may_be() -> None:
    assert Reliability(0, 0, 0).probability == 0.5


def test_look_alikes_share_what_the_name_leaves_of_the_list() -> None:
    held = Reliability(told=19, first=9, listed=17)
    told = cause("frictional_lag", "viscous_quadratic", held=held).to_dict()
    assert told["probability"] == pytest.approx(9.5 / 20.0)
    shares = [each["probability"] for each in told["alternatives"]]
    assert shares == pytest.approx([0.2, 0.2])
    assert [each["name"] for each in told["alternatives"]] == told["look_alikes"]
    assert told["reliability"] == {"told": 19, "first": 9, "listed": 17}


def test_a_cause_that_was_not_counted_has_no_probability() -> None:
    told = cause().to_dict()
    assert (told["probability"], told["alternatives"], told["reliability"]) == (None, [], None)


def row(names: list[str], verdict: str, *found: tuple[str, bool, list[str]]) -> dict[str, Any]:
    causes = [{"name": n, "decided": sure, "look_alikes": alike} for n, sure, alike in found]
    return {"names": names, "verdict": verdict, "found": causes}


def test_names_are_counted_by_how_they_were_told() -> None:
    rows = [
        row(["stribeck"], "missing_effect", ("stribeck", True, [])),
        row([], "missing_effect", ("backlash", True, [])),
        row(["cogging"], "ambiguous", ("stribeck", False, ["cogging"])),
        row(["cogging"], "unexplained", ("cogging", False, [])),
        {"names": ["cogging"]},
    ]
    found = counted(rows)
    sure = found[manner(decided=True, several=False, unexplained=False)]
    assert sure == {"told": 2, "first": 1, "listed": 1}
    several = found[manner(decided=False, several=True, unexplained=False)]
    assert several == {"told": 1, "first": 0, "listed": 1}
    beside = found[manner(decided=False, several=False, unexplained=True)]
    assert beside == {"told": 1, "first": 1, "listed": 1}


def test_it_is_said_in_words() -> None:
    held = Reliability(told=19, first=9, listed=17)
    several = (
        "with alternatives like these one was right in 17 of 19 sessions whose truth was known"
    )
    assert cause("frictional_lag", held=held).track_record == f"{several}, the first in 9"
    told = "a name stated like this was right in 9 of 19 sessions whose truth was known"
    assert cause(held=held).track_record == told
    # One session is no record, of a right name or of a wrong one.
    assert cause(held=Reliability(1, 0, 0)).track_record == ""
    assert cause().track_record == ""
