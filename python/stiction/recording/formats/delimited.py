"""Delimited text: CSV and its relatives.

The delimiter (comma, semicolon, tab, bar or blanks) is found from the first lines.  Where it is
not the comma, numbers may have a decimal comma.  Lines that begin with ``#`` are comments; the
last one before the numbers serves as header where no other header stands (NumPy writes such).
The line below the header may hold units in place of numbers.
"""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...wording import counted
from ..table import CELLS_KEPT, Cell, Table, is_missing
from ..units import FloatArray, bracketed_unit, known_unit
from .format import Format

_BLANKS = " "
_DELIMITERS = (",", ";", "\t", "|", _BLANKS)
_SAMPLED = 25
_DECIMAL_COMMA = re.compile(r"[+-]?(\d+,\d*|,\d+)([eE][+-]?\d+)?")
_BYTE_ORDER_MARKS_16 = (b"\xff\xfe", b"\xfe\xff")

_Line = tuple[int, str]


def read(path: Path) -> Table:
    """Read a delimited text file (see the module's text)."""
    lines, comments = _lines_of(path, _decoded(path))
    delimiter = _find_delimiter([text for _, text in lines[: _SAMPLED + 1]])
    header, body = _split_header(path, lines, comments, delimiter)
    names = _names(path, header, delimiter)
    units = _units(names, body[0], delimiter) if body else {}
    if units:
        del body[0]
    if not body:
        raise InputError(
            f"{path}: the file has a header ({counted(len(names), 'column')}) and no rows under "
            "it; record it again or name another"
        )
    rows = _rows(path, body, delimiter, len(names), header[0])
    cells: list[Cell] = []
    columns = _numbers(names, rows, delimiter, cells)
    cells.sort(key=lambda cell: cell.row)
    numbers = np.array([number for number, _ in body], dtype=np.int64)
    return Table(path, columns, tuple(cells), lines=numbers, units=units)


FORMAT = Format("CSV", (".csv", ".txt", ".tsv", ".dat"), read)


def _decoded(path: Path) -> str:
    data = path.read_bytes()
    if data.startswith(_BYTE_ORDER_MARKS_16):
        raise InputError(f"{path}: the text is encoded in UTF-16; save it as UTF-8")
    if b"\0" in data:
        line = data.count(b"\n", 0, data.index(b"\0")) + 1
        raise InputError(
            f"{path}: line {line} holds a zero byte, so this is not a text file; "
            "export the recording as CSV text, or correct the file's ending"
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        byte = data[error.start : error.start + 1]
        raise InputError(
            f"{path}: line {line} holds the byte 0x{byte.hex().upper()}, which is not UTF-8 "
            f"(in Latin-1 it is {byte.decode('latin-1')!r}); save the text as UTF-8"
        ) from error


def _lines_of(path: Path, text: str) -> tuple[list[_Line], list[_Line]]:
    """The lines that carry something, and the comments above them, both numbered."""
    lines: list[_Line] = []
    comments: list[_Line] = []
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    for number, line in enumerate(text.split("\n"), start=1):
        bare = line.strip()
        if bare.startswith("#"):
            if not lines:
                comments.append((number, bare.lstrip("#")))
        elif bare:
            lines.append((number, line))
    if not lines:
        raise InputError(f"{path}: the file holds no line of data; record it again or name another")
    return lines, comments


def _split(line: str, delimiter: str) -> list[str]:
    if delimiter == _BLANKS:
        return line.split()
    if '"' in line:
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]
        except csv.Error:  # a field beyond csv's size limit; as text it is refused later
            pass
    return [cell.strip() for cell in line.split(delimiter)]


def _find_delimiter(sample: list[str]) -> str:
    """The delimiter under which most lines have as many cells as the header; then most cells."""
    header, body = sample[0], sample[1:]
    best, best_score = ",", (0.0, 0)
    for delimiter in _DELIMITERS:
        width = len(_split(header, delimiter))
        if width < 2:
            continue
        agreeing = sum(_fits(_split(line, delimiter), width) for line in body)
        score = (agreeing / len(body) if body else 1.0, width)
        # Blanks come last and must do strictly better: they also stand after commas.
        if score > best_score:
            best, best_score = delimiter, score
    return best


def _fits(cells: list[str], width: int) -> bool:
    return len(cells) == width or (len(cells) == width + 1 and not cells[-1])


def _split_header(
    path: Path, lines: list[_Line], comments: list[_Line], delimiter: str
) -> tuple[_Line, list[_Line]]:
    first = lines[0]
    cells = [cell for cell in _split(first[1], delimiter) if cell]
    if not all(_is_number(cell, delimiter) for cell in cells):
        return first, lines[1:]
    for comment in reversed(comments):
        if len(_split(comment[1].strip(), delimiter)) == len(cells):
            return comment, lines
    raise InputError(
        f"{path}: line {first[0]} holds numbers where the header belongs; "
        "put a line with the names of the columns above the numbers"
    )


