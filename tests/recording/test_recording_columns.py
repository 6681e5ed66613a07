from __future__ import annotations

import pickle
from typing import Any

import pytest

from stiction.errors import InputError
from stiction.recording import CANONICAL, ROLES, Column, Columns


def test_a_name_and_a_table_are_both_columns() -> None:
    columns = Columns.parse(
        {"time": "t", "position": {"name": "q", "unit": "deg", "scale": -1, "offset": 0.5}}
    )
    assert columns["time"] == Column("t")
    assert columns["position"] == Column("q", "deg", -1.0, 0.5)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"tim": "t"}, r"^columns: 'tim' is not known \(did you mean 'time'\?\)"),
        ({"position_rad": "q"}, "did you mean 'position'"),
        ({"time": 3.0}, "time is 3.0; give the name of a column"),
        ({"time": ""}, "name of the column is ''"),
        ({"time": {"unit": "s"}}, "name of the column is missing"),
        ({"time": {"name": "t", "scal": 1}}, "'scal' is not known.*did you mean 'scale'"),
        ({"time": {"name": "t", "unit": "sec"}}, "unit 'sec' is not known"),
        ({"time": {"name": "t", "unit": 1}}, "unit is 1; write it as text"),
        ({"time": {"name": "t", "scale": "2"}}, "scale is '2'; give a finite number"),
        ({"time": {"name": "t", "scale": True}}, "scale is True"),
        ({"time": {"name": "t", "scale": 0}}, "scale is 0"),
        ({"time": {"name": "t", "offset": float("nan")}}, "offset is nan"),
        ({"input": "u", "effort": "f"}, "both input and effort"),
        ({"input": "q", "position": {"name": "q", "unit": "deg"}}, "input and position are both"),
        (["t", "u"], "give a table of roles"),
    ],
)
def test_what_cannot_be_a_mapping_is_refused_in_a_sentence(given: Any, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        Columns.parse(given)
    assert "\n" not in str(caught.value)


def test_the_place_that_holds_the_mapping_begins_the_sentence() -> None:
    with pytest.raises(InputError, match=r"^session\.toml: \[columns\]: time:"):
        Columns.parse({"time": {"name": "t", "unit": "h"}}, where="session.toml: [columns]")


def test_canonical_names_have_known_roles_and_units() -> None:
    assert {role for role, _ in CANONICAL.values()} == set(ROLES) - {"effort"}
    for name, (role, unit) in CANONICAL.items():
        assert Columns.parse({role: {"name": name, "unit": unit}})[role].name == name


def test_parsed_columns_pass_through_and_survive_pickling() -> None:
    columns = Columns.parse({"time": "t"})
    assert Columns.parse(columns) is columns
    assert dict(pickle.loads(pickle.dumps(columns))) == dict(columns)
