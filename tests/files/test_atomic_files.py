"""A file is the earlier one or the new one, whatever happens while it is written."""

from __future__ import annotations

import os
import resource
import stat
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from tests.report.canned import diagnosis, plant

import stiction as st
from stiction import plot
from stiction._support.atomic_files import atomic_write, create_text, subfolder, write_text
from stiction.plan.result import Signal

pytestmark = pytest.mark.skipif(os.name != "posix", reason="asks for what POSIX promises")


def run() -> st.Trajectory:
    motor = st.Motor(0.0076, friction=st.FrictionModel("coulomb"))
    return motor.simulate(np.full(5000, 0.6), 1e-3)


def streamed(path: Path) -> None:
    motor = st.Motor(0.0076, friction=st.FrictionModel("maxwell_slip"))
    for _ in st.stream(motor, [np.full(500, 0.1)] * 2, 1e-3, checkpoint=path):
        pass


def signal(path: Path) -> None:
    time = np.arange(5000) * 1e-3
    Signal("ramps", "input", "", "train", time, time, "torque_nm", time, {}).save(path.parent)


WRITERS: dict[str, Callable[[Path], object]] = {
    "text.txt": lambda path: write_text(path, "new " * 5000),
    "plant.toml": lambda path: plant().save(path),
    "run.csv": lambda path: run().save(path),
    "run.npz": lambda path: run().save(path),
    "figure.svg": lambda path: plot.save(Figure(), path),
    "figure.png": lambda path: plot.save(Figure(), path),
    "state.npz": streamed,
    "ramps-train.csv": signal,
    "findings.json": lambda path: diagnosis("not_testable").save(path.parent),
}
RESUMED = {"state.npz"}
"""An earlier file is read first."""