def _is_number(text: str, delimiter: str) -> bool:
    if delimiter != "," and _DECIMAL_COMMA.fullmatch(text):
        return True
    return _number(text) is not None


def _number(text: str) -> float | None:
    """The number a cell holds; NaN where it says that the value is missing; None for text."""
    if "_" in text:  # Python's digit grouping, which no instrument writes
        return None
    try:
        return float(text)
    except ValueError:
        return float("nan") if is_missing(text) else None


def _names(path: Path, header: _Line, delimiter: str) -> list[str]:
    number, text = header
    names = _split(text.strip() if delimiter == _BLANKS else text, delimiter)
    while names and not names[-1]:
        names.pop()
    for column, name in enumerate(names):
        if name and name in names[:column]:
            raise InputError(
                f"{path}: line {number} names two columns '{name}'; give each its own name"
            )
    return [name or f"column {column}" for column, name in enumerate(names, start=1)]


def _units(names: list[str], line: _Line, delimiter: str) -> dict[str, str]:
    """Units by column where a line holds them and nothing else: at least two that are known.

    In brackets a unit may be one that is not known here, or a dash: that is told where the column
    is used, as of one in the header.
    """
    cells = _split(line[1], delimiter)
    if not _fits(cells, len(names)):
        return {}
    found: dict[str, str] = {}
    for name, cell in zip(names, cells, strict=False):
        inside = bracketed_unit(cell) if cell[:1] in ("[", "(") else None
        # A bare 1 is a number before it is a unit.
        if cell and inside is None and (_is_number(cell, delimiter) or known_unit(cell) is None):
            return {}
        if unit := cell if inside is None else inside:
            found[name] = unit
    return found if sum(known_unit(unit) is not None for unit in found.values()) > 1 else {}


def _rows(
    path: Path, body: list[_Line], delimiter: str, width: int, header_line: int
) -> list[list[str]]:
    rows: list[list[str]] = []
    for number, line in body:
        cells = _split(line, delimiter)
        if len(cells) > width:
            if any(cells[width:]):
                raise InputError(_too_long(path, number, len(cells), width, header_line, delimiter))
            del cells[width:]
        elif len(cells) < width:
            # Between blanks an empty cell leaves no trace: only a last line, broken off, is safe.
            if delimiter == _BLANKS and number != body[-1][0]:
                raise InputError(
                    f"{path}: line {number} has {counted(len(cells), 'cell')}, and the header "
                    f"(line {header_line}) names {width}; write nan where a value is missing"
                )
            cells.extend([""] * (width - len(cells)))
        rows.append(cells)
    return rows


def _too_long(
    path: Path, number: int, cells: int, width: int, header_line: int, delimiter: str
) -> str:
    remedy = (
        "write decimal points, or separate the columns by semicolons"
        if delimiter == "," and width > 1 and cells == 2 * width
        else "name every column in the header, and begin lines above it with #"
    )
    return (
        f"{path}: line {number} has {cells} cells, and the header (line {header_line}) names "
        f"{counted(width, 'column')}; {remedy}"
    )


def _numbers(
    names: list[str], rows: list[list[str]], delimiter: str, cells: list[Cell]
) -> dict[str, FloatArray]:
    texts = dict(zip(names, zip(*rows, strict=True), strict=True))
    columns: dict[str, FloatArray] = {}
    doubtful: list[str] = []
    for name, column in texts.items():
        values = _plain_numbers(column)
        if values is None:
            doubtful.append(name)
        columns[name] = np.empty(0) if values is None else values
    # 1,234 beside a column with decimal points may be a grouped 1234: then it is not read.
    commas = bool(doubtful) and delimiter != "," and not _has_points(texts)
    for name in doubtful:
        columns[name] = _careful_numbers(name, texts[name], commas, cells)
    return columns


def _has_points(texts: dict[str, tuple[str, ...]]) -> bool:
    return any(
        "." in text and _number(text) is not None for column in texts.values() for text in column
    )


def _plain_numbers(column: tuple[str, ...]) -> FloatArray | None:
    """The fast way, for columns in which every cell is a plain number."""
    if any("_" in text for text in column):
        return None
    try:
        return np.array([float(text) for text in column])
    except ValueError:
        return None


def _careful_numbers(
    name: str, column: tuple[str, ...], commas: bool, cells: list[Cell]
) -> FloatArray:
    values = np.full(len(column), np.nan)
    kept = 0
    for row, text in enumerate(column):
        comma = commas and _DECIMAL_COMMA.fullmatch(text)
        number = _number(text.replace(",", ".") if comma else text)
        if number is not None:
            values[row] = number
        elif kept < CELLS_KEPT:
            cells.append(Cell(row, name, text))
            kept += 1
    return values
