"""What one experiment on one law yields, and what a property is."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from .._support import given
from .._support.given import number
from .subject import Subject

__all__ = ["Measured", "Property"]


@dataclass(frozen=True)
class Measured:
    """One experiment on one subject.

    Attributes
    ----------
    holds : bool or None
        Whether the property is there; None where the question makes no sense for this law.
    numbers : Mapping of str to float
        What was measured; each name ends with its unit or says that it is a share.
    why : str
        Why the question makes no sense, or what kind of no it is; may be empty.
    """

    holds: bool | None
    numbers: Mapping[str, float] = field(default_factory=dict)
    why: str = ""

    def __post_init__(self) -> None:
        # What comes out of numpy is no number for JSON.
        if self.holds is not None:
            given.instance(self.holds, bool | np.bool_, "Measured: holds", "True, False or None")
            object.__setattr__(self, "holds", bool(self.holds))
        held = given.mapping(self.numbers, "Measured: numbers", "numbers by name")
        # A share of nothing is no number, and says so.
        plain = {
            name: math.nan
            if isinstance(value, float) and math.isnan(value)
            else number(value, f"Measured: {name}")
            for name, value in held.items()
        }
        object.__setattr__(self, "numbers", plain)


@dataclass(frozen=True)
class Property:
    """A column of the table.

    Attributes
    ----------
    name : str
        As in the JSON.
    title : str
        As in the table.
    question : str
        What is asked.
    criterion : str
        What counts as yes, and why.
    measure : callable
        From a subject to what was measured.
    drawn_over : bool
        Whether parameters are drawn at random besides the cases of the law.
    """

    name: str
    title: str
    question: str
    criterion: str
    measure: Callable[[Subject], Measured]
    drawn_over: bool = False
