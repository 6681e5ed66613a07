"""Answers of the command line: text for people, or JSON and nothing else."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from ..errors import InputError

__all__ = ["answer", "folder", "json_of"]


def answer(text: str, data: Any, *, as_json: bool) -> None:
    """Print the text, or the data as JSON where that was asked for."""
    print(json_of(data) if as_json else text)


def json_of(data: Any) -> str:
    """The data as JSON text; what JSON has no number for becomes a word."""
    return json.dumps(_plain(data), indent=2, ensure_ascii=False)


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


def _plain(data: Any) -> Any:
    """JSON has no infinity: it becomes the word."""
    if isinstance(data, dict):
        return {str(key): _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(value) for value in data]
    if isinstance(data, Path):
        return str(data)
    if isinstance(data, float) and not math.isfinite(data):
        return str(data)
    return data
