"""Answers of the command line: text for people, or JSON and nothing else, and files."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .._support.json_text import json_of
from ..errors import InputError
from .interrupt import defer_interrupt

__all__ = ["answer", "discard_stdout", "folder", "json_of", "print_on_failure", "protect_writes"]


def answer(text: str, data: Any, *, as_json: bool) -> None:
    """Print the text, or the data as JSON where that was asked for."""
    said = json_of(data) if as_json else text
    if as_json and not _has_letters(said):
        # A question mark in place of a letter would be another name.
        said = json.dumps(json.loads(said), indent=2)
    print(said, flush=True)


@contextmanager
def print_on_failure(text: str, data: Any, *, as_json: bool) -> Iterator[None]:
    """Where the files of an answer cannot be written the answer is printed all the same.

    So it is where Ctrl-C was pressed while they were written.

    Raises
    ------
    InputError
        A file cannot be written.
    KeyboardInterrupt
    """
    try:
        yield
    except (InputError, KeyboardInterrupt):
        answer(text, data, as_json=as_json)
        raise


def discard_stdout() -> None:
    """What standard output still holds goes nowhere: closing it would fail once more."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def _has_letters(text: str) -> bool:
    """Whether standard output has all characters of a text."""
    try:
        text.encode(sys.stdout.encoding or "utf-8")
    except UnicodeEncodeError:
        return False
    return True


def folder(path: Path) -> Path:
    """The folder at ``path``, made where it is not there.

    Raises
    ------
    InputError
        It cannot be made, or nothing can be written into it.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{path}: cannot be made a folder ({error.strerror}); give another one with --out"
        ) from None
    # Better said before the work than after it.
    if not os.access(path, os.W_OK | os.X_OK):
        raise _refused(path, "permission denied")
    return path


@contextmanager
def protect_writes(where: Path) -> Iterator[None]:
    """Files are written in here: all of them, before Ctrl-C takes effect.

    Raises
    ------
    InputError
        One cannot be written.
    KeyboardInterrupt
        At the end, where it was pressed.
    """
    with defer_interrupt():
        try:
            yield
        except OSError as error:
            path = where if error.filename is None else Path(os.fsdecode(error.filename))
            raise _refused(path, error.strerror or str(error)) from None


def _refused(path: Path, why: str) -> InputError:
    return InputError(f"{path}: cannot be written ({why}); give another folder with --out")
