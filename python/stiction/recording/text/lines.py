"""Text files in blocks of whole lines, so that a long file does not have to fit in memory."""

from __future__ import annotations

import codecs
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from ...errors import InputError

BLOCK: Final = 2**22
"""Bytes of a block: large beside the cost of starting on one, small beside the memory at hand."""

LONGEST_LINE: Final = 2**20
"""Bytes of a line.  No instrument writes longer ones, and splitting one takes fifty times as
much."""

_AS_TEXT: Final = 2**20
_BYTE_ORDER_MARKS_16: Final = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}
_ASCII: Final = bytes(range(128))
_OF_TEXT: Final = bytes(b for b in range(256) if b >= 32 or b in b"\0\t\n\f\v\r\x1a")
_MOST_FOREIGN: Final = 0.3
"""Bytes of Latin-1 beyond ASCII that a text of numbers has, as a share."""
_BYTE_ORDER_MARK_8: Final = b"\xef\xbb\xbf"

IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Block:
    """Whole lines of a text file.

    Attributes
    ----------
    first : int
        1-based number of its first line.
    data : bytes
        UTF-8 without zero bytes; every line ends in ``"\\n"``, save the last one of the file.
    """

    first: int
    data: bytes

    def after(self, line: int) -> Block | None:
        """What stands below a line of the file, None where that is nothing."""
        data, ahead = self.data, line + 1 - self.first
        if ahead <= 0:
            return self
        begin = 0
        for _ in range(ahead):
            begin = data.find(b"\n", begin) + 1
            if not begin:
                return None
        return Block(line + 1, data[begin:]) if begin < len(data) else None

    def without_empty(self) -> tuple[bytes, range | IntArray]:
        """The lines that are not empty, and their numbers."""
        data = self.data if self.data.endswith(b"\n") else self.data + b"\n"
        if not data.startswith(b"\n") and b"\n\n" not in data:
            return data, range(self.first, self.first + data.count(b"\n"))
        ends = np.flatnonzero(np.frombuffer(data, np.uint8) == ord("\n"))
        lengths = np.diff(ends, prepend=-1) - 1
        while b"\n\n" in data:
            data = data.replace(b"\n\n", b"\n")
        return data.removeprefix(b"\n"), self.first + np.flatnonzero(lengths)

    def lines(self) -> Iterator[tuple[int, str]]:
        """Every line with its number, without its end."""
        number, begin = self.first, 0
        while begin < len(self.data):
            # As text a line takes twenty times as much where it is short.
            end = self.data.find(b"\n", begin + _AS_TEXT) + 1 or len(self.data)
            for line in self.data[begin:end].removesuffix(b"\n").decode().split("\n"):
                yield number, line
                number += 1
            begin = end


def blocks(path: Path) -> Iterator[Block]:
    """A text file as it is at the first step, in blocks of whole lines.

    UTF-8; UTF-16 where a mark at the beginning says so; a block that is neither is read as Latin-1,
    in the way of Windows: in its place are names and units at most, for digits are the same.

    Raises
    ------
    InputError
        Where the file holds a zero byte, a line beyond ``LONGEST_LINE``, or half of a character of
        UTF-16.
    """
    with path.open("rb") as file:
        left = os.fstat(file.fileno()).st_size  # what a logger adds while this reads is left
        first, rest = 1, b""
        decoded: Callable[[bytes, bool], bytes] | None = None
        while left > 0 and (piece := file.read(min(BLOCK, left))):
            left -= len(piece)
            if decoded is None:
                piece, decoded = _without_mark(path, piece)
            data = rest + decoded(piece, not left)
            end = _end_of_lines(data) if left else len(data)
            data, rest = data[:end], data[end:]
            if len(rest) > LONGEST_LINE:
                _refuse_long(path, first + _plain_ends(data).count(b"\n"))
            if data:
                block = Block(first, _in_utf_8(path, first, _plain_ends(data)))
                _check(path, block)
                yield block
                first += block.data.count(b"\n")
        if rest:  # the file was cut while it was read
            yield Block(first, _in_utf_8(path, first, _plain_ends(rest)))


