"""One unit for the residuals of a report, so that nobody has to count zeros."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from .numbers import quantity

if TYPE_CHECKING:
    from ..diagnosis.findings.result import Diagnosis

__all__ = ["Scale", "effort_unit_of", "loop_scale_of", "prefix_for", "scale_for", "scale_of"]

_PREFIXES: Final = (
    (1e7, 1e-6, "M"),
    (1e4, 1e-3, "k"),
    (0.05, 1.0, ""),
    (5e-5, 1e3, "m"),
    (0.0, 1e6, "µ"),
)


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

    def on_axis(self, name: str) -> str:
        """What an axis says: a name, and the unit where there is one."""
        return name if self.unit in ("", "1") else f"{name} ({self.unit})"

    def text(self, value: float | None, figures: int = 3) -> str:
        """An SI value in this unit, with it."""
        return quantity(None if value is None else self.factor * value, self.unit, figures)


def scale_of(diagnosis: Diagnosis) -> Scale:
    """The unit that suits what the models leave: N·m or mN·m, N or mN, of a servo rad or mrad."""
    sizes = [
        size
        for model in (diagnosis.baseline, diagnosis.extended)
        if model is not None
        for size in (model.train_rms, model.heldout_rms or 0.0, model.noise_floor_rms)
    ]
    stiffness = None if diagnosis.baseline is None else diagnosis.baseline.stiffness
    if stiffness:
        position = scale_for([size / stiffness for size in sizes], diagnosis.plant.position_unit)
        return Scale(position.factor / stiffness, position.unit)
    return scale_for(sizes, effort_unit_of(diagnosis))


def effort_unit_of(diagnosis: Diagnosis) -> str:
    """The unit in which efforts were measured."""
    model = diagnosis.baseline
    return diagnosis.plant.effort_unit if model is None else model.unit


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
    return scale_for(sizes, diagnosis.plant.position_unit)


def scale_for(sizes: Iterable[float], unit: str) -> Scale:
    """The unit that writes the largest of these SI values without many zeros; "" for none."""
    if unit in ("", "1"):
        return Scale(1.0, "")
    factor, prefix = prefix_for(max((size for size in sizes if math.isfinite(size)), default=1.0))
    return Scale(factor, prefix + unit)


def prefix_for(largest: float, *, at_least: float = 0.0) -> tuple[float, str]:
    """Factor and prefix of the unit that suits values up to this one, taken as ``at_least``."""
    size = max(largest, at_least)
    return next((factor, prefix) for least, factor, prefix in _PREFIXES if size >= least)
