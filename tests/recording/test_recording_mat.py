from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io  # type: ignore[import-untyped]

from stiction.errors import InputError
from stiction.recording import Recording, read_table

VECTOR = np.linspace(0.0, 1.0, 300)


def saved(path: Path, variables: dict[str, Any]) -> Path:
    scipy.io.savemat(path, variables)
    return path


def saved_hdf5(path: Path) -> Path:
    """A file as MATLAB writes it with -v7.3: HDF5 behind a text header, arrays transposed."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        file["t"] = VECTOR[np.newaxis, :]
        file["log/q"] = VECTOR[:, np.newaxis]
        file["gain"] = np.array([[2.0]])
        file["matrix"] = np.ones((3, 300))
        file["title"] = np.array([[72], [105]], dtype=np.uint16)
        file["title"].attrs["MATLAB_class"] = np.bytes_("char")
        file["nothing"] = np.array([0, 0], dtype=np.uint64)
        file["nothing"].attrs["MATLAB_empty"] = np.uint8(1)
        file["#refs#/a"] = VECTOR
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return path


def test_row_and_column_vectors_are_columns(tmp_path: Path) -> None:
    path = saved(tmp_path / "run.mat", {"t": VECTOR[np.newaxis, :], "q": VECTOR[:, np.newaxis]})
    columns = read_table(path).columns
    assert list(columns) == ["t", "q"]
    assert all(np.array_equal(column, VECTOR) for column in columns.values())


def test_integers_and_logicals_become_doubles(tmp_path: Path) -> None:
    path = saved(tmp_path / "run.mat", {"n": np.arange(5, dtype=np.int16), "on": VECTOR > 0.5})
    assert {column.dtype for column in read_table(path).columns.values()} == {np.dtype(float)}


def test_struct_fields_stand_under_dotted_names(tmp_path: Path) -> None:
    log = {"t": VECTOR, "drive": {"i": 2.0 * VECTOR, "name": "x"}}
    table = read_table(saved(tmp_path / "run.mat", {"log": log}))
    assert list(table.columns) == ["log.t", "log.drive.i"]
    recording = Recording.load(table.path, {"time": "log.t", "input": "log.drive.i"})
    np.testing.assert_array_equal(recording.input, 2.0 * VECTOR)


def test_scalars_text_and_matrices_are_passed_over(tmp_path: Path) -> None:
    others = {"k": 3.0, "name": "rig", "m": np.ones((300, 3)), "z": 1j * VECTOR, "none": []}
    table = read_table(saved(tmp_path / "run.mat", {"t": VECTOR, **others}))
    assert list(table.columns) == ["t"]
    assert set(table.unusable) == set(others)


def test_a_matrix_that_is_asked_for_is_refused(tmp_path: Path) -> None:
    path = saved(tmp_path / "run.mat", {"t": VECTOR, "q": VECTOR, "m": np.ones((300, 3))})
    with pytest.raises(InputError, match=r"'m', asked for as position, is a 300 x 3 matrix"):
        Recording.load(path, {"time": "t", "input": "t", "position": "m"})
    assert Recording.load(path, {"time": "t", "input": "t", "position": "q"}).position is not None


def test_vectors_of_unequal_length_are_refused_when_used_together(tmp_path: Path) -> None:
    path = saved(tmp_path / "run.mat", {"t": VECTOR, "u": VECTOR, "short": VECTOR[:-1]})
    with pytest.raises(InputError, match=r"input \(column 'short'\) has 299 rows, and time"):
        Recording.load(path, {"time": "t", "input": "short"})
    assert len(Recording.load(path, {"time": "t", "input": "u"})) == 300


def test_a_file_without_any_vector_says_what_it_holds(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none of its 1 variable is a vector .*k is a scalar"):
        read_table(saved(tmp_path / "run.mat", {"k": 3.0}))


def test_a_file_cut_short_is_refused(tmp_path: Path) -> None:
    path = saved(tmp_path / "run.mat", {"t": VECTOR})
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(InputError, match="cannot be read as a MAT file"):
        read_table(path)


def test_version_7_3_is_read_through_h5py(tmp_path: Path) -> None:
    table = read_table(saved_hdf5(tmp_path / "run.mat"))
    assert list(table.columns) == ["log.q", "t"]
    assert np.array_equal(table.columns["t"], VECTOR)
    assert set(table.unusable) == {"gain", "matrix", "title", "nothing"}


def test_version_7_3_without_h5py_names_the_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = saved_hdf5(tmp_path / "run.mat")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(InputError, match=r"version 7\.3.*h5py.*pip install 'stiction\[mat73\]'"):
        read_table(path)


def test_a_damaged_version_7_3_file_is_refused(tmp_path: Path) -> None:
    path = saved_hdf5(tmp_path / "run.mat")
    path.write_bytes(path.read_bytes()[:900])
    with pytest.raises(InputError, match="cannot be read as a MAT file"):
        read_table(path)
