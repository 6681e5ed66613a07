"""Products of matrices on one thread, for as long as a fit or a diagnosis runs."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

__all__ = ["on_one_thread"]

Given = ParamSpec("Given")
Result = TypeVar("Result")


def on_one_thread(work: Callable[Given, Result]) -> Callable[Given, Result]:
    """A function during which matrices are multiplied on one thread.

    A fit multiplies thousands of matrices of a few columns. Over threads each product waits longer
    for them than it takes by itself, most of all where others use the processor; and sums that are
    divided otherwise round otherwise, so that results would depend on how many cores a machine has.

    The limit is one of the process. Where several threads fit at the same time the first of them
    holds it, and the others go on without it once that has ended.
    """

    @wraps(work)
    def limited(*args: Given.args, **kwargs: Given.kwargs) -> Result:
        with threadpool_limits(limits=1, user_api="blas"):
            return work(*args, **kwargs)

    return limited
