"""Folders and files of a report: made, written and moved as a whole."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from ..errors import InputError

__all__ = ["encoded", "made", "moved", "refused"]

OWN: Final = re.compile(
    r"(before-after|closed-loop|coordinates|candidates|errors|cause-\d+-\w+)\.svg"
)
"""What a report calls its figures."""


def made(folder: Path) -> Path:
    """The folder, made where it is not there.

    Raises
    ------
    InputError
        It cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise refused(folder, "cannot be made a folder", error) from None
    return folder


def refused(folder: Path, what: str, error: OSError) -> InputError:
    """The sentence for a folder that cannot be used."""
    return InputError(f"{folder}: {what} ({error.strerror or error}); give another folder")


def encoded(text: str) -> bytes:
    """UTF-8; names of files that are not text in any encoding show their bytes.

    The escape is also what JSON writes for such a character.
    """
    return text.encode("utf-8", "backslashreplace")


def moved(drafts: Path, folder: Path, names: Iterable[str]) -> None:
    """Move the finished figures and then the named files from ``drafts`` into ``folder``.

    Figures that an earlier report left there and this one has not are removed; other files in the
    folder may be the user's and stay.
    """
    figures = made(folder / "figures")
    fresh = sorted((drafts / "figures").glob("*.svg"))
    kept = {path.name for path in fresh}
    for path in figures.glob("*.svg"):
        if OWN.fullmatch(path.name) and path.name not in kept:
            path.unlink()
    for path in fresh:
        os.replace(path, figures / path.name)
    for name in names:
        os.replace(drafts / name, folder / name)