def check_length(path: Path, number: int, line: str) -> None:
    """Refuse a line that is too long to be split.

    Raises
    ------
    InputError
        Where it is beyond ``LONGEST_LINE``.
    """
    if len(line) > LONGEST_LINE:
        _refuse_long(path, number)


def _refuse_long(path: Path, number: int) -> None:
    raise InputError(
        f"{path}: line {number} is longer than {LONGEST_LINE // 2**20} MiB, and no row of a "
        "recording is; write one row a line, or correct the file's ending"
    )


def _without_mark(path: Path, piece: bytes) -> tuple[bytes, Callable[[bytes, bool], bytes]]:
    """The first bytes without their mark, and what makes UTF-8 of all that follow."""
    encoding = _BYTE_ORDER_MARKS_16.get(piece[:2])
    if encoding is None:
        return piece.removeprefix(_BYTE_ORDER_MARK_8), lambda data, last: data
    decoder = codecs.getincrementaldecoder(encoding)()

    def decoded(data: bytes, last: bool) -> bytes:
        try:
            return decoder.decode(data, last).encode()
        except UnicodeError as error:
            raise InputError(
                f"{path}: the text begins as UTF-16 and is none further on; save it as UTF-8"
            ) from error

    return piece[2:], decoded


def _in_utf_8(path: Path, first: int, data: bytes) -> bytes:
    """Whole lines in UTF-8, of which the first has this number."""
    if data.isascii():
        return data
    try:
        data.decode()
        return data
    except UnicodeDecodeError as error:
        foreign = len(data.translate(None, _ASCII))
        if foreign > _MOST_FOREIGN * len(data) or data.translate(None, _OF_TEXT):
            line = first + data.count(b"\n", 0, error.start)
            raise InputError(
                f"{path}: line {line} holds the byte 0x{data[error.start]:02X}, which is not "
                "UTF-8, and too much here is no text at all; export the recording as CSV text, or "
                "correct the file's ending"
            ) from error
    try:
        return data.decode("cp1252").encode()
    except UnicodeDecodeError:
        return data.decode("latin-1").encode()


def _end_of_lines(data: bytes) -> int:
    """Where the last whole line ends; a last ``"\\r"`` may be half of a line's end."""
    return max(data.rfind(b"\n"), data.rfind(b"\r", 0, len(data) - 1)) + 1


def _plain_ends(data: bytes) -> bytes:
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in data else data


def _check(path: Path, block: Block) -> None:
    data = block.data
    if b"\0" in data:
        line = block.first + data.count(b"\n", 0, data.index(b"\0"))
        raise InputError(
            f"{path}: line {line} holds a zero byte, so this is not a text file; "
            "export the recording as CSV text, or correct the file's ending"
        )


class LineNumbers:
    """1-based line number of each row: runs of lines that follow each other, as most do."""

    def __init__(self) -> None:
        self._runs: list[IntArray] = []  # each run's first row and its line
        self._length = 0
        self._next = 0

    def add(self, lines: range | IntArray) -> None:
        """Append the line numbers of the rows that come next, increasing."""
        if not len(lines):
            return
        starts = np.zeros(1, dtype=np.int64)
        if not isinstance(lines, range):
            starts = np.append(starts, np.flatnonzero(np.diff(lines) != 1) + 1)
        if self._length and lines[0] == self._next:
            starts = starts[1:]
        at = np.asarray(lines)[starts] if len(starts) else starts
        self._runs.append(np.stack([starts + self._length, at]))
        self._next = int(lines[-1]) + 1
        self._length += len(lines)

    def __len__(self) -> int:
        return self._length

    def __getitem__(self, row: int) -> int:
        if len(self._runs) > 1:
            self._runs = [np.concatenate(self._runs, axis=1)]
        rows, lines = self._runs[0]
        run = int(np.searchsorted(rows, row, side="right")) - 1
        return int(lines[run] + row - rows[run])
