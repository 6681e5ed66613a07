"""What an answer can do without: a figure, a section of a page.

A fault in one is a sentence in its place and in the log; the numbers, the other figures and the
rest of the page stand.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from ..errors import InputError

__all__ = ["Failure", "attempt"]

T = TypeVar("T")

_logger = logging.getLogger("stiction.best_effort")


@dataclass(frozen=True)
class Failure:
    """Something that could not be made.

    Attributes
    ----------
    sentence : str
        What, why, and what that means for the rest.
    """

    sentence: str

    def __str__(self) -> str:
        return self.sentence


def attempt(what: str, make: Callable[[], T]) -> T | Failure:
    """What ``make`` returns; where it raises, a sentence, which is logged as a warning too.

    Parameters
    ----------
    what : str
        Subject of the sentence, such as ``"the figure before-after"``.
    make : callable
        Writes no files: a full disk is no fault of a figure.

    Returns
    -------
    object or Failure
    """
    try:
        return make()
    except Exception as error:
        why = " ".join(str(error).split())
        if not isinstance(error, InputError):
            why = f"{type(error).__name__}: {why}" if why else type(error).__name__
        failure = Failure(
            f"{what[:1].upper()}{what[1:]} could not be made ({why}); no number depends on it, and "
            "all else is here."
        )
        _logger.warning("%s", failure)
        _logger.debug("%s", what, exc_info=True)
        return failure
