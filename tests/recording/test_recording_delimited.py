from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stiction.errors import InputError
from stiction.recording import read_table
from stiction.recording.text import plain

Written = Callable[..., Path]


@pytest.fixture(params=["pyarrow", "numpy"], autouse=True, scope="module")
def reader(request: pytest.FixtureRequest) -> Iterator[None]:
    """All of this holds with pyarrow and without."""
    if request.param == "pyarrow":
        pytest.importorskip("pyarrow", reason="pyarrow, which reads faster, is not installed")
    with pytest.MonkeyPatch.context() as patched:
        if request.param == "numpy":
            patched.setattr(plain, "_arrow", lambda: None)
        yield


def columns_of(path: Path) -> dict[str, list[float]]:
    return {name: column.tolist() for name, column in read_table(path).columns.items()}


PLAIN = {"t": [0.0, 1.0, 2.0], "x": [0.5, -1.5, 250.0]}


@pytest.mark.parametrize(
    "content",
    [
        ["t,x", "0,0.5", "1,-1.5", "2,2.5e2"],
        ["t, x", "0, 0.5", "1, -1.5", "2, 2.5e2"],
        ["t;x", "0;0.5", "1;-1.5", "2;2.5e2"],
        ["t;x", "0;0,5", "1;-1,5", "2;2,5e2"],
        ["t\tx", "0\t0.5", "1\t-1.5", "2\t250"],
        ["t|x", "0|0.5", "1|-1.5", "2|250"],
        ["  t    x", "  0    0.5", "  1   -1.5", "  2  250"],
        ["t x", "0 0,5", "1 -1,5", "2 250"],
        ["# t,x", "0,0.5", "1,-1.5", "2,250"],
        ["# a machine", "", "t,x", "# rest", "0,0.5", "1,-1.5", "", "2,250"],
        ['"t","x"', '"0","0.5"', "1,-1.5", "2,250"],
        ["t,x,", "0,0.5,", "1,-1.5,", "2,250,"],
        ["t,x", "0,0.5,", "1,-1.5,", "2,250,"],
    ],
)
def test_one_table_in_many_spellings(written: Written, content: list[str]) -> None:
    assert columns_of(written(content)) == PLAIN


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_any_line_end_and_a_byte_order_mark_are_read(written: Written, end: bytes) -> None:
    content = b"\xef\xbb\xbf" + end.join([b"t,x", b"0,0.5", b"1,-1.5", b"2,250"])
    assert columns_of(written(content)) == PLAIN


def test_names_with_blanks_units_and_signs_stay_as_they_are(written: Written) -> None:
    path = written(["Time (s), pos [µm],", "0,1,", "1,2,"])
    assert list(read_table(path).columns) == ["Time (s)", "pos [µm]"]


@pytest.mark.parametrize(
    ("content", "units"),
    [
        (["t,x", "s,deg", "0,0.5", "1,-1.5", "2,250"], {"t": "s", "x": "deg"}),
        (["t;x;", "[ms];(µm);", "0;0,5;", "1;-1,5;", "2;250;"], {"t": "ms", "x": "µm"}),
        (["t x", "s rad/s", "0 0.5", "1 -1.5", "2 250"], {"t": "s", "x": "rad/s"}),
    ],
)
def test_a_line_of_units_below_the_header_is_no_row(
    written: Written, content: list[str], units: dict[str, str]
) -> None:
    table = read_table(written(content))
    assert columns_of(written(content)) == PLAIN
    assert table.units == units
    assert table.place(0) == "line 3"
    assert [table.heading(name) for name in table.columns] == [
        f"{name} [{unit}]" for name, unit in units.items()
    ]


def test_of_some_columns_the_line_of_units_may_say_nothing(written: Written) -> None:
    table = read_table(written(["t,x,mu,mode", "s,A,[-],", "0,1,2,3"]))
    assert table.units == {"t": "s", "x": "A", "mu": "-"}
    assert [column.tolist() for column in table.columns.values()] == [[0.0], [1.0], [2.0], [3.0]]


