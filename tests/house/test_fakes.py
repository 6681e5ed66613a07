"""Tests ask the product itself: nothing stands in for its parts but what cannot be provoked."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

TESTS = Path(__file__).parents[1]
STAND_INS = {"SimpleNamespace", "Mock", "MagicMock", "create_autospec"}
FOREIGN = {
    "export/test_learning_simulators.py": "a simulator that runs on graphics cards alone",
}
"""Files in which something stands in for a library of others, and which."""

STRUCK = "Ctrl-C at one place of the work"
FAULT = "a fault of a part that has none"
ABSENT = "a program or a library that this machine has, and others lack"
SIZE = "a limit, an interval or a folder that real use reaches after minutes or megabytes"
KNOWN = "minutes of work whose answer is known"
WATCHED = "work that is counted, or must not begin"
COARSE = "kernels or readings so coarse that only long recordings have them"
MADE_UP = "a member or a file format that the package lacks"
ALLOWED = {
    "bench/test_layout.py": (1, STRUCK),
    "bench/test_scores.py": (4, f"{STRUCK}; {KNOWN}"),
    "cli/test_bench.py": (1, STRUCK),
    "cli/test_demo.py": (3, KNOWN),
    "cli/test_help.py": (1, SIZE),
    "cli/test_kept.py": (2, WATCHED),
    "cli/test_progress.py": (5, SIZE),
    "cli/test_stopped.py": (3, f"{STRUCK}; {WATCHED}"),
    "cli/test_watch.py": (2, f"{STRUCK}; {WATCHED}"),
    "diagnosis/second_base.py": (1, f"{STRUCK}; {FAULT}"),
    "diagnosis/test_interrupted.py": (8, f"{STRUCK}; {WATCHED}"),
    "diagnosis/test_laws.py": (2, f"{STRUCK}; {WATCHED}"),
    "diagnosis/test_laws_that_fail.py": (1, FAULT),
    "diagnosis/test_pieces.py": (2, STRUCK),
    "diagnosis/test_restated.py": (4, f"{SIZE}; {WATCHED}"),
    "export/test_firmware.py": (1, ABSENT),
    "export/test_fmu.py": (4, ABSENT),
    "export/test_targets.py": (1, ABSENT),
    "fit/test_fit.py": (4, f"{STRUCK}; {WATCHED}"),
    "fit/test_products.py": (1, WATCHED),
    "fit/test_wider_kernels.py": (2, f"{COARSE}; {WATCHED}"),
    "fit/test_windows.py": (5, f"{STRUCK}; {FAULT}; {COARSE}"),
    "fuzz/test_fuzzer.py": (4, FAULT),
    "fuzz/test_surface.py": (3, MADE_UP),
    "library/test_library.py": (1, SIZE),
    "recording/test_dialects.py": (1, SIZE),
    "recording/test_recording_delimited.py": (1, ABSENT),
    "recording/test_recording_hostile.py": (2, f"{MADE_UP}; {SIZE}"),
    "recording/test_recording_text.py": (5, f"{SIZE}; {ABSENT}"),
    "report/test_explorer.py": (2, f"{SIZE}; {FAULT}"),
    "report/test_left_out.py": (10, f"{FAULT}; {KNOWN}"),
    "report/test_report.py": (1, STRUCK),
}
"""How often a test file puts something in the place of a part of the package, and why it has to."""


def trees() -> Iterator[tuple[str, ast.Module]]:
    for path in sorted(TESTS.rglob("*.py")):
        yield path.relative_to(TESTS).as_posix(), ast.parse(path.read_text("utf-8"))


def of_the_package(tree: ast.Module) -> set[str]:
    """Names under which a test file knows parts of the package."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("stiction"):
            found |= {each.asname or each.name for each in node.names}
        elif isinstance(node, ast.Import):
            own = [each for each in node.names if each.name.startswith("stiction")]
            found |= {each.asname or each.name.partition(".")[0] for each in own}
    return found


def replaced(tree: ast.Module) -> list[str]:
    """What ``monkeypatch.setattr`` replaces of the package."""
    known, found = of_the_package(tree), []
    for node in ast.walk(tree):
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)):
            continue
        if node.func.attr != "setattr" or not node.args:
            continue
        target, what = node.args[0], ast.unparse(node.args[0])
        root = target
        while isinstance(root, ast.Attribute):
            root = root.value
        named = isinstance(root, ast.Name) and root.id in known
        text = isinstance(target, ast.Constant | ast.JoinedStr) and "__name__" not in what
        if named or text:
            found.append(what)
    return found


def test_nothing_stands_in_for_a_record() -> None:
    found = {
        path
        for path, tree in trees()
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom | ast.Import)
        if STAND_INS & {each.name.rpartition(".")[2] for each in node.names}
    }
    assert found == FOREIGN.keys()


def test_parts_of_the_package_are_replaced_for_what_cannot_be_provoked_alone() -> None:
    found = Counter({path: len(names) for path, tree in trees() if (names := replaced(tree))})
    assert found == {path: number for path, (number, _) in ALLOWED.items()}
