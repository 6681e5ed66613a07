"""What a MAT file of version 5 would take, found before SciPy reads it.

Its variables are packed, and each says itself how long it is: a kilobyte may unpack to gigabytes,
or ask for an array of any size.  Here the elements are walked through without keeping them.
"""

from __future__ import annotations

import math
import struct
import zlib
from pathlib import Path
from typing import IO, Final, Protocol

from ..errors import InputError
from .expansion import Expansion

_HEADER: Final = 128
_MATRIX, _PACKED = 14, 15
_CELL, _STRUCT, _OBJECT, _CHAR, _SPARSE = 1, 2, 3, 4, 5
_LAST_NUMERIC: Final = 15
_DEEPEST: Final = 64
"""Structs within structs; SciPy goes down by calls, and has no bound of its own."""
_PIECE: Final = 2**16


class _Source(Protocol):
    def take(self, size: int) -> bytes: ...
    def skip(self, size: int) -> None: ...


class _Bare:
    """Elements as they stand in the file."""

    def __init__(self, file: IO[bytes], end: int) -> None:
        self._file, self._end = file, end

    def take(self, size: int) -> bytes:
        data = self._file.read(size)
        if len(data) < size:
            raise EOFError("it ends within a variable")
        return data

    def skip(self, size: int) -> None:
        if self._file.tell() + size > self._end:
            raise EOFError("it ends within a variable")
        self._file.seek(size, 1)


class _Unpacked:
    """Elements of a packed variable, never more than a piece of them at a time."""

    def __init__(self, file: IO[bytes], size: int) -> None:
        self._file, self._left = file, size
        self._zlib = zlib.decompressobj()
        self._data = b""

    def take(self, size: int) -> bytes:
        while len(self._data) < size:
            self._data += self._more()
        taken, self._data = self._data[:size], self._data[size:]
        return taken

    def skip(self, size: int) -> None:
        while len(self._data) < size:
            size -= len(self._data)
            self._data = self._more()
        self._data = self._data[size:]

    def _more(self) -> bytes:
        packed = self._zlib.unconsumed_tail
        if not packed:
            packed = self._file.read(min(_PIECE, self._left))
            self._left -= len(packed)
        data = self._zlib.decompress(packed, _PIECE)
        if not data and not packed:
            raise EOFError("it ends within a variable")
        return data


class _Walk:
    """One way through a file."""

    def __init__(self, path: Path, order: str) -> None:
        self.order = order
        self._path = path
        self._expansion = Expansion(path)
        self._names: set[str] = set()

    def tag(self, source: _Source) -> tuple[int, int, bytes | None]:
        """Kind and length of an element, and its data where they stand in the tag itself."""
        data = source.take(8)
        kind, size = struct.unpack(self.order + "II", data)
        if kind >> 16:
            small = kind >> 16
            if small > 4:
                raise ValueError("an element of its own length is too long")
            return kind & 0xFFFF, small, data[4 : 4 + small]
        return kind, size, None

    def variable(self, source: _Source, size: int) -> None:
        """One that the file holds; ``size`` is without its tag."""
        self._expansion.bytes(f"variable {len(self._names) + 1}", size)
        self._matrix(source, size, "", 0)

    def _matrix(self, source: _Source, size: int, name: str, depth: int) -> None:
        if depth > _DEEPEST:
            raise ValueError(f"variable '{name}' is nested more than {_DEEPEST} deep")
        if size == 0:
            return
        left = _Left(self, source, size)
        flags = struct.unpack(self.order + "I", left.element(8)[:4])[0] & 0xFF
        if flags > _LAST_NUMERIC:
            # Functions and objects; SciPy reads what is within as it reads variables.
            self._within(left, name, depth)
            return
        lengths = left.element(4 * 64)
        shape = struct.unpack(self.order + f"{len(lengths) // 4}i", lengths)
        if min(shape, default=0) < 0:
            raise ValueError("a dimension is below 0")
        own = left.element(_PIECE)
        if not depth:
            name = own.decode("latin-1")
            if name in self._names:
                raise InputError(
                    f"{self._path}: the variable '{name}' stands there twice; rename one of them"
                )
            self._names.add(name)
        number = 0 if flags == _SPARSE else math.prod(shape)
        if flags in (_STRUCT, _OBJECT):
            if flags == _OBJECT:
                left.element(_PIECE)
            (longest,) = struct.unpack(self.order + "i", left.element(4))
            fields = len(left.element(2**20)) // max(longest, 1)
            number *= max(fields, 1)
        self._expansion.numbers(f"variable '{name}'", number)
        self._within(left, name, depth)

    def _within(self, left: _Left, name: str, depth: int) -> None:
        while left.size > 0:
            kind, size, data = left.tag()
            if data is not None:
                continue
            if kind == _PACKED:
                raise ValueError("a packed element stands within another")
            if kind == _MATRIX:
                left.claim(size)
                self._matrix(left.source, size, name, depth + 1)
            else:
                left.skip(size)


class _Left:
    """What is left of an element, of which those within it may take no more."""

    def __init__(self, walk: _Walk, source: _Source, size: int) -> None:
        self.source, self.size, self._walk = source, size, walk

    def claim(self, size: int) -> None:
        if size > self.size:
            raise ValueError("an element is longer than the one it stands in")
        self.size -= size

    def tag(self) -> tuple[int, int, bytes | None]:
        self.claim(8)
        return self._walk.tag(self.source)

    def skip(self, size: int) -> None:
        # Up to whole words, save at the end of what some writers leave ragged.
        padded = min(size + -size % 8, max(self.size, size))
        self.claim(padded)
        self.source.skip(padded)

    def element(self, longest: int) -> bytes:
        """The data of a short element."""
        _, size, data = self.tag()
        if data is not None:
            return data
        if size > longest:
            raise ValueError("an element is longer than it can be")
        padded = min(size + -size % 8, max(self.size, size))
        self.claim(padded)
        return self.source.take(padded)[:size]


def walk(path: Path, file: IO[bytes]) -> None:
    """Go through every variable.

    Parameters
    ----------
    path : Path
        For the sentence.
    file : binary file
        Of version 5.

    Raises
    ------
    InputError
        It takes more memory than it may.
    ValueError, EOFError, struct.error, zlib.error
        It is damaged.
    """
    end = file.seek(0, 2)
    file.seek(0)
    head = file.read(_HEADER)
    through = _Walk(path, ">" if head.endswith(b"MI") else "<")
    while file.tell() + 8 <= end:
        bare = _Bare(file, end)
        kind, size, data = through.tag(bare)
        begin = file.tell()
        if data is not None or begin + size > end:
            raise EOFError("it ends within a variable")
        if kind == _PACKED:
            unpacked = _Unpacked(file, size)
            inner, length, data = through.tag(unpacked)
            if inner == _MATRIX and data is None:
                through.variable(unpacked, length)
        elif kind == _MATRIX:
            through.variable(bare, size)
        file.seek(begin + size)
