"""What stops a command: Ctrl-C, files that cannot be written, streams that are closed or narrow."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction.cli import run
from stiction.cli.answer import folder
from stiction.cli.interrupt import HEARD, answer_on_interrupt, defer_interrupt
from stiction.fitting import fit

PLANT = """
[drive]
input = "torque_nm"
[body]
inertia = 0.0076
[friction]
law = "coulomb"
coulomb = 0.3
viscous = 0.05
"""
SESSION = 'plant = "plant.toml"\n[[recordings]]\nfile = "run.csv"\n'


@pytest.fixture
def session(tmp_path: Path) -> Path:
    plant, path = tmp_path / "plant.toml", tmp_path / "session.toml"
    plant.write_text(PLANT)
    path.write_text(SESSION)
    time = np.arange(2000) * 1e-3
    effort = np.sin(6.0 * time)
    position = np.append(0.0, st.Plant.load(plant).simulate(effort[:-1], 1e-3).position)
    table = np.column_stack([time, effort, position])
    header = "time_s,torque_nm,position_rad"
    np.savetxt(tmp_path / "run.csv", table, "%.12g", ",", header=header, comments="")
    return path


@pytest.fixture(autouse=True)
def heard() -> Iterator[None]:
    """Ctrl-C as it is heard in a terminal: what runs in the background may be told to ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def struck() -> None:
    signal.raise_signal(signal.SIGINT)


def test_what_is_being_written_is_finished() -> None:
    done = []

    def written(times: int) -> None:
        with defer_interrupt():
            for _ in range(times):
                with defer_interrupt():
                    struck()
            done.append(times)

    written(0)
    with pytest.raises(KeyboardInterrupt):
        written(1)
    with pytest.raises(KeyboardInterrupt):
        written(2)
    # The second ended it before it was done.
    assert done == [0, 1]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_ctrl_c_is_said_to_be_heard_before_what_there_is_is_written(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(KeyboardInterrupt), answer_on_interrupt():
        struck()
    assert capfd.readouterr().err == f"{HEARD}\n"
    done = []

    def written(*, before: bool) -> None:
        with defer_interrupt(struck=before):
            struck()
            done.append(capfd.readouterr().err)

    with pytest.raises(KeyboardInterrupt):
        written(before=False)
    assert done == [f"{HEARD}\n"]
    # Pressed before, it ends what is written at once.
    with pytest.raises(KeyboardInterrupt):
        written(before=True)
    assert len(done) == 1
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_interrupted_fit_is_written_and_says_so(
    session: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*given: Any) -> Any:
        return replace(fit(*given), success=False, interrupted=True)

    monkeypatch.setattr("stiction.fitting.fit", stopped)
    assert run(["fit", str(session), "-o", str(tmp_path / "out")]) == 130
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"plant.toml", "begins.toml", "fit.json", "fit.html"}


def test_a_page_that_is_being_written_is_finished(
    session: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def drawn(*_: object) -> str:
        struck()
        return "page"

    monkeypatch.setattr("stiction.report.fit_page.fit_page", drawn)
    assert run(["fit", str(session), "-o", str(tmp_path / "out")]) == 130
    assert (tmp_path / "out" / "fit.html").read_text() == "page"


@pytest.mark.parametrize(
    ("arguments", "taken"),
    [
        (["fit", "SESSION"], "fit.json"),
        (["simulate", "PLANT", "SESSION"], "run-trajectory.csv"),
        (["simulate", "PLANT", "SESSION"], "run-effort-residual.png"),
        (["plan", "PLANT", "--only", "ramps"], "plan.json"),
        (["laws"], "laws.json"),
        (["compare", "coulomb", "--steps", "1000", "--draws", "0"], "compare.md"),
    ],
)
def test_a_file_that_cannot_be_written_is_named_in_a_sentence(
    arguments: list[str],
    taken: str,
    session: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = tmp_path / "out"
    (out / taken).mkdir(parents=True)
    paths = {"SESSION": str(session), "PLANT": str(tmp_path / "plant.toml")}
    given = [paths.get(word, word) for word in arguments]
    assert run([*given, "-o", str(out)]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "cannot be written (Is a directory)" in told
    assert str(out) in told


def test_where_nothing_can_be_written_nothing_is_fitted(
    session: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def never(*_: object) -> None:
        raise AssertionError("fits for nothing")

    monkeypatch.setattr("stiction.fitting.fit", never)
    assert run(["fit", str(session), "-o", str(session)]) == 2
    assert "cannot be made a folder" in capsys.readouterr().err
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(st.InputError, match="permission denied"):
        folder(tmp_path)


def told(
    arguments: list[str], *, stdout: Any = subprocess.PIPE, **environment: str
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "stiction", *arguments],
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        env={**os.environ, **environment},
    )


def test_letters_that_standard_output_lacks_are_replaced() -> None:
    text = told(["laws", "coulomb"], PYTHONIOENCODING="ascii")
    assert (text.returncode, text.stderr) == (0, "")
    whole = told(["laws", "coulomb", "--json"], PYTHONIOENCODING="utf-8").stdout
    narrow = told(["laws", "coulomb", "--json"], PYTHONIOENCODING="ascii").stdout
    assert whole != narrow
    assert json.loads(whole) == json.loads(narrow)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device here")
def test_a_full_standard_output_is_told_in_a_sentence() -> None:
    for arguments in (["laws"], ["--help"]):
        with Path("/dev/full").open("w") as full:
            found = told(arguments, stdout=full)
        assert found.returncode == 2
        assert found.stderr.count("\n") == 1
        assert "standard output cannot be written" in found.stderr


@pytest.mark.skipif(os.name != "posix", reason="closes streams by a shell")
def test_streams_that_are_closed_take_nothing() -> None:
    command = f"{sys.executable} -m stiction compare coulomb --steps 1000 --draws 0"
    assert subprocess.run(f"{command} 2>&- >/dev/null", shell=True, check=False).returncode == 0
    assert subprocess.run(f"{command} >&-", shell=True, check=False).returncode == 0
    unread = subprocess.run(
        f"{sys.executable} -m stiction laws nothing 2>&-",
        shell=True,
        check=False,
        stdout=subprocess.PIPE,
    )
    assert (unread.returncode, unread.stdout) == (2, b"")
