"""What a file format is to the rest of the package."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..table import Table


@dataclass(frozen=True)
class Format:
    """A kind of file.

    Attributes
    ----------
    name : str
        As people call it.
    suffixes : tuple of str
        File endings, lower case, with their dot.
    read : callable
        Reads an existing, non-empty file; raises `InputError` where it is not of this kind.
    """

    name: str
    suffixes: tuple[str, ...]
    read: Callable[[Path], Table]
