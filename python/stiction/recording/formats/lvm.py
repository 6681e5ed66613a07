"""LabVIEW measurement files: text with a head of its own.

National Instruments, "Specification for the LabVIEW Measurement File (.lvm)".  The last
``***End_of_Header***`` is followed by the names of the columns and the rows.  Where the file holds
no times, they follow from ``Delta_X``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.units import known_unit
from ...errors import InputError
from ..table import Table
from ..text.cells import number, split
from ..text.lines import blocks, check_length
from ..text.rows import Head
from ..text.stamps import Stamps
from .delimited import rows_below
from .format import Format

_TITLE: Final = "LabVIEW Measurement"
_END: Final = "***End_of_Header***"
_COMMENT: Final = "Comment"
_TIME: Final = "X_Value"
_MOST_LINES: Final = 1000
_SEPARATORS: Final = {"tab": "\t", "comma": ","}
_UNITS: Final = {"volts": "V", "amps": "A", "amperes": "A", "seconds": "s", "newtons": "N"}


@dataclass(frozen=True)
class _Top:
    """What stands above the rows: each line by its first cell, and the line of names."""

    said: dict[str, list[str]]
    delimiter: str
    names: list[str]
    line: int


def read(path: Path) -> Table:
    """Read a LabVIEW measurement file (see the module's text)."""
    top = _top(path)
    names = [name or f"column {place}" for place, name in enumerate(top.names, start=1)]
    commas = top.said.get("Decimal_Separator", [""])[0] == "," and top.delimiter != ","
    table = rows_below(path, Head(top.delimiter, top.line, names, {}, top.line), commas=commas)
    # Remarks stand in a last column, in single rows.
    columns = {name: column for name, column in table.columns.items() if name != _COMMENT}
    cells = tuple(cell for cell in table.cells if cell.column != _COMMENT)
    signals = [name for name in columns if name != _TIME]
    units = _units(top.said.get("Y_Unit_Label", []), signals)
    if top.said.get("X_Columns", ["One"])[0].casefold() == "no":
        columns.pop(_TIME, None)
        columns = {_TIME: _times(path, top, len(table.lines or ())), **columns}
    begins = _begins(top.said)
    return replace(
        table,
        columns=columns,
        cells=cells,
        units={_TIME: "s", **units} if _TIME in columns else units,
        begins={} if begins is None else {_TIME: begins},
    )


FORMAT = Format("LabVIEW", (".lvm",), read)


def _top(path: Path) -> _Top:
    said: dict[str, list[str]] = {}
    delimiter, ended, count = "\t", False, 0
    for block in blocks(path):
        for number_, line in block.lines():
            count += 1
            check_length(path, number_, line)
            if count == 1 and not line.startswith(_TITLE):
                raise InputError(
                    f"{path}: this is no LabVIEW measurement (its first line is not "
                    f"'{_TITLE}'); correct the file's ending, as in .csv"
                )
            if count == 2 and line.startswith("Writer_Version,"):
                delimiter = ","
            cells = split(line, delimiter)
            first = cells[0]
            if first == _END:
                ended = True
            elif first == "Separator" and len(cells) > 1:
                delimiter = _SEPARATORS.get(cells[1].casefold(), delimiter)
            elif ended and first == _TIME:
                while cells and not cells[-1]:
                    cells.pop()
                return _Top(said, delimiter, _distinct(cells), number_)
            elif first:
                said[first] = cells[1:]
            if count > _MOST_LINES:
                break
        if count > _MOST_LINES:
            break
    raise InputError(
        f"{path}: the LabVIEW measurement has no line of names ('{_TIME}') below its header; was "
        "the file cut off?"
    )


def _distinct(names: Sequence[str]) -> list[str]:
    """Names that are there twice, as with a column of times for each channel, with a number."""
    seen: dict[str, int] = {}
    distinct = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        distinct.append(name if seen[name] == 1 else f"{name} {seen[name]}")
    return distinct


def _units(labels: Sequence[str], signals: Sequence[str]) -> dict[str, str]:
    said = {
        name: _UNITS.get(label.casefold(), label)
        for name, label in zip(signals, labels, strict=False)
    }
    return {name: unit for name, unit in said.items() if known_unit(unit) is not None}


def _times(path: Path, top: _Top, rows: int) -> FloatArray:
    step, start = _number(top, "Delta_X"), _number(top, "X0")
    if step is None or not 0.0 < step < np.inf:
        raise InputError(
            f"{path}: the LabVIEW measurement holds no times, and no step of time (Delta_X) "
            "either; write it with a column of times"
        )
    times: FloatArray = (start or 0.0) + step * np.arange(rows, dtype=np.float64)
    return times


def _number(top: _Top, key: str) -> float | None:
    text = next(iter(top.said.get(key, [])), "")
    return number(text.replace(",", "."))


def _begins(said: dict[str, list[str]]) -> float | None:
    stamp = " ".join(next(iter(said.get(key, [])), "") for key in ("Date", "Time"))
    stamps = Stamps()
    stamps.second(stamp.strip())
    return stamps.begins
