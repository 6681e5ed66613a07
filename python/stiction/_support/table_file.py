"""Columns of numbers as a file, NPZ or CSV by the name's ending.

A CSV file that was cut short is one as well, so that its last column counts the rows and says in
its name how many there are; ``recording.row_count`` reads that.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from . import given
from .atomic_files import atomic_write

if TYPE_CHECKING:
    from .arrays import FloatArray

__all__ = ["save_table"]


def save_table(path: Path, table: Mapping[str, FloatArray]) -> Path:
    """Write columns to a file; every number is read back as it was.

    A CSV file gets one more column, such as ``row_of_4000``, which counts its rows.

    Parameters
    ----------
    path : Path
        NPZ or CSV, by the name's ending.
    table : Mapping of str to numpy.ndarray, shape (n,)
        Columns by name.

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    InputError
        An unknown ending, a folder that is not there, a file that cannot be written.
    """
    if not path.parent.is_dir():
        raise InputError(f"{path}: there is no folder {path.parent}; make it first")
    if path.suffix not in (".npz", ".csv"):
        raise InputError(f"{path}: ending '{path.suffix}' is not known; use .npz or .csv")
    with given.explain_write_errors(path), atomic_write(path) as file:
        if path.suffix == ".npz":
            np.savez_compressed(file, **table)  # type: ignore[arg-type]
        else:
            rows = np.column_stack(list(table.values()))
            counting = np.arange(1, len(rows) + 1)
            file.write(f"{','.join(table)},row_of_{len(rows)}\n".encode())
            formats = ["%.17g"] * rows.shape[1] + ["%d"]
            np.savetxt(file, np.column_stack([rows, counting]), delimiter=",", fmt=formats)
    return path
