"""A servo as simulators have it: stiffness, damping and what its motor can at a speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..plant.drive import servo_numbers

if TYPE_CHECKING:
    from ..plant import Plant

__all__ = ["PdServo"]


@dataclass(frozen=True)
class PdServo:
    """A goal, a voltage within the supply, and a motor that induces against it.

    Attributes
    ----------
    stiffness : float
        N·m/rad or N/m from the goal.
    damping : float
        N·m·s/rad or N·s/m, back-EMF with it.
    integral : float
        N·m/(rad·s) or N/(m·s).
    stall : float
        Greatest effort at rest without a limit of the current, N·m or N.
    no_load : float
        Speed at which the greatest voltage is induced, rad/s or m/s.
    most : float
        Effort at the limit of the current, N·m or N; that at rest where there is none.
    """

    stiffness: float
    damping: float
    integral: float
    stall: float
    no_load: float
    most: float

    @classmethod
    def of(cls, plant: Plant) -> PdServo | None:
        """Of a plant; None of other drives, and of a motor that is wired the other way round."""
        numbers, constant = servo_numbers(plant.drive), plant.gain
        if numbers is None or constant <= 0.0:
            return None
        supply, per_volt = numbers["supply"], constant / numbers["resistance"]
        voltage = supply * numbers.get("duty_limit", 1.0)
        stall = per_volt * voltage
        return cls(
            per_volt * supply * numbers["proportional"],
            per_volt * (constant + supply * numbers.get("derivative", 0.0)),
            per_volt * supply * numbers.get("integral", 0.0),
            stall,
            voltage / constant,
            min(stall, constant * numbers.get("current_limit", math.inf)),
        )
