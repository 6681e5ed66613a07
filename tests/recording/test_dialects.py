"""Text as instruments, spreadsheets and measuring programs write it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from stiction.errors import InputError
from stiction.recording import Recording, read_table

Written = Callable[..., Path]
PLAIN = {"t": [0.0, 1.0, 2.0, 3.0], "x": [0.5, -1.5, 250.0, 4.0]}
ROWS = ["0,0.5", "1,-1.5", "2,250", "3,4"]
GERMAN = ["0;0,5", "1;-1,5", "2;250", "3;4"]


def columns_of(path: Path) -> dict[str, list[float]]:
    return {name: column.tolist() for name, column in read_table(path).columns.items()}


def test_without_a_header_columns_go_by_number(written: Written) -> None:
    path = written([f"{0.01 * k},{k % 7},{k % 5}" for k in range(300)])
    assert list(read_table(path).columns) == ["column 1", "column 2", "column 3"]
    assert read_table(path).place(0) == "line 1"
    columns = {"time": 1, "input": {"name": 3, "unit": "A"}, "position": "column 2"}
    found = Recording.load(path, columns)
    assert found.input is not None
    np.testing.assert_array_equal(found.input[:6], [0, 1, 2, 3, 4, 0])
    assert found.dt == pytest.approx(0.01)


def test_columns_of_a_header_go_by_number_too(written: Written) -> None:
    path = written(["a,b,c", *(f"{0.01 * k},{k % 7},{k % 5}" for k in range(300))])
    found = Recording.load(path, {"time": 1, "input": 3, "position": 2})
    np.testing.assert_array_equal(found.position[:3], [0, 1, 2])
    with pytest.raises(InputError, match="no column 'column 4', asked for as input"):
        Recording.load(path, {"time": 1, "input": 4, "position": 2})
    for number in (0, -1, True, 1.5):
        with pytest.raises(InputError, match=r"name of the column is|name of a column"):
            Recording.load(path, {"time": number, "input": 3, "position": 2})


@pytest.mark.parametrize(
    "content",
    [
        ["sep=,", "t,x", *ROWS],
        ["sep=;", "t;x", *GERMAN],
        ['"sep=;"', "t;x", *GERMAN],
        ["A title of a measurement", "t,x", *ROWS],
        ["A title, with a comma", "t,x", *ROWS],
        ["Prüfstand 3", "", "t;x", *GERMAN],
        ["Model,TDS2024", "Record Length,2500", "Sample Interval,1e-3", "t,x", *ROWS],
        ["Channel;1", "Rate;1000;Hz", "Note;a;b;c", "t;x", *GERMAN],
    ],
)
def test_titles_and_preambles_are_passed_over(written: Written, content: list[str]) -> None:
    assert columns_of(written(content)) == PLAIN
    assert columns_of(written("\r\n".join(content).encode("utf-16"))) == PLAIN
    assert columns_of(written(b"\xef\xbb\xbf" + "\r\n".join(content).encode())) == PLAIN


def test_a_preamble_of_hundreds_of_lines_is_passed_over(written: Written) -> None:
    preamble = [f"Channel {k},on,{k}" for k in range(300)]
    path = written([*preamble, "t,x", "s,deg", *ROWS])
    assert columns_of(path) == PLAIN
    assert read_table(path).units == {"t": "s", "x": "deg"}
    assert read_table(path).place(0) == "line 303"


def test_latin_1_is_read_with_its_signs(written: Written) -> None:
    path = written("t,Weg [µm],Wärme [°C]\n0,1,2\n1,2,3\n2,3,4\n".encode("latin-1"))
    assert list(read_table(path).columns) == ["t", "Weg [µm]", "Wärme [°C]"]


def test_utf_16_is_read_in_blocks(written: Written, monkeypatch: pytest.MonkeyPatch) -> None:
    from stiction.recording.text import lines

    monkeypatch.setattr(lines, "BLOCK", 37)
    text = "t,x\r\n" + "".join(f"{k},{-k}\r\n" for k in range(400))
    for encoding in ("utf-16-le", "utf-16-be"):
        mark = "\ufeff".encode(encoding)
        path = written(mark + text.encode(encoding))
        assert columns_of(path)["x"] == [-float(k) for k in range(400)]


@pytest.mark.parametrize(
    ("stamps", "begins"),
    [
        (["2024-05-01T12:00:00.000Z", "2024-05-01T12:00:00.250Z", "2024-05-01T12:00:01Z"], 1.0),
        (["2024-05-01 14:00:00+02:00", "2024-05-01 14:00:00.25+02:00",
          "2024-05-01 14:00:01.000000000+02:00"], 1.0),
        (["1.5.2024 12:00:00,000", "1.5.2024 12:00:00,250", "1.5.2024 12:00:01,000"], 1.0),
        (["5/1/2024 12:00:00 PM", "5/1/2024 12:00:00.25 PM", "5/1/2024 12:00:01 PM"], 1.0),
        (["23:59:59.75", "0:00:00.000", "00:00:00.75"], None),
        (["58:59.75", "59:00.00", "59:00.75"], None),
    ],
)  # fmt: skip
def test_dates_and_times_of_day_are_seconds(
    written: Written, stamps: list[str], begins: float | None
) -> None:
    path = written(["when;x", *(f"{stamp};{k}" for k, stamp in enumerate(stamps))])
    table = read_table(path)
    assert columns_of(path)["when"] == [0.0, 0.25, 1.0]
    assert table.units == {"when": "s"}
    assert table.begins == ({} if begins is None else {"when": 1714564800.0})


def test_stamps_keep_their_nanoseconds(written: Written) -> None:
    path = written(["t,x", *(f"2024-05-01T12:00:00.{k:09d},1" for k in range(5))])
    assert columns_of(path)["t"] == pytest.approx([0.0, 1e-9, 2e-9, 3e-9, 4e-9], rel=1e-12)


def test_what_is_no_stamp_among_stamps_is_a_fault_of_its_line(written: Written) -> None:
    good = [f"12:00:0{k},1" for k in range(5)]
    table = read_table(written(["t,x", *good, "12:61:00,1", ",1"]))
    assert [(cell.row, cell.text) for cell in table.cells] == [(5, "12:61:00")]
    assert np.isnan(table.columns["t"][5:]).all()


@pytest.mark.parametrize(
    ("whole", "nano"),
    [("header.stamp.sec", "header.stamp.nanosec"), ("secs", "nsecs"), ("t_s", "t_nsec")],
)
def test_seconds_and_nanoseconds_are_one_clock(written: Written, whole: str, nano: str) -> None:
    start = 1_714_564_800
    rows = [f"{start + k // 4},{250_000_000 * (k % 4) + 1},{k}" for k in range(300)]
    path = written([f"{whole},{nano},x", *rows])
    table = read_table(path)
    clock = next(name for name in table.columns if name != "x")
    assert clock.startswith(f"{whole} + n")
    np.testing.assert_allclose(table.columns[clock], 0.25 * np.arange(300), atol=1e-9)
    assert table.begins[clock] == pytest.approx(start)
    with pytest.raises(InputError, match="is a part of the clock"):
        Recording.load(path, {"time": whole, "input": "x"})


def lvm(*, times: bool, comma: bool) -> bytes:
    """As LabVIEW's "Write To Measurement File" writes it, two channels."""
    rows = [(0.0, 1.0, -0.5), (0.001, 1.5, -0.25), (0.002, 2.0, 0.125)]
    lines = [
        "LabVIEW Measurement\t",
        "Writer_Version\t2",
        "Reader_Version\t2",
        "Separator\tTab",
        f"Decimal_Separator\t{',' if comma else '.'}",
        "Multi_Headings\tNo",
        f"X_Columns\t{'One' if times else 'No'}",
        "Time_Pref\tRelative",
        "Operator\tsomebody",
        "Date\t2024/05/01",
        "Time\t12:00:00,5",
        "***End_of_Header***\t",
        "\t",
        "Channels\t2\t\t",
        "Samples\t3\t3\t",
        "Date\t2024/05/01\t2024/05/01\t",
        "Time\t12:00:00,5\t12:00:00,5\t",
        "Y_Unit_Label\tVolts\tAmps\t",
        "X_Dimension\tTime\tTime\t",
        "X0\t0.0000000000000000E+0\t0.0000000000000000E+0\t",
        "Delta_X\t0.001000\t0.001000\t",
        "***End_of_Header***\t\t\t",
        "X_Value\tTacho\tCurrent\tComment",
    ]
    for t, a, b in rows:
        cells = [f"{t:.6f}" if times else "", f"{a:.6f}", f"{b:.6f}"]
        lines.append("\t".join(cells) + ("\tstart" if t == 0.0 else ""))
    text = "\r\n".join(lines) + "\r\n"
    if comma:
        text = text.replace(".", ",")
    return text.encode()


@pytest.mark.parametrize("times", [True, False])
@pytest.mark.parametrize("comma", [True, False])
def test_labview_measurements_are_read(written: Written, times: bool, comma: bool) -> None:
    table = read_table(written(lvm(times=times, comma=comma), "run.lvm"))
    assert {name: column.tolist() for name, column in table.columns.items()} == {
        "X_Value": pytest.approx([0.0, 0.001, 0.002]),
        "Tacho": [1.0, 1.5, 2.0],
        "Current": [-0.5, -0.25, 0.125],
    }
    assert table.units == {"X_Value": "s", "Tacho": "V", "Current": "A"}
    assert table.cells == ()
    assert table.begins == {"X_Value": 1714564800.5}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"t,x\n0,1\n", "no LabVIEW measurement"),
        (lvm(times=True, comma=False)[:300], "no line of names.*cut off"),
        (lvm(times=False, comma=False).replace(b"Delta_X", b"Delta"), "no step of time"),
        (lvm(times=True, comma=False).split(b"Comment")[0] + b"Comment\r\n", "no rows under it"),
    ],
)
def test_damaged_labview_measurements_are_refused(
    written: Written, content: bytes, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        read_table(written(content, "run.lvm"))
