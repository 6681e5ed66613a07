"""Parquet and Arrow (Feather) files: every column of numbers is a column, empty cells are missing.

Lists of as many numbers in every row, as LeRobot writes them, give a column each,
``action[0]``, ``action[1]``. Stamps become seconds since the first. They are read through pyarrow,
an optional extra.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from ..._support.arrays import FloatArray
from ...errors import InputError
from ..expansion import Expansion
from ..gathered import damage_error, missing_package
from ..table import Table, table_of_arrays, vector
from .format import Format

_SIGNATURE = b"PAR1"
_ARROW = b"ARROW1"
_WIDEST = 256


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


def read_arrow(path: Path) -> Table:
    """Read the columns of an Arrow (Feather) file (see the module's text)."""
    with path.open("rb") as file:
        start = file.read(len(_ARROW))
    if start != _ARROW:
        raise InputError(
            f"{path}: this is not an Arrow file (it does not start with ARROW1); correct the "
            "file's ending"
        )
    try:
        arrow: Any = import_module("pyarrow")
        ipc: Any = import_module("pyarrow.ipc")
    except ImportError as error:
        raise missing_package(path, "an Arrow file", "pyarrow", "parquet", error) from error
    found: dict[str, FloatArray | str] = {}
    expansion = Expansion(path)
    try:
        with path.open("rb") as file:
            reader = ipc.open_file(file)
            batches = []
            for k in range(reader.num_record_batches):
                batches.append(reader.get_batch(k))
                expansion.bytes("its columns", 3 * batches[-1].nbytes)
            stored = arrow.Table.from_batches(batches, reader.schema)
            for place, field in enumerate(stored.schema):
                if field.name in found:
                    raise InputError(
                        f"{path}: the column '{field.name}' stands there twice; rename one of them"
                    )
                if reason := _unusable(field.type):
                    found[field.name] = reason
                elif _is_list(field.type):
                    _add_lists(field.name, stored.column(place), found)
                else:
                    found[field.name] = _column(stored.column(place))
    except Exception as error:
        raise damage_error(path, "an Arrow file", error) from error
    return table_of_arrays(path, found, "column")


ARROW = Format("Arrow", (".arrow", ".feather", ".ipc"), read_arrow)


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
        if _is_list(field.type):
            number = held.get(f"{field.name}.list.element", held.get(f"{field.name}.list.item", 0))
            expansion.numbers(f"column '{field.name}'", 3 * number)
            _add_lists(field.name, stored.read(columns=[field.name]).column(0), found)
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
    if kinds.is_dictionary(kind) or _is_list(kind):
        kind = kind.value_type
    if kinds.is_timestamp(kind):
        return None
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


def _is_list(kind: Any) -> bool:
    kinds: Any = import_module("pyarrow").types
    listed = kinds.is_list(kind) or kinds.is_large_list(kind) or kinds.is_fixed_size_list(kind)
    return listed and not kinds.is_nested(kind.value_type)


def _add_lists(name: str, column: Any, found: dict[str, FloatArray | str]) -> None:
    """The columns of a column of lists, or why it has none."""
    compute: Any = import_module("pyarrow.compute")
    lengths = compute.list_value_length(column).to_numpy(zero_copy_only=False)
    width = int(lengths[0]) if len(lengths) and np.isfinite(lengths[0]) else 0
    if not 0 < width <= _WIDEST or not np.all(lengths == width):
        found[name] = f"holds lists that are not all of 1 to {_WIDEST} numbers and of one length"
        return
    flat = _column(compute.list_flatten(column))
    if isinstance(flat, str):
        found[name] = flat
        return
    for k, values in enumerate(flat.reshape(-1, width).T):
        found[name if width == 1 else f"{name}[{k}]"] = np.ascontiguousarray(values)


def _column(column: Any) -> FloatArray | str:
    kinds: Any = import_module("pyarrow").types
    kind = column.type
    if kinds.is_timestamp(kind):
        stamps = column.to_numpy().astype("datetime64[ns]")
        since = stamps - stamps[~np.isnat(stamps)][:1] if len(stamps) else stamps
        return vector(np.where(np.isnat(stamps), np.nan, 1e-9 * since.astype(np.float64)))
    if kinds.is_dictionary(kind):
        column, kind = column.cast(kind.value_type), kind.value_type
    numbers = column.to_pylist() if kinds.is_decimal(kind) else column.to_numpy()
    if numbers.dtype.kind == "O" if isinstance(numbers, np.ndarray) else True:
        # Booleans and decimals with empty cells come as objects; None becomes NaN.
        numbers = np.array([np.nan if value is None else float(value) for value in numbers])
    return vector(numbers)
