"""What one experiment on one law yields, and what a property is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

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
        object.__setattr__(self, "holds", None if self.holds is None else bool(self.holds))
        plain = {name: float(value) for name, value in self.numbers.items()}
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
