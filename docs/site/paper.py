"""The page of the paper's experiments: every figure of ``stiction paper``, with its numbers."""

from __future__ import annotations

import contextlib
import io
import json
from pathlib import Path
from typing import Any, Final

from stiction.cli.paper import paper

from .doc_comments import escaped
from .files import copied, written

__all__ = ["write_paper"]

HEAD: Final = """\
# Figures of the paper

C. Hsieh, Y.-C. Pan, "Dynamic behavior and modelling of the pre-sliding static friction", Wear 242
(2000) 1-17, repeated by `stiction paper` on an illustrative rig whose contact is
[`hsieh_pan`](../theory/hsieh-pan.md).

{note}
"""


def write_paper(docs: Path) -> None:
    """Runs every experiment and writes the page, into ``gallery`` of a copy of the documentation.

    Parameters
    ----------
    docs : Path
    """
    made, place = docs.parent / "paper", docs / "gallery"
    with contextlib.redirect_stdout(io.StringIO()):
        paper(out=made)
    found = json.loads((made / "numbers.json").read_text("utf-8"))
    text = HEAD.format(note=escaped(found["note"]))
    for experiment in found["experiments"]:
        (picture,) = (name for name in experiment["figures"] if name.endswith(".png"))
        copied(made / picture, place / "pictures" / f"paper-{picture}")
        text += _section(experiment, f"pictures/paper-{picture}")
    written(place / "paper.md", text)


def _section(experiment: dict[str, Any], picture: str) -> str:
    rows = "\n".join(
        f"| {escaped(name)} | {number['value']:.5g} | {number['unit']} "
        f"| {_known(number.get('prototype'))} |"
        for name, number in experiment["numbers"].items()
    )
    return f"""
## {escaped(experiment["title"])}

{escaped(experiment["shows"])} ({escaped(experiment["source"])})

![{escaped(experiment["title"])}]({picture})

| | here | unit | prototype |
|---|---|---|---|
{rows}
"""


def _known(prototype: Any) -> str:
    if prototype is None:
        return ""
    if isinstance(prototype, list):
        return " to ".join(f"{each:.5g}" for each in prototype)
    return f"{prototype:.5g}"
