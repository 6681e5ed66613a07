"""How much memory the numbers of one file may take: a small file may ask for all there is."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

from ..errors import InputError

__all__ = ["BYTES_OF_A_NUMBER", "VARIABLE", "Expansion", "check_expansion", "most_bytes"]

VARIABLE: Final = "STICTION_MOST_BYTES"
"""The environment variable that sets another ceiling, in bytes."""

BYTES_OF_A_NUMBER: Final = 8

_DEFAULT: Final = 4 * 2**30


def most_bytes() -> int:
    """The ceiling on what one file may expand to, in bytes.

    Raises
    ------
    InputError
        If ``STICTION_MOST_BYTES`` is no whole number above 0.
    """
    given = os.environ.get(VARIABLE, "").strip()
    if not given:
        return _DEFAULT
    if not (given.isascii() and given.isdigit() and len(given) < 20 and int(given) > 0):
        raise InputError(
            f"the environment variable {VARIABLE} is {given[:40]!r}; give a whole number of bytes "
            f"above 0, as in {_DEFAULT}, or remove it"
        )
    return int(given)


def check_expansion(path: Path, what: str, size: int) -> None:
    """Refuse what would take more memory than one file may, before any of it is taken.

    Parameters
    ----------
    path : Path
    what : str
        What takes it, for the sentence: ``"array 't'"``.
    size : int
        All that the file has asked for so far, in bytes.

    Raises
    ------
    InputError
        If that is beyond the ceiling.
    """
    most = most_bytes()
    if size > most:
        raise InputError(
            f"{path}: with {what} the file expands to {_gib(size)} GiB, and {_gib(most)} GiB are "
            f"allowed; leave out what is not needed, or, if you trust the file, set the "
            f"environment variable {VARIABLE} to more bytes than that"
        )


class Expansion:
    """What a file has asked for so far.

    Parameters
    ----------
    path : Path
        The file.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._size = 0

    def numbers(self, what: str, number: int) -> None:
        """Take so many numbers into account, as `check_expansion` does."""
        self.bytes(what, number * BYTES_OF_A_NUMBER)

    def bytes(self, what: str, size: int) -> None:
        """Take so many bytes into account, as `check_expansion` does."""
        self._size += size
        check_expansion(self._path, what, self._size)


def _gib(size: int) -> str:
    return f"{size / 2**30:.3g}"
