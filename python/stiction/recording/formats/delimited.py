"""Delimited text: CSV and its relatives.

The delimiter (comma, semicolon, tab, bar or blanks) is found from the first lines.  Where it is
not the comma, numbers may have a decimal comma.  Lines that begin with ``#`` are comments; the
last one before the numbers serves as header where no other header stands (NumPy writes such).
The line below the header may hold units in place of numbers.

A file is read in blocks: those that hold plain numbers alone the fast way, all others with care.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from ...errors import InputError
from ...wording import counted
from ..table import Table
from ..text.cells import BLANKS, fits, is_number, split
from ..text.lines import blocks, check_length
from ..text.rows import Head, Rows
from ..units import bracketed_unit, known_unit
from .format import Format

_DELIMITERS: Final = (",", ";", "\t", "|", BLANKS)
_SAMPLED: Final = 25
_COMMENTS_KEPT: Final = 1000

_Line = tuple[int, str]


def read(path: Path) -> Table:
    """Read a delimited text file (see the module's text)."""
    lines, comments = _first_lines(path)
    delimiter = _find_delimiter([text for _, text in lines[: _SAMPLED + 1]])
    (header, text), body = _split_header(path, lines, comments, delimiter)
    names = _names(path, header, text, delimiter)
    units = _units(names, body[0], delimiter) if body else {}
    above = body[0][0] - (not units) if body else header
    head = Head(delimiter, header, names, units, above)
    rows = _rows(path, head, commas=delimiter != ",")
    if rows.mixed:
        rows = _rows(path, head, commas=False)
    if not len(rows.lines):
        raise InputError(
            f"{path}: the file has a header ({counted(len(names), 'column')}) and no rows under "
            "it; record it again or name another"
        )
    columns, cells = rows.columns()
    return Table(path, columns, cells, lines=rows.lines, units=units)


FORMAT = Format("CSV", (".csv", ".txt", ".tsv", ".dat"), read)


def _rows(path: Path, head: Head, *, commas: bool) -> Rows:
    rows = Rows(path, head, commas=commas)
    for block in blocks(path):
        if (below := block.after(head.last)) is not None:
            rows.add(below)
        if rows.mixed:
            break
    return rows


def _first_lines(path: Path) -> tuple[list[_Line], Iterable[_Line]]:
    """The first lines that carry something, and the comments above them, both numbered.

    A header, a line of units and a row are among them where the file has any.
    """
    lines: list[_Line] = []
    comments: deque[_Line] = deque(maxlen=_COMMENTS_KEPT)
    for block in blocks(path):
        if not block.data.strip():
            continue
        for number, line in block.lines():
            bare = line.strip()
            if not bare:
                continue
            check_length(path, number, line)
            if not bare.startswith("#"):
                lines.append((number, line))
            elif not lines:
                comments.append((number, bare.lstrip("#")))
            if len(lines) > _SAMPLED + 1:
                return lines, comments
    if not lines:
        raise InputError(f"{path}: the file holds no line of data; record it again or name another")
    return lines, comments


def _find_delimiter(sample: list[str]) -> str:
    """The delimiter under which most lines have as many cells as the header; then most cells."""
    header, body = sample[0], sample[1:]
    best, best_score = ",", (0.0, 0)
    for delimiter in _DELIMITERS:
        width = len(split(header, delimiter))
        if width < 2:
            continue
        agreeing = sum(fits(split(line, delimiter), width) for line in body)
        score = (agreeing / len(body) if body else 1.0, width)
        # Blanks come last and must do strictly better: they also stand after commas.
        if score > best_score:
            best, best_score = delimiter, score
    return best


def _split_header(
    path: Path, lines: list[_Line], comments: Iterable[_Line], delimiter: str
) -> tuple[_Line, list[_Line]]:
    first = lines[0]
    cells = [cell for cell in split(first[1], delimiter) if cell]
    if not all(is_number(cell, delimiter) for cell in cells):
        return first, lines[1:]
    for comment in reversed(list(comments)):
        if len(split(comment[1].strip(), delimiter)) == len(cells):
            return comment, lines
    raise InputError(
        f"{path}: line {first[0]} holds numbers where the header belongs; "
        "put a line with the names of the columns above the numbers"
    )


def _names(path: Path, line: int, text: str, delimiter: str) -> list[str]:
    names = split(text.strip() if delimiter == BLANKS else text, delimiter)
    while names and not names[-1]:
        names.pop()
    known: set[str] = set()
    for name in names:
        if name and name in known:
            raise InputError(
                f"{path}: line {line} names two columns '{name}'; give each its own name"
            )
        known.add(name)
    return [name or f"column {column}" for column, name in enumerate(names, start=1)]


def _units(names: list[str], line: _Line, delimiter: str) -> dict[str, str]:
    """Units by column where a line holds them and nothing else: at least two that are known.

    In brackets a unit may be one that is not known here, or a dash: that is told where the column
    is used, as of one in the header.
    """
    cells = split(line[1], delimiter)
    if not fits(cells, len(names)):
        return {}
    found: dict[str, str] = {}
    for name, cell in zip(names, cells, strict=False):
        inside = bracketed_unit(cell) if cell[:1] in ("[", "(") else None
        # A bare 1 is a number before it is a unit.
        if cell and inside is None and (is_number(cell, delimiter) or known_unit(cell) is None):
            return {}
        if unit := cell if inside is None else inside:
            found[name] = unit
    return found if sum(known_unit(unit) is not None for unit in found.values()) > 1 else {}
