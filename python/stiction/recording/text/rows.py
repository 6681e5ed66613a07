"""The rows of a delimited text file, gathered block by block."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.wording import plural
from ...errors import InputError
from ..expansion import BYTES_OF_A_NUMBER, check_expansion, most_bytes
from ..table import CELLS_KEPT, Cell, is_missing
from .cells import BLANKS, DECIMAL_COMMA, number, split
from .lines import Block, IntArray, LineNumbers, check_length
from .plain import plain_numbers
from .stamps import Stamps

_CELLS_AT_ONCE: Final = 2**18
"""Cells that are held as text at a time."""


@dataclass(frozen=True)
class Head:
    """What the first lines of a file tell.

    Attributes
    ----------
    delimiter : str
    line : int
        That holds the names.
    names : list of str
    units : dict of str to str
        By column, where a line holds them.
    last : int
        The line above the first row.
    stamps : frozenset of int
        Places of the columns that hold dates and times of day.
    """

    delimiter: str
    line: int
    names: list[str]
    units: dict[str, str]
    last: int
    stamps: frozenset[int] = frozenset()


class Rows:
    """The numbers of a file as far as it has been read.

    Parameters
    ----------
    path : Path
    head : Head
    commas : bool
        Whether a comma in a number is a decimal one.

    Attributes
    ----------
    lines : LineNumbers
        Of the rows.
    mixed : bool
        Commas were taken for decimal ones, and there are decimal points as well: 1,234 may then be
        a grouped 1234, and all has to be read again without.
    """

    def __init__(self, path: Path, head: Head, *, commas: bool) -> None:
        self.lines = LineNumbers()
        self._path, self._head, self._commas = path, head, commas
        self._width = len(head.names)
        self._expected = 0
        self._size = path.stat().st_size
        self._columns: list[FloatArray] = []
        self._cells: list[list[Cell]] = [[] for _ in head.names]
        self._stamps = {index: Stamps() for index in sorted(head.stamps)}
        self._commas_seen = self._points_seen = False
        # Between blanks an empty cell leaves no trace: only a last line, broken off, is safe.
        self._broken: tuple[int, int] | None = None

    @property
    def begins(self) -> dict[str, float]:
        """When the first row was, s since 1970, by each column of stamps with a date."""
        names = self._head.names
        return {names[k]: s.begins for k, s in self._stamps.items() if s.begins is not None}

    @property
    def mixed(self) -> bool:
        return self._commas and self._commas_seen and self._points_seen

    def add(self, block: Block) -> None:
        """Take the rows of the next lines.

        Raises
        ------
        InputError
            A line with too many cells or, between blanks, too few, or more numbers than may be.
        """
        data, lines = block.without_empty()
        if not data:
            return
        if not self._expected:
            # Room is made once, and taken where rows come: joining pieces would need it twice.
            expected = int(1.02 * len(lines) * self._size / len(data)) + 1
            self._expected = min(expected, most_bytes() // (BYTES_OF_A_NUMBER * self._width) + 1)
        if self._broken is None and (columns := self._plainly(data)) is not None:
            self._append(columns, lines)
            return
        taken: list[tuple[int, list[str]]] = []
        for line, text in block.lines():
            bare = text.strip()
            if bare and not bare.startswith("#"):
                check_length(self._path, line, text)
                taken.append((line, self._split(line, text)))
            if len(taken) * self._width >= _CELLS_AT_ONCE:
                self._add_cells(taken)
                taken = []
        if taken:
            self._add_cells(taken)

    def columns(self) -> tuple[dict[str, FloatArray], tuple[Cell, ...]]:
        """Every column by name, and cells that hold text; empties what was gathered."""
        columns, self._columns = self._columns, []
        for column in columns:
            column.resize(len(self.lines), refcheck=False)
        cells = [cell for column in self._cells for cell in column]
        cells.sort(key=lambda cell: cell.row)
        return dict(zip(self._head.names, columns, strict=True)), tuple(cells)

    def _plainly(self, data: bytes) -> list[FloatArray] | None:
        delimiter = self._head.delimiter
        commas = delimiter != "," and b"," in data
        points = b"." in data
        if commas and (points or not self._commas):
            return None
        if commas:
            data = data.replace(b",", b".")
        columns = plain_numbers(data, self._width, delimiter)
        if columns is not None:
            self._commas_seen |= commas
            self._points_seen |= points
        return columns

    def _split(self, line: int, text: str) -> list[str]:
        """As many cells as there are names."""
        cells, width = split(text, self._head.delimiter), self._width
        if self._broken is not None:
            number, length = self._broken
            raise InputError(
                f"{self._path}: line {number} has {plural(length, 'cell')}, and the header "
                f"(line {self._head.line}) names {width}; write nan where a value is missing"
            )
        if len(cells) > width:
            if any(cells[width:]):
                raise InputError(self._too_long(line, len(cells)))
            del cells[width:]
        elif len(cells) < width:
            if self._head.delimiter == BLANKS:
                self._broken = line, len(cells)
            cells.extend([""] * (width - len(cells)))
        return cells

    def _too_long(self, line: int, cells: int) -> str:
        width = self._width
        remedy = (
            "write decimal points, or separate the columns by semicolons"
            if self._head.delimiter == "," and width > 1 and cells == 2 * width
            else "name every column in the header, and begin lines above it with #"
        )
        return (
            f"{self._path}: line {line} has {cells} cells, and the header (line "
            f"{self._head.line}) names {plural(width, 'column')}; {remedy}"
        )

    def _add_cells(self, taken: list[tuple[int, list[str]]]) -> None:
        columns = zip(*(cells for _, cells in taken), strict=True)
        numbers = [self._numbers(index, column) for index, column in enumerate(columns)]
        self._append(numbers, np.array([line for line, _ in taken], dtype=np.int64))

    def _numbers(self, index: int, column: tuple[str, ...]) -> FloatArray:
        if index in self._stamps:
            return self._seconds(index, column)
        if self._commas and not self._points_seen:
            self._points_seen = any("." in text and number(text) is not None for text in column)
        if not any("_" in text for text in column):
            try:
                return np.array([float(text) for text in column])
            except ValueError:
                pass
        values = np.full(len(column), np.nan)
        cells = self._cells[index]
        for row, text in enumerate(column):
            comma = self._commas and DECIMAL_COMMA.fullmatch(text) is not None
            self._commas_seen |= comma
            value = number(text.replace(",", ".") if comma else text)
            if value is not None:
                values[row] = value
            elif len(cells) < CELLS_KEPT:
                cells.append(Cell(len(self.lines) + row, self._head.names[index], text))
        return values

    def _seconds(self, index: int, column: tuple[str, ...]) -> FloatArray:
        values = np.full(len(column), np.nan)
        for row, text in enumerate(column):
            second = self._stamps[index].second(text)
            if second is not None:
                values[row] = second
            elif not is_missing(text) and len(self._cells[index]) < CELLS_KEPT:
                name = self._head.names[index]
                self._cells[index].append(Cell(len(self.lines) + row, name, text))
        return values

    def _append(self, columns: list[FloatArray], lines: range | IntArray) -> None:
        rows = len(self.lines) + len(lines)
        size = rows * self._width * BYTES_OF_A_NUMBER
        check_expansion(self._path, f"{rows} rows of {plural(self._width, 'column')}", size)
        part = slice(len(self.lines), rows)
        for whole, column in zip(self._room(rows), columns, strict=True):
            whole[part] = column
        self.lines.add(lines)

    def _room(self, rows: int) -> list[FloatArray]:
        """The columns, of so many rows at least."""
        if not self._columns:
            self._columns = [np.empty(max(rows, self._expected)) for _ in self._head.names]
        elif rows > len(self._columns[0]):
            for column in self._columns:
                column.resize(rows + rows // 4, refcheck=False)
        return self._columns
