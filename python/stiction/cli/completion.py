"""``stiction completion``: completion of shells, and the manual page, from the tree of verbs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from .._support.atomic_files import write_text
from .answer import answer, folder, protect_writes

__all__ = ["completion"]

_FILES = {
    "bash": "stiction",
    "zsh": "_stiction",
    "fish": "stiction.fish",
    "powershell": "stiction.ps1",
    "man": "stiction.1",
}
"""What each is called where it is looked for."""


def completion(
    shell: Literal["bash", "zsh", "fish", "powershell", "man"],
    *,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Print the completion of a shell, or the manual page.

    Parameters
    ----------
    shell
        bash, zsh, fish or powershell; man is the manual page.
    out
        Folder to write it into as well, under the name that the shell looks for.
    json
        Print JSON.
    """
    from .app import build

    if shell == "man":
        from .manual import manual

        text = manual()
    else:
        text = build().generate_completion(shell=shell)
    if out is not None:
        with protect_writes(folder(out)):
            write_text(out / _FILES[shell], text)
    answer(text, {"shell": shell, "text": text}, as_json=json)