@contextmanager
def full_disk(size: int = 200) -> Iterator[None]:
    """No file may become larger than so many bytes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("name", WRITERS)
def test_a_write_that_fails_leaves_the_earlier_file_and_nothing_else(
    name: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    if name in RESUMED:
        WRITERS[name](path)
    else:
        path.write_bytes(b"the last good file")
    before = path.read_bytes()
    path.chmod(0o640)
    if name in RESUMED:
        # What was kept is at its end: there is more to keep only for a longer run.
        path.rename(tmp_path / "kept")
        before = None
    limit = 100 if name == "plant.toml" else 200
    with full_disk(limit), pytest.raises((st.InputError, OSError), match="File too large"):
        WRITERS[name](path)
    assert (path.read_bytes() if path.exists() else None) == before
    assert {each.name for each in tmp_path.iterdir()} <= {name, "kept"}


@pytest.mark.parametrize("name", WRITERS)
def test_a_link_is_replaced_and_what_it_leads_to_stays(name: str, tmp_path: Path) -> None:
    target = tmp_path / "elsewhere"
    if name not in RESUMED:
        target.write_bytes(b"not to be touched")
    folder = tmp_path / "out"
    folder.mkdir()
    path = folder / name
    path.symlink_to(target)
    WRITERS[name](path)
    assert path.is_file()
    assert not path.is_symlink()
    assert name in RESUMED or target.read_bytes() == b"not to be touched"
    assert name not in RESUMED or not target.exists()


def test_permissions_of_a_file_are_kept_and_one_that_is_read_only_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "private.txt"
    path.write_text("old")
    path.chmod(0o600)
    write_text(path, "new")
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    # As root every file may be written: the system is asked, and its answer stands.
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(PermissionError) as refused:
        write_text(path, "newer")
    assert refused.value.filename == str(path)
    assert path.read_text() == "new"


def test_a_folder_a_device_and_a_pipe_are_refused_by_their_names(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "led").symlink_to("/dev/null")
    for name in ("folder", "pipe", "led"):
        with pytest.raises(OSError, match=r"directory|not a file") as refused:
            write_text(tmp_path / name, "text")
        assert refused.value.filename == str(tmp_path / name)
    assert (tmp_path / "led").is_symlink()
    with pytest.raises(FileNotFoundError) as refused:
        write_text(tmp_path / "away" / "file.txt", "text")
    assert refused.value.filename == str(tmp_path / "away" / "file.txt")


def test_a_new_file_is_made_only_where_nothing_is(tmp_path: Path) -> None:
    path = tmp_path / "new.txt"
    create_text(path, "one")
    (tmp_path / "nowhere").symlink_to(tmp_path / "away")
    for taken in (path, tmp_path / "nowhere"):
        with pytest.raises(FileExistsError) as refused:
            create_text(taken, "two")
        assert refused.value.filename == str(taken)
    assert path.read_text() == "one"
    assert {each.name for each in tmp_path.iterdir()} == {"new.txt", "nowhere"}


def test_where_files_have_no_second_name_a_new_one_is_made_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def without(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", without)
    create_text(tmp_path / "new.txt", "one")
    with pytest.raises(FileExistsError):
        create_text(tmp_path / "new.txt", "two")
    assert [each.read_text() for each in tmp_path.iterdir()] == ["one"]


def test_a_folder_within_the_output_is_no_link(tmp_path: Path) -> None:
    (tmp_path / "figures").symlink_to(tmp_path)
    with pytest.raises(OSError, match="a link is there"):
        subfolder(tmp_path, "figures")
    with pytest.raises(st.InputError, match="a link is there, and is not written through"):
        diagnosis("not_testable").save(tmp_path)


def test_what_a_killed_program_left_is_cleared_by_the_next_and_not_what_is_being_written(
    tmp_path: Path,
) -> None:
    code = (
        "import os, signal, sys; from pathlib import Path; "
        "from stiction._support.atomic_files import atomic_write\n"
        "with atomic_write(Path(sys.argv[1])) as file:\n"
        "    file.write(b'half'); file.flush(); os.kill(os.getpid(), signal.SIGKILL)"
    )
    path = tmp_path / "file.txt"
    killed = subprocess.run([sys.executable, "-c", code, str(path)], check=False)
    assert killed.returncode == -9
    (left,) = tmp_path.iterdir()
    mine = tmp_path / "notes.part"
    mine.write_text("somebody else's")
    with atomic_write(path) as file:
        assert not left.exists()
        (draft,) = tmp_path.glob(".stiction-*.part")
        # Another file in the same folder, written meanwhile.
        write_text(tmp_path / "other.txt", "other")
        assert draft.exists()
        file.write(b"whole")
    assert path.read_bytes() == b"whole"
    assert {each.name for each in tmp_path.iterdir()} == {"file.txt", "other.txt", "notes.part"}


def test_many_writers_of_one_file_leave_one_that_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    texts = [str(k) * 10_000 for k in range(8)]
    threads = [threading.Thread(target=write_text, args=(path, text)) for text in texts]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert path.read_text() in texts
    assert len(list(tmp_path.iterdir())) == 1


def test_a_trajectory_that_was_cut_short_is_refused_wherever_it_was_cut(tmp_path: Path) -> None:
    path = run().save(tmp_path / "run.csv")
    whole = path.read_bytes()
    assert list(st.Recording.load(path, COLUMNS).channels) == []
    short = tmp_path / "short.csv"
    source = np.random.default_rng(5)
    last = range(len(whole) - 60, len(whole) - 1)
    for cut in [*source.integers(200, len(whole) - 60, 8).tolist(), *last]:
        short.write_bytes(whole[:cut])
        with pytest.raises(st.InputError, match=r"row_of_5000|no rows|1 cell") as refused:
            st.Recording.load(short, COLUMNS)
        assert str(refused.value).startswith(str(short))


COLUMNS = {
    "time": "time_s",
    "input": {"name": "friction", "unit": "Nm"},
    "position": {"name": "position", "unit": "rad"},
}


def test_other_readers_take_a_trajectory_as_a_table(tmp_path: Path) -> None:
    made = run()
    path = made.save(tmp_path / "run.csv")
    names = ["time_s", *made, "row_of_5000"]
    assert path.read_text().splitlines()[0].split(",") == names
    rows = np.genfromtxt(path, delimiter=",", names=True)
    assert list(rows.dtype.names or ()) == names
    assert np.array_equal(rows["position"], made.position)
    assert np.array_equal(np.loadtxt(path, delimiter=",", skiprows=1)[:, 0], made.time)
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_csv(path)
    assert {kind.kind for kind in frame.dtypes} == {"f", "i"}
    assert np.allclose(frame["velocity"], made.velocity, rtol=1e-15, atol=0.0)


def test_rows_that_were_left_out_on_purpose_are_taken_without_the_count(tmp_path: Path) -> None:
    path = run().save(tmp_path / "run.csv")
    lines = [line.rpartition(",")[0] for line in path.read_text().splitlines()]
    path.write_text("\n".join([lines[0], *lines[1::10]]))
    assert len(st.Recording.load(path, COLUMNS)) == 500
