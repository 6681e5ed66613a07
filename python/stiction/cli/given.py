"""Options that several verbs have."""

from __future__ import annotations

import glob
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter, Token

__all__ = ["Quiet", "Whole", "expand_patterns", "separate"]


def _read(_: object, tokens: Sequence[Token]) -> int:
    """A whole number, and no other: cyclopts would round 1.9 without a word."""
    return int(tokens[0].value)


def separate(names: str) -> list[str]:
    """Names that stand in one word with commas between."""
    return [name.strip() for name in names.split(",") if name.strip()]


def expand_patterns(paths: Sequence[Path]) -> list[Path]:
    """Paths, with what a pattern finds in its place: shells of Windows leave that to programs."""
    found: list[Path] = []
    for path in paths:
        # What no file can be called is told by those that read it.
        there = os.path.exists(path) or "\0" in str(path)
        matches = [] if there else sorted(map(Path, glob.glob(str(path))))
        found += matches or [path]
    return found


Whole = Annotated[int, Parameter(converter=_read)]

Quiet = Annotated[bool, Parameter(name=["--quiet", "-q"], negative="", help="Show no progress.")]
