"""What the numbers of a column say, whatever its name: rising, moving, alike, in which steps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..column_words import Said, what_it_says
from ..motion import count_of
from ..table import Table, quote

RISING: Final = 0.95
"""Share of steps upward that makes a clock: a logger's odd slip is repaired later."""

_TRIMMED: Final = (0.001, 0.999)
_STEP_FITS: Final = 1e-4


@dataclass(frozen=True)
class Column:
    """A column of one or several files that have the same columns.

    Attributes
    ----------
    name : str
    said : Said
        What the name says.
    arrays : tuple of ndarray
        The numbers of each file, gaps filled; empty where ``trouble`` is not.
    trouble : str
        Why it cannot be a channel.
    from_text : bool
        The numbers were printed, so that their smallest step may be the last digit.
    """

    name: str
    said: Said
    arrays: tuple[FloatArray, ...] = ()
    trouble: str = ""
    from_text: bool = False

    @property
    def constant(self) -> bool:
        """Whether it never changes, within any file."""
        return all(np.ptp(array) == 0.0 for array in self.arrays)

    @property
    def low(self) -> float:
        """Least value but for a few outliers."""
        return min(float(np.quantile(array, _TRIMMED[0])) for array in self.arrays)

    @property
    def high(self) -> float:
        """Greatest value but for a few outliers."""
        return max(float(np.quantile(array, _TRIMMED[1])) for array in self.arrays)

    @property
    def span(self) -> float:
        """Greatest width of its range in any file, but for a few outliers."""
        widths = (np.ptp(np.quantile(array, _TRIMMED)) for array in self.arrays)
        return float(max(widths))

    @property
    def rises(self) -> bool:
        """Whether it increases, row by row, as a clock does."""
        return all(
            len(array) > 1 and np.mean(np.diff(array) > 0.0) >= RISING for array in self.arrays
        )

    @property
    def step(self) -> float:
        """Median of its steps."""
        return float(np.median(np.concatenate([np.diff(array) for array in self.arrays])))

    @property
    def even(self) -> bool:
        """Whether nine of ten steps are within a half of the median one."""
        steps = np.concatenate([np.diff(array) for array in self.arrays])
        return bool(np.mean(np.abs(steps - self.step) <= 0.5 * abs(self.step)) >= 0.9)

    @property
    def whole(self) -> bool:
        """Whether all values are whole numbers."""
        return all(bool(np.all(array == np.round(array))) for array in self.arrays)

    @property
    def count(self) -> float:
        """Size of the steps that readings are made of, 0 where they have no common step."""
        counts = [count_of(array) for array in self.arrays]
        return min((count for count in counts if count > 0.0), default=0.0)

    @property
    def roughness(self) -> float:
        """How rough it is: what nine of ten third differences stay below, jumps apart."""
        rough = [np.quantile(np.abs(np.diff(array, 3)), 0.9) for array in self.arrays]
        return float(np.median(rough))

    @property
    def hold_length(self) -> float:
        """Rows from one change to the next, usually."""
        lengths: list[float] = []
        for array in self.arrays:
            changes = np.flatnonzero(np.diff(array))
            lengths += np.diff(changes).tolist() if len(changes) > 1 else [len(array)]
        return float(np.median(lengths))


def columns_of(tables: Sequence[Table]) -> list[Column]:
    """The columns that all of these tables have, in the order of the first."""
    rows = [_usual_length(table) for table in tables]
    first = tables[0]
    names = [*first.columns, *first.unusable]
    return [_column(name, tables, rows) for name in names]


