"""Ctrl-C where an answer is still made of what there is: said to be heard at once."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Final

__all__ = ["answer_on_interrupt", "defer_interrupt"]

HEARD: Final = "interrupted: what there is by now is still written; once more ends it at once"


@contextmanager
def answer_on_interrupt() -> Iterator[None]:
    """What is in here makes an answer of what it has when Ctrl-C is pressed, and that is told."""
    if not _usual():
        yield
        return

    def told(number: int, frame: FrameType | None) -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        _say()
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, told)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def defer_interrupt(*, struck: bool = False) -> Iterator[None]:
    """What is in here is finished before Ctrl-C takes effect; a second one ends at once.

    Parameters
    ----------
    struck : bool
        Whether it was pressed before.

    Raises
    ------
    KeyboardInterrupt
        At the end, where it was pressed.
    """
    if not _usual():
        yield
        return

    def noted(number: int, frame: FrameType | None) -> None:
        nonlocal struck
        if struck:
            raise KeyboardInterrupt
        struck = True
        _say()

    signal.signal(signal.SIGINT, noted)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if struck:
        raise KeyboardInterrupt


def _usual() -> bool:
    """Whether Ctrl-C is ours to hear, and does here what it does anywhere."""
    main = threading.current_thread() is threading.main_thread()
    return main and signal.getsignal(signal.SIGINT) is signal.default_int_handler


def _say() -> None:
    # Past the stream, which may be at work just now.
    with suppress(OSError, ValueError):
        line = "\n" if sys.stderr.isatty() else ""
        os.write(sys.stderr.fileno(), f"{line}{HEARD}\n".encode())
