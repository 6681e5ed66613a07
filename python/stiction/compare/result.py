"""The table, and what stands behind each of its cells."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from .._support.wording import commas, did_you_mean, plural
from ..errors import UnknownName
from .measured import Measured, Property

__all__ = ["CONDITIONAL", "NO", "UNDEFINED", "YES", "Cell", "Comparison", "Row", "verdict_of"]

YES: Final = "yes"
NO: Final = "no"
CONDITIONAL: Final = "conditional"
UNDEFINED: Final = "not defined for this law"


@dataclass(frozen=True)
class Cell:
    """A property of a law.

    Attributes
    ----------
    verdict : str
        "yes", "no", "conditional" or "not defined for this law".
    note : str
        Where a conditional property holds, or what kind of no it is; may be empty.
    cases : Mapping of str to Measured
        What was measured in each case of the law.
    """

    verdict: str
    note: str
    cases: Mapping[str, Measured]


@dataclass(frozen=True)
class Row:
    """A law.

    Attributes
    ----------
    law : str
    level, span : float
        Force of slow sliding and pre-sliding distance at the defaults, found by experiment; SI.
    slides : bool
        Whether it slides at its defaults.
    cells : Mapping of str to Cell
        By name of the property.
    cost_ns, cost : float
        Nanoseconds a step, and that over the cost of ``coulomb`` in the same run.
    """

    law: str
    level: float
    span: float
    slides: bool
    cells: Mapping[str, Cell]
    cost_ns: float
    cost: float


@dataclass(frozen=True, repr=False)
class Comparison:
    """Laws compared by experiment.

    Attributes
    ----------
    properties : tuple of Property
        The columns but for the cost.
    rows : tuple of Row
    steps, draws : int
        Random steps of each case and each draw in the test of passivity, and draws of parameters.
    """

    properties: tuple[Property, ...]
    rows: tuple[Row, ...]
    steps: int
    draws: int

    def __getitem__(self, law: str) -> Row:
        """The row of a law.

        Raises
        ------
        UnknownName
            An ``InputError`` and a ``KeyError``: it was not compared.
        """
        for row in self.rows:
            if row.law == law:
                return row
        compared = [row.law for row in self.rows]
        near = did_you_mean(str(law), compared)
        raise UnknownName(f"law {law!r} was not compared{near}; there are {commas(compared)}")

    @property
    def success(self) -> bool:
        """Whether all that was found and timed of each law is a finite number."""
        return not self._without_numbers()

    @property
    def message(self) -> str:
        """What happened, in words."""
        laws = plural(len(self.rows), "law")
        done = f"{laws} compared by {plural(len(self.properties), 'property', 'properties')}"
        lost = self._without_numbers()
        return f"{done}; no finite number came out for {commas(lost)}" if lost else done

    def _without_numbers(self) -> list[str]:
        return [
            row.law
            for row in self.rows
            if not all(map(math.isfinite, (row.level, row.span, row.cost_ns, row.cost)))
        ]

    def to_dict(self) -> dict[str, Any]:
        """Everything that was measured, as plain dicts and lists."""
        return {
            "properties": [
                {"name": p.name, "title": p.title, "question": p.question,
                 "criterion": p.criterion}
                for p in self.properties
            ],
            "passivity": {"random_steps": self.steps, "draws": self.draws},
            "laws": [
                {
                    "law": row.law,
                    "level": row.level,
                    "span": row.span,
                    "slides": row.slides,
                    "cost_ns": row.cost_ns,
                    "cost_relative_to_coulomb": row.cost,
                    "properties": {
                        name: {
                            "verdict": cell.verdict,
                            "note": cell.note,
                            "cases": {
                                label: {"holds": m.holds, "why": m.why, "numbers": dict(m.numbers)}
                                for label, m in cell.cases.items()
                            },
                        }
                        for name, cell in row.cells.items()
                    },
                }
                for row in self.rows
            ],
        }  # fmt: skip

    def __repr__(self) -> str:
        from .text import as_text

        return as_text(self)

    def _repr_html_(self) -> str:
        from .page import table

        return table(self)


def verdict_of(cases: Mapping[str, Measured]) -> tuple[str, str]:
    """The verdict on a property from what its cases showed, and a note.

    All cases yes: yes. Some: conditional, and the note names them. None of those that it is
    defined for: no.
    """
    asked = {label: m for label, m in cases.items() if m.holds is not None}
    if not asked:
        return UNDEFINED, _common(cases)
    holding = [label for label, m in asked.items() if m.holds]
    if len(holding) == len(cases):
        return YES, ""
    if not holding:
        return NO, _common(asked)
    drawn = [label for label in cases if label.startswith("draw ")]
    kept = [label for label in holding if label not in drawn]
    named = [label for label in cases if label not in drawn]
    words = []
    if len(kept) < len(named):
        words.append("holds with " + (", ".join(kept) if kept else "none of the cases"))
    if drawn:
        number = len([label for label in drawn if label in holding])
        words.append(f"holds for {number} of {len(drawn)} drawn sets of parameters")
    return CONDITIONAL, "; ".join(words)


def _common(cases: Mapping[str, Measured]) -> str:
    """The one reason that all cases give, if they do."""
    reasons = {m.why for m in cases.values()}
    return reasons.pop() if len(reasons) == 1 else ""
