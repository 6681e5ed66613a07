"""Whether a table that says how many rows it has is whole.

A column ``row_of_4000`` counts its rows, 1 to 4000: the commonest readers of tables (spreadsheets,
pandas, NumPy) take a column and trip over a comment. It stands last, so that a last row that was
broken off lacks it.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

import numpy as np

from .._support.wording import plural
from ..errors import InputError
from .table import Table

__all__ = ["complete"]

_COUNTING: Final = re.compile(r"row_of_(\d{1,15})")


def complete(table: Table) -> Table:
    """The table without the column that counts its rows.

    Raises
    ------
    InputError
        Rows are missing, or one was broken off.
    """
    for name, column in table.columns.items():
        found = _COUNTING.fullmatch(name.strip())
        if found is None:
            continue
        number = int(found[1])
        right = column[:number] == np.arange(1, min(number, len(column)) + 1)
        if len(column) != number or not np.all(right):
            whole = int(np.argmin(right)) if not np.all(right) else len(right)
            raise InputError(
                f"{table.path}: column '{name.strip()}' says that the file has "
                f"{plural(number, 'row')}, and {whole} of {len(column)} stand as they were "
                "written: the file was cut short or edited; write it again, or delete that column "
                "where rows were left out on purpose"
            )
        return replace(
            table,
            columns={other: values for other, values in table.columns.items() if other != name},
            cells=tuple(cell for cell in table.cells if cell.column != name),
            units={other: unit for other, unit in table.units.items() if other != name},
        )
    return table
