"""Options that are whole numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from cyclopts import Parameter, Token

__all__ = ["Whole"]


def _read(_: object, tokens: Sequence[Token]) -> int:
    """A whole number, and no other: cyclopts would round 1.9 without a word."""
    return int(tokens[0].value)


Whole = Annotated[int, Parameter(converter=_read)]
