"""In which direction friction is higher, in levels of the machine."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from ...catalogue import EffectRecord
from ...fitting.result import FitParameter

__all__ = ["describe_effect"]

LEVELS: Final = {"coulomb": "dry friction", "viscous": "viscous friction"}
"""What the shares of an effect of two levels are shares of."""


def describe_effect(record: EffectRecord, parameters: Mapping[str, FitParameter]) -> str:
    """What an effect is, in words that hold no colon; of an asymmetry which way it goes.

    Parameters
    ----------
    record : EffectRecord
    parameters : Mapping of str to FitParameter
        Of the model that holds the effect, by whole path.
    """
    if not record.two_levels:
        return record.summary
    told = []
    for name, level in LEVELS.items():
        share = parameters.get(f"effects.{record.name}.{name}")
        if share is None or share.ci95[0] <= 0.0 <= share.ci95[1]:
            continue
        told.append(_compared(level, share.value, parameters.get(f"friction.{name}")))
    if not told:
        return record.summary
    return f"{' and '.join(told)}, forwards being where the position grows"


def _compared(level: str, share: float, mean: FitParameter | None) -> str:
    """A level in its two directions: 1 + share times its mean forwards, 1 - share backwards."""
    sizes = {"forwards": 1.0 + share, "backwards": 1.0 - share}
    more, less = sorted(sizes, key=lambda way: -sizes[way])
    if mean is None:
        return f"{level} is {200.0 * abs(share):.2g} % of its mean higher {more} than {less}"
    high, low = (f"{mean.value * sizes[way]:.3g}" for way in (more, less))
    unit = "" if mean.unit == "1" else f" {mean.unit}"
    return f"{level} is higher {more} ({high}{unit}) than {less} ({low}{unit})"
