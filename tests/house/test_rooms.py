"""The rooms of the package stand on each other: no circle, and nothing below looks up."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import stiction as st

PACKAGE = Path(st.__file__).parent
GROUND = frozenset({"_support", "errors", "_native"})
"""What everything stands on: errors speak in the words of ``_support``, which raises them."""
LOOKS_UP = {
    "_support/keywords.py": "recording",
    "_support/file_kinds.py": "recording",
}
"""A hint that is looked for in a register of a room above, once a call has failed."""


def room_of(module: str) -> str:
    name = module.split(".")[1]
    return "_support" if name in GROUND else name


def imports(path: Path, *, late: bool) -> Iterator[str]:
    """Modules that a file needs to be imported; with ``late`` those of its functions as well."""
    here = ("stiction", *path.relative_to(PACKAGE).with_suffix("").parts)
    stack: list[tuple[ast.AST, bool]] = [(ast.parse(path.read_text("utf-8")), False)]
    while stack:
        node, inside = stack.pop()
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        if isinstance(node, ast.ImportFrom) and node.level and inside <= late:
            base = ".".join([*here[: len(here) - node.level], *filter(None, [node.module])])
            yield from ([base] if "." in base else [f"{base}.{each.name}" for each in node.names])
        deeper = inside or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        stack += [(child, deeper) for child in ast.iter_child_nodes(node)]


def rooms() -> dict[str, set[str]]:
    """By room, the rooms that it needs to be imported."""
    found: dict[str, set[str]] = {}
    for path in PACKAGE.rglob("*.py"):
        if path == PACKAGE / "__init__.py":
            continue
        own = room_of("stiction." + path.relative_to(PACKAGE).with_suffix("").parts[0])
        needed = {room_of(module) for module in imports(path, late=False)}
        found.setdefault(own, set()).update(needed - {own})
    return found


def test_no_room_needs_itself() -> None:
    left = rooms()
    assert {"_support", "plant", "residual", "fitting", "diagnosis", "report"} <= set(left)
    while free := [room for room, needed in left.items() if not needed & set(left)]:
        for room in free:
            del left[room]
    assert left == {}, "these rooms need each other"


def test_the_ground_needs_no_room() -> None:
    looks_up = {
        (path.relative_to(PACKAGE).as_posix(), room)
        for path in (PACKAGE / "_support").rglob("*.py")
        for module in imports(path, late=True)
        if (room := room_of(module)) != "_support"
    }
    assert looks_up == set(LOOKS_UP.items())
