"""What a built site must hold: no dead link, nothing from the network, everything findable."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Final
from urllib.parse import unquote, urlsplit

import stiction as st

__all__ = ["complaints"]

LOADED: Final = {"script": "src", "img": "src", "iframe": "src", "source": "src", "video": "src"}
"""Elements that a browser fetches something for by itself."""


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.anchors: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        if tag == "link" and given.get("rel", "") in ("stylesheet", "icon", "preload"):
            self.loads.append(given["href"])
        if tag in LOADED and LOADED[tag] in given:
            self.loads.append(given[LOADED[tag]])


def complaints(site: Path) -> list[str]:
    """What is wrong with a built site, a sentence each.

    Parameters
    ----------
    site : Path
        Folder of its pages.
    """
    pages = {}
    for path in sorted(site.rglob("*.html")):
        pages[path] = _Page()
        pages[path].feed(path.read_text("utf-8"))
    return [*_dead(site, pages), *_from_outside(site, pages), *_missing(site)]


def _dead(site: Path, pages: dict[Path, _Page]) -> Iterator[str]:
    for path, page in pages.items():
        for link in (*page.links, *page.loads):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists():
                yield f"{path.relative_to(site)}: {link} leads nowhere"
            elif parts.fragment and target in pages and not _known(pages[target], parts.fragment):
                yield f"{path.relative_to(site)}: {link}: no such place on that page"


def _known(page: _Page, fragment: str) -> bool:
    return fragment in page.anchors or unquote(fragment) in page.anchors


def _from_outside(site: Path, pages: dict[Path, _Page]) -> Iterator[str]:
    """What a browser would ask the network for."""
    for path, page in pages.items():
        for load in page.loads:
            if urlsplit(load).netloc:
                yield f"{path.relative_to(site)}: loads {load} from the network"
    for sheet in sorted(site.rglob("*.css")):
        for load in re.findall(r"url\(['\"]?((?:https?:)?//[^)'\"]+)", sheet.read_text("utf-8")):
            yield f"{sheet.relative_to(site)}: loads {load} from the network"


def _missing(site: Path) -> Iterator[str]:
    """Laws and effects without a page, or that the search does not know."""
    index = (site / "searchindex.js").read_text("utf-8")
    for folder, records in (("laws", st.laws()), ("effects", st.effects())):
        for record in records:
            page = f"gallery/{folder}/{record.name}"
            if not (site / f"{page}.html").exists():
                yield f"{page}: no page"
            if f'"{page}"' not in index:
                yield f"{page}: unknown to the search"
