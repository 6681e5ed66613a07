"""Folders that are full or cannot be written to, as far as the machine allows it."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest
from tests.faults.verbs import Ended, arguments, contents, desk, limited, run_verb


@pytest.fixture
def mounted(tmp_path: Path) -> Iterator[Callable[[str], Path | None]]:
    """A small file system of its own with these options; None without the rights to mount one."""
    made: list[Path] = []

    def mount(options: str) -> Path | None:
        where = tmp_path / f"mount{len(made)}"
        where.mkdir()
        words = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(where)]
        if os.geteuid() != 0 or subprocess.run(words, capture_output=True, check=False).returncode:
            return None
        made.append(where)
        return where

    yield mount
    for where in made:
        subprocess.run(["umount", "-l", str(where)], check=False)


@pytest.fixture
def full(
    tmp_path: Path, mounted: Callable[[str], Path | None]
) -> tuple[Path, Callable[[], None] | None]:
    """A folder without room, and what a process does first that is to find none."""
    where = mounted("size=4k")
    if where is None:
        where = tmp_path / "small"
        where.mkdir()
        # Less than the smallest file that any verb writes.
        return where, partial(limited, 100)
    (where / "filler").write_bytes(b"x" * 4096)
    return where, None


@pytest.fixture(scope="session")
def good(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], dict[str, bytes]]:
    """What a verb writes where nothing is in its way."""
    found: dict[str, tuple[Ended, dict[str, bytes]]] = {}

    def files(verb: str) -> dict[str, bytes]:
        if verb not in found:
            folder = desk(tmp_path_factory.mktemp("good") / verb)
            ended = run_verb(arguments(verb, folder / "out"), folder)
            found[verb] = ended, contents(folder / "out")
        ended, written = found[verb]
        assert ended.status == 0, ended
        assert written
        return written

    return files
