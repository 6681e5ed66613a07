"""Options that several verbs have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from cyclopts import Parameter, Token

__all__ = ["Quiet", "Whole", "separate"]


def _read(_: object, tokens: Sequence[Token]) -> int:
    """A whole number, and no other: cyclopts would round 1.9 without a word."""
    return int(tokens[0].value)


def separate(names: str) -> list[str]:
    """Names that stand in one word with commas between."""
    return [name.strip() for name in names.split(",") if name.strip()]


Whole = Annotated[int, Parameter(converter=_read)]

Quiet = Annotated[bool, Parameter(name=["--quiet", "-q"], negative="", help="Show no progress.")]
