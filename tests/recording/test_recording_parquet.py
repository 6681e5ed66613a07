from __future__ import annotations

import datetime
import decimal
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stiction.errors import InputError
from stiction.recording import Recording, read_table

VECTOR = np.linspace(0.0, 1.0, 300)


def saved(path: Path, columns: dict[str, Any]) -> Path:
    why = "pyarrow, the extra that reads Parquet, is not installed"
    pyarrow = pytest.importorskip("pyarrow", reason=why)
    parquet = pytest.importorskip("pyarrow.parquet", reason=why)
    parquet.write_table(pyarrow.table(columns), path)
    return path


def test_columns_of_a_parquet_file_are_read_under_their_names(tmp_path: Path) -> None:
    columns = {"time_s": VECTOR, "current_a": 2.0 * VECTOR, "position_rad": VECTOR**2}
    recording = Recording.load(saved(tmp_path / "run.parquet", columns))
    np.testing.assert_array_equal(recording.input, 2.0 * VECTOR)
    assert recording.units["position"] == "rad"
    assert not recording.notes


def test_numbers_of_every_kind_become_doubles(tmp_path: Path) -> None:
    columns = {
        "integer": np.arange(300, dtype=np.int16),
        "single": VECTOR.astype(np.float32),
        "on": VECTOR > 0.5,
        "exact": [decimal.Decimal(k) for k in range(300)],
    }
    table = read_table(saved(tmp_path / "run.pq", columns))
    assert list(table.columns) == list(columns)
    assert {column.dtype for column in table.columns.values()} == {np.dtype(float)}
    assert table.columns["exact"][299] == 299.0
    assert table.columns["on"].sum() == 150.0


def test_empty_cells_are_missing_and_are_filled(tmp_path: Path) -> None:
    holes = [None if k == 7 else float(k) for k in range(300)]
    flags = [None if k == 8 else k > 3 for k in range(300)]
    columns = {"time_s": VECTOR, "current_a": holes, "flags": flags}
    path = saved(tmp_path / "run.parquet", columns)
    assert np.flatnonzero(np.isnan(read_table(path).columns["flags"])).tolist() == [8]
    recording = Recording.load(path)
    assert recording.input is not None
    assert recording.input[7] == pytest.approx(7.0)
    assert "row 8" in recording.notes[0]


def test_text_and_times_of_day_are_passed_over_and_refused_when_asked_for(tmp_path: Path) -> None:
    noon = datetime.time(12)
    lists = [[1.0] * (k % 3) for k in range(300)]
    columns = {"t": VECTOR, "note": ["x"] * 300, "when": [noon] * 300, "many": lists}
    path = saved(tmp_path / "run.parquet", columns)
    assert list(read_table(path).columns) == ["t"]
    with pytest.raises(InputError, match=r"'note', asked for as input, holds string, not numbers"):
        Recording.load(path, {"time": "t", "input": "note"})
    with pytest.raises(InputError, match="'when', asked for as time, holds dates"):
        Recording.load(path, {"time": "when", "input": "t"})
    with pytest.raises(InputError, match="'many', asked for as input, holds lists that are not"):
        Recording.load(path, {"time": "t", "input": "many"})


def test_a_file_without_numbers_says_what_it_holds(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none of its 1 column is a vector of numbers \(note"):
        read_table(saved(tmp_path / "run.parquet", {"note": ["x"] * 300}))


def test_a_file_cut_short_is_refused(tmp_path: Path) -> None:
    path = saved(tmp_path / "run.parquet", {"t": VECTOR})
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(InputError, match=r"run\.parquet: the Parquet file is damaged"):
        read_table(path)


def test_another_file_under_the_ending_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    path.write_text("time_s,current_a\n0,1\n")
    with pytest.raises(InputError, match="this is not a Parquet file"):
        read_table(path)


def test_without_pyarrow_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "run.parquet"
    path.write_bytes(b"PAR1 and more")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(InputError, match=r"through pyarrow.*pip install 'stiction\[parquet\]'"):
        read_table(path)
