"""One unit for the residuals of a report, so that nobody has to count zeros."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from .numbers import quantity

if TYPE_CHECKING:
    from ..diagnosis.result import Diagnosis

__all__ = ["Scale", "loop_scale_of", "scale_of", "suited"]

_PREFIXES: Final = ((0.05, 1.0, ""), (5e-5, 1e3, "m"), (0.0, 1e6, "µ"))


@dataclass(frozen=True)
class Scale:
    """A unit and how many of it make the SI unit.

    Attributes
    ----------
    factor : float
        What an SI value is multiplied with.
    unit : str
    """

    factor: float
    unit: str

    def text(self, value: float | None, figures: int = 3) -> str:
        """An SI value in this unit, with it."""
        return quantity(None if value is None else self.factor * value, self.unit, figures)


def scale_of(diagnosis: Diagnosis) -> Scale:
    """The unit that suits what the models leave: N·m or mN·m, N or mN."""
    unit = diagnosis.plant.effort_unit
    sizes = [
        size
        for model in (diagnosis.baseline, diagnosis.extended)
        if model is not None
        for size in (model.train_rms, model.heldout_rms or 0.0, model.noise_floor_rms)
    ]
    return suited(sizes, unit)


def loop_scale_of(diagnosis: Diagnosis) -> Scale:
    """The unit that suits the position errors in closed loop: mrad or µrad, mm or µm."""
    replays = [m.replay for m in (diagnosis.baseline, diagnosis.extended) if m is not None]
    sizes = [
        size
        for each in replays
        if each is not None
        for size in (each.train_rms, each.heldout_rms)
        if size is not None
    ]
    return suited(sizes, diagnosis.plant.position_unit)


def suited(sizes: Iterable[float], unit: str) -> Scale:
    """The unit that writes the largest of these SI values without many zeros."""
    largest = max((size for size in sizes if math.isfinite(size)), default=1.0)
    for least, factor, prefix in _PREFIXES:
        if largest >= least:
            return Scale(factor, prefix + unit)
    return Scale(1.0, unit)
