"""Parquet files: every flat column of numbers is a column, empty cells are missing.

They are read through pyarrow, an optional extra.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ..expansion import Expansion
from ..table import Table, table_of_arrays, vector
from ..units import FloatArray
from .format import Format

_SIGNATURE = b"PAR1"


def read(path: Path) -> Table:
    """Read the columns of a Parquet file (see the module's text).

    Parameters
    ----------
    path : Path

    Returns
    -------
    Table

    Raises
    ------
    InputError
        No Parquet file or a damaged one, a name twice, no column of numbers, or no pyarrow.
    """
    with path.open("rb") as file:
        start = file.read(len(_SIGNATURE))
    if start != _SIGNATURE:
        raise InputError(
            f"{path}: this is not a Parquet file (it does not start with PAR1); write it again, or "
            "correct the file's ending"
        )
    try:
        parquet: Any = import_module("pyarrow.parquet")
    except ImportError as error:
        raise InputError(
            f"{path}: Parquet is read through pyarrow; install it with "
            "pip install 'stiction[parquet]', or save the recording as CSV"
        ) from error
    found: dict[str, FloatArray | str] = {}
    try:
        with path.open("rb") as file:
            _read_columns(path, parquet.ParquetFile(file), found)
    except InputError:
        raise
    except Exception as error:  # damage shows as ArrowInvalid, OSError, ValueError and others
        if isinstance(error, OSError) and error.errno is not None:
            raise  # the disk's fault, not the file's
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            f"{path}: the Parquet file is damaged ({reason[:120]}); write it again"
        ) from error
    return table_of_arrays(path, found, "column")


FORMAT = Format("Parquet", (".parquet", ".pq"), read)


def _read_columns(path: Path, stored: Any, found: dict[str, FloatArray | str]) -> None:
    """Read columns of numbers, one at a time: text may be of any length and is not touched."""
    expansion = Expansion(path)
    held = _numbers_held(stored.metadata)
    for field in stored.schema_arrow:
        if field.name in found:
            raise InputError(
                f"{path}: the column '{field.name}' stands there twice; rename one of them"
            )
        if reason := _unusable(field.type):
            found[field.name] = reason
            continue
        # Twice: as it is stored, and as the number that it becomes.
        expansion.numbers(f"column '{field.name}'", 2 * held.get(field.name, 0))
        found[field.name] = _column(stored.read(columns=[field.name]).column(0))


def _numbers_held(metadata: Any) -> dict[str, int]:
    """How many values of each column the file says that it holds."""
    held: dict[str, int] = {}
    for group in range(metadata.num_row_groups):
        rows = metadata.row_group(group)
        for index in range(rows.num_columns):
            column = rows.column(index)
            name = column.path_in_schema
            held[name] = held.get(name, 0) + max(column.num_values, rows.num_rows)
    return held


def _unusable(kind: Any) -> str | None:
    """Why a type of column holds no numbers."""
    kinds: Any = import_module("pyarrow").types
    if kinds.is_dictionary(kind):
        kind = kind.value_type
    if kinds.is_temporal(kind):
        return "holds dates or times of day; save it as seconds since the start"
    if not (
        kinds.is_integer(kind)
        or kinds.is_floating(kind)
        or kinds.is_decimal(kind)
        or kinds.is_boolean(kind)
        or kinds.is_null(kind)
    ):
        return f"holds {kind}, not numbers"
    return None


def _column(column: Any) -> FloatArray | str:
    kinds: Any = import_module("pyarrow").types
    kind = column.type
    if kinds.is_dictionary(kind):
        column, kind = column.cast(kind.value_type), kind.value_type
    numbers = column.to_pylist() if kinds.is_decimal(kind) else column.to_numpy()
    if numbers.dtype.kind == "O" if isinstance(numbers, np.ndarray) else True:
        # Booleans and decimals with empty cells come as objects; None becomes NaN.
        numbers = np.array([np.nan if value is None else float(value) for value in numbers])
    return vector(numbers)
