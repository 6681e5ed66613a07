"""Pages of the API's reference: what is public, found by looking, from its docstrings."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import stiction

from .files import written

__all__ = ["documented", "write_reference"]

REPOSITORY: Final = Path(__file__).parents[2]
COMMANDS: Final = "cli"
"""The package whose public side is the command line."""
LONGEST: Final = 160
"""Characters of the value of a constant."""
HEAD: Final = """\
API reference
=============

What is public, from the docstrings. Arrays are float64 and SI throughout; every function refuses
what it cannot use with :class:`stiction.InputError`, in a sentence that says what is allowed.

.. list-table::
   :widths: 30 70

{rows}

.. toctree::
   :hidden:

{pages}
"""


def documented() -> list[str]:
    """Modules of the reference: the package, its packages, and what a page or example imports."""
    inside = {m.name: m.ispkg for m in pkgutil.iter_modules(stiction.__path__)}
    packages = {
        name for name, package in inside.items() if package and name != COMMANDS and name[0] != "_"
    }
    named = {name for name in _imported() if name in inside and not name.startswith("_")}
    return ["stiction", *(f"stiction.{name}" for name in sorted((packages | named) - {COMMANDS}))]


def _imported() -> Iterator[str]:
    """First names below ``stiction`` that Python blocks of pages, and examples, import."""
    pages = [REPOSITORY / "README.md", *sorted((REPOSITORY / "docs").rglob("*.md"))]
    codes = [
        code
        for page in pages
        for code in re.findall(r"^```python\n(.*?)^```$", page.read_text("utf-8"), re.M | re.S)
    ]
    scripts = [*(REPOSITORY / "examples").glob("*.py"), *(REPOSITORY / "docs").rglob("[0-9]*.py")]
    codes += [script.read_text("utf-8") for script in sorted(scripts)]
    for code in codes:
        for node in ast.walk(ast.parse(code)):
            if isinstance(node, ast.ImportFrom) and node.module:
                names = [node.module] + [f"{node.module}.{alias.name}" for alias in node.names]
            elif isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            else:
                continue
            for name in names:
                head, _, rest = name.partition(".")
                if head == "stiction" and rest:
                    yield rest.partition(".")[0]


def write_reference(docs: Path) -> None:
    """Writes a page for each module, and their index, into a copy of the documentation.

    Parameters
    ----------
    docs : Path
        The copy of ``docs``; everything goes into ``api`` within.
    """
    seen: set[int] = set()
    rows, pages = [], []
    for path in documented():
        try:
            module = importlib.import_module(path)
        except ImportError:  # an extra that is not installed has no page
            continue
        public = [(name, getattr(module, name)) for name in module.__all__ if name[:2] != "__"]
        written(docs / "api" / f"{path}.rst", _page(module, path, public, seen))
        summary = (inspect.getdoc(module) or "").partition("\n\n")[0].replace("\n", " ")
        rows.append(f"   * - :doc:`{path} <{path}>`\n     - {summary}")
        pages.append(f"   {path}")
    written(docs / "api" / "index.rst", HEAD.format(rows="\n".join(rows), pages="\n".join(pages)))


def _page(module: Any, path: str, public: list[tuple[str, Any]], seen: set[int]) -> str:
    parts = [path, "=" * len(path), "", f".. currentmodule:: {path}", ""]
    parts += [(inspect.getdoc(module) or "").partition("\n\n")[0], ""]
    rows, bodies = [], []
    for name, value in public:
        kind = _kind(value)
        again = id(value) in seen and kind != "data"
        seen.add(id(value))
        if kind == "data":
            bodies += [f".. py:data:: {name}", f"   :value: {_shown(value)}", ""]
            continue
        rows.append(f"   * - `{name}`\n     - {_summary(value)}")
        bodies.append(f".. auto{kind}:: {name}")
        if kind in ("class", "exception"):
            bodies += [
                "   :members:",
                "   :inherited-members: Exception, object, tuple, ValueError",
            ]
        if again:
            bodies.append("   :no-index:")
        bodies.append("")
    if rows:
        parts += [".. list-table::", "   :widths: 30 70", "", *rows, ""]
    return "\n".join([*parts, *bodies])


def _kind(value: Any) -> str:
    if inspect.isclass(value):
        return "exception" if issubclass(value, BaseException) else "class"
    return "function" if callable(value) and hasattr(value, "__doc__") else "data"


def _shown(value: Any) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}…"


def _summary(value: Any) -> str:
    text = (inspect.getdoc(value) or "").partition("\n\n")[0].replace("\n", " ")
    return re.sub(r"([|*])", r"\\\1", text)
