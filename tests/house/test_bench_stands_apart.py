"""The simulator of the bench shares nothing with the core, and no diagnosis can look at it."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "python" / "stiction"
BENCH = PACKAGE / "bench"
SIMULATOR = BENCH / "ordinary"
ALLOWED = {"stiction._support.atomic_files", "stiction.errors"}
"""How a file is written whole, and how a fault is told: neither knows of friction."""
OUTSIDE = {"numpy", "scipy", "pyarrow"}
USERS = {PACKAGE / "cli" / "bench.py"}
"""Of the bench, beside itself."""


def imported(path: Path) -> Iterator[str]:
    """Modules that a file of the package imports, in full, by statement or by name."""
    own = ("stiction", *path.relative_to(PACKAGE).parts)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = own[: len(own) - node.level] if node.level else ()
            module = ".".join([*above, *filter(None, [node.module])])
            # A module of a package may be named on either side of "import".
            yield module
            yield from (f"{module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Call) and "import" in ast.unparse(node.func):
            yield from (str(a.value) for a in node.args if isinstance(a, ast.Constant))


def foreign(path: Path) -> list[str]:
    """What the simulator may not import."""
    inside = "stiction.bench.ordinary"
    free = {*ALLOWED, inside, *(f"{each}." for each in (*ALLOWED, inside))}
    found = []
    for module in imported(path):
        known = module.split(".")[0] in {*OUTSIDE, *sys.stdlib_module_names}
        within = any(
            module == each or (each[-1] == "." and module.startswith(each)) for each in free
        )
        if not known and not within:
            found.append(module)
    return found


@pytest.mark.parametrize("path", sorted(SIMULATOR.glob("*.py")), ids=lambda path: path.name)
def test_the_simulator_shares_nothing_with_the_core(path: Path) -> None:
    assert foreign(path) == []


@pytest.mark.parametrize(
    "line",
    [
        "import stiction",
        "from ... import motor",
        "from ...motor import Motor",
        "from stiction._native import Motor",
        "from ..layout import make",
        "import_module('stiction.motor')",
        "from tests.reference import golden",
    ],
)
def test_the_search_sees_each_way_of_importing(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(f"{__name__}.PACKAGE", tmp_path)
    path = tmp_path / "bench" / "ordinary" / "one.py"
    path.parent.mkdir(parents=True)
    path.write_text(
        f"import math\nfrom ...errors import InputError\nfrom .draw import Spec\n{line}\n"
    )
    assert foreign(path)


def test_nothing_else_of_the_package_imports_the_bench() -> None:
    for path in sorted(PACKAGE.rglob("*.py")):
        if path.is_relative_to(BENCH) or path in USERS:
            continue
        used = [m for m in imported(path) if f"{m}.".startswith("stiction.bench.")]
        assert not used, f"{path.relative_to(PACKAGE)} imports {used}"


def test_a_diagnosis_does_not_load_the_bench() -> None:
    code = (
        "import sys, pkgutil, stiction.diagnosis as d; "
        "from importlib import import_module; "
        "[import_module(f'{d.__name__}.{m.name}') for m in pkgutil.iter_modules(d.__path__)]; "
        "print([name for name in sys.modules if name.startswith('stiction.bench')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
