"""NumPy archives: every vector is a column."""

from __future__ import annotations

import math
from pathlib import Path
from typing import IO, Any, Final
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

import numpy as np
from numpy.lib import format as npy

from ..._support.arrays import FloatArray
from ...errors import InputError
from ..expansion import Expansion
from ..table import Table, table_of_arrays, unfit, vector
from .format import Format

_ZIP_SIGNATURE: Final = b"PK"
_ENDING: Final = ".npy"
# Other ways of packing are no NumPy's, and a few bytes of them may be gigabytes at once.
_PACKED: Final = (ZIP_STORED, ZIP_DEFLATED)

_Header = tuple[tuple[int, ...], bool, np.dtype[Any]]


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
    expansion = Expansion(path)
    try:
        with path.open("rb") as file, ZipFile(file) as stored:
            for member in stored.infolist():
                name = member.filename.removesuffix(_ENDING)
                if name in found:
                    raise InputError(
                        f"{path}: the array '{name}' stands there twice; rename one of them"
                    )
                found[name] = _column(name, stored, member, expansion)
    except InputError:
        raise
    except Exception as error:  # damage shows as BadZipFile, zlib.error, ValueError or EOFError
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            f"{path}: the NPZ archive is damaged ({reason[:120]}); write it again with numpy.savez"
        ) from error
    return table_of_arrays(path, found, "array")


FORMAT = Format("NPZ", (".npz",), read)


def check_room(path: Path, file: IO[bytes]) -> None:
    """Refuse an archive whose arrays are larger than what is stored of them, or than a file may be.

    For those who have NumPy read it all, which makes room for what a header asks for.

    Parameters
    ----------
    path : Path
        For the sentence.
    file : file
        Open for reading.

    Raises
    ------
    InputError
        It would expand beyond the ceiling.
    ValueError
        It is damaged; the errors of a zip archive and of NumPy's headers too.
    """
    expansion = Expansion(path)
    with ZipFile(file) as stored:
        for member in stored.infolist():
            name = member.filename.removesuffix(_ENDING)
            if member.compress_type not in _PACKED:
                raise ValueError(f"array '{name}' is packed in a way that NumPy does not write")
            with stored.open(name=member) as opened:
                header = _header(opened)
            if header is None:
                raise ValueError(f"array '{name}' does not hold numbers")
            expansion.bytes(f"array '{name}'", _stored(name, member, header))


def _column(name: str, stored: ZipFile, member: ZipInfo, expansion: Expansion) -> FloatArray | str:
    if not member.filename.endswith(_ENDING):
        return "is no array"
    if member.compress_type not in _PACKED:
        return "is packed in a way that NumPy does not write"
    with stored.open(name=member) as file:
        if (header := _header(file)) is None:
            return "does not hold numbers"
        shape, _, kind = header
        if kind.hasobject:
            # Pickled objects could run code on loading; they are never opened.
            return "holds Python objects, not numbers"
        _stored(name, member, header)
        if reason := unfit(kind.kind, shape):
            return reason
        size = math.prod(shape)
        expansion.bytes(f"array '{name}'", size * (kind.itemsize + 8))
        data = file.read(size * kind.itemsize)
    return vector(np.frombuffer(data, kind, size))


def _stored(name: str, member: ZipInfo, header: _Header) -> int:
    """Bytes of an array: what its header asks for is there, or nothing is made room for."""
    shape, _, kind = header
    size = math.prod(shape) * kind.itemsize
    if min(shape, default=0) < 0 or size > member.file_size:
        raise ValueError(f"array '{name}' is longer than what is stored of it")
    return size


def _header(file: IO[bytes]) -> _Header | None:
    """Shape, order and type of a stored array, None of one that has named fields."""
    version = npy.read_magic(file)
    if version == (1, 0):
        return npy.read_array_header_1_0(file)
    if version == (2, 0):
        return npy.read_array_header_2_0(file)
    if version == (3, 0):
        return None
    raise ValueError(f"an array of format {version}")
