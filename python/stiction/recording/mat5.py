"""MAT files of version 5 (MATLAB's -v6 and -v7): the numbers in them.

Such a file is made of elements, each with its kind and length, which may be packed; the layout is
that of MathWorks' "MAT-File Format".  SciPy's reader believes what a file says of itself: a few
bytes ask it for any amount of memory, and a damaged variable ends the whole process.  Here vectors
of numbers are read, and all else is walked over.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Final, Protocol

import numpy as np

from .._support.arrays import FloatArray
from .._support.wording import printable
from ..errors import InputError
from .expansion import Expansion
from .table import unfit

_HEADER: Final = 128
_MATRIX, _PACKED = 14, 15
_CELL, _STRUCT, _OBJECT, _CHAR, _SPARSE = 1, 2, 3, 4, 5
_LAST_NUMERIC: Final = 15
_COMPLEX: Final = 1 << 11
_TYPES: Final = {
    **{1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4"},
    **{6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"},
}
_DEEPEST: Final = 64
_MOST_LENGTHS: Final = 64
_LONGEST_NAMES: Final = 2**20
"""Bytes; of a variable, or of all fields of a struct."""
_PIECE: Final = 2**16

_Found = dict[str, FloatArray | str]


def read_variables(path: Path, file: IO[bytes], found: _Found) -> None:
    """Add every variable, or why it cannot be a column.

    Parameters
    ----------
    path : Path
        For the sentence.
    file : binary file
        Of version 5.
    found : dict
        By name, the fields of a struct under dotted ones.

    Raises
    ------
    InputError
        It expands to more than it may, or a name stands there twice.
    ValueError, EOFError, struct.error, zlib.error
        It is damaged.
    """
    end = file.seek(0, 2)
    file.seek(0)
    order = ">" if file.read(_HEADER).endswith(b"MI") else "<"
    reader = _Reader(path, order, found)
    while file.tell() + 8 <= end:
        bare = _Bare(file, end)
        kind, size, _ = reader.tag(bare)
        begin = file.tell()
        if begin + size > end:
            raise EOFError("it ends within a variable")
        if kind == _PACKED:
            unpacked = _Unpacked(file, size)
            inner, length, _ = reader.tag(unpacked)
            if inner == _MATRIX:
                reader.variable(unpacked, length)
                unpacked.close()
        elif kind == _MATRIX:
            reader.variable(bare, size)
        file.seek(begin + size)


class _Source(Protocol):
    def take(self, size: int) -> bytes: ...
    def skip(self, size: int) -> None: ...


class _Bare:
    """Elements as they stand in the file."""

    def __init__(self, file: IO[bytes], end: int) -> None:
        self._file, self._end = file, end

    def take(self, size: int) -> bytes:
        self._check(size)
        return self._file.read(size)

    def skip(self, size: int) -> None:
        self._check(size)
        self._file.seek(size, 1)

    def _check(self, size: int) -> None:
        if self._file.tell() + size > self._end:
            raise EOFError("it ends within a variable")


class _Unpacked:
    """Elements of a packed variable, of which no more is unpacked than is asked for."""

    def __init__(self, file: IO[bytes], size: int) -> None:
        self._file, self._left = file, size
        self._zlib = zlib.decompressobj()
        self._data = b""

    def take(self, size: int) -> bytes:
        taken = bytearray()
        for piece in self._pieces(size):
            taken += piece
        return bytes(taken)

    def skip(self, size: int) -> None:
        for _ in self._pieces(size):
            pass

    def close(self) -> None:
        """Check that nothing follows, and, as zlib does at the end, that nothing is damaged."""
        while not self._data and not self._zlib.eof:
            self._data = self._more()
        if self._data:
            raise ValueError("a packed variable is longer than it says")

    def _pieces(self, size: int) -> Iterator[bytes]:
        while size > 0:
            self._data = self._data or self._more()
            piece, self._data = self._data[:size], self._data[size:]
            size -= len(piece)
            yield piece

    def _more(self) -> bytes:
        packed = self._zlib.unconsumed_tail
        if not packed:
            packed = self._file.read(min(_PIECE, self._left))
            self._left -= len(packed)
        data = self._zlib.decompress(packed, _PIECE)
        if not data and not packed:
            raise EOFError("it ends within a variable")
        return data


class _Left:
    """What is left of an element, of which those within it may take no more."""

    def __init__(self, reader: _Reader, source: _Source, size: int) -> None:
        self.source, self.size, self._reader = source, size, reader

    def claim(self, size: int) -> None:
        if size > self.size:
            raise ValueError("an element is longer than the one it stands in")
        self.size -= size

    def tag(self) -> tuple[int, int, bytes | None]:
        self.claim(8)
        return self._reader.tag(self.source)

    def skip(self, size: int) -> None:
        size = self._padded(size)
        self.claim(size)
        self.source.skip(size)

    def element(self, longest: int) -> tuple[int, bytes]:
        """Kind and data of an element of at most so many bytes."""
        kind, size, data = self.tag()
        if data is not None:
            return kind, data
        if size > longest:
            raise ValueError("an element is longer than it can be")
        padded = self._padded(size)
        self.claim(padded)
        return kind, self.source.take(padded)[:size]

    def _padded(self, size: int) -> int:
        # To whole words, save at the end, which some writers leave ragged.
        return max(size, min(size + -size % 8, self.size))


class _Reader:
    """One way through a file."""

    def __init__(self, path: Path, order: str, found: _Found) -> None:
        self._path, self._order, self._found = path, order, found
        self._expansion = Expansion(path)
        self._number = 0

    def tag(self, source: _Source) -> tuple[int, int, bytes | None]:
        """Kind and length of an element, and its data where they stand in the tag itself."""
        data = source.take(8)
        kind, size = struct.unpack(self._order + "II", data)
        if not kind >> 16:
            return kind, size, None
        kind, size = kind & 0xFFFF, kind >> 16
        if size > 4 or kind in (_MATRIX, _PACKED):
            raise ValueError("an element is longer than its tag")
        return kind, size, data[4 : 4 + size]

    def variable(self, source: _Source, size: int) -> None:
        """One that the file holds; ``size`` is without its tag."""
        self._number += 1
        self._expansion.bytes(f"variable {self._number}", size)
        self._add(_Left(self, source, size), None, 0)

    def _add(self, left: _Left, name: str | None, depth: int) -> None:
        """A variable without a name takes its own."""
        if not left.size:
            self._put(name or "", "is empty")
            return
        if depth > _DEEPEST:
            raise ValueError(f"it is nested more than {_DEEPEST} deep")
        (flags,) = struct.unpack(self._order + "I", left.element(8)[1][:4])
        kind = flags & 0xFF
        if kind > _LAST_NUMERIC:
            own = left.element(_LONGEST_NAMES)[1].decode("latin-1") if name is None else name
            self._put(own, "is a MATLAB object; save its contents as plain vectors")
            left.skip(left.size)
            return
        lengths = left.element(4 * _MOST_LENGTHS)[1]
        shape = struct.unpack(self._order + f"{len(lengths) // 4}i", lengths)
        if min(shape, default=0) < 0:
            raise ValueError("a variable has a length below 0")
        own = left.element(_LONGEST_NAMES)[1].decode("latin-1")
        name = own if name is None else name
        if kind in (_STRUCT, _OBJECT):
            self._add_fields(left, name, kind, math.prod(shape), depth)
        elif kind == _SPARSE:
            reason = "is stored as a sparse matrix or an object; save it as a plain vector"
            self._put(name, reason)
        elif kind in (_CELL, _CHAR):
            self._put(name, "holds text or cells, not numbers")
        elif flags & _COMPLEX:
            self._put(name, "holds complex numbers")
        else:
            self._put(name, unfit("f", shape) or self._numbers(left, name, math.prod(shape)))
        left.skip(left.size)

    def _numbers(self, left: _Left, name: str, number: int) -> FloatArray:
        self._expansion.numbers(f"variable '{name}'", number)
        kind, data = left.element(8 * number)
        if kind not in _TYPES:
            raise ValueError(f"variable '{name}' holds elements of kind {kind}")
        values = np.frombuffer(data, self._order + _TYPES[kind])
        if len(values) != number:
            raise ValueError(f"variable '{name}' has {len(values)} values in place of {number}")
        return values.astype(np.float64)

    def _add_fields(self, left: _Left, name: str, kind: int, number: int, depth: int) -> None:
        if kind == _OBJECT:
            left.element(_LONGEST_NAMES)  # the name of its class
        (longest,) = struct.unpack(self._order + "i", left.element(4)[1])
        names = left.element(_LONGEST_NAMES)[1]
        if number != 1:
            self._put(name, f"is an array of {number} structs, and only a single struct is read")
            return
        if longest < 1:
            raise ValueError(f"the names of struct '{name}' have no length")
        for k in range(0, len(names), longest):
            field = names[k : k + longest].split(b"\0")[0].decode("latin-1")
            inner, size, _ = left.tag()
            if inner != _MATRIX:
                raise ValueError(f"field '{field}' of '{name}' is no variable")
            left.claim(size)
            self._add(_Left(self, left.source, size), f"{name}.{field}", depth + 1)

    def _put(self, name: str, value: FloatArray | str) -> None:
        # Without a name, or with such a one, it is MATLAB's own.
        if not name or name.startswith("__"):
            return
        if name in self._found:
            raise InputError(
                f"{self._path}: the variable '{printable(name)}' stands there twice; rename one "
                "of them"
            )
        self._found[name] = value
