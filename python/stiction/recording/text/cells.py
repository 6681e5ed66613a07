"""Cells of a line of text, and the numbers in them."""

from __future__ import annotations

import csv
import re
from typing import Final

from ..table import is_missing

BLANKS: Final = " "
"""The delimiter that stands for any number of blanks and tabs."""

DECIMAL_COMMA: Final = re.compile(r"[+-]?(\d+,\d*|,\d+)([eE][+-]?\d+)?")


def split(line: str, delimiter: str) -> list[str]:
    """The cells of a line, without blanks around them."""
    if delimiter == BLANKS:
        return line.split()
    if '"' in line:
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]
        except csv.Error:  # a field beyond csv's size limit; as text it is refused later
            pass
    return [cell.strip() for cell in line.split(delimiter)]


def fits(cells: list[str], width: int) -> bool:
    """Whether a line has ``width`` cells, or one more that is empty."""
    return len(cells) == width or (len(cells) == width + 1 and not cells[-1])


def is_number(text: str, delimiter: str) -> bool:
    """Whether a cell holds a number, or says that it is missing."""
    if delimiter != "," and DECIMAL_COMMA.fullmatch(text):
        return True
    return number(text) is not None


def number(text: str) -> float | None:
    """The number a cell holds; NaN where it says that the value is missing; None for text."""
    if "_" in text:  # Python's digit grouping, which no instrument writes
        return None
    try:
        return float(text)
    except ValueError:
        return float("nan") if is_missing(text) else None
