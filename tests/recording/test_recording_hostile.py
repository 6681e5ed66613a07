"""Files from strangers: none reads another file, takes all memory, or ends in a traceback."""

from __future__ import annotations

import io
import json
import os
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io  # type: ignore[import-untyped]

from stiction.errors import InputError
from stiction.recording import formats, read_table
from stiction.recording.expansion import VARIABLE
from stiction.recording.text import lines as lines_of_text

Written = Callable[..., Path]
VECTOR = np.linspace(0.0, 1.0, 300)


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_table(path)
    sentence = str(caught.value)
    assert sentence.startswith(f"{path}: ")
    assert "\n" not in sentence
    return sentence


@pytest.fixture
def little(monkeypatch: pytest.MonkeyPatch) -> None:
    """A file may expand to 100 000 bytes."""
    monkeypatch.setenv(VARIABLE, "100000")


def hdf5(path: Path, write: Callable[[Any, Any], None]) -> Path:
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        file["t"] = VECTOR
        write(file, h5py)
    return path


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    path = tmp_path / "secret.h5"
    hdf5(path, lambda file, h5py: None)
    return path


def test_links_into_another_file_are_refused(tmp_path: Path, secret: Path) -> None:
    def write(file: Any, h5py: Any) -> None:
        file["log/q"] = h5py.ExternalLink(str(secret), "/t")

    sentence = refusal(hdf5(tmp_path / "run.mat", write))
    assert "variable 'log.q' is a link into another file" in sentence
    assert "save the values themselves" in sentence


def test_links_within_a_file_are_refused(tmp_path: Path, secret: Path) -> None:
    def write(file: Any, h5py: Any) -> None:
        file["#refs#/q"] = h5py.ExternalLink(str(secret), "/t")
        file["q"] = h5py.SoftLink("/#refs#/q")

    assert "variable 'q' is a link to another" in refusal(hdf5(tmp_path / "run.mat", write))


def test_values_in_another_file_are_refused(tmp_path: Path, secret: Path) -> None:
    def write(file: Any, h5py: Any) -> None:
        file.create_dataset("q", (300,), "f8", external=[(str(secret), 0, 2400)])

    assert "'q' has its values in another file" in refusal(hdf5(tmp_path / "run.mat", write))


def test_virtual_data_sets_are_refused(tmp_path: Path, secret: Path) -> None:
    def write(file: Any, h5py: Any) -> None:
        layout = h5py.VirtualLayout((300,), "f8")
        layout[:] = h5py.VirtualSource(str(secret), "t", (300,))
        file.create_virtual_dataset("q", layout)

    assert "'q' is put together from other files" in refusal(hdf5(tmp_path / "run.mat", write))


def test_references_records_and_types_are_passed_over(tmp_path: Path) -> None:
    def write(file: Any, h5py: Any) -> None:
        file.create_dataset("cells", (10**9,), h5py.ref_dtype, chunks=(1000,))
        file["records"] = np.zeros(3, dtype=[("a", "f8"), ("b", "f8")])
        file["complex"] = np.zeros(3, dtype=[("real", "f8"), ("imag", "f8")])
        file["words"] = ["a", "b"]
        file["type"] = np.dtype("f8")
        file["again"] = file

    table = read_table(hdf5(tmp_path / "run.mat", write))
    assert list(table.columns) == ["t"]
    assert table.unusable == {
        "again": "is a struct that stands there under another name too",
        "cells": "holds text or cells, not numbers",
        "complex": "holds complex numbers",
        "records": "holds records, not numbers",
        "type": "is a type, not numbers",
        "words": "holds text or cells, not numbers",
    }


def test_rows_that_are_declared_and_not_there_are_refused(tmp_path: Path) -> None:
    def write(file: Any, h5py: Any) -> None:
        file.create_dataset("q", (10**12,), "f8", chunks=(1000,))

    sentence = refusal(hdf5(tmp_path / "run.mat", write))
    assert "with variable 'q' the file expands to 1.49e+04 GiB, and 4 GiB are allowed" in sentence
    assert f"set the environment variable {VARIABLE}" in sentence


