"""Where the rows of a delimited text file begin, and what stands above them.

The delimiter (comma, semicolon, tab, bar or blanks) is found from the first lines; ``sep=;`` in the
first of them says it.  Above the header there may be titles and what an instrument says of itself.
Lines that begin with ``#`` are comments; the last one before the numbers serves as header where no
other header stands (NumPy writes such).  Without any header the columns are numbered from 1.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

from ..._support.units import bracketed_unit, known_unit
from ...errors import InputError
from ..columns import default_name
from .cells import BLANKS, fits, is_number, split
from .lines import blocks, check_length
from .rows import Head
from .stamps import is_stamp

_DELIMITERS: Final = (",", ";", "\t", "|", BLANKS)
_SAMPLED: Final = 25
_PREAMBLE: Final = 400
"""Lines that an instrument writes above its rows at most."""
_LETTERS: Final = 2**18
"""Beyond this many no preamble is looked for."""
_ROWS: Final = 3
"""So many lines that are alike make a table."""
_COMMENTS_KEPT: Final = 1000
_SAID: Final = "sep="

_Line = tuple[int, str]


def find_head(path: Path) -> Head:
    """What the first lines of a file tell (see the module's text).

    Raises
    ------
    InputError
        No line of data, a name twice, or a line that is too long.
    """
    lines, comments = _first_lines(path)
    said = _said(lines[0][1])
    if said is not None and len(lines) > 1:
        lines = lines[1:]
    delimiter = said or _find_delimiter([text for _, text in lines[: _SAMPLED + 1]])
    at = 0
    if not _begins(lines, delimiter):
        found = _table(lines, [said] if said else _DELIMITERS)
        if found is not None:
            delimiter, at = found
    header, body = _split_header(lines[at:], comments, delimiter)
    if header is None:
        width = max(len(_without_empty(_cells(text, delimiter))) for _, text in body[:_SAMPLED])
        names = [default_name(place) for place in range(1, width + 1)]
        # There is no line of names: what is wrong with a row is told by the first of them.
        header = (body[0][0], "")
    else:
        names = _names(path, header, delimiter)
    units = _units(names, body[0], delimiter) if body and header[1] else {}
    last = body[0][0] - (not units) if body else header[0]
    rows = [_cells(text, delimiter) for _, text in body[bool(units) : _SAMPLED]]
    return Head(delimiter, header[0], names, units, last, _stamps(rows, len(names)))


def _first_lines(path: Path) -> tuple[list[_Line], Iterable[_Line]]:
    """The first lines that carry something, and the comments above them, both numbered.

    A header, a line of units and a row are among them where the file has any.
    """
    lines: list[_Line] = []
    comments: deque[_Line] = deque(maxlen=_COMMENTS_KEPT)
    letters = 0
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
                letters += len(line)
            elif not lines:
                comments.append((number, bare.lstrip("#")))
            enough = len(lines) > _PREAMBLE or letters > _LETTERS
            if enough and len(lines) > _SAMPLED + 1:
                return lines, comments
    if not lines:
        raise InputError(f"{path}: the file holds no line of data; record it again or name another")
    return lines, comments


def _said(line: str) -> str | None:
    """The delimiter that a first line says, as spreadsheets write it: ``sep=;``."""
    bare = line.strip('" \r\n')
    given = bare[len(_SAID) :] if bare.casefold().startswith(_SAID) else ""
    return given if given in _DELIMITERS else None


def _find_delimiter(sample: Sequence[str]) -> str:
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


def _begins(lines: Sequence[_Line], delimiter: str) -> bool:
    """Whether the first line is the header, or a row of its own, of the lines below it."""
    if len(lines) == 1:
        return True
    first, below = (_cells(text, delimiter) for _, text in lines[:2])
    if len(lines) > 2 and sum(map(_unit, below)) > 1:
        below = _cells(lines[2][1], delimiter)
    own, kinds = _kinds(first, delimiter), _kinds(below, delimiter)
    # A single value with a word before it is what instruments say of themselves.
    if kinds.count(True) < min(2, len(first)):
        return False
    named = any(row and not head for head, row in zip(own, kinds, strict=False))
    return _alike(own, kinds) or (named and fits(below, len(_without_empty(first))))


def _table(lines: Sequence[_Line], delimiters: Iterable[str]) -> tuple[str, int] | None:
    """The delimiter and the place of the header of the first lines that make a table.

    That is, of lines with as many values at the same places; of several delimiters the one under
    which they hold most of them.
    """
    best: tuple[int, str, int] | None = None
    for delimiter in delimiters:
        rows = [_cells(text, delimiter) for _, text in lines]
        kinds = [_kinds(row, delimiter) for row in rows]
        for at in range(len(rows) - _ROWS + 1):
            values = kinds[at].count(True)
            alike = all(_alike(kinds[at], kinds[at + k]) for k in range(1, _ROWS))
            # One column of numbers is any text with a number in each line.
            if alike and values > 1 and 2 * values >= len(kinds[at]):
                width = max(len(_without_empty(rows[at + k])) for k in range(_ROWS))
                above = _above(rows[:at], width, delimiter)
                if best is None or values > best[0]:
                    best = (values, delimiter, at - above)
                break
    return None if best is None else best[1:]


def _above(rows: Sequence[list[str]], width: int, delimiter: str) -> int:
    """How many lines above the first row belong to it: the header, and a line of units below."""
    for number in (1, 2):
        if len(rows) < number or len(_without_empty(rows[-number])) != width:
            return 0
        row = rows[-number]
        if any(_is_value(cell, delimiter) for cell in row if cell):
            return 0
        units = number == 1 and sum(_unit(cell) for cell in row) > 1
        if not (units and len(rows) > 1 and len(_without_empty(rows[-2])) == width):
            return number
    return 0


def _unit(cell: str) -> bool:
    return known_unit(cell if (inside := bracketed_unit(cell)) is None else inside) is not None


def _cells(line: str, delimiter: str) -> list[str]:
    return split(line.strip() if delimiter == BLANKS else line, delimiter)


def _without_empty(cells: Sequence[str]) -> list[str]:
    """Without the empty cells at the end."""
    kept = list(cells)
    while kept and not kept[-1]:
        kept.pop()
    return kept


def _is_value(cell: str, delimiter: str) -> bool:
    return is_number(cell, delimiter) or is_stamp(cell)


def _kinds(cells: Sequence[str], delimiter: str) -> list[bool | None]:
    """Of each cell whether it is a value, None of an empty one."""
    return [_is_value(cell, delimiter) if cell else None for cell in cells]


def _alike(one: Sequence[bool | None], other: Sequence[bool | None]) -> bool:
    """Whether two lines have values at the same places, empty cells apart."""
    pairs = zip(one, other, strict=False)
    return len(one) == len(other) and all(a == b for a, b in pairs if None not in (a, b))


def _split_header(
    lines: list[_Line], comments: Iterable[_Line], delimiter: str
) -> tuple[_Line | None, list[_Line]]:
    first = lines[0]
    cells = [cell for cell in _cells(first[1], delimiter) if cell]
    if not all(is_number(cell, delimiter) for cell in cells):
        own, below = (_kinds(_cells(text, delimiter), delimiter) for _, text in (lines * 2)[:2])
        # A row whose like follows is none of names, though it holds a word or a stamp.
        if len(lines) == 1 or True not in own or not _alike(own, below):
            return first, lines[1:]
    for comment in reversed(list(comments)):
        if len(split(comment[1].strip(), delimiter)) == len(cells):
            return comment, lines
    return None, lines


def _names(path: Path, header: _Line, delimiter: str) -> list[str]:
    line, text = header
    names = _without_empty(_cells(text, delimiter))
    known: set[str] = set()
    for name in names:
        if name and name in known:
            raise InputError(
                f"{path}: line {line} names two columns '{name}'; give each its own name"
            )
        known.add(name)
    return [name or default_name(place) for place, name in enumerate(names, start=1)]


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


def _stamps(rows: Sequence[list[str]], width: int) -> frozenset[int]:
    """The columns that hold times of day in most rows."""
    found = []
    for index in range(width):
        cells = [row[index] for row in rows if index < len(row)]
        if 2 * sum(map(is_stamp, cells)) > len(cells):
            found.append(index)
    return frozenset(found)
