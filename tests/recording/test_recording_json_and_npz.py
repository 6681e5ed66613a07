from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from stiction.errors import InputError
from stiction.recording import read_table

Written = Callable[..., Path]
RECORDS = [{"t": 0, "on": True, "x": 1.5}, {"t": 1, "x": None, "late": "a"}]


@pytest.mark.parametrize("content", [RECORDS, {"kp": 8, "gains": [1, 2], "entries": RECORDS}])
def test_one_list_of_records_is_the_table(written: Written, content: object) -> None:
    table = read_table(written(json.dumps(content).encode(), "run.json"))
    assert list(table.columns) == ["t", "on", "x", "late"]
    np.testing.assert_array_equal(table.columns["on"], [1.0, np.nan])
    np.testing.assert_array_equal(table.columns["x"], [1.5, np.nan])
    assert [(cell.row, cell.column, cell.text) for cell in table.cells] == [(1, "late", "a")]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b'{"a": [{"t": 0}], "b": [{"t": 1}]}', r"2 lists of records \(a, b\)"),
        (b'{"t": [0, 1]}', "no list of records"),
        (b"[]", "no list of records"),
        (b"3", "no list of records"),
        (b'[{"t": 0},\n{"t": 1', "line 2 is not JSON"),
        (b'["\xb5"]', "not UTF-8"),
        (b'[{"t": ' + b"9" * 5000 + b"}]", "cannot be read"),
    ],
)
def test_json_that_is_no_table_is_refused(written: Written, content: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_table(written(content, "run.json"))


def test_vectors_of_an_archive_are_columns(tmp_path: Path) -> None:
    np.savez(tmp_path / "run.npz", t=np.arange(5), q=np.ones((5, 1)), m=np.ones((5, 2)), k=1.0)
    table = read_table(tmp_path / "run.npz")
    assert list(table.columns) == ["t", "q"]
    assert set(table.unusable) == {"m", "k"}


def test_pickled_objects_are_never_opened(tmp_path: Path) -> None:
    np.savez(tmp_path / "run.npz", t=np.arange(5), o=np.array([{}], dtype=object))
    assert read_table(tmp_path / "run.npz").unusable == {"o": "holds Python objects, not numbers"}


def test_a_damaged_archive_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    np.savez(path, t=np.arange(500))
    path.write_bytes(path.read_bytes()[:-50])
    with pytest.raises(InputError, match="archive is damaged"):
        read_table(path)
