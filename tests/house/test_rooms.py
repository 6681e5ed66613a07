"""The rooms of the package stand on each other: no circle, and nothing below looks up."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import stiction as st

PACKAGE = Path(st.__file__).parent
GROUND = frozenset({"_support", "errors", "_native"})
"""What everything stands on: errors speak in the words of ``_support``, which raises them."""
ROOM = dict.fromkeys(GROUND, "_support")
DIAGNOSIS = ("data", "screening", "adequacy", "selection", "findings")
"""From the ground up."""
LOOKS_UP = {
    "_support/keywords.py": "recording",
    "_support/file_kinds.py": "recording",
}
"""A hint that is looked for in a register of a room above, once a call has failed."""


def room_of(module: str) -> str:
    name = module.split(".")[1]
    return ROOM.get(name, name)


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


def rooms(within: str = "") -> dict[str, set[str]]:
    """By room of the package, or of a package in it, the rooms that it needs to be imported."""
    found: dict[str, set[str]] = {}
    top = PACKAGE / within
    whole = ".".join(["stiction", *filter(None, [within])])
    for path in top.rglob("*.py"):
        own = ".".join(path.relative_to(top).with_suffix("").parts[:1])
        if path.name != "__init__.py" or path.parent != top:
            needed = {
                module.removeprefix(f"{whole}.").partition(".")[0]
                for module in imports(path, late=False)
                if module.startswith(f"{whole}.")
            }
            own = ROOM.get(own, own)
            found.setdefault(own, set()).update({ROOM.get(each, each) for each in needed} - {own})
    return found


def circles(left: dict[str, set[str]]) -> dict[str, set[str]]:
    """Rooms that need each other."""
    left = dict(left)
    while free := [room for room, needed in left.items() if not needed & set(left)]:
        for room in free:
            del left[room]
    return left


def test_no_room_needs_itself() -> None:
    found = rooms()
    assert {"_support", "plant", "residual", "fitting", "diagnosis", "report"} <= set(found)
    assert circles(found) == {}, "these rooms need each other"


def test_the_rooms_of_a_diagnosis_stand_in_their_order() -> None:
    found = rooms("diagnosis")
    assert circles(found) == {}
    for place, room in enumerate(DIAGNOSIS):
        above = set(DIAGNOSIS[place + 1 :]) | {"pipeline", "searched", "restated", "otherwise"}
        assert not found[room] & above, room


def test_the_ground_needs_no_room() -> None:
    looks_up = {
        (path.relative_to(PACKAGE).as_posix(), room)
        for path in (PACKAGE / "_support").rglob("*.py")
        for module in imports(path, late=True)
        if (room := room_of(module)) != "_support"
    }
    assert looks_up == set(LOOKS_UP.items())