def test_a_chunk_that_expands_beyond_its_shape_is_refused(tmp_path: Path, little: None) -> None:
    def write(file: Any, h5py: Any) -> None:
        data = file.create_dataset("q", (300,), "f8", chunks=(300,), compression="gzip")
        data.id.write_direct_chunk((0,), zlib.compress(bytes(10**6)))

    sentence = refusal(hdf5(tmp_path / "run.mat", write))
    assert "a chunk of variable 'q' is longer than its own shape" in sentence


def test_the_ceiling_can_be_raised(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    np.savez_compressed(tmp_path / "run.npz", t=np.zeros(10_000))
    monkeypatch.setenv(VARIABLE, "100000")
    assert "with array 't' the file expands to" in refusal(tmp_path / "run.npz")
    monkeypatch.setenv(VARIABLE, "200000")
    assert len(read_table(tmp_path / "run.npz").columns["t"]) == 10_000


@pytest.mark.parametrize("given", ["4GiB", "-1", "0", "1e9", "9" * 30])
def test_a_ceiling_that_is_no_number_of_bytes_is_refused(
    written: Written, lines: list[str], monkeypatch: pytest.MonkeyPatch, given: str
) -> None:
    monkeypatch.setenv(VARIABLE, given)
    with pytest.raises(InputError, match=f"{VARIABLE} is '{given}'; give a whole number"):
        read_table(written(lines))


def test_arrays_of_an_archive_add_up(tmp_path: Path, little: None) -> None:
    np.savez_compressed(tmp_path / "run.npz", **{f"a{k}": np.zeros(1000) for k in range(7)})
    assert "array 'a6'" in refusal(tmp_path / "run.npz")


def archive(path: Path, header: str, packing: int = zipfile.ZIP_DEFLATED) -> Path:
    text = header.encode().ljust(118)
    with zipfile.ZipFile(path, "w", packing) as file:
        file.writestr("t.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text)
    return path


@pytest.mark.parametrize("shape", ["(10**9,)", "(1000000000000,)", "(-3,)", "(" * 90, "'a'"])
def test_an_array_with_an_absurd_header_is_damage(tmp_path: Path, shape: str) -> None:
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"
    assert "archive is damaged" in refusal(archive(tmp_path / "run.npz", header))


def test_other_ways_of_packing_are_not_unpacked(tmp_path: Path) -> None:
    path = archive(tmp_path / "run.npz", "", zipfile.ZIP_BZIP2)
    assert "t is packed in a way that NumPy does not write" in refusal(path)


def test_one_name_twice_in_an_archive_is_refused(tmp_path: Path) -> None:
    data = io.BytesIO()
    np.save(data, VECTOR)
    with zipfile.ZipFile(tmp_path / "run.npz", "w") as file:
        file.writestr("t.npy", data.getvalue())
        with pytest.warns(UserWarning, match="Duplicate"):
            file.writestr("t.npy", data.getvalue())
    assert "the array 't' stands there twice" in refusal(tmp_path / "run.npz")


def element(kind: int, data: bytes) -> bytes:
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def variable(name: str, kind: int, shape: tuple[int, ...], *within: bytes) -> bytes:
    parts = [
        element(6, struct.pack("<II", kind, 0)),
        element(5, struct.pack(f"<{len(shape)}i", *shape)),
        element(1, name.encode()),
        *within,
    ]
    return element(14, b"".join(parts))


def matlab(path: Path, *variables: bytes, packed: bool = True) -> Path:
    if packed:
        small = [zlib.compress(each) for each in variables]
        variables = tuple(struct.pack("<II", 15, len(each)) + each for each in small)
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    path.write_bytes(head + b"".join(variables))
    return path


DOUBLES = element(9, VECTOR.tobytes())


@pytest.mark.parametrize("packed", [True, False])
def test_variables_are_walked_through_as_they_are_written(tmp_path: Path, packed: bool) -> None:
    within = variable("", 6, (300, 1), DOUBLES)
    path = matlab(
        tmp_path / "run.mat",
        variable("t", 6, (300, 1), DOUBLES),
        variable("c", 1, (1, 2), within, within),
        packed=packed,
    )
    table = read_table(path)
    assert np.array_equal(table.columns["t"], VECTOR)
    assert list(table.unusable) == ["c"]


@pytest.mark.parametrize(
    ("own", "message"),
    [
        (variable("t", 6, (1, 2**30), DOUBLES), "with variable 't' the file expands to 8 GiB"),
        (variable("t", 6, (2, 2**30), DOUBLES), "is a 2 x 1073741824 matrix"),
        (variable("t", 4, (10**9, 9), element(16, b"")), "t holds text or cells"),
        (variable("t", 2, (10**9, 9), element(5, b"\0\0\0\1"), b""), "an element is longer"),
        (variable("t", 6, (-1, 9)), "a variable has a length below 0"),
        (variable("t", 6, (299, 1), DOUBLES), "an element is longer than it can be"),
        (variable("t", 6, (301, 1), DOUBLES), "'t' has 300 values in place of 301"),
        (variable("t", 6, (300, 1), element(11, VECTOR.tobytes())), "holds elements of kind 11"),
        (variable("t", 6, (300, 1), struct.pack("<II", 9, 2**31)), "an element is longer"),
        (variable("t", 6, (300, 1), struct.pack("<HH", 9, 9) + b"1234"), "longer than its tag"),
        (struct.pack("<II", 14, 2**31), "it ends within a variable"),
    ],
)
def test_a_variable_that_asks_for_more_than_it_holds_is_refused(
    tmp_path: Path, own: bytes, message: str
) -> None:
    assert message in refusal(matlab(tmp_path / "run.mat", own))


def test_a_variable_that_unpacks_to_gigabytes_is_refused_before(
    tmp_path: Path, little: None
) -> None:
    scipy.io.savemat(tmp_path / "run.mat", {"t": np.zeros(20_000)}, do_compression=True)
    assert (tmp_path / "run.mat").stat().st_size < 1000
    assert "the file expands to" in refusal(tmp_path / "run.mat")


def test_structs_within_structs_are_refused_beyond_a_depth(tmp_path: Path) -> None:
    own = variable("", 6, (300, 1), DOUBLES)
    for _ in range(100):
        own = variable("s", 2, (1, 1), element(5, struct.pack("<i", 8)), element(1, b"a"), own)
    assert "it is nested more than 64 deep" in refusal(matlab(tmp_path / "run.mat", own))


def test_a_name_of_thousands_of_bytes_does_not_fill_the_screen(tmp_path: Path) -> None:
    own = variable("\x1b" * 20_000, 6, (1, 1), element(9, bytes(8)))
    sentence = refusal(matlab(tmp_path / "run.mat", own))
    assert len(sentence) < 4000
    assert sentence.endswith("save time, input and position as vectors")


def test_a_packed_variable_that_is_damaged_is_refused(tmp_path: Path) -> None:
    path = matlab(tmp_path / "run.mat", variable("t", 6, (300, 1), DOUBLES))
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    assert "incorrect data check" in refusal(path)
    longer = variable("t", 6, (300, 1), DOUBLES) + bytes(8)
    assert "a packed variable is longer than it says" in refusal(matlab(path, longer))


def test_one_name_twice_in_a_matlab_file_is_refused(tmp_path: Path) -> None:
    own = variable("t", 6, (300, 1), DOUBLES)
    assert "the variable 't' stands there twice" in refusal(matlab(tmp_path / "run.mat", own, own))


def test_a_column_of_one_value_over_and_over_counts_as_its_rows(
    tmp_path: Path, little: None
) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    parquet.write_table(pyarrow.table({"t": np.zeros(100_000)}), tmp_path / "run.parquet")
    assert (tmp_path / "run.parquet").stat().st_size < 2000
    assert "with column 't' the file expands to" in refusal(tmp_path / "run.parquet")


def test_text_in_a_parquet_file_is_not_unpacked(tmp_path: Path, little: None) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    table = pyarrow.table({"t": VECTOR, "note": ["x" * 10_000] * 300})
    parquet.write_table(table, tmp_path / "run.parquet")
    assert read_table(tmp_path / "run.parquet").unusable == {"note": "holds string, not numbers"}


@pytest.mark.parametrize(
    "content",
    [
        json.dumps([{f"k{k}": 1} for k in range(200)]),
        "[" + "[]," * 2000 + "{}]",
    ],
)
def test_json_that_grows_in_memory_is_refused(written: Written, little: None, content: str) -> None:
    assert "the file expands to" in refusal(written(content.encode(), "run.json"))


def test_short_lines_under_a_wide_header_are_refused(written: Written, little: None) -> None:
    names = ",".join(f"c{k}" for k in range(200))
    sentence = refusal(written([names, *["1"] * 100]))
    assert "rows of 200 columns the file expands to" in sentence


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"a," * 600_000, "line 1 is longer than 1 MiB"),
        (b"t,x\n1,2\n" + b"1," * 600_000 + b"\n", "line 3 is longer than 1 MiB"),
        (b"t,x\n1,2\n" + b"9" * 9_000_000, "line 3 is longer than 1 MiB"),
        (b"a" * 9_000_000 + b"\n1\n", "line 1 is longer than 1 MiB"),
    ],
)
def test_a_line_without_end_is_refused(written: Written, content: bytes, message: str) -> None:
    assert message in refusal(written(content))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"[" * 100_000, "nested too deeply"),
        (b'{"a":' * 100_000, "nested too deeply"),
        (b'[{"t": ' + b"9" * 1_000_000 + b"}]", "a number in it has thousands of digits"),
        (b'[{"t": 1, "t": 2}]', "one object names 't' twice"),
        (b'[{"\\ud800": 1, "\\ud800": 2}]', r"one object names '\ud800' twice"),
    ],
)
def test_json_from_a_stranger_is_refused(written: Written, content: bytes, message: str) -> None:
    assert message in refusal(written(content, "run.json"))


