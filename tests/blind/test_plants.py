"""Simulators of ordinary sessions come in one form, and a stranger's is registered beside ours."""

from __future__ import annotations

import pytest

import stiction as st

from .ordinary_table import beside
from .plants import PLANTS, SPRING, catalogued, ordinary_cases


@pytest.mark.parametrize("plant", PLANTS)
def test_a_longer_list_begins_with_the_shorter_one_of_each_kind(plant):
    short, long = (PLANTS[plant](("null", "hidden"), n, 4, (20.0, 24.0)) for n in (6, 20))
    for kind in ("null", "hidden"):
        few = [case.key for case in short if case.kind == kind]
        many = [case.key for case in long if case.kind == kind]
        assert len(few) == 3
        assert many[: len(few)] == few


@pytest.mark.parametrize("plant", PLANTS)
def test_a_session_reads_as_it_was_laid_out(plant, tmp_path):
    cases = PLANTS[plant](("hidden",), 2, 4, (20.0, 22.0))
    for k, case in enumerate(cases):
        laid = case.lay(tmp_path / f"s{k}")
        session = st.load(laid.path)
        assert len(list(session)) == laid.spec["recordings"]
        assert session.plant.friction.law == laid.spec["law"]
        assert len(laid.names) == 1
        assert laid.reached > 0.0


def test_only_the_spring_of_a_linear_axis_has_no_name_in_the_catalogue():
    known = {record.name for record in st.effects()}
    cases = PLANTS["axis4"](("hidden",), 16, 4)
    names = {catalogued(case.effect, linear=False) for case in cases}
    assert names <= known
    assert len(names) == len(cases)
    assert catalogued("position_load", linear=True) == SPRING
    assert SPRING not in known


def test_the_grid_comes_whole_and_first():
    assert [case.kind for case in ordinary_cases(("grid", "null"), 1, 0)] == ["grid"] * 24 + [
        "null"
    ]


def row(names, found, verdict="missing_effect"):
    sure = {"decided": True, "look_alikes": []}
    causes = [{"name": name, "class": name, "classes": [name], **sure} for name in found]
    return {"names": names, "classes": names, "found": causes, "verdict": verdict}


def test_judges_stand_beside_each_other():
    one = [row(["cogging"], ["cogging"]), row([], [], "nothing_missing")]
    two = [row(["cogging"], ["stribeck"]), row([], ["stribeck"])]
    lines = beside({"one": one, "two": two}).splitlines()
    assert lines[0] == "| what | one | two |"
    cells = {
        line.split(" | ")[0]: [c.split(" = ")[0] for c in line.split(" | ")[1:]] for line in lines
    }
    assert cells["| nothing hidden: a sure name"] == ["0/1", "1/1"]
    assert cells["| hidden: name"] == ["1/1", "0/1"]
    assert cells["| hidden: a sure and wrong name"] == ["0/1", "1/1"]
