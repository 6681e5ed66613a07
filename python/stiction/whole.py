"""Whole numbers that are given as arguments."""

from __future__ import annotations

import operator
from typing import Any

from .errors import InputError

__all__ = ["whole"]


def whole(name: str, given: Any, least: int, most: int | None = None) -> int:
    """A whole number within bounds: an int, or one of numpy's.

    Raises
    ------
    InputError
        Anything else, such as 1.9 or True; a number out of bounds.
    """
    try:
        number = None if isinstance(given, bool) else operator.index(given)
    except TypeError:
        number = None
    if number is None or number < least or (most is not None and number > most):
        upto = "" if most is None else f" to {most}"
        raise InputError(
            f"{name} = {given!r} is out of bounds: give a whole number from {least}{upto}"
        )
    return number
