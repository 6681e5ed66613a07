"""What a simulation is compared by, in words: efforts, or of a servo the motion of its loop."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from ..plant import Plant

__all__ = ["EFFORT", "Compared", "comparison_of"]

MOST_PERCENT: Final = 10.0
"""Shares beyond this are told as a multiple: nobody reads 1234.56 %."""


@dataclass(frozen=True)
class Compared:
    """Names of what is measured and of what a simulation misses of it.

    Attributes
    ----------
    quantity : str
        Of which the residual is a part.
    error : str
        What the residual is called.
    whole : str
        What it is a share of.
    loop : bool
        Whether it is that of a servo, whose effort nobody measures.
    """

    quantity: str
    error: str
    whole: str
    loop: bool

    def share(self, relative: float, decimals: int = 2) -> str:
        """A residual over what it is a part of, in words."""
        if math.isinf(relative):
            return f"all there is: {self.whole} is 0"
        if relative > MOST_PERCENT:
            return f"{relative:.3g} times {self.whole}"
        return f"{100.0 * relative:.{decimals}f} % of {self.whole}"


EFFORT: Final = Compared("effort", "effort error", "the effort", loop=False)
POSITION: Final = Compared(
    "position", "position error of the simulated loop", "the motion", loop=True
)


def comparison_of(plant: Plant) -> Compared:
    """What this plant is compared with a machine by."""
    return POSITION if plant.servo else EFFORT
