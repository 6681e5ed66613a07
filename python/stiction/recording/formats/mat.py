"""MATLAB files: every vector is a column, the fields of a struct under dotted names.

Files of version 7.3 are HDF5 and are read through h5py, an optional extra.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import IO

import numpy as np

from ..._support.arrays import FloatArray
from ...errors import InputError
from ..hdf5 import Hdf5
from ..mat5 import read_variables
from ..table import Table, table_of_arrays, vector
from .format import Format

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# MATLAB puts its own text header before the HDF5 part; other writers may not.
_HDF5_OFFSETS = (0, 512)

_Found = dict[str, FloatArray | str]


def read(path: Path) -> Table:
    """Read a MAT file of any version (see the module's text)."""
    with path.open("rb") as file:
        start = file.read(_HDF5_OFFSETS[-1] + len(_HDF5_SIGNATURE))
    found: _Found = {}
    if any(start[offset:].startswith(_HDF5_SIGNATURE) for offset in _HDF5_OFFSETS):
        _read_hdf5(path, found)
    else:
        _read_classic(path, found)
    return table_of_arrays(path, found, "variable")


FORMAT = Format("MAT", (".mat",), read)


def _unreadable(path: Path, error: Exception) -> InputError:
    reason = " ".join(str(error).split()) or type(error).__name__
    return InputError(
        f"{path}: this cannot be read as a MAT file ({reason[:120]}); "
        "save it again from MATLAB, or correct the file's ending"
    )


def _read_classic(path: Path, found: _Found) -> None:
    try:
        with path.open("rb") as file:
            if 0 in file.read(4):  # version 4 has no text in front
                _read_oldest(file, found)
            else:
                read_variables(path, file, found)
    except InputError:
        raise
    except Exception as error:  # a damaged file makes readers fail in ways they do not list
        if isinstance(error, OSError) and error.errno is not None:
            raise  # the disk's fault, not the file's
        raise _unreadable(path, error) from error


def _read_oldest(file: IO[bytes], found: _Found) -> None:
    """Version 4, in which nothing is packed: there is no more of it than the file is long."""
    import scipy.io

    file.seek(0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        variables = scipy.io.loadmat(file, appendmat=False)
    for name, value in variables.items():
        if isinstance(value, np.ndarray):
            found[name] = vector(value)
        elif not name.startswith("__"):
            found[name] = "is stored as a sparse matrix or an object; save it as a plain vector"


def _read_hdf5(path: Path, found: _Found) -> None:
    try:
        import h5py
    except ImportError as error:
        raise InputError(
            f"{path}: this MAT file has version 7.3, which is read through h5py; install it "
            "with pip install 'stiction[mat73]', or save the file with -v7 in MATLAB"
        ) from error
    try:
        with h5py.File(path, "r") as file:
            Hdf5(path, h5py, found).add("", file)
    except InputError:
        raise
    except Exception as error:  # h5py reports damage as OSError, RuntimeError or KeyError
        raise _unreadable(path, error) from error
