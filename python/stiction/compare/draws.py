"""Parameters drawn about the defaults of a law."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from ..catalogue import LawRecord, ParameterRecord
from ..errors import InputError
from .defaults import DRAWS
from .subject import Subject

__all__ = ["draws"]

_DECADES, _SHAPE_DECADES = 1.0, 0.3
"""How far a value is drawn from its default; pure numbers, often exponents, less far."""
_TRIES: Final = 50


def draws(record: LawRecord, count: int = DRAWS) -> Iterator[Subject]:
    """Sets of parameters and options that a law accepts, the same ones each time."""
    rng = np.random.default_rng(6)
    for index in range(count):
        for _ in range(_TRIES):
            values: dict[str, float | str] = {}
            for parameter in record.parameters:
                value = _drawn(rng, parameter)
                if value is not None:
                    values[parameter.name] = value
            for option in record.options:
                values[option.name] = option.choices[int(rng.integers(len(option.choices)))][0]
            subject = Subject(record.name, f"draw {index + 1}", values)
            try:
                usable = subject.scale.level > 0.0
            except InputError:
                continue
            if usable:
                yield subject
                break


def _drawn(rng: np.random.Generator, parameter: ParameterRecord) -> float | None:
    """A value about the default; None leaves it at its default."""
    far = _SHAPE_DECADES if parameter.unit == "1" else _DECADES
    factor, spared = 10.0 ** rng.uniform(-far, far), rng.uniform() < 0.5
    value = parameter.default
    if value == 0.0 or not math.isfinite(value):
        # A term that is off: half of the draws switch it on.
        if spared:
            return None
        value = parameter.typical
    low, high = parameter.bounds
    return float(np.clip(value * factor, low, high))
