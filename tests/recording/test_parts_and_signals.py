"""Parts of files, files of one signal each, patterns, and faults told together."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.cli import run
from stiction.errors import InputError
from stiction.recording import Recording

ROWS = 600
COLUMNS = {"time": "t", "input": {"name": "i", "unit": "A"}, "position": "q"}


def written(path: Path, seed: int = 0, names: str = "t,i,q") -> Path:
    time = 10.0 + 0.01 * np.arange(ROWS)
    table = np.column_stack([time, np.sin(time + seed), np.cos(3.0 * time + seed)])
    np.savetxt(path, table, delimiter=",", header=names, comments="")
    return path


def session(folder: Path, *entries: str) -> Path:
    head = '[columns]\ntime = "t"\ninput = { name = "i", unit = "A" }\nposition = "q"\n'
    path = folder / "session.toml"
    path.write_text(head + "".join(f"[[recordings]]\n{entry}\n" for entry in entries))
    return path


@pytest.mark.parametrize(
    ("begin", "end", "rows"),
    [
        (None, None, (0, 600)),
        (12.0, None, (200, 600)),
        (12.0, 15.0, (200, 501)),
        ("row 201", "row 501", (200, 501)),
        ("row 201", 15.0, (200, 501)),
        (-5.0, 99.0, (0, 600)),
    ],
)
def test_a_part_goes_from_and_to_a_time_or_a_row(
    tmp_path: Path, begin: float | str | None, end: float | str | None, rows: tuple[int, int]
) -> None:
    path = written(tmp_path / "run.csv")
    whole = Recording.load(path, COLUMNS)
    part = Recording.load(path, COLUMNS, begin=begin, end=end)
    np.testing.assert_array_equal(part.time, whole.time[slice(*rows)])
    np.testing.assert_array_equal(part.position, whole.position[slice(*rows)])


@pytest.mark.parametrize(
    ("begin", "end", "message"),
    [
        (99.0, None, "nothing lies from 99 s to its end: the file has 600 rows, from 10 s to"),
        (13.0, 12.0, "nothing lies from 13 s to 12 s"),
        ("row 601", None, "from = 'row 601': give a row from 'row 1' to 'row 600'"),
        (None, "line 3", "to = 'line 3': give a row"),
        (float("nan"), None, "from: nan is not a number"),
        (12.0, 13.0, "101 rows"),
    ],
)
def test_a_part_that_is_none_is_refused(
    tmp_path: Path, begin: float | str | None, end: float | str | None, message: str
) -> None:
    path = written(tmp_path / "run.csv")
    with pytest.raises(InputError, match=message):
        Recording.load(path, COLUMNS, begin=begin, end=end)


def test_a_fault_in_a_part_is_told_by_its_line_in_the_file(tmp_path: Path) -> None:
    path = written(tmp_path / "run.csv")
    lines = path.read_text().splitlines()
    lines[301] = lines[301].rpartition(",")[0] + ","
    path.write_text("\n".join(lines))
    assert "line 302" in Recording.load(path, COLUMNS, begin=12.0).notes[0]


def test_a_session_takes_parts_of_one_file(tmp_path: Path) -> None:
    written(tmp_path / "run.csv")
    one = 'file = "run.csv"\nfrom = 10.0\nto = 12.5'
    two = 'file = "run.csv"\nfrom = "row 300"'
    found = st.load(session(tmp_path, one, 'file = "run.csv"\nfrom = 12.6'))
    assert [len(recording) for recording in found] == [251, 340]
    assert len(set(found.hashes)) == 2
    assert len(st.load(session(tmp_path, one, two))) == 2
    with pytest.raises(InputError, match=r"already recording 1; .*state parts with from and to"):
        st.load(session(tmp_path, one, 'file = "run.csv"\nfrom = 12.0'))
    with pytest.raises(InputError, match="already recording 1; a file has one role"):
        st.load(session(tmp_path, one, 'file = "run.csv"'))
    with pytest.raises(InputError, match="from = 'twelve' is no row; write a row as in"):
        st.load(session(tmp_path, 'file = "run.csv"\nfrom = "twelve"'))


def test_a_pattern_lists_files_and_leaves_out_what_is_no_recording(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for seed in range(3):
        written(tmp_path / f"run{seed}.csv", seed)
    (tmp_path / "run9.csv").write_text("t,i,q\n1,2,3\n")
    (tmp_path / "run8.csv").write_text("t,x\n1,2\n")
    found = st.load(session(tmp_path, 'file = "run*.csv"\nkind = "sine"'))
    assert [recording.path and recording.path.name for recording in found] == [
        f"run{k}.csv" for k in range(3)
    ]
    assert {recording.kind for recording in found} == {"sine"}
    assert len(found.left_out) == 2
    assert "run8.csv: there is no column 'i'" in found.left_out[0]
    plant = '[drive]\ninput = "current_a"\ngain = 1.0\n[friction]\nlaw = "coulomb"\n'
    (tmp_path / "plant.toml").write_text(plant)
    path = session(tmp_path, 'file = "run*.csv"')
    path.write_text('plant = "plant.toml"\n' + path.read_text())
    run(["fit", str(path), "-o", str(tmp_path / "fitted")])
    captured = capsys.readouterr()
    assert "left out: " in captured.out + captured.err


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ('file = "none*.csv"', "no file fits 'none\\*.csv'"),
        ('file = "bad*.csv"', "bad.csv: the recording has 1 row"),
        ('file = "run*.csv"\nstart_s = 3.0', "start_s is said of one recording"),
        ("file = []", "is not a path; write file"),
        ("file = [1]", "is not a path; write file"),
    ],
)
def test_a_pattern_that_fits_nothing_is_refused(tmp_path: Path, entry: str, message: str) -> None:
    for seed in range(2):
        written(tmp_path / f"run{seed}.csv", seed)
    (tmp_path / "bad.csv").write_text("t,i,q\n1,2,3\n")
    with pytest.raises(InputError, match=message):
        st.load(session(tmp_path, entry))


def test_all_faults_of_files_that_are_named_are_told_in_one_run(tmp_path: Path) -> None:
    written(tmp_path / "run.csv")
    (tmp_path / "a.csv").write_text("t,i,q\n1,2,3\n")
    with pytest.raises(InputError) as caught:
        st.load(session(tmp_path, 'file = "a.csv"', 'file = "run.csv"', 'file = "b.csv"'))
    sentence = str(caught.value)
    assert "2 recordings cannot be read: (1) " in sentence
    assert "a.csv: the recording has 1 row" in sentence
    assert "b.csv: there is no such file" in sentence


def test_all_copies_are_told_in_one_run() -> None:
    time = 0.01 * np.arange(ROWS)
    one, two = (Recording(time, np.sin(k * time), np.cos(k * time)) for k in (1.0, 2.0))
    roles = [("train", one), ("test", one), ("train", two), ("test", two)]
    recordings = [
        Recording(each.time, each.input, each.position, role=role) for role, each in roles
    ]
    with pytest.raises(InputError) as caught:
        st.Session(recordings).split()
    assert str(caught.value).count("are the same recording twice") == 2


def signals(folder: Path, run_: str, *, shift: float = 0.0) -> list[Path]:
    """A position at 100 Hz and a current at 70 Hz, each with its clock and in its file."""
    slow, fast = 0.3 + np.arange(500) / 70.0, np.arange(800) / 100.0
    files = []
    for name, time, values in (
        ("position", fast, np.sin(fast)),
        ("current", slow + shift, np.sign(np.cos(slow))),
    ):
        files.append(folder / f"{run_}_{name}.csv")
        np.savetxt(files[-1], np.column_stack([time, values]), delimiter=",",
                   header="time,value", comments="")  # fmt: skip
    return files


def test_files_of_one_signal_each_are_merged_by_time(tmp_path: Path) -> None:
    files = signals(tmp_path, "run1")
    columns = {"time": "position.time", "input": {"name": "current", "unit": "A"},
               "position": {"name": "position", "unit": "rad"}}  # fmt: skip
    found = Recording.load(files, columns)
    # Where both were recorded; the input holds from one row of its own to the next.
    assert found.time[0] == pytest.approx(0.3)
    assert found.time[-1] == pytest.approx(0.3 + 499 / 70.0, abs=0.01)
    np.testing.assert_allclose(found.position, np.sin(found.time), rtol=1e-12)
    last = 0.3 + np.floor((found.time - 0.3) * 70.0 + 1e-9) / 70.0
    np.testing.assert_array_equal(found.input, np.sign(np.cos(last)))
    assert any("'current.time', and was held" in note for note in found.notes)


def test_signals_that_do_not_overlap_are_refused(tmp_path: Path) -> None:
    files = signals(tmp_path, "run1", shift=100.0)
    columns = {"time": "position.time", "input": "current", "position": "position"}
    with pytest.raises(InputError, match="were not recorded at the same time"):
        Recording.load(files, columns)
    with pytest.raises(InputError, match="has 1 file; give 2 to"):
        Recording.load(files[:1], columns)
    (tmp_path / "x.csv").write_text("a,b\n" + "1,2\n1,3\n" * 200)
    with pytest.raises(InputError, match="no column of it is known to be the time"):
        Recording.load([files[0], tmp_path / "x.csv"], columns)


def test_init_puts_signals_together_run_by_run(tmp_path: Path) -> None:
    for name in ("run1", "run2"):
        signals(tmp_path, name)
    out = tmp_path / "drafts"
    assert run(["init", str(tmp_path), "-o", str(out)]) == 0
    drafted = tomllib.loads((out / "session.toml").read_text("utf-8"))
    assert [entry["file"] for entry in drafted["recordings"]] == [
        [f"../{name}_current.csv", f"../{name}_position.csv"] for name in ("run1", "run2")
    ]
    found = st.load(out / "session.toml")
    assert len(found) == 2
    assert found.recordings[0].units["position"] == "rad"
    assert found.recordings[0].time[0] == pytest.approx(0.3)
