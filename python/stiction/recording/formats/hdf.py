"""HDF5 files of any layout: every vector is a column, groups under dotted names.

The columns of a matrix are numbered. Read through h5py, an optional extra.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any, Final

from ..._support.arrays import FloatArray
from ...errors import InputError
from ..gathered import damage_error, missing_package
from ..hdf5 import Hdf5
from ..table import Table, table_of_arrays
from .format import Format

_SIGNATURE: Final = b"\x89HDF\r\n\x1a\n"


def read(path: Path) -> Table:
    """Read an HDF5 file (see the module's text)."""
    with path.open("rb") as file:
        start = file.read(len(_SIGNATURE))
    if start != _SIGNATURE:
        raise InputError(
            f"{path}: this is not an HDF5 file (it does not start as one); correct the file's "
            "ending"
        )
    try:
        h5py: Any = import_module("h5py")
    except ImportError as error:
        raise missing_package(path, "HDF5", "h5py", "mat73", error) from error
    found: dict[str, FloatArray | str] = {}
    try:
        with h5py.File(path, "r") as file:
            Hdf5(path, h5py, found, matrices=True).add("", file)
    except Exception as error:
        raise damage_error(path, "HDF5", error) from error
    return table_of_arrays(path, found, "data set")


FORMAT = Format("HDF5", (".h5", ".hdf5", ".hdf", ".he5"), read)
