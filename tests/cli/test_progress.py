"""Long commands say on stderr what they are at; quick ones say nothing."""

from __future__ import annotations

import io
import json
import logging
import os
import re
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from tests.cli.desk import Desk, of_two

from stiction._support.progress import Progress, duration, phase, steps, watch
from stiction.cli import run
from stiction.cli.progress import progress

LINE = re.compile(r"(\d+ min )?\d+ s: .+")


@pytest.fixture
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """A line every few milliseconds."""
    monkeypatch.setattr("stiction.cli.progress.SELDOM", 0.003)


class Terminal(io.StringIO):
    """A terminal that keeps what was written."""

    def isatty(self) -> bool:
        return True

    @property
    def lines(self) -> list[str]:
        """What its lines show in the end."""
        shown = []
        for line in self.getvalue().split("\n"):
            cells: list[str] = []
            for part in line.split("\r"):
                cells[: len(part)] = part
            shown.append("".join(cells).rstrip())
        return shown


@pytest.mark.usefixtures("soon")
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        # Which recording it is at when a line is due hangs on how fast the machine is.
        (["fit", "SESSION", "--json"], r"recording [12] of 2|fitting"),
        (["simulate", "PLANT", "SESSION", "--json"], r"simulating, recording [12] of 2"),
        (["plan", "PLANT", "--only", "ramps", "--json"], r"planning ramps"),
        (["compare", "coulomb", "--steps", "1000", "--draws", "0", "--json"], r"law 1 of 1"),
    ],
)
def test_off_a_terminal_a_long_command_says_now_and_then_what_it_is_at(
    arguments: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    desk = of_two(tmp_path)
    paths = {"SESSION": str(desk.session), "PLANT": str(desk.plant)}
    given = [paths.get(word, word) for word in arguments]
    assert run([*given, "-o", str(tmp_path / "out")]) == 0
    told = capsys.readouterr()
    lines = told.err.splitlines()
    assert all(LINE.fullmatch(line) for line in lines)
    assert any(re.search(said, line) for line in lines)
    assert json.loads(told.out)


@pytest.mark.usefixtures("soon")
def test_a_diagnosis_counts_its_recordings_and_says_when_it_draws(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    desk = Desk(tmp_path)
    assert run(["diagnose", str(desk.session), "-o", str(tmp_path / "out")]) == 0
    told = capsys.readouterr().err
    assert "fitting the base, recording 1 of 1" in told
    assert "replaying it with noise, 24 times" in told
    assert re.search(r"drawing the report, figure \d of \d", told)


def test_a_quick_command_says_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("stiction.cli.progress.SELDOM", 5.0)
    desk = Desk(tmp_path)
    began = time.monotonic()
    assert run(["simulate", str(desk.plant), str(desk.session), "-o", str(tmp_path / "out")]) == 0
    assert time.monotonic() - began > 5.0 or capsys.readouterr().err == ""


def test_a_terminal_has_one_line_that_is_empty_in_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr("stiction.cli.progress.OFTEN", 0.002)
    logger = logging.getLogger("stiction.test")
    warned = logging.StreamHandler(terminal)
    logging.getLogger().addHandler(warned)
    try:
        with progress():
            phase(logger, "fitting the law %s", "coulomb")
            for k in steps(range(3), "recording"):
                time.sleep(0.05)
                if k == 1:
                    logger.warning("a warning")
    finally:
        logging.getLogger().removeHandler(warned)
    written = terminal.getvalue()
    assert "\r0 s: fitting the law coulomb, recording 3 of 3" in written
    assert terminal.lines == ["a warning", ""]


def test_a_long_line_never_wraps(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr("stiction.cli.progress.OFTEN", 0.002)
    monkeypatch.setenv("COLUMNS", "20")
    with progress():
        phase(logging.getLogger("stiction.test"), "fitting " * 20)
        time.sleep(0.05)
    assert terminal.lines == [""]
    assert 0 < max(map(len, terminal.getvalue().split("\r"))) < 20


def test_loops_within_one_another_are_all_counted_and_their_pace_tells_the_rest() -> None:
    with watch() as state:
        phase(logging.getLogger("stiction.test"), "comparing")
        began = state.began
        laws, parts = iter(steps("abcd", "law")), iter(steps(iter("xy"), "recording", 2))
        for _ in range(3):
            next(laws)
        next(parts)
        # Two laws are done after a minute: the two that are left take another one.
        assert state.words(began + 60.0) == (
            "60 s: comparing, law 3 of 4, recording 1 of 2, about 60 s left of this"
        )
        assert list(parts) == ["y"]
        assert list(laws) == ["d"]
        assert state.words(began + 61.0) == "61 s: comparing"


def test_a_loop_that_was_left_is_not_told_any_more() -> None:
    with watch() as state:
        for _ in steps(range(5), "law"):
            for _ in steps(range(5), "recording"):
                break
            assert "recording" not in state.words()
        assert state.words().endswith(": at work")


def test_where_nobody_looks_and_in_other_threads_nothing_is_counted() -> None:
    items = [1, 2]
    assert steps(items, "recording") is items
    with watch() as state:
        seen = []
        thread = threading.Thread(target=lambda: seen.append(steps(items, "recording")))
        thread.start()
        thread.join()
        assert seen == [items]
        with watch() as inner:
            assert inner is state


@pytest.mark.parametrize(
    ("seconds", "words"), [(7.4, "7 s"), (200.0, "3 min 20 s"), (7500.0, "2 h 5 min")]
)
def test_times_are_said_as_people_say_them(seconds: float, words: str) -> None:
    assert duration(seconds) == words
    assert Progress(began=0.0).words(seconds).startswith(f"{words}: ")


def test_a_stderr_that_is_closed_disturbs_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stiction.cli.progress.SELDOM", 0.002)
    shut = Shut()
    monkeypatch.setattr(sys, "stderr", shut)
    with progress():
        assert shut.asked.wait(5.0), "nothing was written that could disturb"


class Shut(io.StringIO):
    """Nobody reads it any more."""

    def __init__(self) -> None:
        super().__init__()
        self.asked = threading.Event()

    def write(self, _: str) -> int:
        self.asked.set()
        raise BrokenPipeError


@pytest.mark.skipif(os.name != "posix", reason="closes pipes by a shell")
@pytest.mark.parametrize("words", ["--help", "diagnose --help", "laws --json"])
def test_a_reader_that_goes_away_is_no_error(words: str) -> None:
    command = f"{sys.executable} -m stiction {words} | true; exit ${{PIPESTATUS[0]}}"
    found = subprocess.run(["bash", "-c", command], check=False, capture_output=True)
    assert (found.returncode, found.stderr) == (0, b"")


@pytest.mark.skipif(os.name != "posix", reason="closes pipes by a shell")
def test_a_sentence_that_nobody_reads_keeps_its_status() -> None:
    command = f"{sys.executable} -m stiction fit nowhere.toml 2>&1 | true; exit ${{PIPESTATUS[0]}}"
    assert subprocess.run(["bash", "-c", command], check=False).returncode == 2
