"""Work on several recordings side by side, on threads that Ctrl-C ends together."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor, wait
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Final, TypeVar

from .._native import CancelToken

__all__ = ["side_by_side", "thread_count", "with_workers"]

Item = TypeVar("Item")
Result = TypeVar("Result")

# Threads of a pool do not see it: what they do side by side themselves goes one by one.
_pool: Final[ContextVar[Executor | None]] = ContextVar("_pool", default=None)
_number: Final[ContextVar[int]] = ContextVar("_number", default=1)


@contextmanager
def with_workers(threads: int | None) -> Iterator[None]:
    """Until the end `side_by_side` has so many threads, as many as there are cores without one."""
    number = _cores() if threads is None else threads
    if number < 2:
        yield
        return
    with ThreadPoolExecutor(number) as pool:
        tokens = _pool.set(pool), _number.set(number)
        try:
            yield
        finally:
            _pool.reset(tokens[0])
            _number.reset(tokens[1])


def thread_count() -> int:
    """How many threads work side by side here."""
    return _number.get()


def side_by_side(
    work: Callable[[Item], Result], items: Sequence[Item]
) -> Generator[Result, None, None]:
    """Results of some work on each item, in their order, whatever the number of threads.

    Whatever ends it early, as Ctrl-C does, ends the work on the other threads as well: a simulation
    within a fraction of a second.
    """
    pool = _pool.get()
    if pool is None or len(items) < 2:
        yield from map(work, items)
        return
    token = CancelToken()
    running = [pool.submit(token.run, work, item) for item in items]
    try:
        for future in running:
            yield future.result()
    except BaseException:
        token.cancel()
        for future in running:
            future.cancel()
        wait(running)
        raise


def _cores() -> int:
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
