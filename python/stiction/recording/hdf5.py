"""What is read of an HDF5 file from a stranger: numbers that stand in the file itself.

A library that follows all that the format can say would read any other file of the machine.
MATLAB writes nothing of that kind.
"""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any, Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.wording import printable
from ..errors import InputError
from .expansion import Expansion, most_bytes
from .table import unfit, vector

_DEEPEST: Final = 64
_WIDEST: Final = 64
_DEFLATE: Final = 1
_MOST_DEFLATED: Final = 1032
"""Bytes that one deflated byte may expand to."""


class Hdf5:
    """One way through a file.

    Parameters
    ----------
    path : Path
    h5py : module
    found : dict
        Variables by dotted name, or why they cannot be columns; filled here.
    matrices : bool
        Whether the columns of a matrix are columns, ``q[0]``, ``q[1]``: not so in MATLAB's files.
    """

    def __init__(
        self, path: Path, h5py: Any, found: dict[str, FloatArray | str], *, matrices: bool = False
    ) -> None:
        self._matrices = matrices
        self._path, self._h5py, self._found = path, h5py, found
        self._expansion = Expansion(path)
        self._groups: set[int] = set()

    def add(self, name: str, node: Any, depth: int = 0) -> None:
        """Add a variable, or all of a struct.

        Raises
        ------
        InputError
            Something in it leads out of the file, or is larger than it may be.
        """
        if isinstance(node, self._h5py.Group):
            self._add_group(name, node, depth)
        elif isinstance(node, self._h5py.Dataset):
            column = self._column(name, node)
            if isinstance(column, np.ndarray) and column.ndim == 2:
                for k, values in enumerate(column.T):
                    self._found[f"{name}[{k}]"] = np.ascontiguousarray(values)
            else:
                self._found[name] = column
        else:
            self._found[name] = "is a type, not numbers"

    def _add_group(self, name: str, group: Any, depth: int) -> None:
        place = self._h5py.h5o.get_info(group.id).addr
        if place in self._groups or depth > _DEEPEST:
            self._found[name] = "is a struct that stands there under another name too"
            return
        self._groups.add(place)
        for key in group:
            # #refs# and #subsystem# hold what cells and objects point to.
            if key.startswith("#"):
                continue
            own = f"{name}.{key}" if name else key
            link = group.get(key, getlink=True)
            if isinstance(link, self._h5py.ExternalLink):
                self._refuse(own, f"is a link into another file ({link.filename!r})")
            if not isinstance(link, self._h5py.HardLink):
                self._refuse(own, "is a link to another variable")
            self.add(own, group[key], depth + 1)

    def _refuse(self, name: str, what: str) -> None:
        raise InputError(
            f"{self._path}: variable '{printable(name)}' {what}, which is not followed; save the "
            "values themselves in this file, as MATLAB does with -v7.3 or -v7"
        )

    def _column(self, name: str, node: Any) -> FloatArray | str:
        # First of all, for asking for more may open the other file.
        storage = node.id.get_create_plist()
        if storage.get_layout() == self._h5py.h5d.VIRTUAL:
            self._refuse(name, "is put together from other files or variables (virtual data set)")
        if storage.get_external_count():
            self._refuse(name, "has its values in another file (external storage)")
        kind = node.attrs.get("MATLAB_class", b"double")
        if isinstance(kind, bytes) and kind == b"char":
            return "holds text or cells, not numbers"
        if "MATLAB_empty" in node.attrs:
            return "is empty"
        try:
            dtype = node.dtype
        except TypeError:  # NumPy has no such type
            return "does not hold numbers"
        if dtype.names is not None:
            complex_ = set(dtype.names) == {"real", "imag"}
            return "holds complex numbers" if complex_ else "holds records, not numbers"
        if node.shape is None:
            return "is empty"
        plain = self._matrices and len(node.shape) == 2 and 1 < node.shape[1] <= _WIDEST
        matrix = plain and node.shape[0] > node.shape[1] and dtype.kind in "biuf"
        if not matrix and (reason := unfit(dtype.kind, node.shape)):
            return reason
        size = node.size * (dtype.itemsize + 8)
        self._expansion.bytes(f"variable '{name}'", size)
        if storage.get_layout() == self._h5py.h5d.CHUNKED:
            self._check_chunks(name, node, storage)
        values = node[()]
        return np.asarray(values, dtype=np.float64) if matrix else vector(values)

    def _check_chunks(self, name: str, node: Any, storage: Any) -> None:
        """Refuse chunks that do not say how far they expand, and chunks larger than all data."""
        room = node.dtype.itemsize
        for length in node.chunks:
            room *= length
        self._expansion.bytes(f"a chunk of variable '{name}'", room)
        filters = [storage.get_filter(k)[0] for k in range(storage.get_nfilters())]
        if _DEFLATE not in filters:
            return
        for k in range(node.id.get_num_chunks()):
            chunk = node.id.get_chunk_info(k)
            if chunk.size * _MOST_DEFLATED <= most_bytes() or chunk.filter_mask:
                continue
            if filters[-1] != _DEFLATE:
                continue  # what is packed twice is not deflated last
            _, packed = node.id.read_direct_chunk(chunk.chunk_offset)
            if not _fits(packed, room):
                raise ValueError(f"a chunk of variable '{name}' is longer than its own shape")


def _fits(packed: bytes, room: int) -> bool:
    unpacking = zlib.decompressobj()
    while packed and not unpacking.eof and room >= 0:
        room -= len(unpacking.decompress(packed, 2**20))
        packed = unpacking.unconsumed_tail
    return room >= 0
