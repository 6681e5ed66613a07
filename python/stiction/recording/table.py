"""What a file reader hands over: named columns of numbers, as they stand in the file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from .._support.arrays import FloatArray
from .._support.given import instance, mapping, whole, word
from .._support.units import bracketed_unit
from .._support.wording import commas, did_you_mean, plural, printable
from ..errors import InputError
from .text.lines import LineNumbers

# Of each column, this many cells that are not numbers are kept; one is enough for an error.
CELLS_KEPT = 20

_MISSING = frozenset({"", "nan", "na", "n/a", "#n/a", "null", "none"})


@dataclass(frozen=True)
class Cell:
    """A cell that holds text where a number belongs: 0-based row, column name, the text."""

    row: int
    column: str
    text: str


@dataclass(frozen=True)
class Table:
    """Named columns of one file.

    Columns of text formats have equal lengths; the variables of MAT and NPZ files need not.

    Attributes
    ----------
    path : Path
        The file.
    columns : dict of str to ndarray, shape (rows,), float64
        In the order of the file.  Cells that are missing or hold text are NaN.
    cells : tuple of Cell
        Cells holding text, the first 20 of each column, by row.
    unusable : dict of str to str
        What else the file holds, and why it cannot be a column ("is a scalar").
    lines : sequence of int, optional
        1-based line number of each row, for formats that have lines.
    units : dict of str to str
        Units that the file states beside the names (in a line of their own below them), by column.
    begins : dict of str to float
        When the first row was, s since 1970, by column of time, where the file tells it.
    clocks : dict of str to str
        The column that holds the time of another one, by that one's name, where the signals of a
        file have clocks of their own.
    header : dict of str to float or str
        What the file states once, of all its rows.
    """

    path: Path
    columns: dict[str, FloatArray]
    cells: tuple[Cell, ...] = ()
    unusable: dict[str, str] = field(default_factory=dict)
    lines: LineNumbers | None = None
    units: dict[str, str] = field(default_factory=dict)
    begins: dict[str, float] = field(default_factory=dict)
    clocks: dict[str, str] = field(default_factory=dict)
    header: dict[str, float | str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for what in ("columns", "unusable", "units", "begins", "clocks", "header"):
            names = instance(getattr(self, what), dict, f"Table: {what}", "a dict by column")
            for name in names:
                word(name, f"Table: {what}: a column")
            if not all(name.isprintable() for name in names):
                renamed = {printable(name): value for name, value in names.items()}
                names.clear()
                names.update(renamed)
        for name, clock in self.clocks.items():
            self.clocks[name] = printable(word(clock, "Table: clocks: a column"))

    def heading(self, name: str) -> str:
        """A column's name, with the unit below it in brackets where it has none itself."""
        below = self.units.get(word(name, "Table.heading: name"))
        return name if below is None or bracketed_unit(name) else f"{name} [{below}]"

    def renamed(self, names: Mapping[str, str]) -> Table:
        """The table with other names of some columns.

        Parameters
        ----------
        names : mapping of str to str
            The new name, by the present one.
        """
        names = mapping(names, "Table.renamed: names", "a mapping of names")

        def new(name: str) -> str:
            return names.get(name, name)

        return replace(
            self,
            columns={new(name): values for name, values in self.columns.items()},
            cells=tuple(replace(cell, column=new(cell.column)) for cell in self.cells),
            unusable={new(name): why for name, why in self.unusable.items()},
            units={new(name): unit for name, unit in self.units.items()},
            begins={new(name): begin for name, begin in self.begins.items()},
            clocks={new(name): new(clock) for name, clock in self.clocks.items()},
        )

    def place(self, row: int) -> str:
        """How a reader finds a 0-based row again: ``"line 19"``, or ``"row 17"`` (1-based)."""
        if self.lines is None:
            return f"row {whole(row, 'row', least=0) + 1}"
        return f"line {self.lines[whole(row, 'row', least=0, most=len(self.lines) - 1)]}"

    def find(self, name: str, field_name: str) -> FloatArray:
        """One column, as numbers.

        Parameters
        ----------
        name : str
            The column's name, exactly as it stands in the file.
        field_name : str
            The field that asks for it, for the error sentence.

        Returns
        -------
        ndarray, shape (rows,), float64

        Raises
        ------
        InputError
            If the file has no such column, or it is no vector, or a cell of it holds text.
        """
        word(name, f"{self.path}: {field_name}")
        if name in self.unusable:
            raise InputError(
                f"{self.path}: '{name}', asked for as {field_name}, {self.unusable[name]}; "
                f"the columns here are {commas(self.columns)}"
            )
        if name not in self.columns:
            raise InputError(
                f"{self.path}: there is no column '{name}', asked for as {field_name}"
                f"{did_you_mean(name, self.columns)}; the columns here are {commas(self.columns)}"
            )
        for cell in self.cells:
            if cell.column == name:
                raise InputError(
                    f"{self.path}: {self.place(cell.row)}, column '{name}' holds "
                    f"{quote(cell.text)}, which is not a number; correct the cell, or empty it "
                    "to have it filled from its neighbours"
                )
        return self.columns[name]


def quote(text: str) -> str:
    """Foreign text, quoted and short enough to stand in one sentence."""
    return repr(text if len(text) <= 40 else text[:37] + "...")


def is_missing(text: str) -> bool:
    """Whether a cell's text says that there is no value."""
    return text.strip().casefold() in _MISSING


def unfit(kind: str, shape: tuple[int, ...]) -> str | None:
    """Why an array that is stored so cannot be a column, told before it is read.

    Parameters
    ----------
    kind : str
        Of its NumPy type: "f" for floats.
    shape : tuple of int
    """
    if kind in "USO":
        return "holds text or cells, not numbers"
    if kind == "c":
        return "holds complex numbers"
    if kind not in "biuf":
        return "does not hold numbers"
    size = math.prod(shape)
    if size == 0:
        return "is empty"
    if size == 1:
        return "is a scalar"
    if sum(length > 1 for length in shape) > 1:
        lengths = " x ".join(str(length) for length in shape)
        return f"is a {lengths} matrix, and a column must be a vector (save its columns apart)"
    return None


def vector(array: npt.NDArray[np.generic]) -> FloatArray | str:
    """A stored array as a column, or the reason why it cannot be one."""
    reason = unfit(array.dtype.kind, array.shape)
    return np.ascontiguousarray(array.ravel(), dtype=np.float64) if reason is None else reason


def table_of_arrays(path: Path, arrays: dict[str, FloatArray | str], what: str) -> Table:
    """A table from named vectors, with the reasons that stand in place of the unusable ones.

    Raises
    ------
    InputError
        If there is no vector among them.
    """
    columns = {name: array for name, array in arrays.items() if not isinstance(array, str)}
    unusable = {name: reason for name, reason in arrays.items() if isinstance(reason, str)}
    if not columns:
        held = commas(f"{name} {reason}" for name, reason in unusable.items())
        raise InputError(
            f"{path}: none of its {plural(len(unusable), what)} is a vector of numbers "
            f"({held}); save time, input and position as vectors"
        )
    return Table(path, columns, unusable=unusable)
