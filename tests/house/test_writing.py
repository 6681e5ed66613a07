"""Nobody in the package writes a file but through the one module that writes it whole."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "python" / "stiction"
THE_MODULE = PACKAGE / "_support" / "atomic_files.py"
METHODS = {"write_text", "write_bytes", "touch", "symlink_to", "hardlink_to", "rename", "tofile"}
"""Of paths and arrays, whatever they are called on."""
OF_MODULES = {
    "os": {"open", "replace", "rename", "renames", "link", "symlink", "truncate", "mkfifo"},
    "shutil": {"copy", "copy2", "copyfile", "copytree", "move"},
    "tempfile": {"NamedTemporaryFile", "TemporaryFile", "TemporaryDirectory", "mkstemp", "mkdtemp"},
}
INTO = {"savez": 0, "savez_compressed": 0, "savetxt": 0, "savefig": 0, "save": 0, "to_csv": 0}
"""Functions that write into a path or an open file, and which argument that is."""
OPENED = {"atomic_write", "BytesIO", "StringIO"}
"""What makes a file that they may write into."""


def sources() -> list[Path]:
    return sorted(path for path in PACKAGE.rglob("*.py") if path != THE_MODULE)


def called(call: ast.Call) -> tuple[str, str]:
    """Module or object, and name, of what is called."""
    if isinstance(call.func, ast.Attribute):
        of = call.func.value
        return (of.id if isinstance(of, ast.Name) else ""), call.func.attr
    return "", call.func.id if isinstance(call.func, ast.Name) else ""


def mode(call: ast.Call, place: int) -> str:
    """The mode of an ``open``; "?" where it is no plain text."""
    given = [keyword.value for keyword in call.keywords if keyword.arg == "mode"]
    given += call.args[place : place + 1]
    if not given:
        return "r"
    return str(given[0].value) if isinstance(given[0], ast.Constant) else "?"


def opened_names(tree: ast.AST) -> set[str]:
    """Names that stand for files opened by the module, or for memory."""
    names = set()
    for node in ast.walk(tree):
        made, target = None, None
        if isinstance(node, ast.withitem):
            made, target = node.context_expr, node.optional_vars
        elif isinstance(node, ast.Assign):
            made, target = node.value, node.targets[0]
        if (
            isinstance(made, ast.Call)
            and called(made)[1] in OPENED
            and isinstance(target, ast.Name)
        ):
            names.add(target.id)
    return names


def writes(path: Path) -> Iterator[str]:
    tree = ast.parse(path.read_text("utf-8"))
    safe = opened_names(tree)
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        of, name = called(node)
        method = isinstance(node.func, ast.Attribute) and name in METHODS
        bad = method or name in OF_MODULES.get(of, ())
        if name == "open" and of not in ("os", "Image"):
            # Path.open has the mode first, the function has it second.
            place = 0 if isinstance(node.func, ast.Attribute) else 1
            nowhere = node.args and ast.unparse(node.args[0]) == "os.devnull"
            bad = not nowhere and bool(set("wax+?") & set(mode(node, place)))
        if (of, name) == ("os", "open"):
            bad = ast.unparse(node.args[0]) != "os.devnull"
        if name in INTO and of not in ("plot", "signal", "found", "made", "plant"):
            target = node.args[INTO[name]] if node.args else None
            into_open = isinstance(target, ast.Name) and target.id in safe
            bad = of in ("np", "few", "figure", "fig", "drawn", "frame") and not into_open
        if bad:
            yield f"{path.relative_to(PACKAGE)}:{node.lineno}: {ast.unparse(node)[:80]}"


def test_every_file_is_written_through_the_one_module() -> None:
    found = [each for path in sources() for each in writes(path)]
    assert found == [], "write through stiction._support.atomic_files"


@pytest.mark.parametrize(
    "line",
    [
        "path.write_text('x')",
        "open(path, 'w')",
        "path.open('xb')",
        "path.open(mode=given)",
        "os.replace(one, other)",
        "np.savez(path, a=1)",
        "np.savetxt(path, a)",
        "fig.savefig(path)",
        "few.save(path)",
        "tempfile.mkstemp()",
        "os.open(path, os.O_WRONLY)",
    ],
)
def test_the_search_sees_each_way_of_writing(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(f"{__name__}.PACKAGE", tmp_path)
    source = tmp_path / "one.py"
    source.write_text(f"target = BytesIO()\nfig.savefig(target)\nopen(path, 'rb')\n{line}\n")
    assert [each.split(":")[1] for each in writes(source)] == ["4"]
