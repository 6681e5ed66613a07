"""Friction laws compared by experiment.

>>> from stiction.compare import compare
>>> table = compare(["coulomb"], steps=2000, draws=2)
>>> table["coulomb"].cells["holds_still"].verdict
'yes'
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._support.lazy import lazy

if TYPE_CHECKING:
    from .measured import Measured, Property
    from .properties import PROPERTIES
    from .result import CONDITIONAL, NO, UNDEFINED, YES, Cell, Comparison, Row
    from .run import compare

__all__ = [
    "CONDITIONAL",
    "NO",
    "PROPERTIES",
    "UNDEFINED",
    "YES",
    "Cell",
    "Comparison",
    "Measured",
    "Property",
    "Row",
    "compare",
]

__getattr__, __dir__ = lazy(
    __name__,
    {
        "CONDITIONAL": "result",
        "Cell": "result",
        "Comparison": "result",
        "Measured": "measured",
        "NO": "result",
        "PROPERTIES": "properties",
        "Property": "measured",
        "Row": "result",
        "UNDEFINED": "result",
        "YES": "result",
        "compare": "run",
    },
)
