"""The folder of a report, and what an earlier one left in it."""

from __future__ import annotations

import re
from collections.abc import Container
from pathlib import Path
from typing import Final

from ..errors import InputError

__all__ = ["folder_error", "make_folder", "without_others"]

OWN: Final = re.compile(
    r"(before-after|candidates|closed-loop|coordinates|curves|errors|motion|cause-\d+-\w+)\.svg"
)
"""What a report calls its figures."""


def make_folder(folder: Path) -> Path:
    """The folder, made where it is not there.

    Raises
    ------
    InputError
        It cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise folder_error(folder, "cannot be made a folder", error) from None
    return folder


def folder_error(folder: Path, what: str, error: OSError) -> InputError:
    """The sentence for a folder that cannot be used."""
    return InputError(f"{folder}: {what} ({error.strerror or error}); give another folder")


def without_others(figures: Path, kept: Container[str]) -> None:
    """Remove the figures that an earlier report left in a folder and this one has not.

    Other files there may be the user's and stay.
    """
    for path in figures.glob("*.svg"):
        if OWN.fullmatch(path.name) and path.name not in kept:
            path.unlink()
