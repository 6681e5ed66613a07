"""The rooms of the core stand on each other: each needs those below it alone."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from .core_copy import REPOSITORY, Copy

CORE = REPOSITORY / "crates" / "stiction-core" / "src"
ROOMS = (
    "math",
    "support",
    "friction",
    "plant",
    "integrate",
    "simulate",
    "inverse",
    "batch",
)
"""From the ground up."""
OF_NO_ROOM = {"parameters"}
"""Macros, which are found at the root of a crate wherever they are written."""


def code(path: Path) -> str:
    """A file without its comments, in which links may lead anywhere."""
    return re.sub(r"//[^\n]*", "", path.read_text("utf-8"))


def files() -> Iterator[tuple[str, Path]]:
    """Each file of the core and its room."""
    for path in sorted(CORE.rglob("*.rs")):
        if path != CORE / "lib.rs":
            yield path.relative_to(CORE).parts[0], path


def edges() -> dict[tuple[str, str], list[str]]:
    """Files of a room that need another one."""
    found: dict[tuple[str, str], list[str]] = {}
    for room, path in files():
        for needed in sorted(set(re.findall(r"\bcrate::(\w+)", code(path))) - OF_NO_ROOM - {room}):
            found.setdefault((room, needed), []).append(path.relative_to(CORE).as_posix())
    return found


def test_every_file_has_a_room() -> None:
    assert {room for room, _ in files()} == set(ROOMS)


def test_no_room_looks_up() -> None:
    found = edges()
    assert len(found) > len(ROOMS), "paths are not found any more"
    for (room, needed), where in found.items():
        assert needed in ROOMS, f"{where}: a path in the core names the room, not {needed}"
        assert ROOMS.index(needed) < ROOMS.index(room), f"{room} needs {needed}: {where}"


def test_every_path_to_another_room_begins_at_the_root() -> None:
    for _, path in files():
        text = code(path)
        assert not re.search(r"\bcrate::[{*]", text), path
        inside = path.relative_to(CORE).with_suffix("").parts
        depth = len(inside) - (path.name == "mod.rs")
        # Modules inside a file are one deeper, and may call their file by one more.
        deepest = depth + bool(re.search(r"^\s*(pub(\(\w+\))? )?mod \w+ \{", text, re.M))
        for way in re.findall(r"\b((?:super::)+)", text):
            assert way.count("super") < deepest, f"{path} leaves its room by {way}"


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cargo") is None, reason="cargo is not installed")
def test_each_room_compiles_without_those_above_it(tmp_path: Path) -> None:
    copy = Copy(tmp_path)
    # Also a method that a room above gives to a type below is one that nothing below may call.
    for above in range(1, len(ROOMS)):
        rooms = "".join(f"#[macro_use]\npub mod {room};\n" for room in ROOMS[:above])
        (copy.source / "lib.rs").write_text(f"#![allow(warnings)]\n{rooms}", "utf-8")
        done = copy.cargo("check", "--quiet", "-p", "stiction-core", "--lib")
        assert done.returncode == 0, f"{ROOMS[above - 1]} alone: {done.stderr[:3000]}"
