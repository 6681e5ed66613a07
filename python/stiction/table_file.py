"""Columns of numbers as a file, NPZ or CSV by the name's ending."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import given
from .errors import InputError

if TYPE_CHECKING:
    from .trajectory import FloatArray

__all__ = ["save_table"]


def save_table(path: Path, table: Mapping[str, FloatArray]) -> Path:
    """Write columns to a file; every number is read back as it was.

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
    with given.written(path):
        if path.suffix == ".npz":
            np.savez_compressed(path, **table)  # type: ignore[arg-type]
        else:
            np.savetxt(
                path,
                np.column_stack(list(table.values())),
                delimiter=",",
                header=",".join(table),
                comments="",
                fmt="%.17g",
            )
    return path
