"""Folders that cannot be written to, are no folders, or vanish while something works."""

from __future__ import annotations

import os
import shutil
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.faults.verbs import (
    QUICK,
    Running,
    arguments,
    assert_one_sentence,
    assert_whole,
    desk,
    gone,
    run_verb,
)


@pytest.fixture
def read_only(tmp_path: Path, mounted: Callable[[str], Path | None]) -> Path:
    """A folder into which nothing can be written: for root, rights alone do not do it."""
    if os.geteuid() == 0:
        return mounted("ro") or pytest.skip("root writes everywhere, and nothing can be mounted")
    where = tmp_path / "closed"
    where.mkdir(mode=0o555)
    return where


@pytest.mark.parametrize("verb", QUICK)
def test_a_folder_that_may_not_be_written_is_told_in_a_sentence(
    verb: str, read_only: Path, tmp_path: Path
) -> None:
    folder = desk(tmp_path / "desk")
    for out in (read_only, read_only / "new"):
        assert_one_sentence(run_verb(arguments(verb, out), folder))
    assert list(read_only.iterdir()) == []


@pytest.mark.parametrize("verb", QUICK)
def test_a_working_folder_that_is_gone_is_told_in_a_sentence(verb: str, tmp_path: Path) -> None:
    folder = desk(tmp_path / "desk")
    ended = run_verb(arguments(verb, Path("out")), folder, gone)
    assert_one_sentence(ended)


@pytest.mark.parametrize("verb", QUICK)
def test_a_folder_that_vanishes_while_it_is_written_is_told_in_a_sentence(
    verb: str, tmp_path: Path
) -> None:
    folder = desk(tmp_path / "desk")
    out = folder / "out"
    running = Running(arguments(verb, out), folder)
    over = threading.Event()

    def removing() -> None:
        while not over.is_set():
            shutil.rmtree(out, ignore_errors=True)
            time.sleep(1e-4)

    remover = threading.Thread(target=removing)
    remover.start()
    try:
        ended = running.ended()
    finally:
        over.set()
        remover.join()
    # What was written before it vanished was written.
    if ended.status != 0:
        assert_one_sentence(ended)
    assert "Traceback" not in ended.error
    assert_whole(folder)


@pytest.mark.parametrize("verb", QUICK)
def test_a_file_in_the_place_of_the_folder_is_told_in_a_sentence(verb: str, tmp_path: Path) -> None:
    folder = desk(tmp_path / "desk")
    (folder / "out").write_text("mine\n", encoding="utf-8")
    for out in (folder / "out", folder / "out" / "deeper"):
        assert_one_sentence(run_verb(arguments(verb, out), folder))
    assert (folder / "out").read_text(encoding="utf-8") == "mine\n"
