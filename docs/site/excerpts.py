"""The text of each page as a script: a search that is opened from a disk may fetch nothing else."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from pathlib import Path
from typing import Final

from .files import written

__all__ = ["main_text", "write_excerpts"]

EMPTY: Final = frozenset(("area", "br", "col", "hr", "img", "input", "link", "meta", "wbr"))
"""Elements that have no end."""
SILENT: Final = frozenset(("script", "style"))


class _Main(HTMLParser):
    """The words within the element whose role is main."""

    def __init__(self) -> None:
        super().__init__()
        self.words: list[str] = []
        self._open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in EMPTY and (self._open or ("role", "main") in attrs):
            # The sign of a permanent link is no word of the page.
            self._open.append("style" if ("class", "headerlink") in attrs else tag)

    def handle_endtag(self, tag: str) -> None:
        if self._open and tag not in EMPTY:
            self._open.pop()

    def handle_data(self, data: str) -> None:
        if self._open and not SILENT & set(self._open):
            self.words += data.split()


def main_text(page: str) -> str:
    """The words of a page without menus.

    Parameters
    ----------
    page : str
        HTML.
    """
    reader = _Main()
    reader.feed(page)
    return " ".join(reader.words)


def write_excerpts(site: Path) -> None:
    """Write the text of each page into ``_static/text``, for ``offline-search.js``.

    Parameters
    ----------
    site : Path
        Folder of the built pages.
    """
    for path in sorted(site.rglob("*.html")):
        name = path.relative_to(site).with_suffix("").as_posix()
        text = json.dumps(main_text(path.read_text("utf-8")), ensure_ascii=False)
        target = site / "_static" / "text" / f"{name}.js"
        written(target, f"pageText({json.dumps(name)}, {text});\n")
