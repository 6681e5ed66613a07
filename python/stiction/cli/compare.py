"""``stiction compare``: friction laws side by side, by experiment."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .._support.atomic_files import write_text
from ..compare.defaults import DRAWS, PASSIVE_STEPS
from .answer import answer, folder, json_of, protect_writes
from .given import Quiet, Whole, separate
from .progress import progress

__all__ = ["compare"]


def compare(
    *laws: str,
    steps: Whole = PASSIVE_STEPS,
    draws: Whole = DRAWS,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Compare friction laws by experiment: fifteen properties of each, computed.

    Parameters
    ----------
    laws
        Laws to compare; all of them without any.
    steps
        Random steps of each case in the test of passivity.
    draws
        Sets of parameters drawn about the defaults in that test.
    out
        Folder for compare.html, compare.md and compare.json.
    json
        Print JSON.
    """
    from ..compare import compare as run
    from ..compare.page import page
    from ..compare.text import as_markdown

    if out is not None:
        folder(out)
    with progress(quiet):
        made = run([name for each in laws for name in separate(each)], steps=steps, draws=draws)
    text = repr(made)
    if out is not None:
        with progress(quiet), protect_writes(out):
            # The numbers first: no figure can cost them.
            write_text(out / "compare.json", json_of(made.to_dict()) + "\n")
            write_text(out / "compare.md", as_markdown(made) + "\n")
            write_text(out / "compare.html", page(made))
        text += f"\n\nWith figures and all numbers: {out / 'compare.html'}"
    answer(text, made.to_dict(), as_json=json)
