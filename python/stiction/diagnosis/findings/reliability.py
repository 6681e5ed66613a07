"""How often names that were told in the same way were right, where the truth was known."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

from ..._support.wording import plural

__all__ = ["COUNTS", "Reliability", "manner", "reliability_of"]

COUNTS: Final = Path(__file__).with_name("reliability.toml")
"""Written by ``python -m tests.blind.reliability``, never by hand."""
_JEFFREYS: Final = 0.5
"""Of right and of wrong ones that are counted beforehand (Jeffreys' prior of a share)."""


@dataclass(frozen=True)
class Reliability:
    """What names told in one manner came to in sessions whose truth was known.

    Attributes
    ----------
    told : int
        Names that were told like that.
    first : int
        Of these, those that were right.
    listed : int
        Those that were right or had the right one among their look-alikes.
    """

    told: int
    first: int
    listed: int

    @property
    def probability(self) -> float:
        """That a name told like that is right."""
        return (self.first + _JEFFREYS) / (self.told + 1.0)

    @property
    def coverage(self) -> float:
        """That it or one of its look-alikes is."""
        return (self.listed + _JEFFREYS) / (self.told + 1.0)

    def words(self, *, several: bool) -> str:
        """That in words, of a name with look-alikes or of one without."""
        known = f"of {plural(self.told, 'time')} where the truth was known"
        if several:
            return (
                f"of names told like these one was right {self.listed} {known}, the first one "
                f"{self.first}"
            )
        return f"names told like this one were right {self.first} {known}"

    def to_dict(self) -> dict[str, Any]:
        """As ``reliability`` of an entry of ``effects``."""
        return {"told": self.told, "first": self.first, "listed": self.listed}


def manner(*, decided: bool, several: bool, unexplained: bool) -> str:
    """How a name is told.

    Parameters
    ----------
    decided : bool
    several : bool
        Whether it has look-alikes.
    unexplained : bool
        Whether the verdict is that something is left that has no name.
    """
    own = "sure" if decided else "several" if several else "perhaps"
    return f"{own}_unexplained" if unexplained else own


def reliability_of(*, decided: bool, several: bool, unexplained: bool) -> Reliability:
    """The same for names told like that; parameters as of ``manner``."""
    return _counts()[manner(decided=decided, several=several, unexplained=unexplained)]


@cache
def _counts() -> dict[str, Reliability]:
    told = tomllib.loads(COUNTS.read_text(encoding="utf-8"))["manner"]
    return {name: Reliability(**own) for name, own in told.items()}
