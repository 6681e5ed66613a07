"""How far a long call has come: what it does, and the how-manieth of how many.

The library prints nothing. It notes here what it is at, and whoever opened ``watch`` says so; where
nobody does, noting costs nothing.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterable, Iterator, Sized
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Final, TypeVar

__all__ = ["Progress", "duration", "phase", "steps", "watch"]

T = TypeVar("T")

TELLING: Final = 3.0
"""Seconds after which the pace of a loop tells how long it still takes."""


@dataclass
class _Loop:
    """A loop that is being gone through."""

    unit: str
    of: int | None
    began: float
    at: int = 0

    def words(self) -> str:
        return f"{self.unit} {self.at}" + ("" if self.of is None else f" of {self.of}")

    def seconds_to_go(self, now: float) -> float | None:
        """Seconds, where its pace tells them."""
        done, gone = self.at - 1, now - self.began
        if self.of is None or done < 1 or gone < TELLING:
            return None
        return gone / done * (self.of - done)


@dataclass
class Progress:
    """What a call is at, as of now.

    Attributes
    ----------
    phase : str
        What is being done.
    began : float
        On the clock of ``time.monotonic``.
    """

    phase: str = ""
    began: float = field(default_factory=time.monotonic)
    _loops: list[_Loop] = field(default_factory=list)
    _thread: int = field(default_factory=threading.get_ident)

    @property
    def own(self) -> bool:
        """Whether it is asked by the thread that it looks at: others work on parts of a step."""
        return threading.get_ident() == self._thread

    def words(self, now: float | None = None) -> str:
        """All of it on one line: time gone, phase, counts, and what is left where that is known."""
        now = time.monotonic() if now is None else now
        loops = list(self._loops)
        parts = [each for each in (self.phase, *(loop.words() for loop in loops)) if each]
        left = next((r for r in (loop.seconds_to_go(now) for loop in loops) if r is not None), None)
        if left is not None:
            parts.append(f"about {duration(left)} left of this")
        return f"{duration(now - self.began)}: {', '.join(parts) or 'at work'}"

    def track(self, items: Iterable[T], unit: str, of: int | None) -> Iterator[T]:
        """The items, while it is noted which one it is."""
        loop = _Loop(unit, of, time.monotonic())
        # The first is at work before it comes, where results are gone through.
        loop.at = 1
        self._loops.append(loop)
        try:
            for loop.at, item in enumerate(items, 1):
                yield item
        finally:
            # A loop that was left early ends when its iterator does, which may be later.
            if loop in self._loops:
                del self._loops[self._loops.index(loop) :]


_watching: Progress | None = None


@contextmanager
def watch() -> Iterator[Progress]:
    """What calls inside are at; of calls within one another the outer one looks."""
    global _watching
    if _watching is not None:
        yield _watching
        return
    _watching = Progress()
    try:
        yield _watching
    finally:
        _watching = None


def phase(logger: logging.Logger, words: str, *given: object) -> None:
    """Note and log what is being done from here on.

    Parameters
    ----------
    logger : Logger
    words : str
        Such as ``"fitting law %s"``.
    *given : object
        For the places in it.
    """
    if _watching is not None and _watching.own:
        _watching.phase = words % given if given else words
    logger.info(words, *given)


def steps(items: Iterable[T], unit: str, of: int | None = None) -> Iterable[T]:
    """The items themselves, in a loop whose steps are counted.

    Parameters
    ----------
    items : iterable
    unit : str
        What each is, such as ``"recording"``.
    of : int, optional
        How many they are, where they do not say it themselves.
    """
    if _watching is None or not _watching.own:
        return items
    if of is None and isinstance(items, Sized):
        of = len(items)
    return _watching.track(items, unit, of)


def duration(seconds: float) -> str:
    """A time as people say it."""
    whole = round(seconds)
    if whole < 120:
        return f"{whole} s"
    if whole < 7200:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
