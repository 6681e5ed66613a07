"""Who reads only the first line has what it wanted: that is no error."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.faults.verbs import desk, shell

LONG_TEXTS = ("laws", "--help", "diagnose --help", "laws --json")


@pytest.mark.parametrize("words", LONG_TEXTS)
def test_a_reader_that_leaves_after_a_line_is_no_error(words: str, tmp_path: Path) -> None:
    done = shell(f"stiction {words} | head -1; echo ${{PIPESTATUS[0]}}", tmp_path)
    assert done.stdout.splitlines()[-1] == "0", done
    assert done.stderr == ""


def test_a_reader_that_never_was_is_no_error(tmp_path: Path) -> None:
    done = shell("stiction --help | true; echo ${PIPESTATUS[0]}", tmp_path)
    assert done.stdout.splitlines()[-1] == "0", done
    assert done.stderr == ""


@pytest.mark.parametrize(
    "words", ["laws >&-", "--help >&- 2>&-", "--version <&- >&-", "fit session.toml >&- 2>&-"]
)
def test_closed_streams_are_no_error(words: str, tmp_path: Path) -> None:
    folder = desk(tmp_path / "desk")
    done = shell(f"stiction {words}", folder)
    assert done.returncode == 0, done
    assert done.stderr == ""


def test_a_refusal_is_told_into_a_closed_stream_too(tmp_path: Path) -> None:
    assert shell("stiction fit nothing.toml 2>&-", tmp_path).returncode == 2
    assert shell("stiction nosuch >&-", tmp_path).returncode == 2
