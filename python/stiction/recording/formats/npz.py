"""NumPy archives: every vector is a column."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...errors import InputError
from ..table import Table, table_of_arrays, vector
from ..units import FloatArray
from .format import Format

_ZIP_SIGNATURE = b"PK"


def read(path: Path) -> Table:
    """Read the vectors of an NPZ file."""
    with path.open("rb") as file:
        archive = file.read(len(_ZIP_SIGNATURE)) == _ZIP_SIGNATURE
    if not archive:
        raise InputError(
            f"{path}: this is not an NPZ archive; write one with numpy.savez, or correct the "
            "file's ending"
        )
    found: dict[str, FloatArray | str] = {}
    try:
        # Opened here, for NumPy leaves a damaged archive open.
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            for name in stored.files:
                found[name] = _column(name, stored)
    except Exception as error:  # damage shows as BadZipFile, zlib.error, ValueError or EOFError
        raise InputError(
            f"{path}: the NPZ archive is damaged ({error}); write it again with numpy.savez"
        ) from error
    return table_of_arrays(path, found, "array")


FORMAT = Format("NPZ", (".npz",), read)


def _column(name: str, stored: np.lib.npyio.NpzFile) -> FloatArray | str:
    try:
        array = stored[name]
    except ValueError as error:
        # Pickled objects could run code on loading; they are never opened.
        if "allow_pickle" not in str(error):
            raise
        return "holds Python objects, not numbers"
    return vector(array) if isinstance(array, np.ndarray) else "is no array"