@pytest.mark.parametrize("line", ["s,furlong", "s,", "1,A", "0,A", "1,1", ",", "[x],[y]"])
def test_a_line_of_something_else_is_no_line_of_units(written: Written, line: str) -> None:
    assert not read_table(written(["t,x,", f"{line}", "1,2", "2,3"])).units


def test_a_text_cell_is_known_by_its_line(written: Written) -> None:
    table = read_table(written(["# head", "t,x", "0,1", "", "1,abc", "2,1_000"]))
    assert [(cell.row, cell.column, cell.text) for cell in table.cells] == [
        (1, "x", "abc"),
        (2, "x", "1_000"),
    ]
    assert table.place(1) == "line 5"
    assert np.isnan(table.columns["x"][1:]).all()


@pytest.mark.parametrize("cell", ["", "nan", "NaN", "NA", "null"])
def test_a_missing_cell_is_not_text(written: Written, cell: str) -> None:
    table = read_table(written(["t,x", "0,1", f"1,{cell}", "2,3"]))
    assert table.cells == ()
    assert np.isnan(table.columns["x"][1])


def test_grouped_thousands_are_not_taken_for_decimal_commas(written: Written) -> None:
    table = read_table(written(["t;x", "0.5;1,234", "1.5;2"]))
    assert [cell.text for cell in table.cells] == ["1,234"]
    assert columns_of(written(["t;x", "0,5;1,234", "1,5;2"]))["x"] == [1.234, 2.0]


def test_a_last_line_broken_off_is_filled_up_as_missing(written: Written) -> None:
    table = read_table(written(b"t,x,y\n0,1,2\n1,2,3\n2,3"))
    assert np.isnan(table.columns["y"][2])


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\n\n# only remarks\n", "no line of data"),
        (b"time_s,current_a\n", r"a header \(2 columns\) and no rows"),
        (b"t,x,t\n0,1,2\n", "line 1 names two columns 't'"),
        (b"t,x\n0,1\n1,2,3\n2,3\n", "line 3 has 3 cells, and the header .line 1. names 2"),
        (b"t,x\n0,0,1,0\n1,0,2,0\n", "write decimal points, or separate"),
        (b"t x\n0 1\n1\n2 3\n", "line 3 has 1 cell, .*write nan"),
        (b"t,x\n0,1\n\xb5\x05,2\n", r"line 3 holds the byte 0xB5, .* not UTF-8.*no text at all"),
        ("t,x\n0,1\n".encode("utf-16")[:-1], "begins as UTF-16 and is none further on"),
        (b"t,x\n0,1\n\0\0", "line 3 holds a zero byte"),
    ],
)
def test_what_is_no_table_is_refused_in_a_sentence(
    written: Written, content: bytes, message: str
) -> None:
    path = written(content)
    with pytest.raises(InputError, match=message) as caught:
        read_table(path)
    assert str(caught.value).startswith(f"{path}: ")


def test_micro_signs_in_utf_8_are_welcome(written: Written) -> None:
    assert columns_of(written("t,x_µm\n0,1\n".encode())) == {"t": [0.0], "x_µm": [1.0]}


cells = st.floats(allow_nan=False)


@given(
    st.lists(st.tuples(cells, cells, cells), min_size=1, max_size=20),
    st.sampled_from([",", ";", "\t", "|", " "]),
    st.booleans(),
)
def test_numbers_written_are_the_numbers_read(
    rows: list[tuple[float, float, float]], delimiter: str, comma: bool
) -> None:
    lines = [delimiter.join("abc"), *(delimiter.join(map(repr, row)) for row in rows)]
    text = "\n".join(lines)
    if comma and delimiter != ",":
        text = text.replace(".", ",")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.csv"
        path.write_text(text)
        table = read_table(path)
    read = np.column_stack([table.columns[name] for name in "abc"])
    np.testing.assert_array_equal(read, np.array(rows))
