"""Ctrl-C while something is written."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ["finished"]


@contextmanager
def finished() -> Iterator[None]:
    """What is in here is finished before Ctrl-C takes effect; a second one ends at once.

    Raises
    ------
    KeyboardInterrupt
        At the end, where it was pressed.
    """
    usual = signal.default_int_handler
    main = threading.current_thread() is threading.main_thread()
    if not main or signal.getsignal(signal.SIGINT) is not usual:
        yield
        return
    struck = False

    def noted(number: int, frame: FrameType | None) -> None:
        nonlocal struck
        if struck:
            raise KeyboardInterrupt
        struck = True

    signal.signal(signal.SIGINT, noted)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
    if struck:
        raise KeyboardInterrupt
