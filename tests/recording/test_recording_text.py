"""Long text files: read in blocks, and the same by every way through a block."""

from __future__ import annotations

import tempfile
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from stiction.errors import InputError
from stiction.recording import read_table
from stiction.recording.text import lines, plain, rows

Written = Callable[..., Path]


def careful(*_: object) -> None:
    """No block is plain."""


WAYS: dict[str, Callable[[pytest.MonkeyPatch], None]] = {
    "with care": lambda patched: patched.setattr(rows, "plain_numbers", careful),
    "numpy": lambda patched: patched.setattr(plain, "_arrow", lambda: None),
    "pyarrow": lambda patched: None,
}


def answer(content: bytes, way: str, block: int) -> object:
    """Everything that is read, to the bit, or the sentence."""
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patched:
        WAYS[way](patched)
        patched.setattr(lines, "BLOCK", block)
        path = Path(folder) / "run.csv"
        path.write_bytes(content)
        try:
            table = read_table(path)
        except InputError as error:
            return str(error).replace(folder, "")
    length = len(next(iter(table.columns.values())))
    # One NaN is as good as another.
    bits = {
        name: np.where(np.isnan(values), np.nan, values).tobytes()
        for name, values in table.columns.items()
    }
    places = [table.place(row) for row in range(length)]
    return bits, table.cells, table.units, places


ODD = [
    "",
    " ",
    "\t",
    "nan",
    "NaN",
    "-nan",
    "NA",
    "inf",
    "abc",
    "#",
    "n",
    "0x10",
    "1_000",
    '"3"',
    "1 2",
]
ODD += ["1,5", "-,5", "1.", ".5", ".", "-", "-0", "00012", "+1", "++1", "+-1", "-+1"]
ODD += ["1e400", "1e-400", "4.9e-324", "2.5e-324", "e5", "1e", "1e+05", "1e5e"]
cell = st.one_of(
    st.floats().map(repr),
    st.floats(-1e3, 1e3).map(lambda x: f"{x:+.4f}"),
    st.integers(-(10**40), 10**40).map(str),
    st.sampled_from(ODD),
)
line = st.lists(cell, min_size=2, max_size=3)


@settings(deadline=None)
@given(
    st.lists(line, min_size=1, max_size=30),
    st.sampled_from([",", ";", "\t", "|", " ", ", ", " ; ", "  "]),
    st.sampled_from(["\n", "\r\n", "\r", "\n\n"]),
    st.booleans(),
    st.booleans(),
    st.sampled_from([1, 7, 64, 2**22]),
)
@example([["1", "2"], ["", ""]], "\t", "\n", False, False, 7)
@example([["1,5", "2"], ["1.5", "1,234"]] * 3, ";", "\n", False, True, 7)
@example([["1", "2"]] * 40 + [["3"]], " ", "\n", False, False, 7)
@example([["1", "2", ""]] * 9, ",", "\n", True, False, 64)
def test_every_way_through_a_block_reads_the_same(
    table: list[list[str]], delimiter: str, end: str, closed: bool, comma: bool, block: int
) -> None:
    pytest.importorskip("pyarrow", reason="pyarrow, which reads faster, is not installed")
    text = end.join(
        delimiter.join(row) + (delimiter.strip() if closed else "") for row in [["t", "x"], *table]
    )
    if comma:
        text = text.replace(".", ",")
    content = text.encode()
    expected = answer(content, "with care", 2**22)
    assert answer(content, "numpy", block) == expected
    assert answer(content, "pyarrow", block) == expected


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"t,x\n" + b"1,2\n" * 900 + b"1,2,3\n", "line 902 has 3 cells"),
        (b"t,x\r\n" + b"1,2\r\n" * 900 + b"\xb5\x05,2\r\n", "line 902 holds the byte 0xB5"),
        (b"t x\r" + b"1 2\r" * 900 + b"1\r2 3\r", "line 902 has 1 cell"),
        (b"t;x\n" + b"1;2\n" * 900 + b"\0", "line 902 holds a zero byte"),
    ],
)
def test_a_fault_in_a_later_block_is_told_by_its_line(
    content: bytes, message: str, way: str
) -> None:
    assert message in str(answer(content, way, 64))


@pytest.mark.parametrize("way", WAYS)
def test_text_in_a_later_block_is_told_by_its_line(way: str, written: Written) -> None:
    content = b"t,x\n" + b"1,2\n\n" * 300 + b"# pause\n3,abc\n" + b"1,2\n" * 50
    _, cells, _, places = answer(content, way, 64)  # type: ignore[misc]
    assert [(cell.row, cell.text) for cell in cells] == [(300, "abc")]
    assert [places[0], places[299], places[300], places[-1]] == [
        *("line 2", "line 600", "line 603", "line 653")
    ]


def test_decimal_commas_far_above_a_decimal_point_are_read_again_as_text(
    written: Written, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lines, "BLOCK", 64)
    table = read_table(written(["t;x", *["1;2,500"] * 100, "1;2.5"]))
    assert len(table.cells) == 20
    assert np.isnan(table.columns["x"][:100]).all()
    assert table.columns["x"][100] == 2.5


@pytest.mark.parametrize("way", ["numpy", "pyarrow"])
def test_a_long_file_takes_little_more_memory_than_its_columns(
    written: Written, monkeypatch: pytest.MonkeyPatch, way: str
) -> None:
    WAYS[way](monkeypatch)
    monkeypatch.setattr(lines, "BLOCK", 2**16)
    count = 100_000
    path = written(["t,u,x", *["0.001,1.25,-3.5e-3"] * count])
    tracemalloc.start()
    try:
        table = read_table(path)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert len(table.columns["x"]) == count
    # One column stands twice while its blocks are joined; the blocks themselves are small.
    assert peak < 1.7 * 3 * 8 * count
