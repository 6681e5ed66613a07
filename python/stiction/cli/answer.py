"""Answers of the command line: text for people, or JSON and nothing else."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..errors import InputError
from ..json_text import json_of

__all__ = ["answer", "folder", "json_of"]


def answer(text: str, data: Any, *, as_json: bool) -> None:
    """Print the text, or the data as JSON where that was asked for."""
    print(json_of(data) if as_json else text)


def folder(path: Path) -> Path:
    """The folder at ``path``, made where it is not there.

    Raises
    ------
    InputError
        It cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{path}: cannot be made a folder ({error.strerror}); give another one with --out"
        ) from None
    return path
