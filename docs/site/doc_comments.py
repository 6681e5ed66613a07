"""Equation, behaviour and source of laws and effects, from the comment above their struct."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

__all__ = ["Comment", "comment_of", "escaped"]

CORE: Final = Path(__file__).parents[2] / "crates" / "stiction-core" / "src"
FOLDERS: Final = {"law": "friction", "effect": "plant/effects"}
COMMENT: Final = re.compile(r"(?:^[ \t]*///.*\n)+", re.M)
FORMULA: Final = re.compile(r"(?:\w+: )?\S{1,9} [=≤] ")
"""How a paragraph begins that is set as it stands, line by line."""
AFTER: Final = re.compile(r"At v = 0|Neutral|The bounds|Memory")
"""How the first paragraph begins that tells what follows from the equation."""


@dataclass(frozen=True)
class Comment:
    """The comment above a law or an effect.

    Attributes
    ----------
    equation : str
        What is computed, Markdown; formulas that stand by themselves are blocks of text.
    behaviour : str
        What follows of it: at velocity 0, at the neutral point. Markdown.
    source : str
        Where it was published, and what of it is ours.
    """

    equation: str
    behaviour: str
    source: str


def comment_of(kind: str, name: str) -> Comment:
    """The comment of a law or an effect.

    Parameters
    ----------
    kind : {"law", "effect"}
    name : str
        As in the catalogue.

    Raises
    ------
    LookupError
        No file of this name, or no comment with a source in it: `adding a law` asks for one.
    """
    place = CORE / FOLDERS[kind]
    files = [place / f"{name}.rs", *sorted((place / name).glob("*.rs"))]
    for file in files:
        if not file.exists():
            continue
        for found in COMMENT.findall(file.read_text("utf-8")):
            text = re.sub(r"^[ \t]*/// ?", "", found, flags=re.M)
            if re.search(r"^Source: ", text, re.M):
                return _taken_apart(text)
    raise LookupError(f"{kind} {name}: no comment with a line 'Source: …' in {files[0]}")


def _taken_apart(text: str) -> Comment:
    text = re.sub(r"\[`(?:\w+::)*(\w+)`\]", r"`\1`", text)
    head, _, source = text.partition("Source: ")
    paragraphs = [each.strip("\n") for each in re.split(r"\n\s*\n", head) if each.strip()]
    told = [k for k, each in enumerate(paragraphs) if AFTER.match(each)]
    first = told[0] if told else len(paragraphs)
    equation = "\n\n".join(_set(each) for each in paragraphs[:first])
    return Comment(
        equation, "\n\n".join(map(escaped, paragraphs[first:])), " ".join(source.split())
    )


def _set(paragraph: str) -> str:
    return f"```text\n{paragraph}\n```" if FORMULA.match(paragraph) else escaped(paragraph)


def escaped(text: str) -> str:
    """Text whose letters and bars are no Markdown: x_p, |v|, a*b."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(p if p.startswith("`") else re.sub(r"([*_|<>\[\]])", r"\\\1", p) for p in parts)