def _column(name: str, tables: Sequence[Table], rows: Sequence[int]) -> Column:
    said = what_it_says(tables[0].heading(name))
    arrays = []
    for table, number in zip(tables, rows, strict=True):
        if name not in table.columns:
            return Column(name, said, trouble=table.unusable.get(name, "is not in every file"))
        cell = next((cell for cell in table.cells if cell.column == name), None)
        if cell is not None:
            where = f"{table.path.name}, {table.place(cell.row)}"
            return Column(name, said, trouble=f"holds text ({quote(cell.text)} in {where})")
        array = table.columns[name]
        if len(array) != number:
            trouble = f"has {len(array)} rows, and the others have {number}"
            return Column(name, said, trouble=trouble)
        bad = ~np.isfinite(array)
        if bad.all():
            return Column(name, said, trouble="holds no number")
        if bad.any():
            at = np.arange(len(array))
            array = np.where(bad, np.interp(at, at[~bad], array[~bad]), array)
        # Beyond this, squares and sums are infinite; no quantity of a machine is.
        if float(np.max(np.abs(array))) > 1e100:
            return Column(name, said, trouble="holds numbers beyond 1e100")
        arrays.append(array)
    return Column(name, said, tuple(arrays), from_text=first_has_lines(tables))


def first_has_lines(tables: Sequence[Table]) -> bool:
    """Whether the numbers were read from lines of text."""
    return tables[0].lines is not None


def _usual_length(table: Table) -> int:
    lengths = [len(array) for array in table.columns.values()]
    return max(set(lengths), key=lambda length: (lengths.count(length), length))


def alike(one: Column, other: Column) -> float:
    """Correlation of two columns, the median over files; 0 where one does not change."""
    found = []
    for a, b in zip(one.arrays, other.arrays, strict=True):
        a, b = a - a.mean(), b - b.mean()
        size = math.sqrt(float(a @ a)) * math.sqrt(float(b @ b))
        found.append(float(a @ b) / size if size > 0.0 else 0.0)
    return float(np.median(found))


def rate_of(position: Column, clock: Sequence[FloatArray], velocity: Column) -> tuple[float, float]:
    """Factor from the position's rate of change to a velocity, and their correlation.

    Changes of position over a hundredth of the recording are held against the velocity summed
    over it, so that the noise of single samples does not count. (0, 0) without motion.
    Without a clock rows stand for it, and only the correlation has a meaning.
    """
    ratios, fits = [], []
    clock = clock or [np.arange(len(array), dtype=np.float64) for array in position.arrays]
    for x, time, v in zip(position.arrays, clock, velocity.arrays, strict=True):
        travelled = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(time))])
        rows = max(1, len(x) // 100)
        moved, summed = x[rows:] - x[:-rows], travelled[rows:] - travelled[:-rows]
        power = float(moved @ moved), float(summed @ summed)
        if min(power) > 0.0:
            product = float(moved @ summed)
            ratios.append(product / power[0])
            fits.append(product / math.sqrt(power[0]) / math.sqrt(power[1]))
    return (float(np.median(ratios)), float(np.median(fits))) if ratios else (0.0, 0.0)


def goes_both_ways(position: Column) -> bool:
    """Whether at least a tenth of the travel is in either direction."""
    steps = np.concatenate([np.diff(array) for array in position.arrays])
    up, down = float(np.sum(steps[steps > 0.0])), -float(np.sum(steps[steps < 0.0]))
    return min(up, down) > 0.1 * max(up, down)


def counts_in_a_turn(step: float, turn: float) -> int:
    """Whole number of steps in a turn that encoders have, 0 where there is none."""
    if step <= 0.0:
        return 0
    number = turn / step
    power = round(math.log2(number)) if number > 1.0 else 0
    if 6 <= power <= 26 and abs(number / 2.0**power - 1.0) < 1e-5:
        return int(2**power)
    hundreds = 100 * round(number / 100.0)
    return hundreds if 100 <= hundreds <= 200_000 and abs(number - hundreds) < 0.01 else 0


def round_figure(step: float) -> bool:
    """Whether a step is 1, 2, 2.5 or 5 of some decimal place, as rulers have."""
    if step <= 0.0:
        return False
    mantissa = step / 10.0 ** math.floor(math.log10(step) + 1e-9)
    return any(abs(mantissa / figure - 1.0) < _STEP_FITS for figure in (1.0, 2.0, 2.5, 5.0, 10.0))