def test_json_knows_what_is_not_a_number(written: Written) -> None:
    table = read_table(written(b'[{"t": NaN, "x": -Infinity, "y": [1]}]', "run.json"))
    assert np.isnan(table.columns["t"][0])
    assert table.columns["x"][0] == -np.inf
    assert table.cells[0].text == "[...]"


def test_names_that_would_act_on_a_terminal_are_shown_escaped(written: Written) -> None:
    table = read_table(written(b"t,\x1b[31mx\x1b[0m,\xc2\x9by\n0,1,2\n"))
    assert list(table.columns) == ["t", r"\x1b[31mx\x1b[0m", r"\x9by"]
    table = read_table(written(b'[{"a\\ud800": 1, "b\\u001b": 1}]', "run.json"))
    assert list(table.columns) == [r"a\ud800", r"b\x1b"]
    sentence = refusal(written(b"t,\x1bx,\x1bx\n0,1,2\n"))
    assert r"two columns '\x1bx'" in sentence


def test_a_file_name_that_is_no_text_can_be_told(tmp_path: Path) -> None:
    path = tmp_path / os.fsdecode(b"run\xff\n.csv")
    with pytest.raises(InputError, match=r"run\\udcff\\n\.csv: there is no such file") as caught:
        read_table(path)
    str(caught.value).encode()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes have no names here")
def test_pipes_and_devices_are_refused_and_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "run.csv")
    assert "this is a pipe and no file" in refusal(tmp_path / "run.csv")
    (tmp_path / "zero.csv").symlink_to("/dev/zero")
    assert "this is a device and no file" in refusal(tmp_path / "zero.csv")


def test_a_file_that_grows_while_it_is_read_is_refused(
    written: Written, lines: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = written(lines)
    chosen = formats.FORMATS[0]

    def read(file: Path) -> Any:
        table = chosen.read(file)
        with file.open("a") as logger:
            logger.write("0.24,0,0\n")
        return table

    grown = formats.Format(chosen.name, chosen.suffixes, read)
    monkeypatch.setattr(formats, "FORMATS", (grown,))
    assert "the file changed while it was read" in refusal(path)


def test_what_is_added_while_blocks_are_read_is_left(
    written: Written, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lines_of_text, "BLOCK", 8)
    content = b"t,x\n" + b"1,2\n" * 100
    path = written(content)
    read = b""
    for block in lines_of_text.blocks(path):
        read += block.data
        with path.open("ab") as logger:
            logger.write(b"3,4\n" * 10)
    assert read == content
