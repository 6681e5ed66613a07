"""What a command is at, on stderr: one line in a terminal, now and then one elsewhere."""

from __future__ import annotations

import logging
import shutil
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Final, TextIO

from .._support.progress import Progress, watch

__all__ = ["progress"]

OFTEN: Final = 0.25
"""Seconds between two looks of a terminal."""
SELDOM: Final = 5.0
"""Seconds between two lines in a pipe or a log; a quick run writes none."""


@contextmanager
def progress(quiet: bool = False) -> Iterator[None]:
    """Shows on stderr what is being done in here.

    A terminal has one line that is written again and again, and is empty at the end. Elsewhere a
    line comes every few seconds.

    Parameters
    ----------
    quiet : bool
        Show nothing.
    """
    if quiet:
        yield
        return
    with watch() as state:
        shown = _Line(sys.stderr) if sys.stderr.isatty() else _Log(sys.stderr)
        ended = threading.Event()
        reporter = threading.Thread(target=_report, args=(state, shown, ended), daemon=True)
        reporter.start()
        try:
            with shown.beside_the_log():
                yield
        finally:
            ended.set()
            # Whoever reads stderr may have stopped reading: nothing waits for that.
            reporter.join(OFTEN)
            shown.end()


def _report(state: Progress, shown: _Log, ended: threading.Event) -> None:
    # Whoever closed stderr does not want to know.
    with suppress(OSError, ValueError):
        while not ended.wait(shown.pause):
            shown.show(state.words())


class _Log:
    """Lines, one now and then."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    @property
    def pause(self) -> float:
        """Seconds between two."""
        return SELDOM

    def show(self, words: str) -> None:
        self._stream.write(f"{words}\n")
        self._stream.flush()

    def end(self) -> None:
        """Nothing is left to be cleared away."""

    @contextmanager
    def beside_the_log(self) -> Iterator[None]:
        """What is logged in here has lines of its own."""
        yield


class _Line(_Log):
    """One line of a terminal."""

    def __init__(self, stream: TextIO) -> None:
        super().__init__(stream)
        self._length = 0
        self._lock = threading.Lock()

    @property
    def pause(self) -> float:
        return OFTEN

    def show(self, words: str) -> None:
        # In the last column a terminal would begin another line.
        fits = words[: max(shutil.get_terminal_size().columns - 1, 1)]
        with self._lock:
            self._stream.write(f"\r{fits:<{self._length}}")
            self._stream.flush()
            self._length = len(fits)

    def end(self) -> None:
        with self._lock, suppress(OSError, ValueError):
            if self._length:
                self._stream.write(f"\r{'':<{self._length}}\r")
                self._stream.flush()
                self._length = 0

    @contextmanager
    def beside_the_log(self) -> Iterator[None]:
        def cleared(_: logging.LogRecord) -> bool:
            self.end()
            return True

        handlers = logging.getLogger().handlers
        for each in handlers:
            each.addFilter(cleared)
        try:
            yield
        finally:
            for each in handlers:
                each.removeFilter(cleared)
