"""Lays out the sources of the site: the pages as they are, and what is generated beside them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from .files import copied, written
from .gallery import write_gallery
from .paper import write_paper
from .reference import write_reference

__all__ = ["relinked", "stage"]

REPOSITORY: Final = Path(__file__).parents[2]
ABOVE: Final = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")
FOLDED: Final = {"theory": "Theory", "decisions": "Decisions"}
"""Folders whose pages stand in the menu under one of their own, and its title."""
MADE: Final = """\
## On this site

| page | what it answers |
|---|---|
| [walkthroughs](walked/index.rst) | executed: diagnosis, linear axis, servo, robot, compensation |
| [gallery of laws](gallery/laws.md) | figure, equation, source, example of every law |
| [gallery of effects](gallery/effects.md) | the same of every effect |
| [figures of the paper](gallery/paper.md) | its experiments, simulated at each build |
| [API reference](api/index.rst) | the public Python API, from the docstrings |

"""
LINK: Final = re.compile(r"(\]\()((?:\.\./)*)([^()\s#:]*)((?:#[^()\s]*)?\))")


def stage(target: Path) -> Path:
    """Lays everything out in a folder.

    Pages of ``docs`` keep their place; those of the folder above stand in ``project``. A link to
    anything else of the repository, a test or a source, becomes its path: there is no page of it.

    Parameters
    ----------
    target : Path

    Returns
    -------
    Path
        The folder, which is Sphinx's source.
    """
    docs = REPOSITORY / "docs"
    for page in sorted(docs.rglob("*.md")):
        place = page.relative_to(docs)
        if place.parts[0] not in ("walkthroughs", "site"):
            written(target / place, relinked(page.read_text("utf-8"), page, place))
    for name in ABOVE:
        page, place = REPOSITORY / name, Path("project") / name
        written(target / place, relinked(page.read_text("utf-8"), page, place))
    for picture in sorted((docs / "figures").iterdir()):
        copied(picture, target / "figures" / picture.name)
    for script in sorted((docs / "walkthroughs").iterdir()):
        if script.suffix in (".py", ".rst", ".md"):
            copied(script, target / "walkthroughs" / script.name)
    write_gallery(target)
    write_paper(target)
    write_reference(target)
    written(target / "index.md", _with_trees(target))
    return target


def relinked(text: str, page: Path, place: Path) -> str:
    """A page whose links lead to where their targets stand on the site.

    Parameters
    ----------
    text : str
        Of the page, Markdown.
    page, place : Path
        Where it is, and where it stands on the site, relative to its root.
    """
    up = "../" * (len(place.parts) - 1)

    def turned(match: re.Match[str]) -> str:
        if not match[3]:
            return match[0]
        found = (page.parent / (match[2] + match[3])).resolve()
        if not found.is_relative_to(REPOSITORY):
            return match[0]
        path = found.relative_to(REPOSITORY)
        if path.parts[0] == "docs" and path.suffix in (".md", ".png"):
            return f"{match[1]}{up}{path.relative_to('docs').as_posix()}{match[4]}"
        if path.as_posix() in ABOVE:
            return f"{match[1]}{up}project/{path.name}{match[4]}"
        return f"{match[1]}{SOURCES}{path.as_posix()}{match[4]}"

    blocks = re.split(r"(^```.*?^```$)", text, flags=re.M | re.S)
    text = "".join(b if b.startswith("```") else LINK.sub(turned, b) for b in blocks)
    # What has no page: its name is enough.
    return re.sub(rf"!?\[([^\]]*)\]\({SOURCES}([^)]*)\)", _named, text)


SOURCES: Final = "repository:"


def _named(match: re.Match[str]) -> str:
    words, path = match[1], match[2]
    return words if path.split("/")[-1] in words else f"{words} (`{path}`)"


def _with_trees(target: Path) -> str:
    """The index with what stands on the site alone, and with what Sphinx's menu needs."""
    head, first, rest = (target / "index.md").read_text("utf-8").partition("## First steps")
    text = f"{head}{MADE}{first}{rest}"
    trees = []
    for part in re.split(r"^(?=## )", text, flags=re.M)[1:]:
        title = part.partition("\n")[0].removeprefix("## ").strip()
        if title == "Where to start":  # leads to pages of all parts
            continue
        found = re.findall(
            r"\[([^\]]+)\]\(((?!https?:|\.\./|project/)[^()\s#]+)\.(?:md|rst)\)", part
        )
        words = {page: said for said, page in reversed(found)}
        pages = list(dict.fromkeys(page for _, page in found))
        listed: dict[str, None] = {}
        for page in pages:
            folder = page.rpartition("/")[0]
            beside = [other for other in pages if folder and other.startswith(f"{folder}/")]
            if folder in FOLDED and len(beside) > 1:
                _folded(target / folder / "index.md", FOLDED[folder], beside)
                listed[f"{FOLDED[folder]} <{folder}/index>"] = None
            else:
                said = words[page].replace("`", "").removeprefix("theory: ")
                listed[f"{said[:1].upper()}{said[1:]} <{page}>"] = None
        folded_alone = len(listed) == 1 and "/index>" in next(iter(listed))
        trees.append(_tree(listed, "" if folded_alone else title))
    trees.append(_tree([f"project/{Path(name).stem}" for name in ABOVE], "Project"))
    return text + "\n" + "\n".join(trees)


def _tree(pages: Iterable[str], caption: str = "", hidden: bool = True) -> str:
    options = (":hidden:\n" if hidden else "") + (f":caption: {caption}\n" if caption else "")
    listed = "\n".join(pages)
    return f"```{{toctree}}\n{options}\n{listed}\n```\n"


def _folded(page: Path, title: str, pages: list[str]) -> None:
    """A page that lists those of a folder, which would fill the menu."""
    names = [each.rpartition("/")[2] for each in pages]
    written(page, f"# {title}\n\n{_tree(names, hidden=False)}")
